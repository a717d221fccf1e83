#include "app/simulate/truth_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/simulate/shot_json.h"
#include "app/text/version.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using nlohmann::ordered_json;

// Returns the word of an event under "events"/"kind".
std::string_view EventName(analysis::EventKind kind) {
  switch (kind) {
    case analysis::EventKind::kImpact:
      return "impact";
    case analysis::EventKind::kFlushImpact:
      return "flush-impact";
    case analysis::EventKind::kSettles:
      return "settles";
    case analysis::EventKind::kRolls:
      return "rolls";
    case analysis::EventKind::kRests:
      return "rests";
  }
  return "?";
}

// Writes an angle in degrees, null where the body has none of this kind.
ordered_json DegreesJson(const std::optional<double>& angle_rad) {
  if (!angle_rad) return nullptr;
  return *angle_rad / core::kDegree;
}

// The varied angle.
std::optional<double> ContactAngle(const Shot& shot,
                                   const analysis::TouchdownTruth& t) {
  switch (shot.angle_kind) {
    case core::AngleKind::kRadius:
      return t.radius_angle_rad;
    case core::AngleKind::kFace:
      if (t.face_angle_rad) return std::abs(*t.face_angle_rad);
      return std::nullopt;
    case core::AngleKind::kApproach:
      break;
  }
  return t.approach_angle_rad;
}

// Leaves the ground at the very instant of touchdown (bodies are rigid).
bool Rebounds(const analysis::TouchdownTruth& t, double rest_speed_mps) {
  return !t.from_start && t.contact_vy_after_mps > 2.0 * rest_speed_mps;
}

// Writes the first touchdown. One from the start has no instant. duration_s is
// 0 for a rebound, since rigid bodies leave at once, and null for a body that
// stays down, which has no release.
ordered_json ContactJson(const Shot& shot, const ShotTruth& truth) {
  ordered_json contact;
  contact["found"] = truth.touchdown.has_value();
  if (!truth.touchdown) return contact;
  const analysis::TouchdownTruth& t = *truth.touchdown;
  contact["from_start"] = t.from_start;
  contact["time_s"] = t.from_start ? ordered_json() : ordered_json(t.time_s);
  contact["frame"] =
      t.from_start ? ordered_json() : ordered_json(t.time_s * shot.camera.fps);
  contact["angle_kind"] = std::string(core::Name(shot.angle_kind));
  contact["angle_deg"] = DegreesJson(ContactAngle(shot, t));
  contact["approach_angle_deg"] = DegreesJson(t.approach_angle_rad);
  contact["radius_angle_deg"] = DegreesJson(t.radius_angle_rad);
  contact["face_angle_deg"] = DegreesJson(t.face_angle_rad);
  contact["corner"] = t.corner
                          ? ordered_json(std::string(core::Name(*t.corner)))
                          : ordered_json();
  contact["duration_s"] = Rebounds(t, shot.thrown.rest_speed_mps)
                              ? ordered_json(0.0)
                              : ordered_json();
  return contact;
}

// Writes the true state by the same rule as the analysis, without an interval:
// the greatest gap is exact.
ordered_json StateJson(const ShotTruth& truth) {
  const bool contact = truth.touchdown.has_value();
  return {{"label", std::string(core::Name(truth.state))},
          {"bounce",
           contact ? ordered_json(truth.state == core::MotionState::kBounce)
                   : ordered_json()},
          {"max_gap_mm",
           contact ? ordered_json(truth.greatest.gap_m / core::kMillimetre)
                   : ordered_json()},
          {"max_gap_time_s",
           contact ? ordered_json(truth.greatest.time_s) : ordered_json()},
          {"bounce_height_mm", truth.bounce_height_m / core::kMillimetre},
          {"micro_bounce", truth.micro_bounce}};
}

// Writes what the physics was told (..._set) and the ratios that a perfect
// measurement would find. The two may differ: friction and spin take part in an
// impact.
ordered_json MotionJson(const Shot& shot, const ShotTruth& truth) {
  ordered_json motion;
  motion["gravity_mps2"] = shot.thrown.gravity_mps2;
  motion["restitution_set"] = shot.thrown.restitution;  // Poisson's
  motion["mu_set"] = shot.thrown.mu;
  if (!truth.touchdown) return motion;
  const analysis::TouchdownTruth& t = *truth.touchdown;
  motion["before"] = {
      {"speed_mps", std::hypot(t.before.vx_mps, t.before.vy_mps)},
      {"normal_mps", t.before.vy_mps},
      {"tangential_mps", t.before.vx_mps},
      {"omega_rad_per_s", t.before.omega_rad_per_s}};
  motion["after"] = {{"normal_mps", t.after.vy_mps},
                     {"tangential_mps", t.after.vx_mps},
                     {"omega_rad_per_s", t.after.omega_rad_per_s}};
  // The ratios need an impact: a body that is set down has no speed to divide
  // by.
  const bool impact =
      !t.from_start && t.contact_vy_before_mps < 0.0 && t.before.vy_mps < 0.0;
  motion["restitution"] =
      impact ? ordered_json(-t.contact_vy_after_mps / t.contact_vy_before_mps)
             : ordered_json();
  motion["centre_rebound_ratio"] =
      impact ? ordered_json(-t.after.vy_mps / t.before.vy_mps) : ordered_json();
  const double normal = t.after.vy_mps - t.before.vy_mps;
  motion["impulse_ratio"] =
      impact && normal > 0.0
          ? ordered_json(std::abs(t.after.vx_mps - t.before.vx_mps) / normal)
          : ordered_json();
  return motion;
}

