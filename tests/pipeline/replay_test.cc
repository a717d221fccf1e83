// An analysis out of its document again: the same numbers from the stored
// track, and corrections of it judged by the same code as a fresh analysis.
#include "app/documents/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "app/documents/analysis_json.h"
#include "app/documents/log_analysis.h"
#include "app/measure/judge.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/quantities.h"

namespace touchdown::pipeline {
namespace {

struct Shot {
  explicit Shot(core::BodyKind kind = core::BodyKind::kSphere) {
    filmed::Film film = filmed::Default(kind);
    options.body_kind = kind;
    if (kind == core::BodyKind::kSphere) {
      options.diameter_m = core::Estimate{0.024, 2e-5, std::nullopt};
    } else {
      options.long_m = core::Estimate{0.040, 2e-5, std::nullopt};
      options.short_m = core::Estimate{0.016, 2e-5, std::nullopt};
    }
    analysis = AnalyzeClip(vision::OpenScene(BuildScene(film), 1), options);
    analysis.clip.path = "shot.mraw";
    trial = ToTrial(analysis);
    trial.clip.id = "id";
  }

  AnalyzeOptions options;
  Analysis analysis;
  core::Trial trial;
};

// Both there or both absent; values within `share` of their u.
void ExpectSame(const core::ContactRecord& a, const core::ContactRecord& b,
                double share) {
  for (const auto& quantity : core::kContactQuantities) {
    const core::Measured& x = core::At(a, quantity);
    const core::Measured& y = core::At(b, quantity);
    ASSERT_EQ(x.has_value(), y.has_value()) << quantity.name;
    if (!x) continue;
    // A limit of detection has no u of its own.
    const double tolerance = x->u > 0.0 ? share * x->u : 0.002 * x->value;
    EXPECT_NEAR(x->value, y->value, tolerance) << quantity.name;
    EXPECT_NEAR(x->u, y->u, 0.01 * x->u) << quantity.name;
  }
  EXPECT_EQ(a.state.label, b.state.label);
}

class EachBody : public ::testing::TestWithParam<core::BodyKind> {};

TEST_P(EachBody, SaysTheSameFromItsDocument) {
  const Shot shot(GetParam());
  ASSERT_TRUE(shot.trial.first.contact.found);
  const auto again = Replay(shot.trial);
  ASSERT_TRUE(again) << again.error().reason;
  // Poses are stored to 1e-5 px, of which some thousandths are known.
  ExpectSame(shot.trial.first, again->contacts.first, 0.01);
  EXPECT_EQ(again->track->poses.size(), shot.analysis.track->poses.size());
  EXPECT_EQ(again->options_hash, shot.analysis.options_hash);
}

TEST_P(EachBody, SaysExactlyTheSameASecondTime) {
  const Shot shot(GetParam());
  const auto once = Replay(shot.trial);
  ASSERT_TRUE(once);
  const core::Trial stored = WithAnalysis(shot.trial, *once);
  const auto twice = Replay(stored);
  ASSERT_TRUE(twice) << twice.error().reason;
  EXPECT_EQ(once->contacts.first, twice->contacts.first);
  EXPECT_EQ(once->contacts.later, twice->contacts.later);
}

INSTANTIATE_TEST_SUITE_P(Replay, EachBody,
                         ::testing::Values(core::BodyKind::kSphere,
                                           core::BodyKind::kRectangle));

TEST(Rejudge, TurnsTheAngleWithTheGroundLine) {
  const Shot shot;
  auto analysis = Replay(shot.trial);
  ASSERT_TRUE(analysis);
  const calib::GroundLine& g = *analysis->ground;
  // The line turned by 2 degrees about the point of contact.
  const core::PixelPoint at = analysis->contacts.evidence.front().touching;
  const double angle = calib::ImageAngle(g) + 2.0 * core::kDegree;
  Correction correction;
  correction.ground = calib::MakeGroundLine(
      {at.x_px - 100 * std::cos(angle), at.y_px - 100 * std::sin(angle)},
      {at.x_px + 100 * std::cos(angle), at.y_px + 100 * std::sin(angle)},
      kByHand_px);
  const Analysis turned = Rejudge(*analysis, correction);
  const auto& was = analysis->contacts.first.contact.approach_angle_rad;
  const auto& now = turned.contacts.first.contact.approach_angle_rad;
  ASSERT_TRUE(was && now);
  // Gravity stays along the line's normal, so it turns too: over the 20 to 30
  // ms that are fitted its sine of 2 degrees bends the path by up to 9.8 sin(2
  // deg) 0.015 s / 1.3 m/s = 0.2 deg.
  EXPECT_NEAR(std::abs(now->value - was->value), 2.0 * core::kDegree,
              0.2 * core::kDegree);
  EXPECT_GT(now->u, was->u);  // a hand is less sure than the fit
  EXPECT_THAT(turned.corrections,
              ::testing::ElementsAre(::testing::HasSubstr("ground line")));
}

// A correction and a fresh analysis with the same line agree but for the
// outlines, which the latter fits again with the pixels below the line left
// out.
TEST(Rejudge, AgreesWithAnAnalysisThatIsGivenTheLine) {
  Shot shot;
  auto analysis = Replay(shot.trial);
  ASSERT_TRUE(analysis);
  const auto line = calib::MakeGroundLine({10.0, 97.5}, {230.0, 98.9}, 0.5);
  Correction correction;
  correction.ground = line;
  const Analysis corrected = Rejudge(*analysis, correction);
  shot.options.ground = line;
  const Analysis fresh =
      AnalyzeClip(vision::OpenScene(
                      BuildScene(filmed::Default(core::BodyKind::kSphere)), 1),
                  shot.options);
  const auto& a = corrected.contacts.first.contact;
  const auto& b = fresh.contacts.first.contact;
  ASSERT_TRUE(a.approach_angle_rad && b.approach_angle_rad);
  EXPECT_NEAR(a.approach_angle_rad->value, b.approach_angle_rad->value,
              3.0 * b.approach_angle_rad->u);
  EXPECT_NEAR(a.frame->value, b.frame->value, 3.0 * b.frame->u);
  EXPECT_EQ(corrected.contacts.first.state.label,
            fresh.contacts.first.state.label);
  EXPECT_EQ(corrected.options_hash, fresh.options_hash);
}

TEST(Rejudge, TakesTheContactWhereAPersonSaysItIs) {
  const Shot shot;
  auto analysis = Replay(shot.trial);
  ASSERT_TRUE(analysis);
  const double frame = analysis->contacts.first.contact.frame->value;
  Correction same;
  same.contact_frame = static_cast<std::int64_t>(std::floor(frame));
  const Analysis confirmed = Rejudge(*analysis, same);
  ExpectSame(analysis->contacts.first, confirmed.contacts.first, 0.05);
  EXPECT_EQ(confirmed.contacts.later.size(), analysis->contacts.later.size());
  Correction other;
  other.contact_frame = *same.contact_frame - 6;
  const Analysis moved = Rejudge(*analysis, other);
  EXPECT_NE(moved.contacts.first, analysis->contacts.first);
}

TEST(Rejudge, MovesAndLeavesOutOutlines) {
  const Shot shot;
  auto analysis = Replay(shot.trial);
  ASSERT_TRUE(analysis);
  const std::int64_t frame = analysis->track->poses[20].frame;
  Correction correction;
  correction.moved[frame] = {0.0, -3.0};
  correction.left_out = {analysis->track->poses[30].frame};
  const Analysis corrected = Rejudge(*analysis, correction);
  EXPECT_EQ(corrected.track->poses.size(), analysis->track->poses.size() - 1);
  EXPECT_NEAR(corrected.plane->samples[20].gap_px,
              analysis->plane->samples[20].gap_px + 3.0, 0.01);
  EXPECT_GE(corrected.track->poses[20].u_y_px, kByHand_px);
}

TEST(Rejudge, RefusesFramesWithoutABody) {
  const Shot shot;
  const auto analysis = Replay(shot.trial);
  ASSERT_TRUE(analysis);
  Correction correction;
  correction.moved[3] = {1.0, 1.0};
  EXPECT_THROW(Rejudge(*analysis, correction), std::invalid_argument);
  correction = {};
  correction.left_out = {3};
  EXPECT_THROW(Rejudge(*analysis, correction), std::invalid_argument);
  correction = {};
  correction.contact_frame = 3;
  EXPECT_THROW(Rejudge(*analysis, correction), std::invalid_argument);
  correction = {};
  for (const auto& pose : analysis->track->poses) {
    correction.left_out.push_back(pose.frame);
  }
  EXPECT_THROW(Rejudge(*analysis, correction), std::invalid_argument);
}

// What was told of the camera holds for the next clip; the rest does not.
TEST(ReadCameraOptions, IsWhatTheAnalysisWasTold) {
  Shot shot(core::BodyKind::kSphere);
  shot.analysis.options.fps = 1234.5;
  shot.analysis.options.gamma = 0.8;
  shot.analysis.options.scale_px_per_m = core::Estimate{990.0, 2.0, {}};
  shot.analysis.options.calibration.emplace();
  shot.analysis.options.calibration->camera = "left";
  shot.analysis.options.calibration->date = "2026-11-21";
  shot.analysis.options.calibration->expires = "2027-11-21";
  shot.analysis.options.calibration->picture = {640, 400,
                                                calib::SensorCorner{}};
  shot.analysis.options.calibration->scale =
      calib::ScaleRecord{{1000.0, 1.0, {}}, 0.4, {}};
  shot.analysis.options.contact_frame = 7;
  shot.trial.document_json = ToJson(shot.analysis);
  const auto camera = ReadCameraOptions(shot.trial).value();
  EXPECT_EQ(camera.fps, 1234.5);
  EXPECT_EQ(camera.gamma, 0.8);
  EXPECT_EQ(camera.scale_px_per_m->value, 990.0);
  EXPECT_EQ(camera.calibration->camera, "left");
  EXPECT_EQ(camera.calibration->scale->px_per_m.value, 1000.0);
  EXPECT_FALSE(camera.contact_frame);
  EXPECT_FALSE(camera.diameter_m);
  shot.trial.document_json = "no document";
  EXPECT_FALSE(ReadCameraOptions(shot.trial));
  shot.trial.document_json = "";
  EXPECT_FALSE(ReadCameraOptions(shot.trial));
}

TEST(Replay, SaysWhyThereIsNothingToReplay) {
  Shot shot;
  core::Trial trial = shot.trial;
  trial.document_json.clear();
  EXPECT_THAT(Replay(trial).error().reason, ::testing::HasSubstr("by hand"));
  trial.document_json = R"({"schema": "touchdown.analysis/1"})";
  EXPECT_THAT(Replay(trial).error().reason,
              ::testing::HasSubstr("earlier program"));
  trial.document_json = "{";
  EXPECT_THAT(Replay(trial).error().reason,
              ::testing::HasSubstr("cannot be read"));
  trial.document_json = R"({"replay": {"track": 3}})";
  EXPECT_THAT(Replay(trial).error().reason,
              ::testing::HasSubstr("cannot be read"));
}

// Found by the fuzzer: a number that no frame can have was converted, which is
// undefined.
TEST(Replay, FramesAreWholeNumbers) {
  Shot shot;
  for (const auto& wrong :
       {nlohmann::json(2.8e98), nlohmann::json(1.5), nlohmann::json("1"),
        nlohmann::json(nullptr), nlohmann::json(18446744073709551615ULL)}) {
    core::Trial trial = shot.trial;
    auto document = nlohmann::ordered_json::parse(trial.document_json);
    document["replay"]["track"]["frames"][1] = wrong;
    trial.document_json = document.dump();
    const auto replayed = Replay(trial);
    ASSERT_FALSE(replayed) << wrong;
    EXPECT_THAT(replayed.error().reason,
                ::testing::HasSubstr("frames is " + wrong.dump() +
                                     ", must be a whole number"));
  }
}

// The fields of a struct, in the order of its declaration: where one is added,
// these no longer compile, and the document has to learn it.
auto ListFields(const vision::Pose& pose) {
  const auto& [frame, time, centre, angle, u_x, u_y, correlation, u_angle, size,
               misfit] = pose;
  return std::make_tuple(frame, time, centre, angle, u_x, u_y, correlation,
                         u_angle, size, misfit);
}

auto ListFields(const vision::BodyImage& body) {
  const auto& [kind, radius, half_long, half_short, gamma_long, gamma_short,
               whole, blur, shutter, u_common, u_common_angle, u_texture, gamma,
               contrast] = body;
  return std::make_tuple(kind, radius, half_long, half_short, gamma_long,
                         gamma_short, whole, blur, shutter, u_common,
                         u_common_angle, u_texture, gamma, contrast);
}

// All but its warnings, which stand among those of the analysis.
auto ListFields(const vision::Track& track) {
  const auto& [body, poses, first, last, interval, background, step, modelled,
               patterned, layered, textured, outlined, predicted, several,
               warnings] = track;
  return std::make_tuple(ListFields(body), poses.size(), first, last, interval,
                         background, step, modelled, patterned, layered,
                         textured, outlined, predicted, several);
}

TEST(Replay, KeepsEveryFieldOfTheTrack) {
  Shot shot(core::BodyKind::kRectangle);
  vision::Track& track = *shot.analysis.track;
  // No field has the value that it begins with.
  track.body.radius_px = {1.5, 0.25, core::Interval{1.0, 2.0}};
  track.body.half_long_px = {20.5, 0.125, std::nullopt};
  track.body.half_short_px = {8.5, 0.125, std::nullopt};
  track.body.gamma_long_px = 0.375;
  track.body.gamma_short_px = -0.25;
  track.body.whole_px = 44.5;
  track.body.blur_px = 0.75;
  track.body.shutter_fraction = 0.5;
  track.body.u_common_px = 0.0625;
  track.body.u_common_angle_rad = 0.03125;
  track.body.u_texture_px = 0.015625;
  track.body.gamma = 2.25;
  track.body.contrast_dn = 100.5;
  track.first_frame = 2;
  track.last_frame = 90;
  track.frame_interval_s = 0.00025;
  track.known_background = false;
  track.step = 4;
  track.near_ground_modelled = true;
  track.patterned = true;
  track.layered = true;
  track.textured = true;
  track.outlined = false;
  track.is_predicted = true;
  track.poses = {
      {7, 0.0035, {12.5, 30.25}, 0.5, 0.25, 0.125, 0.75, 0.0625, 1.25, 1.5}};
  shot.analysis.ground =
      core::AbsentBecause("no line");  // else it would be judged again
  const auto again = Replay(ToTrial(shot.analysis));
  ASSERT_TRUE(again) << again.error().reason;
  EXPECT_EQ(ListFields(*again->track), ListFields(track));
  ASSERT_EQ(again->track->poses.size(), 1U);
  EXPECT_EQ(ListFields(again->track->poses[0]), ListFields(track.poses[0]));

  // With several bodies there is nothing to replay.
  track.several_bodies = true;
  EXPECT_FALSE(Replay(ToTrial(shot.analysis)));
}

// All but what decides no answer: progress, threads, limits, digest, today.
TEST(Replay, KeepsTheOptionsThatDecideTheAnswer) {
  Shot shot(core::BodyKind::kRectangle);
  AnalyzeOptions& told = shot.analysis.options;
  told.fps = 2000.5;
  told.gamma = 2.25;
  told.scale_px_per_m = core::Estimate{1000.5, 0.5, std::nullopt};
  told.diameter_m = core::Estimate{0.5, 0.25, std::nullopt};
  told.ground = calib::MakeGroundLine({10.0, 97.5}, {230.0, 98.5}, 0.5);
  told.contact_frame = 5;
  told.first_frame = 2;
  told.last_frame = 90;
  told.region = {1, 2, 30, 40};
  told.angle_kind = core::AngleKind::kFace;
  told.bounce_height_m = 0.125;
  told.stop_early = true;
  told.crop = calib::SensorCorner{16, 32};
  shot.analysis.ground = core::AbsentBecause("no line");
  const auto again = Replay(ToTrial(shot.analysis));
  ASSERT_TRUE(again) << again.error().reason;
  const AnalyzeOptions& kept = again->options;
  EXPECT_EQ(kept.fps, told.fps);
  EXPECT_EQ(kept.gamma, told.gamma);
  EXPECT_EQ(kept.scale_px_per_m, told.scale_px_per_m);
  EXPECT_EQ(kept.body_kind, told.body_kind);
  EXPECT_EQ(kept.diameter_m, told.diameter_m);
  EXPECT_EQ(kept.long_m, told.long_m);
  EXPECT_EQ(kept.short_m, told.short_m);
  ASSERT_TRUE(kept.ground);
  EXPECT_EQ(kept.ground->p1, told.ground->p1);
  EXPECT_EQ(kept.ground->p2, told.ground->p2);
  EXPECT_EQ(kept.ground->reference, told.ground->reference);
  EXPECT_EQ(kept.ground->u_offset_px, told.ground->u_offset_px);
  EXPECT_EQ(kept.ground->u_angle_rad, told.ground->u_angle_rad);
  EXPECT_EQ(kept.ground->source, told.ground->source);
  EXPECT_EQ(kept.contact_frame, told.contact_frame);
  EXPECT_EQ(kept.first_frame, told.first_frame);
  EXPECT_EQ(kept.last_frame, told.last_frame);
  EXPECT_EQ(kept.region, told.region);
  EXPECT_EQ(kept.angle_kind, told.angle_kind);
  EXPECT_EQ(kept.bounce_height_m, told.bounce_height_m);
  EXPECT_EQ(kept.stop_early, told.stop_early);
  ASSERT_TRUE(kept.crop);
  EXPECT_EQ(kept.crop->x_px, told.crop->x_px);
  EXPECT_EQ(kept.crop->y_px, told.crop->y_px);
}

TEST(Replay, AnUnknownWordIsAnErrorAndNotTheFirstOfAList) {
  const Shot shot;
  for (const char* pointer : {"/replay/ground/source", "/clip/time_base/source",
                              "/clip/channel", "/scale/source"}) {
    core::Trial trial = shot.trial;
    auto document = nlohmann::ordered_json::parse(trial.document_json);
    const nlohmann::ordered_json::json_pointer at(pointer);
    ASSERT_TRUE(document.contains(at)) << pointer;
    document[at] = "guess";
    trial.document_json = document.dump();
    const auto replayed = Replay(trial);
    ASSERT_FALSE(replayed) << pointer;
    EXPECT_THAT(replayed.error().reason,
                ::testing::HasSubstr("'guess' is unknown, must be one of"));
  }
}

}  // namespace
}  // namespace touchdown::pipeline
