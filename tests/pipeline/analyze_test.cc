// A clip in, a trial out: rendered clips against their truth, and the document.
#include "app/measure/analyze.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "app/documents/analysis_json.h"
#include "app/documents/analysis_text.h"
#include "app/documents/evidence.h"
#include "tests/pipeline/analyzed_film.h"
#include "tests/pipeline/document.h"
#include "tests/pipeline/filmed.h"
#include "tests/pipeline/shaken.h"
#include "tests/support/csv.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::pipeline {
namespace {

using core::BodyKind;
using core::MotionState;
using filmed::AnalyzeFilm;
using filmed::Default;
using filmed::ExpectDocument;
using filmed::ExpectMeasured;
using filmed::Film;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

void ExpectTruth(const Analysis& analysis, const Film& film) {
  const vision::synthetic::Throw& t = film.thrown;
  ASSERT_TRUE(analysis.body) << analysis.body.error().reason;
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

// ---- Options ------------------------------------------------------------

TEST(AnalyzeOptionsRefused, ByName) {
  Film film = Default(kSphere);
  film.frames = 20;
  const auto refusal = [&](const std::function<void(AnalyzeOptions&)>& set) {
    AnalyzeOptions options;
    set(options);
    try {
      AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 1), options);
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
              HasSubstr("bounce_height_m"));
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

// Touchdown and angle are those that a still camera sees.
TEST(Analyze, AMovingCameraIsPutBack) {
  Film film = Default(kSphere);
  film.look.texture_amplitude = 0.2;
  const Analysis analysis =
      AnalyzeClip(std::make_unique<filmed::ShakenClip>(film, filmed::ByHand),
                  filmed::Known(film));
  EXPECT_THAT(analysis.scene_model.used,
              ::testing::Contains(HasSubstr("motion of the camera")));
  ExpectTruth(analysis, film);
}

TEST(AnalyzeScale, FromTheBodysOwnSize) {
  Film film = Default(kSphere);
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{0.024, 1e-5, std::nullopt};
  const Analysis analysis =
      AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 1), options);
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
      AnalyzeClip(vision::OpenScene(filmed::BuildScene(block), 1), sides);
  ASSERT_TRUE(blocks.scale);
  EXPECT_NEAR(blocks.scale->px_per_m.value, 1000.0,
              4.0 * blocks.scale->px_per_m.u);
}

// The scene's camera is linear; nobody says so at first.
TEST(AnalyzeScale, ASizeThatNobodyStatedOwesItsUToTheGamma) {
  for (const core::BodyKind kind : {kSphere, kBlock}) {
    const Film film = Default(kind);
    const auto analyze = [&](const AnalyzeOptions& options) {
      return AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 1),
                         options);
    };
    AnalyzeOptions options = Known(film);
    options.diameter_m = options.long_m = options.short_m = std::nullopt;
    const Analysis unknown = analyze(options);
    options.gamma = 1.0;
    const Analysis known = analyze(options);
    ASSERT_TRUE(unknown.body && known.body);
    const auto size = [&](const Analysis& analysis) {
      return kind == kSphere ? *analysis.body->diameter_m
                             : *analysis.body->long_m;
    };
    // Apart by what hangs on the gamma alone; times are the same.
    EXPECT_EQ(size(unknown).value, size(known).value);
    EXPECT_GT(size(unknown).u, 3.0 * size(known).u);
    EXPECT_EQ(unknown.contacts.first.contact.time_s->u,
              known.contacts.first.contact.time_s->u);
    ExpectTruth(unknown, film);
    ExpectTruth(known, film);
  }
}

// ---- Files --------------------------------------------------------------

