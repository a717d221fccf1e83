#include "app/measure/answer_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/batch/triage.h"
#include "app/documents/analysis_json.h"
#include "app/documents/log_analysis.h"
#include "app/documents/replay.h"
#include "app/measure/judge.h"
#include "tests/pipeline/analyzed_film.h"

namespace touchdown::pipeline {
namespace {

using filmed::Default;
using filmed::Film;
using ::testing::AllOf;
using ::testing::HasSubstr;

AnalyzeOptions Stated(const Film& film, core::BodyKind kind) {
  AnalyzeOptions options = filmed::Known(film);
  options.body_kind = kind;
  return options;
}

Analysis Answer() {
  Analysis analysis = filmed::AnalyzeFilm(Default(core::BodyKind::kSphere));
  analysis.clip.path = "shot.mraw";
  return analysis;
}

// As if the outline had followed something else.
Analysis WithNear(double near) {
  Analysis analysis = Answer();
  EXPECT_TRUE(analysis.explained);
  analysis.explained->near = near;
  CheckAnswer(analysis);
  return analysis;
}

core::Trial Logged(const Analysis& analysis) {
  core::Trial trial = ToTrial(analysis);
  trial.clip.id = "id";
  return trial;
}

TEST(AnswerCheck, RightAnswersPass) {
  for (const core::BodyKind kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    for (const double shadow : {0.0, 0.25}) {
      Film film = Default(kind);
      film.trouble.shadow_depth = shadow;
      const Analysis analysis = filmed::AnalyzeFilm(film);
      ASSERT_TRUE(analysis.explained) << analysis.explained.error().reason;
      EXPECT_GT(analysis.explained->near, 0.8) << shadow;
      for (const AnswerCheck& check : analysis.checks) {
        EXPECT_TRUE(check.verdict == Verdict::kPassed ||
                    check.verdict == Verdict::kNotMade)
            << check.name << ": " << check.reason;
      }
      EXPECT_TRUE(analysis.contacts.first.contact.found);
    }
  }
}

TEST(AnswerCheck, RefusesWhatExplainsNothing) {
  const Analysis analysis = WithNear(-0.69);
  EXPECT_FALSE(analysis.contacts.first.contact.found);
  EXPECT_THAT(analysis.contacts.first.contact.reason, HasSubstr("Q = -0.69"));
  EXPECT_EQ(analysis.contacts.first.state.label, core::MotionState::kUndecided);
  EXPECT_THAT(analysis.contacts.first.state.reason, HasSubstr("explains none"));
  ASSERT_TRUE(analysis.track);  // a person can look at it
  EXPECT_TRUE(analysis.ground);
  const TriageEntry entry =
      MakeTriageEntry("shot", Done::kLogged, Logged(analysis));
  EXPECT_EQ(entry.attention, Attention::kNoContact);
  EXPECT_THAT(entry.reason, HasSubstr("Q = -0.69"));
}

// Of a hoop that its own picture is followed by the inside is the wall; of a
// block it means that the sides are not its own.
TEST(AnswerCheck, OnlyADiscMayHaveHoles) {
  for (const core::BodyKind kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    Analysis analysis = filmed::AnalyzeFilm(Default(kind));
    ASSERT_TRUE(analysis.explained);
    analysis.track->patterned = true;
    analysis.explained->seen = 0.8;
    CheckAnswer(analysis);
    EXPECT_EQ(analysis.contacts.first.contact.found,
              kind == core::BodyKind::kSphere);
  }
}

// A blow changes a velocity, never a place. Behind the second contact the
// answer does not hang on the path.
TEST(AnswerCheck, APathThatJumpsIsRefused) {
  const Analysis answer = Answer();
  ASSERT_TRUE(answer.contacts.first.contact.found);
  const auto with_jump = [&](double px, std::size_t from) {
    Analysis analysis = answer;
    std::vector<vision::Pose>& poses = analysis.track->poses;
    for (std::size_t i = from; i < poses.size(); ++i) {
      poses[i].centre.x_px += px;
    }
    CheckAnswer(analysis);
    return analysis;
  };
  const double size_px = 2.0 * answer.track->body.radius_px.value;
  const std::size_t middle = answer.track->poses.size() / 2;
  EXPECT_TRUE(with_jump(0.1 * size_px, middle).contacts.first.contact.found);
  const Analysis lost = with_jump(0.5 * size_px, middle);
  EXPECT_FALSE(lost.contacts.first.contact.found);
  EXPECT_THAT(lost.contacts.first.contact.reason, HasSubstr("jumps by"));
  Analysis later = answer;
  later.contacts.later.emplace_back();
  later.contacts.later.front().contact.frame = core::Estimate{
      static_cast<double>(answer.track->poses[middle].frame), 0.1};
  for (std::size_t i = middle + 5; i < later.track->poses.size(); ++i) {
    later.track->poses[i].centre.x_px += size_px;
  }
  CheckAnswer(later);
  EXPECT_TRUE(later.contacts.first.contact.found);
}

TEST(AnswerCheck, DoubtIsAWarning) {
  const Analysis analysis = WithNear(0.8);
  EXPECT_TRUE(analysis.contacts.first.contact.found);
  const TriageEntry entry =
      MakeTriageEntry("shot", Done::kLogged, Logged(analysis));
  EXPECT_EQ(entry.attention, Attention::kWarned);
  EXPECT_THAT(entry.reason, HasSubstr("Q = 0.80"));
}

// A body of another size is told, and refused where most else that changes is
// not it: of 148 clips of known truth, two with a size that was not the stated
// one, the right answers left at most 0.13 of the change elsewhere, and a
// block's trail that was followed in its place 0.47.
TEST(AnswerCheck, AnotherSizeIsRefusedWhereOtherThingsChange) {
  for (const double elsewhere : {0.13, 0.47}) {
    SCOPED_TRACE(elsewhere);
    Analysis analysis = Answer();
    ASSERT_TRUE(analysis.explained);
    analysis.explained->elsewhere = elsewhere;
    CheckAnswer(analysis);
    EXPECT_TRUE(analysis.contacts.first.contact.found);
    analysis.size_conflict = SizeConflict{"another size", 0.01};
    CheckAnswer(analysis);
    EXPECT_EQ(analysis.contacts.first.contact.found, elsewhere < 0.2);
    if (elsewhere > 0.2) {
      EXPECT_THAT(analysis.contacts.first.contact.reason,
                  HasSubstr("another size; 47 % of the change is elsewhere"));
    }
  }
}

TEST(AnswerCheck, AbsentChangeIsNoReasonToRefuse) {
  Analysis analysis = Answer();
  analysis.explained = core::AbsentBecause("noise");
  CheckAnswer(analysis);
  EXPECT_TRUE(analysis.contacts.first.contact.found);
  EXPECT_EQ(analysis.checks.front().verdict, Verdict::kNotMade);
}

TEST(AnswerCheck, ReplayKeepsWhatWasMeasured) {
  for (const double near : {-0.69, 0.99}) {
    const Analysis analysis = WithNear(near);
    const auto again = Replay(Logged(analysis));
    ASSERT_TRUE(again) << again.error().reason;
    ASSERT_TRUE(again->explained);
    EXPECT_EQ(again->explained->near, near);
    EXPECT_EQ(again->explained->frames, analysis.explained->frames);
    EXPECT_EQ(again->contacts.first.contact.found, near > 0.0);
  }
}

// The clip was compared with other outlines then.
TEST(AnswerCheck, SaysNothingOfOutlinesThatAPersonMoved) {
  auto refused = Replay(Logged(WithNear(-0.69)));
  ASSERT_TRUE(refused);
  Correction correction;
  correction.moved[refused->track->poses[20].frame] = {0.5, 0.0};
  const Analysis corrected = Rejudge(*refused, correction);
  EXPECT_TRUE(corrected.contacts.first.contact.found);
  EXPECT_EQ(corrected.checks.front().verdict, Verdict::kNotMade);
  const auto again = Replay(WithAnalysis(Logged(*refused), corrected));
  ASSERT_TRUE(again) << again.error().reason;
  EXPECT_TRUE(again->outlines_corrected);
  EXPECT_TRUE(again->contacts.first.contact.found);
}

TEST(AnswerCheck, DocumentSaysWhatWasFound) {
  const auto json = nlohmann::json::parse(ToJson(WithNear(-0.69)));
  EXPECT_EQ(json["explained"]["near"], -0.69);
  EXPECT_GT(json["explained"]["frames"], 10);
  EXPECT_EQ(json["checks"][0]["name"], "explained");
  EXPECT_EQ(json["checks"][0]["verdict"], "refused");
}

// A ball in a square of its size leaves nothing but corners, which may be the
// background. A square body has them.
TEST(AnswerCheck, ASquareIsToldFromABall) {
  for (const core::BodyKind seen :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    Film film = Default(core::BodyKind::kSphere);
    film.thrown.kind = seen;
    film.thrown.face_rad = 14.0 * core::kDegree;
    AnalyzeOptions options = Stated(film, core::BodyKind::kRectangle);
    options.long_m = options.short_m =
        core::Estimate{2.0 * film.thrown.half_long_m, 1e-5, std::nullopt};
    const Analysis analysis =
        AnalyzeClip(vision::OpenScene(BuildScene(film), 1), options);
    const bool is_square = seen == core::BodyKind::kRectangle;
    EXPECT_EQ(analysis.contacts.first.contact.found, is_square)
        << analysis.contacts.first.contact.reason;
    if (!is_square) {
      EXPECT_THAT(analysis.contacts.first.contact.reason,
                  HasSubstr("looks like a sphere, not like a rectangle"));
    }
  }
}

TEST(AnswerCheck, APartThatIsNotSeenIsToldOrRefused) {
  for (const double seen : {0.99, 0.94, 0.86}) {
    SCOPED_TRACE(seen);
    Analysis analysis = Answer();
    ASSERT_TRUE(analysis.explained);
    ASSERT_TRUE(analysis.explained->seen);
    analysis.explained->seen = seen;
    CheckAnswer(analysis);
    EXPECT_EQ(analysis.contacts.first.contact.found, seen > 0.9);
    EXPECT_EQ(analysis.warnings.empty(), seen != 0.94);
    const auto again = Replay(Logged(analysis));
    ASSERT_TRUE(again) << again.error().reason;
    EXPECT_EQ(again->explained->seen, seen);
    EXPECT_EQ(again->contacts.first.contact.found, seen > 0.9);
    // Whoever corrected the answer has looked at it.
    Correction correction;
    correction.contact_frame = 80;
    const Analysis corrected = Rejudge(*again, correction);
    EXPECT_TRUE(corrected.contacts.first.contact.found)
        << corrected.contacts.first.contact.reason;
  }
}

// One check may doubt a right answer by chance; two do not. Gravity asks for
// the scale, not for the body.
TEST(AnswerCheck, WhatTwoChecksDoubtIsRefused) {
  Analysis analysis = Answer();
  ASSERT_TRUE(analysis.explained);
  analysis.explained->near = 0.8;
  analysis.contacts.first.motion.gravity_check_mps2 = core::Estimate{9.5, 0.01};
  CheckAnswer(analysis);
  EXPECT_TRUE(analysis.contacts.first.contact.found);
  EXPECT_EQ(analysis.warnings.size(), 2U);
  Analysis corrected = analysis;
  corrected.corrections = {"a person moved the ground"};
  for (Analysis* doubted : {&analysis, &corrected}) {
    doubted->explained->seen = 0.94;
    CheckAnswer(*doubted);
  }
  EXPECT_TRUE(corrected.contacts.first.contact.found);
  EXPECT_FALSE(analysis.contacts.first.contact.found);
  EXPECT_THAT(analysis.contacts.first.contact.reason,
              AllOf(HasSubstr("2 checks doubt"), HasSubstr("Q = 0.80"),
                    HasSubstr("94 %")));
}

// From the contact on no body's greatest gap is below zero, but by chance.
TEST(AnswerCheck, ABodyThatStaysBelowItsGroundIsDoubted) {
  for (const double sigmas : {-5.0, -3.0, 5.0}) {
    Analysis analysis = Answer();
    const core::Estimate gap{sigmas * 2e-4, 2e-4};
    analysis.contacts.first.state.max_gap_m = gap;
    CheckAnswer(analysis);
    EXPECT_TRUE(analysis.contacts.first.contact.found);
    EXPECT_EQ(std::ranges::count_if(
                  analysis.warnings,
                  [](const std::string& warning) {
                    return warning.find("stays 1.00 +- 0.20 mm below") !=
                           std::string::npos;
                  }),
              sigmas < -4.0 ? 1 : 0)
        << sigmas;
  }
}

// A body of another kind than was stated is told by name.
TEST(AnswerCheck, NamesTheKindThatWasSeen) {
  for (const core::BodyKind seen :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    const bool sphere = seen == core::BodyKind::kSphere;
    const Film film = Default(seen);
    const Analysis wrong =
        AnalyzeClip(vision::OpenScene(BuildScene(film), 1),
                    Stated(film, sphere ? core::BodyKind::kRectangle
                                        : core::BodyKind::kSphere));
    EXPECT_FALSE(wrong.contacts.first.contact.found);
    EXPECT_THAT(
        wrong.contacts.first.contact.reason,
        HasSubstr(sphere ? "looks like a sphere, not like a rectangle"
                         : "looks like a rectangle, not like a sphere"));
    const Analysis right =
        AnalyzeClip(vision::OpenScene(BuildScene(film), 1), Stated(film, seen));
    EXPECT_TRUE(right.contacts.first.contact.found);
  }
}

}  // namespace
}  // namespace touchdown::pipeline
