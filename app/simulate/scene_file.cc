#include "app/simulate/scene_file.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "app/simulate/shot_json.h"
#include "touchdown/core/body.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using nlohmann::json;

constexpr const char* kSchema = "touchdown.scene/1";

// One object of the file: hands out its members, remembers which were asked
// for, and refuses the others (a misspelt name would be a silent default).
class Object {
 public:
  Object(const json& value, std::string source, std::string path)
      : value_(value), source_(std::move(source)), path_(std::move(path)) {
    if (!value_.is_object()) Fail("", "must be an object");
  }

  // "shot.json: /camera/fps is -1, must be positive". `name` is the member,
  // empty for the object itself.
  [[noreturn]] void Fail(const std::string& name,
                         const std::string& expected) const {
    const std::string where = path_ + (name.empty() ? "" : "/" + name);
    throw core::InputError(fmt::format("{}: {} {}", source_,
                                       where.empty() ? "/" : where, expected));
  }

  bool Has(const std::string& name) const { return value_.contains(name); }

  // Returns a member that must be there, and notes that it was asked for.
  const json& Member(const std::string& name) {
    known_.insert(name);
    if (!value_.contains(name)) Fail(name, "is missing");
    return value_.at(name);
  }

  Object Child(const std::string& name) {
    return {Member(name), source_, path_ + "/" + name};
  }

  // Number and Whole have two forms: one returns a member that is required, the
  // other overwrites `into`, which holds the default, where the member is
  // given.
  double Number(const std::string& name) {
    const json& member = Member(name);
    if (!member.is_number()) {
      Fail(name, fmt::format("is {}, must be a number", member.dump()));
    }
    return member.get<double>();
  }
  double Positive(const std::string& name) {
    const double value = Number(name);
    if (!(value > 0.0)) {
      Fail(name, fmt::format("is {}, must be positive", value));
    }
    return value;
  }
  // `unit` brings the member to SI: core::kMillimetre for "x_mm".
  void Number(const std::string& name, double unit, double& into) {
    known_.insert(name);
    if (Has(name)) into = Number(name) * unit;
  }

  // Returns a whole number in low .. high. An unsigned one is compared first,
  // since one above 2^63 would become negative in the conversion.
  std::int64_t Whole(const std::string& name, std::int64_t low,
                     std::int64_t high) {
    const json& member = Member(name);
    if (!member.is_number_integer() ||
        (member.is_number_unsigned() &&
         member.get<std::uint64_t>() > static_cast<std::uint64_t>(high)) ||
        member.get<std::int64_t>() < low || member.get<std::int64_t>() > high) {
      Fail(name, fmt::format("is {}, must be a whole number of {} .. {}",
                             member.dump(), low, high));
    }
    return member.get<std::int64_t>();
  }
  template <class Integer>
  void Whole(const std::string& name, std::int64_t low, std::int64_t high,
             Integer& into) {
    known_.insert(name);
    if (Has(name)) into = static_cast<Integer>(Whole(name, low, high));
  }

  std::string Word(const std::string& name, const std::string& expected) {
    const json& member = Member(name);
    if (!member.is_string()) {
      Fail(name, fmt::format("is {}, must be {}", member.dump(), expected));
    }
    return member.get<std::string>();
  }
  std::string Word(const std::string& name) { return Word(name, "a word"); }

  // Refuses members that nobody asked for. Called when all known names of the
  // object were read.
  void Done() const {
    for (const auto& [name, member] : value_.items()) {
      if (!known_.contains(name)) {
        Fail(name, "is not a name of " + std::string(kSchema) +
                       "; `touchdown simulate --example` shows them");
      }
    }
  }

 private:
  const json& value_;
  std::string source_;
  std::string path_;
  std::set<std::string> known_;
};

// A recording of more frames is none: at 2000 frames/s it would take 12 days.
constexpr std::int64_t kMaxInt32 = std::numeric_limits<std::int32_t>::max();

