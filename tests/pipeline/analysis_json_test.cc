// The document of an analysis (DESIGN.md section 4), whatever was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "app/documents/analysis_text.h"
#include "app/documents/log_analysis.h"
#include "app/documents/replay.h"
#include "app/measure/analyze.h"
#include "tests/pipeline/analyzed_film.h"
#include "tests/pipeline/document.h"
#include "tests/pipeline/filmed.h"
#include "tests/vision/composite_clip.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::BodyKind;
using core::MotionState;
using filmed::AnalyzeFilm;
using filmed::Default;
using filmed::ExpectDocument;
using filmed::ExpectMeasured;
using filmed::Film;
using filmed::Known;
using nlohmann::json;
using ::testing::HasSubstr;

TEST(AnalyzeDocument, OfABounce) {
  const Film film = Default(BodyKind::kSphere);
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
  const Film film = Default(BodyKind::kRectangle);
  AnalyzeOptions options = Known(film);
  for (const auto& [kind, key] :
       std::vector<std::pair<std::optional<core::AngleKind>, std::string>>{
           {std::nullopt, "radius"},
           {core::AngleKind::kApproach, "approach"},
           {core::AngleKind::kFace, "face"}}) {
    options.angle_kind = kind;
    const Analysis analysis =
        AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 3), options);
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
  Film film = Default(BodyKind::kSphere);
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
  Film film = Default(BodyKind::kSphere);
  Film other = film;
  other.thrown.before = {-1.6, -0.1, 0.0};
  other.thrown.after = {-1.5, 0.1, 0.0};
  other.thrown.x_m = 0.01;
  auto clip = std::make_unique<vision::synthetic::Darker>(
      vision::OpenScene(filmed::BuildScene(film), 1), [&] {
        vision::Scene scene = filmed::BuildScene(other);
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
  Film film = Default(BodyKind::kSphere);
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
    Film film = Default(BodyKind::kSphere);
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

TEST(AnalyzeDocument, ReboundNotFilmedToItsTop) {
  Analysis analysis = AnalyzeFilm(Default(BodyKind::kSphere));
  core::StateDecision& state = analysis.contacts.first.state;
  state.label = core::MotionState::kUndecided;
  state.p_bounce.reset();
  state.reason = "the film ends while the body rises";
  state.max_gap_m = core::Estimate{0.4e-3, 0.02e-3, std::nullopt};
  state.extrapolated_gap_m = core::Estimate{2.1e-3, 0.3e-3, std::nullopt};
  const json document = ExpectDocument(analysis);
  EXPECT_TRUE(document["state"]["p_bounce"].is_null());
  EXPECT_EQ(document["absent"]["state.p_bounce"], state.reason);
  EXPECT_NEAR(document["state"]["extrapolated_gap_mm"]["value"], 2.1, 1e-12);
  EXPECT_NEAR(document["state"]["extrapolated_gap_mm"]["u"], 0.3, 1e-12);
  EXPECT_THAT(ToText(analysis), HasSubstr("would reach 2.10 +- 0.30 mm"));
}

TEST(AnalyzeDocument, WithoutAScale) {
  const Film film = Default(BodyKind::kSphere);
  const Analysis analysis =
      AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 1), {});
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
  Film film = Default(BodyKind::kRectangle);
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
  Analysis down = AnalyzeFilm(film);
  const json from_start = ExpectDocument(down);
  EXPECT_EQ(from_start["contact"]["found"], true);
  EXPECT_EQ(from_start["contact"]["from_start"], true);
  EXPECT_EQ(from_start["contact"]["approach_angle_deg"]["value"], 0.0);
  EXPECT_TRUE(from_start["contact"]["time_s"].is_null());
  EXPECT_EQ(from_start["state"]["label"], "slide");
  // One that turns meanwhile: the corner is as unknown as the face angle.
  core::Contact& contact = down.contacts.first.contact;
  contact.corner.reset();
  contact.face_angle_rad = core::AbsentBecause("it turns");
  EXPECT_EQ(json::parse(ToJson(down))["absent"]["contact.corner"], "it turns");
}

}  // namespace
}  // namespace touchdown::pipeline
