// What a lens does to an analysis: rendered clips seen through one, with and
// without its calibration.
#include "app/measure/lens_uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/documents/analysis_json.h"
#include "app/documents/evidence.h"
#include "app/measure/analyze.h"
#include "app/simulate/scene_file.h"
#include "tests/pipeline/filmed.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::pipeline {
namespace {

using core::BodyKind;
using filmed::Film;
using ::testing::Contains;
using ::testing::HasSubstr;

// A wide-angle lens: 6 px at the corners of 240 x 120 px, and a body that
// crosses the picture near its lower border.
calib::Lens WideLens() {
  return {240.0, 240.0, 119.5, 59.5, -0.15, 0.02, 0.0008, -0.0005, 0.0};
}

Film Bent(BodyKind kind) {
  Film film = filmed::Default(kind);
  film.camera.lens = WideLens();
  return film;
}

calib::Calibration Calibrated(const Film& film) {
  calib::Calibration c;
  c.camera = "rendered";
  c.date = "2026-01-31";
  c.expires = "2027-01-31";
  c.picture = {film.camera.width_px, film.camera.height_px,
               calib::SensorCorner{0, 0}};
  calib::LensRecord lens;
  lens.lens = *film.camera.lens;
  lens.board = "none: as rendered";
  c.lens = lens;
  return c;
}

AnalyzeOptions Known(const Film& film) {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{
      film.camera.px_per_m, 1e-4 * film.camera.px_per_m, std::nullopt};
  return options;
}

Analysis AnalyzeFilm(const Film& film, const AnalyzeOptions& options,
                     std::uint64_t seed) {
  return AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), seed),
                     options);
}

// Errors of the contact's angles, speeds and time over the u of `like`.
std::vector<std::pair<std::string, double>> Errors(const Analysis& analysis,
                                                   const Film& film,
                                                   const Analysis& like) {
  const vision::synthetic::Throw& t = film.thrown;
  const core::ContactRecord& first = analysis.contacts.first;
  std::vector<std::pair<std::string, double>> errors;
  const core::ContactRecord& other = like.contacts.first;
  const auto add = [&](const char* name, const core::Measured& measured,
                       double truth, const core::Measured& u_of) {
    EXPECT_TRUE(measured && u_of) << name;
    if (measured && u_of) {
      errors.emplace_back(name, (measured->value - truth) / u_of->u);
    }
  };
  add("approach", first.contact.approach_angle_rad, t.ContactAngle(),
      other.contact.approach_angle_rad);
  add("frame", first.contact.frame, film.contact_frame, other.contact.frame);
  add("vt", first.motion.before_tangential_mps, t.before.vx,
      other.motion.before_tangential_mps);
  add("vn", first.motion.before_normal_mps, t.before.vy,
      other.motion.before_normal_mps);
  add("vn'", first.motion.after_normal_mps, t.after.vy,
      other.motion.after_normal_mps);
  if (t.kind == BodyKind::kRectangle) {
    add("face", first.contact.face_angle_rad, t.face_rad,
        other.contact.face_angle_rad);
  }
  return errors;
}

class ThroughALens : public ::testing::TestWithParam<BodyKind> {};

TEST_P(ThroughALens, AnglesAreRightWithTheCalibrationAndBiasedWithout) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    Film film = Bent(GetParam());
    film.contact_frame += 0.31 * static_cast<double>(seed);
    AnalyzeOptions options = Known(film);
    const Analysis without = AnalyzeFilm(film, options, seed);
    options.calibration = Calibrated(film);
    const Analysis with = AnalyzeFilm(film, options, seed);
    ASSERT_TRUE(with.contacts.first.contact.found)
        << with.contacts.first.contact.reason;
    for (const auto& [name, error] : Errors(with, film, with)) {
      // A block that lies half under the ground's margin is seen by its upper
      // part alone, which this lens bends otherwise: its time is off by up to
      // 0.03 frames (calib/README.md), its angles are not.
      const bool time_of_block =
          GetParam() == BodyKind::kRectangle && name == "frame";
      EXPECT_LT(std::abs(error), time_of_block ? 6.0 : 4.0) << name;
    }
    double worst = 0.0;
    if (without.contacts.first.contact.found) {
      for (const auto& [name, error] : Errors(without, film, with)) {
        worst = std::max(worst, std::abs(error));
      }
    } else {
      worst = 1e9;
    }
    // In units of what can be known.
    EXPECT_GT(worst, 10.0) << "the lens does not matter in this clip";
    EXPECT_THAT(with.scene_model.used, Contains(HasSubstr("lens (Brown)")));
    EXPECT_FALSE(with.scene_model.left_out.contains("lens distortion"));
    EXPECT_EQ(without.scene_model.left_out.at("lens distortion"),
              "no calibration");
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, ThroughALens,
                         ::testing::Values(BodyKind::kSphere,
                                           BodyKind::kRectangle),
                         [](const auto& each) {
                           return std::string(core::Name(each.param));
                         });