// Reads the body. Its sizes are exact, u = 0: they are the truth.
core::Body ReadBody(Object body) {
  const std::string word = body.Word("kind", "sphere or rectangle");
  core::Body out;
  if (word == "sphere") {
    out = core::Sphere({body.Positive("diameter_mm") * core::kMillimetre, 0.0});
  } else if (word == "rectangle") {
    const double a = body.Positive("long_mm") * core::kMillimetre;
    const double b = body.Positive("short_mm") * core::kMillimetre;
    out = core::Rectangle({a, 0.0}, {b, 0.0});
  } else {
    body.Fail("kind",
              fmt::format("is '{}', must be sphere or rectangle", word));
  }
  body.Done();
  return out;
}

// k1, k2, p1, p2, k3, the focal length and where the axis meets the picture
// (its middle where not given).
calib::Lens ReadLens(Object object, const vision::SceneCamera& camera) {
  calib::Lens lens;
  lens.fx_px = lens.fy_px = object.Positive("focal_px");
  lens.cx_px = 0.5 * (camera.width_px - 1);
  lens.cy_px = 0.5 * (camera.height_px - 1);
  object.Number("cx_px", 1.0, lens.cx_px);
  object.Number("cy_px", 1.0, lens.cy_px);
  object.Number("k1", 1.0, lens.k1);
  object.Number("k2", 1.0, lens.k2);
  object.Number("p1", 1.0, lens.p1);
  object.Number("p2", 1.0, lens.p2);
  object.Number("k3", 1.0, lens.k3);
  object.Done();
  return lens;
}

// Reads the camera. Ranges that depend on several fields (an exposure longer
// than a frame) are left to vision::Validate, which Parse calls at the end.
vision::SceneCamera ReadCamera(Object object) {
  vision::SceneCamera camera;
  // No sensor has more pixels along a side.
  object.Whole("width_px", 1, 65536, camera.width_px);
  object.Whole("height_px", 1, 65536, camera.height_px);
  object.Number("px_per_m", 1.0, camera.px_per_m);
  object.Number("ground_x_px", 1.0, camera.ground_point.x_px);
  object.Number("ground_y_px", 1.0, camera.ground_point.y_px);
  object.Number("roll_deg", core::kDegree, camera.roll_rad);
  if (object.Has("travels")) {
    const std::string way = object.Word("travels", "right or left");
    if (way != "right" && way != "left") {
      object.Fail("travels",
                  fmt::format("is '{}', must be right or left", way));
    }
    camera.travels_left = way == "left";
  }
  if (object.Has("fps")) camera.fps = object.Positive("fps");
  object.Number("exposure_us", 1e-6, camera.exposure_s);
  object.Number("psf_sigma_px", 1.0, camera.psf_sigma_px);
  object.Whole("bit_depth", 1, 16, camera.bit_depth);
  if (object.Has("lens")) camera.lens = ReadLens(object.Child("lens"), camera);
  object.Number("yaw_deg", core::kDegree, camera.yaw_rad);
  object.Number("row_delay_us", 1e-6, camera.row_delay_s);
  object.Done();
  return camera;
}

// Reads brightness and texture. Levels are fractions of full scale.
vision::SceneLook ReadLook(Object object) {
  vision::SceneLook look;
  object.Number("body_level", 1.0, look.body_level);
  object.Number("background_level", 1.0, look.background_level);
  object.Number("ground_level", 1.0, look.ground_level);
  object.Number("gradient_x", 1.0, look.gradient_x);
  object.Number("gradient_y", 1.0, look.gradient_y);
  object.Number("texture_amplitude", 1.0, look.texture_amplitude);
  object.Number("texture_correlation_px", 1.0, look.texture_correlation_px);
  object.Whole("texture_seed", 0, std::numeric_limits<std::int64_t>::max(),
               look.texture_seed);
  object.Number("hole", 1.0, look.hole);
  if (object.Has("mark")) {
    Object mark = object.Child("mark");
    vision::SceneMark& m = look.mark.emplace();
    mark.Number("level", 1.0, m.level);
    mark.Number("distance", 1.0, m.distance);
    mark.Number("radius", 1.0, m.radius);
    mark.Done();
  }
  if (object.Has("face")) {
    Object face = object.Child("face");
    vision::SceneFace& f = look.face.emplace();
    face.Number("amplitude", 1.0, f.amplitude);
    face.Number("correlation_px", 1.0, f.correlation_px);
    face.Whole("seed", 0, std::numeric_limits<std::int64_t>::max(), f.seed);
    face.Done();
  }
  object.Done();
  return look;
}

