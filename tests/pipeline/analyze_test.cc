// A clip in, a trial out: rendered clips against their truth, and the document.
#include "app/pipeline/analyze.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "app/pipeline/analysis_text.h"
#include "app/pipeline/evidence.h"
#include "tests/pipeline/filmed.h"
#include "tests/support/csv.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/composite_clip.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/clip_writer.h"

namespace touchdown::pipeline {
namespace {

using core::BodyKind;
using core::MotionState;
using filmed::Default;
using filmed::Film;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

AnalyzeOptions Known(const Film& film) {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{
      film.camera.px_per_m, 1e-4 * film.camera.px_per_m, std::nullopt};
  return options;
}

Analysis AnalyzeFilm(const Film& film, std::uint64_t seed = 1) {
  return AnalyzeClip(vision::OpenScene(filmed::SceneOf(film), seed),
                     Known(film));
}

// |error| within 4 standard uncertainties.
void ExpectMeasured(const core::Measured& measured, double truth,
                    const char* what) {
  ASSERT_TRUE(measured) << what << ": " << measured.error().reason;
  EXPECT_NEAR(measured->value, truth, 4.0 * measured->u) << what;
}

void ExpectTruth(const Analysis& analysis, const Film& film) {
  const vision::synthetic::Throw& t = film.thrown;
  ASSERT_TRUE(analysis.body) << analysis.no_body_reason;
  EXPECT_EQ(analysis.body->kind, t.kind);
  const core::ContactRecord& first = analysis.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  ExpectMeasured(first.contact.time_s, film.contact_frame / film.camera.fps,
                 "time");
  ExpectMeasured(first.contact.frame, film.contact_frame, "frame");
  ExpectMeasured(first.contact.approach_angle_rad, t.ContactAngle(),
                 "approach");
  EXPECT_LT(first.contact.approach_angle_rad->u, 0.3 * core::kDegree);
  ExpectMeasured(first.motion.before_normal_mps, t.before.vy, "vn");
  ExpectMeasured(first.motion.before_tangential_mps, t.before.vx, "vt");
  ExpectMeasured(first.motion.after_normal_mps, t.after.vy, "vn'");
  ExpectMeasured(first.motion.after_tangential_mps, t.after.vx, "vt'");
  ExpectMeasured(first.motion.centre_rebound_ratio, -t.after.vy / t.before.vy,
                 "centre ratio");
  EXPECT_EQ(first.state.label, MotionState::kBounce) << first.state.reason;
  EXPECT_TRUE(analysis.contacts.later.empty());
  if (t.kind == BodyKind::kRectangle) {
    ExpectMeasured(first.contact.face_angle_rad, t.face_rad, "face");
    ExpectMeasured(first.contact.radius_angle_rad,
                   std::atan2(t.Support(t.face_rad), std::abs(t.Arm())),
                   "radius");
    EXPECT_EQ(first.contact.corner, core::Corner::kTrailing);
    ExpectMeasured(first.motion.restitution, 0.6, "e");
    ExpectMeasured(first.motion.after_omega_rad_per_s, t.after.omega, "omega'");
  } else {
    ExpectMeasured(first.motion.restitution, 0.6, "e");
    EXPECT_FALSE(first.motion.before_omega_rad_per_s);
  }
  ASSERT_TRUE(analysis.ground);
  EXPECT_EQ(analysis.ground->source, calib::GroundSource::kDetected);
}

struct Case {
  const char* name;
  BodyKind kind;
  bool left = false;
  double roll_deg = 0.4;
  std::int32_t bit_depth = 8;
  bool light = false;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class AnalyzeRendered : public ::testing::TestWithParam<Case> {};

TEST_P(AnalyzeRendered, AgreesWithTheTruth) {
  const Case& c = GetParam();
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Film film = Default(c.kind);
    film.camera.travels_left = c.left;
    film.camera.roll_rad = c.roll_deg * core::kDegree;
    film.camera.bit_depth = c.bit_depth;
    film.contact_frame += 0.31 * static_cast<double>(seed);
    if (c.light) {
      film.look.body_level = 0.85;
      film.look.background_level = 0.15;
      film.look.ground_level = 0.30;
    }
    SCOPED_TRACE(seed);
    ExpectTruth(AnalyzeFilm(film, seed), film);
  }
}

constexpr BodyKind kSphere = BodyKind::kSphere;
constexpr BodyKind kBlock = BodyKind::kRectangle;
INSTANTIATE_TEST_SUITE_P(
    All, AnalyzeRendered,
    ::testing::Values(Case{"Sphere", kSphere},
                      Case{"SphereToTheLeft", kSphere, true},
                      Case{"SphereRolledCamera", kSphere, false, -6.0},
                      Case{"SphereTwelveBits", kSphere, false, 0.4, 12},
                      Case{"SphereLightOnDark", kSphere, false, 0.4, 8, true},
                      Case{"Block", kBlock},
                      Case{"BlockToTheLeft", kBlock, true},
                      Case{"BlockRolledCamera", kBlock, true, 5.0},
                      Case{"BlockTwelveBits", kBlock, false, 0.4, 12},
                      Case{"BlockLightOnDark", kBlock, false, 0.4, 12, true}),
    [](const auto& each) { return std::string(each.param.name); });

// Two dozen clips together: their errors are what is claimed, no more, no less.
TEST(AnalyzeSpheres, UncertaintiesAreHonest) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> z_angle, z_time;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    Film film = Default(kSphere);
    const double angle = (30.0 + 15.0 * uniform(engine)) * core::kDegree;
    film.thrown.before = {1.3 * std::cos(angle), -1.3 * std::sin(angle), 0.0};
    film.thrown.after = {1.1 * std::cos(angle), 0.6 * std::sin(angle), 0.0};
    film.camera.travels_left = seed % 2 == 0;
    film.contact_frame += uniform(engine);
    const core::Contact contact =
        AnalyzeFilm(film, 100 + seed).contacts.first.contact;
    ASSERT_TRUE(contact.found) << contact.reason;
    z_angle.push_back((contact.approach_angle_rad->value - angle) /
                      contact.approach_angle_rad->u);
    z_time.push_back((contact.frame->value - film.contact_frame) /
                     contact.frame->u);
  }
  const auto band = testing::RmsBand9999(24);
  for (const auto& z : {z_angle, z_time}) {
    EXPECT_LT(testing::Rms(z), band.high);
    EXPECT_GT(testing::Rms(z), band.low);
  }
}