// Lists what happened up to the last frame, each event with the state just
// before and just after it. Offsets are of the contact point from the centre.
ordered_json EventsJson(const Shot& shot, const ShotTruth& truth) {
  ordered_json events = ordered_json::array();
  const double last_s = static_cast<double>(shot.frames - 1) / shot.camera.fps;
  for (const analysis::MotionEvent& e : truth.motion.events) {
    if (e.before.time_s > last_s) break;
    const auto state = [](const analysis::BodyState& s, double contact_vx,
                          double contact_vy) -> ordered_json {
      return {{"normal_mps", s.vy_mps},
              {"tangential_mps", s.vx_mps},
              {"omega_rad_per_s", s.omega_rad_per_s},
              {"contact_normal_mps", contact_vy},
              {"contact_tangential_mps", contact_vx}};
    };
    events.push_back({{"kind", std::string(EventName(e.kind))},
                      {"time_s", e.before.time_s},
                      {"frame", e.before.time_s * shot.camera.fps},
                      {"x_mm", e.before.centre.x_m / core::kMillimetre},
                      {"angle_deg", e.before.angle_rad / core::kDegree},
                      {"contact_offset_x_mm", e.offset_x_m / core::kMillimetre},
                      {"contact_offset_y_mm", e.offset_y_m / core::kMillimetre},
                      {"before", state(e.before, e.contact_vx_before_mps,
                                       e.contact_vy_before_mps)},
                      {"after", state(e.after, e.contact_vx_after_mps,
                                      e.contact_vy_after_mps)}});
  }
  return events;
}

}  // namespace

std::string TruthText(const Shot& shot, const ShotTruth& truth,
                      const std::string& clip_name, const std::string& format,
                      std::uint64_t seed) {
  const vision::SceneCamera& camera = shot.camera;
  const calib::GroundLine ground = vision::TrueGroundLine(camera);
  ordered_json out;
  out["schema"] = "touchdown.truth/1";
  out["origin"] = std::string(core::Name(core::Origin::kSimulated));
  out["software"] = {{"version", std::string(Version())}};
  out["seed"] = seed;
  out["clip"] = {{"path", clip_name},
                 {"format", format},
                 {"width_px", camera.width_px},
                 {"height_px", camera.height_px},
                 {"bit_depth", camera.bit_depth},
                 {"frames", shot.frames},
                 {"fps", camera.fps}};
  out["scale_px_per_m"] = camera.px_per_m;
  out["ground"] = {{"x1_px", ground.p1.x_px},
                   {"y1_px", ground.p1.y_px},
                   {"x2_px", ground.p2.x_px},
                   {"y2_px", ground.p2.y_px}};
  out["body"] = BodyJson(shot.thrown.body);
  out["set_angle_deg"] = DegreesJson(shot.set_angle_rad);
  out["contact"] = ContactJson(shot, truth);
  out["state"] = StateJson(truth);
  out["motion"] = MotionJson(shot, truth);
  out["events"] = EventsJson(shot, truth);

  // Frames of the lead-in show no body and have no row.
  const vision::Scene scene = BuildScene(shot, truth.motion);
  ordered_json rows = ordered_json::array();
  for (std::int64_t i = shot.lead_in_frames; i < shot.frames; ++i) {
    const vision::SceneTruth frame = vision::ComputeTruth(scene, i);
    rows.push_back({i, frame.time_s, frame.centre.x_px, frame.centre.y_px,
                    frame.image_angle_rad / core::kDegree,
                    frame.pose.angle_rad / core::kDegree,
                    frame.pose.centre.x_m / core::kMillimetre,
                    frame.pose.centre.y_m / core::kMillimetre, frame.gap_px});
  }
  out["frames"] = {
      {"columns",
       {"index", "time_s", "centre_x_px", "centre_y_px", "image_angle_deg",
        "face_angle_deg", "x_mm", "y_mm", "gap_px"}},
      {"rows", rows}};
  // With the scene and the seed the clip can be made again.
  out["scene"] = SceneJson(shot);
  return out.dump(1) + "\n";
}

}  // namespace touchdown::pipeline