std::filesystem::path WriteFilm(const Film& film,
                                const std::filesystem::path& path) {
  const auto clip = vision::OpenScene(filmed::BuildScene(film), 1);
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

TEST(AnalyzeFiles, WithoutADigestAllElseIsTheSame) {
  const testing::TemporaryFolder folder;
  const Film film = Default(kSphere);
  const auto path = WriteFilm(film, folder / "shot.mraw");
  AnalyzeOptions options = Known(film);
  const json with = ExpectDocument(Analyze(path, options));
  options.digest = false;
  const json without = ExpectDocument(Analyze(path, options));
  EXPECT_TRUE(with["clip"]["id"].is_string());
  EXPECT_TRUE(without["clip"]["id"].is_null());
  for (const char* const part : {"ground", "body", "contact", "state", "motion",
                                 "scene_model", "warnings", "software"}) {
    EXPECT_EQ(with[part], without[part]) << part;
  }
}

TEST(AnalyzeFiles, EvidenceIsWhatAPersonCanCheck) {
  const testing::TemporaryFolder folder;
  for (const BodyKind kind : {kSphere, kBlock}) {
    const Film film = Default(kind);
    const auto path = WriteFilm(film, folder / "shot.mraw");
    const Analysis analysis = Analyze(path, Known(film));
    const auto out = folder / "out/deep";
    std::filesystem::remove_all(out);
    WriteEvidence(analysis, out);
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
    WriteEvidence(analysis, out);
    EXPECT_EQ(Names(out).size(), 3u);
  }
}

TEST(AnalyzeFiles, EvidenceOfNothing) {
  const testing::TemporaryFolder folder;
  Film film = Default(kSphere);
  film.lead_in = film.frames + 10;
  film.frames = 20;
  const auto path = WriteFilm(film, folder / "empty.mraw");
  WriteEvidence(Analyze(path, {}), folder / "out");
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
    WriteEvidence(analysis, folder / "file/out");
    ADD_FAILURE() << "written";
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("file/out"));
  }
  EXPECT_EQ(testing::ReadAll(folder / "file"), "not a folder");
  // One of the names is taken by a folder: nothing half-written stays.
  std::filesystem::create_directories(folder / "taken/contact.png/x");
  try {
    WriteEvidence(analysis, folder / "taken");
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

// The dot that docs/camera.md asks for shows the spin.
TEST(Analyze, ADotOnABallShowsItsSpin) {
  filmed::Film film = filmed::Default(core::BodyKind::kSphere);
  film.thrown.before.omega = -20.0;
  film.thrown.after.omega = -55.0;
  film.look.mark = vision::SceneMark{0.5, 0.66, 0.25};
  AnalyzeOptions options = filmed::Known(film);
  options.diameter_m = core::Estimate{2.0 * film.thrown.half_long_m, 1e-5};
  const auto analyze = [&] {
    return AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 7), options);
  };
  const Analysis dotted = analyze();
  const core::Motion& motion = dotted.contacts.first.motion;
  filmed::ExpectMeasured(motion.before_omega_rad_per_s, -20.0, "before");
  filmed::ExpectMeasured(motion.after_omega_rad_per_s, -55.0, "after");
  EXPECT_LT(motion.after_omega_rad_per_s->u, 2.0);
  EXPECT_THAT(dotted.scene_model.used,
              ::testing::Contains("the ball's face, which turns"));
  film.look.mark.reset();
  const Analysis plain = analyze();
  EXPECT_FALSE(plain.contacts.first.motion.before_omega_rad_per_s);
  EXPECT_EQ(plain.scene_model.left_out.count("spin"), 1U);
}

// A dark ring that rolls down a ramp of 32 degrees, with a bright mark on it:
// steeper than any edge that is taken for ground.
TEST(Analyze, ARingOnARampIsCarriedByIt) {
  vision::Scene scene;
  scene.body = core::Sphere({0.05, 0.0});
  scene.camera.width_px = 320;
  scene.camera.height_px = 240;
  scene.camera.ground_point = {160.0, 150.0};
  scene.camera.roll_rad = 32.0 * core::kDegree;
  scene.camera.fps = 120.0;
  scene.camera.exposure_s = 0.0;
  scene.look.hole = 0.3;
  scene.look.mark = vision::SceneMark{0.9, 0.65, 0.3};
  scene.noise.read_dn = 1.5;
  scene.frames = 60;
  scene.pose = [](double t) {
    if (t < 0.025) return vision::ScenePose{{99.0, 99.0}, 0.0};
    const double x = -0.14 + 0.1 * t + 0.5 * 2.6 * t * t;
    return vision::ScenePose{{x, 0.025}, -x / 0.025};
  };
  const Analysis a = AnalyzeClip(vision::OpenScene(scene, 7));
  ASSERT_TRUE(a.track) << a.track.error().reason;
  EXPECT_GE(a.track->poses.size(), 25u);
  EXPECT_NEAR(a.track->body.radius_px.value, 25.0, 1.0);
  ASSERT_TRUE(a.ground) << a.ground.error().reason;
  EXPECT_EQ(a.ground->source, calib::GroundSource::kContactPoints);
  EXPECT_NEAR(calib::ImageAngle(*a.ground), 32.0 * core::kDegree,
              0.5 * core::kDegree);
  EXPECT_TRUE(a.contacts.first.contact.from_start)
      << a.contacts.first.contact.reason;
  EXPECT_NE(a.contacts.first.state.label, MotionState::kBounce)
      << a.contacts.first.state.reason;
}

}  // namespace
}  // namespace touchdown::pipeline