// ---- The document -------------------------------------------------------

using Visit = std::function<void(const std::string&, const json&)>;
void Walk(const json& value, const std::string& path, const Visit& visit) {
  visit(path, value);
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      Walk(child, path.empty() ? key : path + "." + key, visit);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      Walk(value[i], path + "[" + std::to_string(i) + "]", visit);
    }
  }
}

// The document of DESIGN.md section 4, whatever was found: every key is there;
// null where absent, with its reason under "absent", and nothing else there.
json ExpectDocument(const Analysis& analysis) {
  json document;
  try {
    document = json::parse(ToJson(analysis));
  } catch (const json::exception& error) {
    ADD_FAILURE() << error.what();
    return document;
  }
  EXPECT_EQ(document["schema"], "touchdown.analysis/1");
  const char* const keys[] = {"/clip/path",
                              "/clip/id",
                              "/clip/sha256",
                              "/clip/format",
                              "/clip/width_px",
                              "/clip/height_px",
                              "/clip/bit_depth",
                              "/clip/frames",
                              "/clip/first_camera_frame",
                              "/clip/time_base/fps",
                              "/clip/time_base/source",
                              "/clip/time_base/uniform",
                              "/clip/time_base/trusted",
                              "/scale",
                              "/ground",
                              "/body",
                              "/contact/found",
                              "/contact/time_s",
                              "/contact/frame",
                              "/contact/angle_kind",
                              "/contact/angle_deg",
                              "/contact/approach_angle_deg",
                              "/contact/radius_angle_deg",
                              "/contact/face_angle_deg",
                              "/contact/corner",
                              "/contact/duration_s",
                              "/contact/budget",
                              "/state/label",
                              "/state/p_bounce",
                              "/state/reason",
                              "/state/max_gap_mm",
                              "/state/bounce_height_mm",
                              "/state/detectable_gap_mm",
                              "/state/micro_bounce",
                              "/later_contacts",
                              "/motion/before/speed_mps",
                              "/motion/before/normal_mps",
                              "/motion/before/tangential_mps",
                              "/motion/before/omega_rad_per_s",
                              "/motion/after/normal_mps",
                              "/motion/after/tangential_mps",
                              "/motion/after/omega_rad_per_s",
                              "/motion/restitution",
                              "/motion/centre_rebound_ratio",
                              "/motion/impulse_ratio",
                              "/motion/gravity_check_mps2",
                              "/scene_model/used",
                              "/scene_model/left_out",
                              "/warnings",
                              "/timing_s/total",
                              "/timing_s/decode",
                              "/timing_s/track",
                              "/timing_s/digest",
                              "/absent",
                              "/software/version",
                              "/software/options_hash"};
  for (const char* key : keys) {
    EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
  }
  if (document["scale"].is_object()) {
    for (const char* key :
         {"/scale/px_per_m/value", "/scale/px_per_m/u", "/scale/source"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  if (document["ground"].is_object()) {
    for (const char* key :
         {"/ground/x1_px", "/ground/y1_px", "/ground/x2_px", "/ground/y2_px",
          "/ground/u_angle_deg", "/ground/source"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  if (document["body"].is_object()) {
    for (const char* key : {"/body/kind", "/body/diameter_mm", "/body/long_mm",
                            "/body/short_mm"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  std::set<std::string> nulls;
  Walk(document, "", [&](const std::string& path, const json& value) {
    if (path.rfind("absent", 0) == 0) return;
    if (value.is_null()) {
      nulls.insert(path);
      EXPECT_TRUE(document["absent"].contains(path))
          << path << " is null without a reason";
    }
    if (value.is_number()) {
      EXPECT_TRUE(std::isfinite(value.get<double>()));
    }
    // A measured number has its uncertainty.
    if (value.is_object() && value.contains("value")) {
      EXPECT_TRUE(value["value"].is_number()) << path;
      EXPECT_TRUE(value["u"].is_number()) << path;
      EXPECT_GE(value["u"].get<double>(), 0.0) << path;
    }
  });
  for (const auto& [path, reason] : document["absent"].items()) {
    EXPECT_TRUE(nulls.contains(path)) << path << " is said to be absent";
    EXPECT_FALSE(reason.get<std::string>().empty()) << path;
  }
  return document;
}

TEST(AnalyzeDocument, OfABounce) {
  const Film film = Default(kSphere);
  const Analysis analysis = AnalyzeFilm(film);
  const json document = ExpectDocument(analysis);
  EXPECT_EQ(document["contact"]["found"], true);
  EXPECT_EQ(document["contact"]["angle_kind"], "approach");
  EXPECT_EQ(document["contact"]["angle_deg"],
            document["contact"]["approach_angle_deg"]);
  EXPECT_NEAR(document["contact"]["angle_deg"]["value"].get<double>(),
              film.thrown.ContactAngle() / core::kDegree, 0.3);
  EXPECT_EQ(document["state"]["label"], "bounce");
  EXPECT_GT(document["state"]["p_bounce"].get<double>(), 0.975);
  EXPECT_EQ(document["state"]["bounce_height_mm"].get<double>(), 0.5);
  EXPECT_EQ(document["body"]["kind"], "sphere");
  EXPECT_NEAR(document["body"]["diameter_mm"]["value"].get<double>(), 24.0,
              0.1);
  EXPECT_TRUE(document["contact"]["radius_angle_deg"].is_null());
  EXPECT_THAT(document["absent"]["contact.radius_angle_deg"].get<std::string>(),
              HasSubstr("sphere"));
  EXPECT_EQ(document["ground"]["source"], "detected");
  EXPECT_EQ(document["scale"]["source"], "user");
  EXPECT_EQ(document["clip"]["width_px"], 240);
  EXPECT_EQ(document["clip"]["frames"], film.frames);
  EXPECT_GT(document["timing_s"]["total"].get<double>(), 0.0);
  EXPECT_FALSE(document["contact"]["budget"].empty());
  for (const json& line : document["contact"]["budget"]) {
    EXPECT_TRUE(line.contains("source"));
    EXPECT_TRUE(line.contains("u_deg"));
  }
  // For a person.
  const std::string text = ToText(analysis);
  for (const char* word : {"sphere", "bounce", "approach angle", "deg", "mm",
                           "ground", "speed", "frames/s"}) {
    EXPECT_THAT(text, HasSubstr(word));
  }
  EXPECT_THAT(text, ::testing::Not(HasSubstr("nan")));
  // The trial for the store says the same.
  const core::Trial trial = ToTrial(analysis);
  EXPECT_EQ(trial.first, analysis.contacts.first);
  EXPECT_EQ(trial.origin, core::Origin::kRecorded);
  EXPECT_EQ(json::parse(trial.document_json)["state"]["label"], "bounce");
}

TEST(AnalyzeDocument, OfABlockItsAngleIsTheRadiusAngleUnlessAskedOtherwise) {
  const Film film = Default(kBlock);
  AnalyzeOptions options = Known(film);
  for (const auto& [kind, key] :
       std::vector<std::pair<std::optional<core::AngleKind>, std::string>>{
           {std::nullopt, "radius"},
           {core::AngleKind::kApproach, "approach"},
           {core::AngleKind::kFace, "face"}}) {
    options.angle_kind = kind;
    const Analysis analysis =
        AnalyzeClip(vision::OpenScene(filmed::SceneOf(film), 3), options);
    const json document = ExpectDocument(analysis);
    const json& contact = document["contact"];
    EXPECT_EQ(contact["angle_kind"], key);
    EXPECT_EQ(contact["angle_deg"], contact[key + "_angle_deg"]);
    EXPECT_EQ(contact["corner"], "trailing");
    EXPECT_TRUE(document["absent"].contains("body.diameter_mm"));
    EXPECT_THAT(ToText(analysis), HasSubstr("(" + key + " angle)"));
  }
}

TEST(AnalyzeDocument, NothingMoves) {
  Film film = Default(kSphere);
  film.lead_in = film.frames + 10;
  const Analysis analysis = AnalyzeFilm(film);
  EXPECT_FALSE(analysis.body);
  const json document = ExpectDocument(analysis);
  EXPECT_EQ(document["contact"]["found"], false);
  EXPECT_EQ(document["state"]["label"], "undecided");
  EXPECT_TRUE(document["state"]["p_bounce"].is_null());
  EXPECT_THAT(document["contact"]["reason"].get<std::string>(),
              HasSubstr("nothing moves"));
  EXPECT_THAT(ToText(analysis), HasSubstr("nothing moves"));
}

TEST(AnalyzeDocument, TwoBodies) {
  Film film = Default(kSphere);
  Film other = film;
  other.thrown.before = {-1.6, -0.1, 0.0};
  other.thrown.after = {-1.5, 0.1, 0.0};
  other.thrown.x_m = 0.01;
  auto clip = std::make_unique<vision::synthetic::Darker>(
      vision::OpenScene(filmed::SceneOf(film), 1), [&] {
        vision::Scene scene = filmed::SceneOf(other);
        const auto pose = scene.pose;
        scene.pose = [pose](double t) {
          vision::ScenePose p = pose(t);
          p.centre.y_m += 0.05;  // above the other
          return p;
        };
        return vision::OpenScene(scene, 2);
      }());
  const Analysis analysis = AnalyzeClip(std::move(clip), Known(film));
  const json document = ExpectDocument(analysis);
  EXPECT_EQ(document["contact"]["found"], false);
  EXPECT_EQ(document["state"]["label"], "undecided");
  EXPECT_THAT(document["state"]["reason"].get<std::string>(),
              HasSubstr("several bodies"));
}

TEST(AnalyzeDocument, NoContactWithinTheClip) {
  Film film = Default(kSphere);
  film.frames = 74;
  const Analysis analysis = AnalyzeFilm(film);
  ASSERT_TRUE(analysis.body);
  const json document = ExpectDocument(analysis);
  EXPECT_EQ(document["contact"]["found"], false);
  EXPECT_EQ(document["state"]["label"], "undecided");
  EXPECT_TRUE(document["state"]["p_bounce"].is_null());
}

TEST(AnalyzeDocument, ReboundNotFilmedIsUndecided) {
  for (const std::int64_t frames : {81, 82}) {
    Film film = Default(kSphere);
    film.frames = frames;
    const Analysis analysis = AnalyzeFilm(film);
    const json document = ExpectDocument(analysis);
    EXPECT_EQ(document["contact"]["found"], true) << frames;
    EXPECT_EQ(document["state"]["label"], "undecided") << frames;
    EXPECT_TRUE(document["state"]["p_bounce"].is_null()) << frames;
    EXPECT_THAT(document["state"]["reason"].get<std::string>(),
                HasSubstr("no rebound was filmed"))
        << frames;
    ExpectMeasured(analysis.contacts.first.contact.approach_angle_rad,
                   film.thrown.ContactAngle(), "approach");
  }
}

TEST(AnalyzeDocument, WithoutAScale) {
  const Film film = Default(kSphere);
  const Analysis analysis =
      AnalyzeClip(vision::OpenScene(filmed::SceneOf(film), 1), {});
  const json document = ExpectDocument(analysis);
  EXPECT_TRUE(document["scale"].is_null());
  EXPECT_THAT(document["absent"]["scale"].get<std::string>(),
              HasSubstr("--scale-px-per-m"));
  EXPECT_TRUE(document["motion"]["before"]["speed_mps"].is_null());
  EXPECT_EQ(document["contact"]["found"], true);
  ExpectMeasured(analysis.contacts.first.contact.approach_angle_rad,
                 film.thrown.ContactAngle(), "approach");
  EXPECT_EQ(document["state"]["label"], "bounce");
}

TEST(AnalyzeDocument, SlideOfABlock) {
  Film film = Default(kBlock);
  film.thrown.face_rad = 0.0;
  film.thrown.before = {1.2, -0.25, 0.0};
  film.thrown.after = {1.1, 0.0, 0.0};
  film.thrown.stays = true;
  film.frames = 130;
  const Analysis analysis = AnalyzeFilm(film);
  const json document = ExpectDocument(analysis);
  EXPECT_EQ(document["contact"]["found"], true);
  EXPECT_EQ(document["state"]["label"], "slide") << document["state"];
  EXPECT_EQ(document["contact"]["corner"], "flush");
  ExpectMeasured(analysis.contacts.first.contact.approach_angle_rad,
                 film.thrown.ContactAngle(), "approach");
  // On the ground from the first frame: approach angle 0.
  film.contact_frame = -400.0;
  film.thrown.x_m = -0.58;
  const Analysis down = AnalyzeFilm(film);
  const json from_start = ExpectDocument(down);
  EXPECT_EQ(from_start["contact"]["found"], true);
  EXPECT_EQ(from_start["contact"]["from_start"], true);
  EXPECT_EQ(from_start["contact"]["approach_angle_deg"]["value"], 0.0);
  EXPECT_TRUE(from_start["contact"]["time_s"].is_null());
  EXPECT_EQ(from_start["state"]["label"], "slide");
}

// ---- Options ------------------------------------------------------------

TEST(AnalyzeOptionsRefused, ByName) {
  Film film = Default(kSphere);
  film.frames = 20;
  const auto refusal = [&](const std::function<void(AnalyzeOptions&)>& set) {
    AnalyzeOptions options;
    set(options);
    try {
      AnalyzeClip(vision::OpenScene(filmed::SceneOf(film), 1), options);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  const core::Estimate negative{-1.0, 0.1, std::nullopt};
  const core::Estimate fine{0.02, 1e-5, std::nullopt};
  EXPECT_THAT(refusal([&](auto& o) { o.scale_px_per_m = negative; }),
              HasSubstr("scale"));
  EXPECT_THAT(refusal([&](auto& o) { o.diameter_m = negative; }),
              HasSubstr("diameter"));
  EXPECT_THAT(refusal([&](auto& o) { o.long_m = fine; }), HasSubstr("sides"));
  EXPECT_THAT(
      refusal([&](auto& o) { o.diameter_m = o.long_m = o.short_m = fine; }),
      HasSubstr("diameter and sides"));
  EXPECT_THAT(refusal([&](auto& o) {
                o.body_kind = kBlock;
                o.diameter_m = fine;
              }),
              HasSubstr("rectangle"));
  EXPECT_THAT(refusal([](auto& o) { o.bounce_height_m = 0.0; }),
              HasSubstr("bounce height"));
  EXPECT_THAT(refusal([](auto& o) { o.first_frame = 20; }),
              HasSubstr("frames"));
  EXPECT_THAT(refusal([](auto& o) { o.last_frame = 21; }), HasSubstr("0:20"));
  EXPECT_THAT(refusal([](auto& o) { o.first_frame = -1; }),
              HasSubstr("frames"));
  EXPECT_THAT(refusal([](auto& o) {
                o.region = {500, 500, 10, 10};
              }),
              HasSubstr("region"));
}

TEST(AnalyzeScale, FromTheBodysOwnSize) {
  Film film = Default(kSphere);
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{0.024, 1e-5, std::nullopt};
  const Analysis analysis =
      AnalyzeClip(vision::OpenScene(filmed::SceneOf(film), 1), options);
  ASSERT_TRUE(analysis.scale);
  EXPECT_EQ(analysis.scale->source, calib::ScaleSource::kBodySize);
  EXPECT_NEAR(analysis.scale->px_per_m.value, 1000.0,
              4.0 * analysis.scale->px_per_m.u);
  ExpectTruth(analysis, film);
  Film block = Default(kBlock);
  AnalyzeOptions sides;
  sides.long_m = core::Estimate{0.016, 1e-5, std::nullopt};  // either order
  sides.short_m = core::Estimate{0.040, 1e-5, std::nullopt};
  const Analysis blocks =
      AnalyzeClip(vision::OpenScene(filmed::SceneOf(block), 1), sides);
  ASSERT_TRUE(blocks.scale);
  EXPECT_NEAR(blocks.scale->px_per_m.value, 1000.0,
              4.0 * blocks.scale->px_per_m.u);
}

// ---- Files --------------------------------------------------------------

std::filesystem::path WriteFilm(const Film& film,
                                const std::filesystem::path& path) {
  const auto clip = vision::OpenScene(filmed::SceneOf(film), 1);
  std::int64_t next = 0;
  vision::MrawOptions options;
  options.fps = film.camera.fps;
  vision::WriteMraw(path, options, [&]() -> std::optional<core::Frame> {
    if (next == film.frames) return std::nullopt;
    return clip->Read(next++);
  });
  return path;
}

std::vector<std::string> Names(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

TEST(AnalyzeFiles, TruncatedRecordingIsAnalysedWithAWarning) {
  const testing::TemporaryFolder folder;
  const Film film = Default(kSphere);
  const auto path = WriteFilm(film, folder / "shot.mraw");
  const Analysis whole = Analyze(path, Known(film));
  ExpectTruth(whole, film);
  EXPECT_FALSE(whole.clip_id.empty());
  EXPECT_EQ(whole.clip.path, path);
  // Its last 12 frames and a half are lost.
  std::filesystem::resize_file(path, 240 * 120 * 102 + 240 * 60);
  const Analysis cut = Analyze(path, Known(film));
  EXPECT_EQ(cut.clip.frames, 102);
  EXPECT_FALSE(cut.warnings.empty());
  ExpectTruth(cut, film);
  EXPECT_NE(cut.clip_id, whole.clip_id);
  const json document = ExpectDocument(cut);
  EXPECT_FALSE(document["warnings"].empty());
}

TEST(AnalyzeFiles, EvidenceIsWhatAPersonCanCheck) {
  const testing::TemporaryFolder folder;
  for (const BodyKind kind : {kSphere, kBlock}) {
    const Film film = Default(kind);
    const auto path = WriteFilm(film, folder / "shot.mraw");
    const Analysis analysis = Analyze(path, Known(film));
    const auto out = folder / "out/deep";
    std::filesystem::remove_all(out);
    WriteEvidence(analysis, Known(film), out);
    EXPECT_THAT(Names(out), UnorderedElementsAre("track.csv", "contact.png",
                                                 "analysis.json"));
    EXPECT_EQ(json::parse(testing::ReadAll(out / "analysis.json")),
              json::parse(ToJson(analysis)));
    EXPECT_EQ(testing::ReadAll(out / "contact.png").substr(1, 3), "PNG");
    const auto rows = testing::SplitCsv(testing::ReadAll(out / "track.csv"));
    ASSERT_EQ(rows.size(), analysis.track->poses.size() + 1);
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
    const testing::Row row =
        testing::ParseCsv(testing::ReadAll(out / "track.csv")).front();
    for (const char* column : {"frame", "time_s", "x_px", "y_px", "gap_px"}) {
      EXPECT_TRUE(row.cells.contains(column)) << column;
    }
    EXPECT_NEAR(row.Number("x_px"), analysis.track->poses.front().centre.x_px,
                1e-4);
    // Again into the same folder: replaced, nothing left over.
    WriteEvidence(analysis, Known(film), out);
    EXPECT_EQ(Names(out).size(), 3u);
  }
}

TEST(AnalyzeFiles, EvidenceOfNothing) {
  const testing::TemporaryFolder folder;
  Film film = Default(kSphere);
  film.lead_in = film.frames + 10;
  film.frames = 20;
  const auto path = WriteFilm(film, folder / "empty.mraw");
  WriteEvidence(Analyze(path, {}), {}, folder / "out");
  EXPECT_THAT(Names(folder / "out"),
              UnorderedElementsAre("track.csv", "analysis.json"));
}

TEST(AnalyzeFiles, UnwritableFolderIsNamedAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  const Film film = Default(kSphere);
  const auto path = WriteFilm(film, folder / "shot.mraw");
  const Analysis analysis = Analyze(path, Known(film));
  folder.Write("file", "not a folder");
  try {
    WriteEvidence(analysis, {}, folder / "file/out");
    ADD_FAILURE() << "written";
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("file/out"));
  }
  EXPECT_EQ(testing::ReadAll(folder / "file"), "not a folder");
  // One of the names is taken by a folder: nothing half-written stays.
  std::filesystem::create_directories(folder / "taken/contact.png/x");
  try {
    WriteEvidence(analysis, {}, folder / "taken");
    ADD_FAILURE() << "written";
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("contact.png"));
  }
  for (const std::string& name : Names(folder / "taken")) {
    EXPECT_TRUE(name == "track.csv" || name == "analysis.json" ||
                name == "contact.png")
        << name;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