// Reads what makes a recording hard: shading, highlights, shadows, flicker,
// waves, specks, an obstacle. What is not named is not there.
vision::SceneTrouble ReadTrouble(Object object) {
  vision::SceneTrouble trouble;
  object.Number("shading_x", 1.0, trouble.shading_x);
  object.Number("shading_y", 1.0, trouble.shading_y);
  object.Number("highlight_level", 1.0, trouble.highlight_level);
  object.Number("highlight_x", 1.0, trouble.highlight_x);
  object.Number("highlight_y", 1.0, trouble.highlight_y);
  object.Number("highlight_sigma", 1.0, trouble.highlight_sigma);
  object.Number("shadow_depth", 1.0, trouble.shadow_depth);
  object.Number("flicker_amplitude", 1.0, trouble.flicker_amplitude);
  object.Number("flicker_hz", 1.0, trouble.flicker_hz);
  object.Number("wave_amplitude_px", 1.0, trouble.wave_amplitude_px);
  object.Number("wave_length_px", 1.0, trouble.wave_length_px);
  object.Whole("specks", 0, 10000, trouble.specks);
  object.Number("speck_diameter_px", 1.0, trouble.speck_diameter_px);
  object.Number("speck_speed_px", 1.0, trouble.speck_speed_px);
  object.Whole("speck_seed", 0, std::numeric_limits<std::int64_t>::max(),
               trouble.speck_seed);
  if (object.Has("obstacle")) {
    Object rect = object.Child("obstacle");
    core::PixelRect& r = trouble.obstacle.emplace();
    constexpr std::int64_t kFar = 65536;
    r.x = static_cast<std::int32_t>(rect.Whole("x", -kFar, kFar));
    r.y = static_cast<std::int32_t>(rect.Whole("y", -kFar, kFar));
    r.width = static_cast<std::int32_t>(rect.Whole("width", 1, kFar));
    r.height = static_cast<std::int32_t>(rect.Whole("height", 1, kFar));
    rect.Done();
  }
  object.Number("obstacle_level", 1.0, trouble.obstacle_level);
  object.Done();
  return trouble;
}

// Height of the centre above the lowest outline point.
double CentreHeight(const core::Body& body, double angle_rad) {
  return -vision::Gap(body, {{0.0, 0.0}, angle_rad});
}

// Reads the state at frame lead_in_frames. The file tells the gap of the lowest
// point; the state wants the height of the centre.
analysis::BodyState ReadStart(Object object, const core::Body& body) {
  analysis::BodyState start;
  object.Number("x_mm", core::kMillimetre, start.centre.x_m);
  object.Number("vx_mps", 1.0, start.vx_mps);
  object.Number("vy_mps", 1.0, start.vy_mps);
  object.Number("angle_deg", core::kDegree, start.angle_rad);
  object.Number("omega_rad_per_s", 1.0, start.omega_rad_per_s);
  const double gap = object.Number("gap_mm");
  if (!(gap >= 0.0)) {
    object.Fail("gap_mm", fmt::format("is {}, must be at least 0", gap));
  }
  start.centre.y_m =
      gap * core::kMillimetre + CentreHeight(body, start.angle_rad);
  object.Done();
  return start;
}