// The body's size gives the scale, in the ideal picture; the ground is the
// calibration's, as two points of the image; the clip is a crop.
TEST(ThroughALens, CropsGroundAndBodySizeFit) {
  Film film = Bent(BodyKind::kSphere);
  calib::Calibration calibration = Calibrated(film);
  calib::GroundRecord ground;
  ground.p1 = vision::ToImage(film.camera, {-0.05, 0.0});
  ground.p2 = vision::ToImage(film.camera, {0.06, 0.0});
  ground.u_point_px = 0.02;
  calibration.ground = ground;
  // Calibrated as a part of a larger sensor's picture.
  constexpr std::int32_t kX = 40;
  constexpr std::int32_t kY = 24;
  calibration.picture.width_px += 100;
  calibration.picture.height_px += 60;
  calibration.lens->lens = calib::Cropped(calibration.lens->lens, -kX, -kY);
  for (core::PixelPoint* p :
       {&calibration.ground->p1, &calibration.ground->p2}) {
    p->x_px += kX;
    p->y_px += kY;
  }
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{0.024, 2.4e-6, std::nullopt};
  options.calibration = calibration;
  options.crop = calib::SensorCorner{kX, kY};
  const Analysis analysis = AnalyzeFilm(film, options, 5);
  ASSERT_TRUE(analysis.ground);
  EXPECT_EQ(analysis.ground->source, calib::GroundSource::kCalibration);
  ASSERT_TRUE(analysis.scale);
  EXPECT_NEAR(analysis.scale->px_per_m.value, 1000.0,
              4.0 * analysis.scale->px_per_m.u);
  for (const auto& [name, error] : Errors(analysis, film, analysis)) {
    EXPECT_LT(std::abs(error), 4.0) << name;
  }
}

// A .cihx says where on the sensor its picture lies: no --crop is needed. A
// .cih does not, and a picture of another size is then refused.
TEST(ThroughALens, AnMrawBringsItsOwnCrop) {
  const Film film = Bent(BodyKind::kSphere);
  constexpr std::int32_t kX = 40;
  constexpr std::int32_t kY = 24;
  AnalyzeOptions options = Known(film);
  options.calibration = Calibrated(film);
  options.calibration->picture.width_px += 100;
  options.calibration->picture.height_px += 60;
  options.calibration->lens->lens = calib::Cropped(*film.camera.lens, -kX, -kY);
  const testing::TemporaryFolder folder;
  const auto write = [&](const char* name, bool xml) {
    const auto clip = vision::OpenScene(filmed::BuildScene(film), 5);
    vision::MrawOptions mraw;
    mraw.fps = film.camera.fps;
    mraw.xml_header = xml;
    if (xml) mraw.sensor_origin = vision::SensorOrigin{kX, kY};
    std::int64_t i = 0;
    vision::WriteMraw(folder / name, mraw, [&]() -> std::optional<core::Frame> {
      if (i == clip->info().frames) return std::nullopt;
      return clip->Read(i++);
    });
    return folder / name;
  };
  const Analysis own = Analyze(write("a.mraw", true), options);
  ASSERT_TRUE(own.calibration && own.calibration->lens);
  EXPECT_NEAR(own.calibration->lens->lens.cx_px, film.camera.lens->cx_px, 1e-9);
  EXPECT_NEAR(own.calibration->lens->lens.cy_px, film.camera.lens->cy_px, 1e-9);
  const auto bare = write("b.mraw", false);
  EXPECT_THAT([&] { Analyze(bare, options); },
              ::testing::ThrowsMessage<core::InputError>(
                  HasSubstr("say where with --crop X,Y")));
  options.crop = calib::SensorCorner{kX, kY};
  const Analysis told = Analyze(bare, options);
  ASSERT_TRUE(own.contacts.first.contact.found);
  ASSERT_TRUE(told.contacts.first.contact.found);
  EXPECT_DOUBLE_EQ(own.contacts.first.contact.approach_angle_rad->value,
                   told.contacts.first.contact.approach_angle_rad->value);
}

TEST(ThroughALens, RefusesAClipThatDoesNotFitAndWarnsOfAge) {
  const Film film = Bent(BodyKind::kSphere);
  AnalyzeOptions options = Known(film);
  options.calibration = Calibrated(film);
  options.calibration->picture.width_px = 640;
  EXPECT_THAT([&] { AnalyzeFilm(film, options, 1); },
              ::testing::ThrowsMessage<core::InputError>(
                  HasSubstr("the calibration is of 640x120 px")));
  options.calibration = Calibrated(film);
  options.today = "2027-03-01";
  EXPECT_THAT(AnalyzeFilm(film, options, 1).warnings,
              Contains(HasSubstr("expired on 2027-01-31")));
}