// Back along the flight from the state at first contact to frame
// lead_in_frames.
// `frame` counts from the beginning of the clip and may lie between two frames.
// Throws where the flight back to frame lead_in_frames would pass through the
// ground.
analysis::BodyState ReadTouchdown(Object object, const core::Body& body,
                                  const Shot& shot) {
  const double fps = shot.camera.fps;
  const double gravity_mps2 = shot.thrown.gravity_mps2;
  analysis::BodyState at;
  const double frame = object.Number("frame");
  const auto lead_in = static_cast<double>(shot.lead_in_frames);
  if (!(frame >= lead_in)) {
    object.Fail("frame", fmt::format("is {}, must be after lead_in_frames, {}",
                                     frame, lead_in));
  }
  at.time_s = (frame - lead_in) / fps;
  const double speed = object.Positive("speed_mps");
  const double approach = object.Number("approach_angle_deg");
  if (!(approach >= 0.0 && approach <= 90.0)) {
    object.Fail("approach_angle_deg",
                fmt::format("is {}, must be from 0 to 90", approach));
  }
  object.Number("x_mm", core::kMillimetre, at.centre.x_m);
  object.Number("angle_deg", core::kDegree, at.angle_rad);
  object.Number("omega_rad_per_s", 1.0, at.omega_rad_per_s);
  object.Done();
  const double angle = approach * core::kDegree;
  // cos(pi/2) is 6e-17 and not 0; a body that falls straight must not travel.
  at.vx_mps = approach == 90.0 ? 0.0 : speed * std::cos(angle);
  at.vy_mps = -speed * std::sin(angle);
  at.centre.y_m = CentreHeight(body, at.angle_rad);

  // The free flight is solved backwards in closed form: spin and horizontal
  // speed are constant, the vertical speed grows by g t.
  analysis::BodyState start = at;
  const double t = at.time_s;
  start.time_s = 0.0;
  start.vy_mps = at.vy_mps + gravity_mps2 * t;
  start.centre.x_m = at.centre.x_m - at.vx_mps * t;
  start.centre.y_m = at.centre.y_m - at.vy_mps * t - 0.5 * gravity_mps2 * t * t;
  start.angle_rad = at.angle_rad - at.omega_rad_per_s * t;
  // The whole flight must be above the ground: the gap of a flight that rises
  // from the ground is 0 at frame 0 at the earliest.
  if (vision::Gap(body, {start.centre, start.angle_rad}) < 0.0) {
    object.Fail("frame",
                fmt::format("is {}: so long before touchdown this body would "
                            "be in the ground; give a smaller frame, or a "
                            "faster or steeper approach",
                            frame));
  }
  return start;
}

// Reads the physics. Body, frames and camera must have been read before: the
// state at touchdown is turned back in time by them.
void ReadThrown(Object object, Shot& shot) {
  analysis::RigidMotionProblem& thrown = shot.thrown;
  thrown.mu = object.Number("mu");
  thrown.restitution = object.Number("restitution");
  object.Number("gravity_mps2", 1.0, thrown.gravity_mps2);
  object.Number("gyration_radius_mm", core::kMillimetre,
                thrown.gyration_radius_m);
  const bool at_start = object.Has("start");
  if (at_start == object.Has("touchdown")) {
    object.Fail("", "must have either start or touchdown");
  }
  thrown.start =
      at_start ? ReadStart(object.Child("start"), thrown.body)
               : ReadTouchdown(object.Child("touchdown"), thrown.body, shot);
  object.Done();
}

// Reads the whole scene; every object refuses names that it does not know.
Shot ReadShot(const json& document, const std::string& source,
              const std::string& default_name) {
  Object object(document, source, "");
  const std::string schema = object.Word("schema");
  if (schema != kSchema) {
    object.Fail("schema",
                fmt::format("is '{}', must be '{}'", schema, kSchema));
  }
  Shot shot;
  shot.name = object.Has("name") ? object.Word("name") : default_name;
  // The camera comes before the throw, which needs its frame rate.
  if (object.Has("camera")) shot.camera = ReadCamera(object.Child("camera"));
  if (object.Has("look")) shot.look = ReadLook(object.Child("look"));
  if (object.Has("trouble")) {
    shot.trouble = ReadTrouble(object.Child("trouble"));
  }
  if (object.Has("noise")) {
    Object noise = object.Child("noise");
    noise.Number("read_dn", 1.0, shot.noise.read_dn);
    noise.Number("shot_dn2_per_dn", 1.0, shot.noise.shot_dn2_per_dn);
    noise.Done();
  }
  shot.thrown.body = ReadBody(object.Child("body"));
  shot.frames = object.Whole("frames", 1, kMaxInt32);
  object.Whole("lead_in_frames", 0, shot.frames - 1, shot.lead_in_frames);
  ReadThrown(object.Child("thrown"), shot);
  shot.angle_kind = core::DefaultAngleKind(shot.thrown.body.kind);
  if (object.Has("angle_kind")) {
    const std::string word =
        object.Word("angle_kind", "approach, radius or face");
    const auto kind = core::ParseAngleKind(word);
    if (!kind) {
      object.Fail(
          "angle_kind",
          fmt::format("is '{}', must be approach, radius or face", word));
    }
    shot.angle_kind = *kind;
  }
  if (object.Has("set_angle_deg")) {
    shot.set_angle_rad = object.Number("set_angle_deg") * core::kDegree;
  }
  if (object.Has("bounce_height_mm")) {
    shot.bounce_height_m =
        object.Positive("bounce_height_mm") * core::kMillimetre;
  }
  object.Done();
  return shot;
}

// Turns every way in which a text can be no scene into a core::InputError that
// names the source.
Shot Parse(const std::string& text, const std::string& source,
           const std::string& default_name) {
  json document;
  try {
    document = json::parse(text);
  } catch (const json::parse_error& error) {
    throw core::InputError(fmt::format(
        "{}: is not JSON: trouble at byte {}; `touchdown simulate --example` "
        "prints a scene",
        source, error.byte));
  } catch (const json::out_of_range&) {
    throw core::InputError(fmt::format(
        "{}: a number in it is too large; expected numbers up to 1e308",
        source));
  }
  Shot shot = ReadShot(document, source, default_name);
  try {
    // What only the whole can tell: ranges of the renderer and of the physics.
    // One frame of motion is enough to ask the physics for its ranges; the
    // whole of it may take long and is computed when the clip is made.
    analysis::RigidMotionProblem first_instant = MakeProblem(shot);
    first_instant.end_s = first_instant.start.time_s + 1.0 / shot.camera.fps;
    vision::Validate(
        BuildScene(shot, analysis::SimulateRigidMotion(first_instant)));
  } catch (const std::invalid_argument& error) {
    throw core::InputError(fmt::format("{}: {}", source, error.what()));
  }
  return shot;
}

}  // namespace

Shot ParseScene(const std::string& text, const std::string& source) {
  return Parse(text, source, "scene");
}

Shot ReadSceneFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw core::InputError(
        fmt::format("{}: cannot be read; is it there, and may you read it?",
                    path.string()));
  }
  const std::string text(std::istreambuf_iterator<char>(in), {});
  return Parse(text, path.string(), path.stem().string());
}

std::string SceneText(const Shot& shot) {
  return SceneJson(shot).dump(2) + "\n";
}

Shot ExampleShot() {
  Shot shot;
  shot.name = "sphere_20_deg";
  shot.lead_in_frames = 140;
  shot.frames = 280;
  shot.noise = {1.8, 0.03};
  shot.thrown.body = core::Sphere({40.0 * core::kMillimetre, 0.0});
  shot.thrown.mu = 0.3;
  shot.thrown.restitution = 0.5;
  // Touches down at 1.5 m/s and 20 degrees, 40 frames (20 ms) later.
  const double t = 0.020;
  const double g = shot.thrown.gravity_mps2;
  const double fall = 1.5 * std::sin(20.0 * core::kDegree);
  analysis::BodyState& start = shot.thrown.start;
  start.vx_mps = 1.5 * std::cos(20.0 * core::kDegree);
  start.vy_mps = -fall + g * t;
  start.centre.x_m = -0.05;
  start.centre.y_m = 0.020 + fall * t - 0.5 * g * t * t;
  return shot;
}

}  // namespace touchdown::pipeline