// The lens's own uncertainty against the derivative that is found by analysing
// with another k1. The speed along the ground shows it best; the approach angle
// at the picture's middle hardly at all.
TEST(AddLensUncertainty, IsTheDerivativeTimesTheDeviation) {
  const Film film = Bent(BodyKind::kSphere);
  AnalyzeOptions options = Known(film);
  options.ground = vision::TrueGroundLine(film.camera);
  options.calibration = Calibrated(film);
  const Analysis exact = AnalyzeFilm(film, options, 3);
  constexpr double kDeviation = 0.02;
  options.calibration->lens->covariance(4, 4) = kDeviation * kDeviation;
  const Analysis wide = AnalyzeFilm(film, options, 3);
  const core::Contact& a = exact.contacts.first.contact;
  const core::Contact& b = wide.contacts.first.contact;
  ASSERT_TRUE(a.approach_angle_rad && b.approach_angle_rad);
  EXPECT_DOUBLE_EQ(a.approach_angle_rad->value, b.approach_angle_rad->value);
  ASSERT_FALSE(b.approach_budget.empty());
  EXPECT_EQ(b.approach_budget.back().source, "lens");
  const double u_lens = b.approach_budget.back().u;
  EXPECT_GT(u_lens, 0.0);
  EXPECT_NEAR(std::hypot(a.approach_angle_rad->u, u_lens),
              b.approach_angle_rad->u, 1e-12);
  options.calibration->lens->covariance(4, 4) = 0.0;
  options.calibration->lens->lens.k1 += 0.5 * kDeviation;
  const Analysis moved = AnalyzeFilm(film, options, 3);
  const auto vt = [](const Analysis& analysis) {
    return *analysis.contacts.first.motion.before_tangential_mps;
  };
  const double slope = (vt(moved).value - vt(exact).value) / (0.5 * kDeviation);
  const double u_vt =
      std::sqrt(std::pow(vt(wide).u, 2) - std::pow(vt(exact).u, 2));
  EXPECT_GT(u_vt, vt(exact).u);
  EXPECT_NEAR(u_vt, std::abs(slope) * kDeviation, 0.1 * u_vt);
}

// The document and the evidence: the ground as the camera sees it.
TEST(ThroughALens, DocumentAndEvidence) {
  const testing::TemporaryFolder folder;
  const Film film = Bent(BodyKind::kSphere);
  const auto clip = vision::OpenScene(filmed::BuildScene(film), 1);
  std::int64_t next = 0;
  vision::MrawOptions raw;
  raw.fps = film.camera.fps;
  vision::WriteMraw(folder / "shot.mraw", raw,
                    [&]() -> std::optional<core::Frame> {
                      if (next == film.frames) return std::nullopt;
                      return clip->Read(next++);
                    });
  AnalyzeOptions options = Known(film);
  options.calibration = Calibrated(film);
  const Analysis analysis = Analyze(folder / "shot.mraw", options);
  const auto json = nlohmann::json::parse(ToJson(analysis));
  EXPECT_EQ(json["calibration"]["date"], "2026-01-31");
  const auto truth = vision::TrueGroundLine(film.camera);
  EXPECT_NEAR(json["ground"]["y1_px"].get<double>(), truth.p1.y_px, 0.3);
  EXPECT_NEAR(json["ground"]["y2_px"].get<double>(), truth.p2.y_px, 0.3);
  EXPECT_EQ(json["ground"]["ideal_px"].size(), 4u);
  WriteEvidence(analysis, folder / "evidence");
  EXPECT_TRUE(std::filesystem::exists(folder / "evidence" / "contact.png"));
}

TEST(SceneFile, HasALens) {
  Shot shot = ExampleShot();
  shot.camera.lens =
      calib::Lens{900.0, 900.0, 310.0, 205.0, -0.1, 0.01, 1e-3, 2e-3, -1e-3};
  const Shot back = ParseScene(SceneText(shot), "text");
  ASSERT_TRUE(back.camera.lens);
  EXPECT_EQ(*back.camera.lens, *shot.camera.lens);
  shot.camera.yaw_rad = 3.0 * core::kDegree;
  shot.camera.row_delay_s = 1e-6;
  shot.look.hole = 0.25;
  shot.look.mark = vision::SceneMark{0.8, 0.6, 0.3};
  const Shot turned = ParseScene(SceneText(shot), "text");
  EXPECT_DOUBLE_EQ(turned.camera.yaw_rad, shot.camera.yaw_rad);
  EXPECT_DOUBLE_EQ(turned.camera.row_delay_s, 1e-6);
  EXPECT_EQ(turned.look.hole, 0.25);
  ASSERT_TRUE(turned.look.mark);
  EXPECT_EQ(turned.look.mark->distance, 0.6);
  EXPECT_FALSE(turned.look.face);
  shot.camera.lens->k1 = -9.0;
  EXPECT_THAT(
      [&] { ParseScene(SceneText(shot), "text"); },
      ::testing::ThrowsMessage<core::InputError>(HasSubstr("camera.lens.k1")));
}

TEST(SceneFile, HasAPictureOnTheFace) {
  Shot shot = ExampleShot();
  shot.look.face = vision::SceneFace{0.07, 2.5, 12};
  const Shot back = ParseScene(SceneText(shot), "text");
  ASSERT_TRUE(back.look.face);
  EXPECT_EQ(back.look.face->amplitude, 0.07);
  EXPECT_EQ(back.look.face->correlation_px, 2.5);
  EXPECT_EQ(back.look.face->seed, 12U);
}

}  // namespace
}  // namespace touchdown::pipeline
