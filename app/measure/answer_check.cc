#include "app/measure/answer_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/measure/analyze.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// Of the frames in view some are not explained because no outline was found.
std::string LostFrames(const vision::ExplainedChange& explained) {
  if (explained.lost == 0) return {};
  return fmt::format("; in {} of {} sampled frames the body was not found",
                     explained.lost, explained.frames);
}

AnswerCheck CheckExplained(const Analysis& analysis,
                           const AnswerCheckLimits& limits) {
  AnswerCheck check;
  check.name = "explained";
  if (!analysis.explained) {
    check.reason = analysis.explained.error().reason;
    return check;
  }
  if (analysis.outlines_corrected) {
    check.reason = "a person moved outlines after the clip was compared";
    return check;
  }
  const vision::ExplainedChange& explained = *analysis.explained;
  // `!(a >= b)` and not `a < b`: a number that could not be computed is
  // refused, too.
  const bool patterned = analysis.track && analysis.track->patterned;
  const double least =
      patterned ? limits.least_near_patterned : limits.least_near;
  if (!(explained.near >= least)) {
    check.verdict = Verdict::kRefused;
    check.reason = fmt::format(
        "the answer's outline explains {} of what changes near it (Q = {:.2f}, "
        "must be at least {:g}): it follows something else than the body, or "
        "lost it{}; give --region X,Y,W,H or the body's size",
        explained.near > 0.0 ? "only a part" : "none", explained.near, least,
        LostFrames(explained));
  } else if (!(explained.near >= limits.usual_near)) {
    check.verdict = Verdict::kDoubtful;
    check.reason = fmt::format(
        "the answer's outline explains only part of what changes near it (Q = "
        "{:.2f}, usually above {:g}){}",
        explained.near, limits.usual_near, LostFrames(explained));
  } else {
    check.verdict = Verdict::kPassed;
  }
  return check;
}

struct Step {
  double x_px = 0.0;
  double y_px = 0.0;
};

Step MeasureStep(const vision::Pose& from, const vision::Pose& to) {
  return {to.centre.x_px - from.centre.x_px, to.centre.y_px - from.centre.y_px};
}

double Distance(const Step& a, const Step& b) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

// How far a step lies beside those between the one before and the one after it:
// the frame in which a blow falls has some of both.
double BesideBoth(const Step& before, const Step& step, const Step& after) {
  const Step change{after.x_px - before.x_px, after.y_px - before.y_px};
  const double square = change.x_px * change.x_px + change.y_px * change.y_px;
  const double along = (step.x_px - before.x_px) * change.x_px +
                       (step.y_px - before.y_px) * change.y_px;
  const double share =
      square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  return Distance(step, {before.x_px + share * change.x_px,
                         before.y_px + share * change.y_px});
}

// The first pose before `last` from which the path jumps to the next frame's by
// more than `most_px`; nothing where it does not.
std::optional<std::size_t> FindJump(const std::vector<vision::Pose>& poses,
                                    std::int64_t last, double most_px) {
  // What a flight's acceleration changes from one step to the next.
  std::vector<double> changes;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    if (poses[i].frame - poses[i - 2].frame != 2) continue;
    changes.push_back(Distance(MeasureStep(poses[i - 2], poses[i - 1]),
                               MeasureStep(poses[i - 1], poses[i])));
  }
  if (changes.empty()) return std::nullopt;
  const auto middle =
      changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  constexpr double kChanges = 2.0;  // on both sides of the step
  const double allowed_px = most_px + kChanges * *middle;
  for (std::size_t i = 3; i < poses.size(); ++i) {
    if (poses[i - 1].frame > last) break;
    if (poses[i].frame - poses[i - 3].frame != 3) continue;
    if (BesideBoth(MeasureStep(poses[i - 3], poses[i - 2]),
                   MeasureStep(poses[i - 2], poses[i - 1]),
                   MeasureStep(poses[i - 1], poses[i])) > allowed_px) {
      return i - 2;
    }
  }
  return std::nullopt;
}

// Up to the second contact: what the first one's angles and state hang on.
std::optional<std::size_t> FindJump(const Analysis& analysis,
                                    const AnswerCheckLimits& limits) {
  if (!analysis.track) return std::nullopt;
  const vision::Track& track = *analysis.track;
  std::int64_t last = track.last_frame;
  if (!analysis.contacts.later.empty()) {
    const core::Measured& frame = analysis.contacts.later.front().contact.frame;
    if (frame) last = std::llround(frame->value);
  }
  return FindJump(track.poses, last,
                  2.0 * limits.most_jump * HalfShort(track.body).value);
}

// The flights that measure the first contact, against their own poses.
AnswerCheck CheckPath(const Analysis& analysis,
                      const AnswerCheckLimits& limits) {
  AnswerCheck check;
  check.name = "path";
  if (const auto at = FindJump(analysis, limits)) {
    const vision::Pose& from = analysis.track->poses[*at];
    const vision::Pose& to = analysis.track->poses[*at + 1];
    const Step step = MeasureStep(from, to);
    check.verdict =
        analysis.corrections.empty() ? Verdict::kRefused : Verdict::kDoubtful;
    check.reason = fmt::format(
        "the path jumps by {:.0f} px from frame {} to {}, as no body does: it "
        "was lost; give --frames, --region X,Y,W,H or the body's size",
        std::hypot(step.x_px, step.y_px), from.frame, to.frame);
    return check;
  }
  const vision::ContactResult& contacts = analysis.contacts;
  if (contacts.evidence.empty()) {
    check.reason = "no flight was measured";
    return check;
  }
  check.verdict = Verdict::kPassed;
  // Of all stretches of the path those count in which the flights before and
  // after the first contact lie: the angles come of them.
  const vision::ContactEvidence& first = contacts.evidence.front();
  for (const auto* flight : {&first.before, &first.after}) {
    if (!*flight) continue;
    for (const vision::PathStretch& stretch : contacts.path) {
      const bool measures = stretch.first_frame <= (*flight)->first_frame &&
                            stretch.last_frame >= (*flight)->last_frame;
      if (!measures || stretch.degrees < limits.least_degrees ||
          stretch.chi2 <= limits.most_reduced_chi2 * stretch.degrees) {
        continue;
      }
      // u of the answer has grown by its square root; ten times as much is not
      // a body that comes nearer, but another motion.
      constexpr double kAnotherMotion = 10.0;
      check.verdict = stretch.chi2 > kAnotherMotion * limits.most_reduced_chi2 *
                                         stretch.degrees
                          ? Verdict::kRefused
                          : Verdict::kDoubtful;
      check.reason = fmt::format(
          "the path from frame {} to {} is no free flight: chi^2 per degree of "
          "freedom is {:.1f}, usually at most {:g}",
          stretch.first_frame, stretch.last_frame,
          stretch.chi2 / stretch.degrees, limits.most_reduced_chi2);
      return check;
    }
  }
  return check;
}

// The body that was stated beside the one that was followed. A person who
// corrected the answer has looked at it.
AnswerCheck CheckSize(const Analysis& analysis,
                      const AnswerCheckLimits& limits) {
  AnswerCheck check;
  check.name = "size";
  check.verdict = Verdict::kPassed;
  if (!analysis.size_conflict) return check;
  check.reason = analysis.size_conflict->reason;
  const bool other_changes =
      analysis.explained &&
      analysis.explained->elsewhere > limits.most_elsewhere;
  const bool refused =
      analysis.size_conflict->relative > limits.most_size_conflict ||
      other_changes;
  check.verdict = refused && analysis.corrections.empty() ? Verdict::kRefused
                                                          : Verdict::kDoubtful;
  if (other_changes) {
    check.reason += fmt::format("; {:.0f} % of the change is elsewhere",
                                100.0 * analysis.explained->elsewhere);
  }
  return check;
}

// The body's shape, of which every part must be seen. A person who corrected
// the answer has looked at it.
AnswerCheck CheckShape(const Analysis& analysis,
                       const AnswerCheckLimits& limits) {
  AnswerCheck check;
  check.name = "shape";
  if (!analysis.explained) {
    check.reason = analysis.explained.error().reason;
    return check;
  }
  // A rectangle's angles are those of its sides: it has to be seen.
  if (analysis.track && analysis.track->patterned &&
      analysis.track->body.kind == core::BodyKind::kSphere) {
    check.reason = "the body is followed by its own picture, which has holes";
    return check;
  }
  const vision::ExplainedChange& explained = *analysis.explained;
  if (!explained.seen && !explained.near_as_disc) {
    check.reason = "too little of the body is sampled";
    return check;
  }
  check.verdict = Verdict::kPassed;
  const Verdict refused =
      analysis.corrections.empty() ? Verdict::kRefused : Verdict::kDoubtful;
  if (explained.near_as_disc &&
      explained.near - *explained.near_as_disc < limits.least_of_corners) {
    check.verdict = refused;
    check.reason = fmt::format(
        "the body looks like a sphere, not like a rectangle: a disc as wide as "
        "the short side explains {:.3f} of what changes near it, the rectangle "
        "{:.3f}; give --body sphere",
        *explained.near_as_disc, explained.near);
  } else if (explained.seen && *explained.seen < limits.usual_seen) {
    check.verdict =
        *explained.seen < limits.least_seen ? refused : Verdict::kDoubtful;
    check.reason = fmt::format(
        "only {:.0f} % of the {}'s area is seen to be the body, the rest shows "
        "what lies behind it: the body is smaller or of another shape; check "
        "the size, the scale and --body",
        100.0 * *explained.seen,
        analysis.track->body.kind == core::BodyKind::kSphere ? "circle"
                                                             : "rectangle");
  }
  return check;
}

// A check of a number: passed until it is compared, not made without one.
AnswerCheck BeginCheck(const char* name, const core::Measured& number) {
  AnswerCheck check;
  check.name = name;
  if (number) {
    check.verdict = Verdict::kPassed;
  } else {
    check.reason = number.error().reason;
  }
  return check;
}

// What is measured beside what nature allows.
AnswerCheck CheckRestitution(const Analysis& analysis,
                             const AnswerCheckLimits& limits) {
  const core::Measured& e = analysis.contacts.first.motion.restitution;
  AnswerCheck check = BeginCheck("restitution", e);
  if (!e) return check;
  // Distance from 0 .. 1; negative within.
  const double beyond = std::max(-e->value, e->value - 1.0);
  if (beyond > limits.most_sigmas * e->u) {
    // It comes out below the line: no rebound at all. Above 1 the film may run
    // backwards, or a second corner have struck between two frames.
    check.verdict =
        -e->value > limits.most_beyond ? Verdict::kRefused : Verdict::kDoubtful;
    check.reason = fmt::format(
        "the restitution is {:.3f} +- {:.3f}, must be in 0 .. 1: the frames "
        "beside the contact show no rebound from this line; check --ground",
        e->value, e->u);
  }
  return check;
}

// The greatest gap from the contact on, which no body has below zero: then it
// touched the ground. It doubts and never refuses: soft ground gives way.
AnswerCheck CheckGap(const Analysis& analysis,
                     const AnswerCheckLimits& limits) {
  const core::Measured& gap = analysis.contacts.first.state.max_gap_m;
  AnswerCheck check = BeginCheck("gap", gap);
  if (!gap) return check;
  if (-gap->value > limits.most_sigmas * gap->u) {
    check.verdict = Verdict::kDoubtful;
    check.reason = fmt::format(
        "from the contact on the body stays {:.2f} +- {:.2f} mm below where it "
        "touched the ground: it has another size or shape, or the ground gave "
        "way; check the size, the scale and --body",
        -gap->value / core::kMillimetre, gap->u / core::kMillimetre);
  }
  return check;
}

// Gravity fitted freely beside g: the one check of scale and frame rate that
// every flight holds. It doubts and never refuses: which of the two is wrong is
// not known, and the angles hardly depend on either.
AnswerCheck CheckGravity(const Analysis& analysis,
                         const AnswerCheckLimits& limits) {
  const core::Measured& g = analysis.contacts.first.motion.gravity_check_mps2;
  AnswerCheck check = BeginCheck("gravity", g);
  check.is_of_units = true;
  if (!g) return check;
  // g varies by 0.5 % over the earth; 0.2 % is a standard deviation of that.
  const core::Estimate known{core::kStandardGravity_mps2,
                             0.002 * core::kStandardGravity_mps2};
  if (core::Disagreement(*g, known) > limits.most_sigmas) {
    check.verdict = Verdict::kDoubtful;
    // g_fit / g = true scale / stated scale = (stated rate / true rate)^2.
    const double ratio = g->value / known.value;
    check.reason = fmt::format(
        "gravity fitted freely is {:.3f} +- {:.3f} m/s2 for {:.3f}: a scale of "
        "{:.1f} px/m or {:.1f} frames/s would explain it",
        g->value, g->u, known.value, analysis.scale->px_per_m.value * ratio,
        analysis.clip.time_base.fps / std::sqrt(std::max(ratio, 1e-6)));
  }
  return check;
}

// Why the answer is withheld: the first reason that refuses, or all of those
// that doubt the body, where these are too many. Empty where it stands.
std::string FindRefusal(const Analysis& analysis,
                        const AnswerCheckLimits& limits) {
  std::vector<std::string> doubts;
  for (const AnswerCheck& check : analysis.checks) {
    if (check.verdict == Verdict::kRefused) return check.reason;
    if (check.verdict == Verdict::kDoubtful && !check.is_of_units) {
      doubts.push_back(check.reason);
    }
  }
  const bool are_too_many =
      doubts.size() > static_cast<std::size_t>(limits.most_doubts);
  if (!are_too_many || !analysis.corrections.empty()) return {};
  return fmt::format("{} checks doubt the answer: {}", doubts.size(),
                     fmt::join(doubts, "; "));
}

// Contacts and state as they are where there is no answer.
void Withhold(const std::string& reason, Analysis& analysis) {
  analysis.contacts = {};
  analysis.contacts.first.contact.reason = reason;
  analysis.contacts.first.state.reason = reason;
}

}  // namespace

std::string_view Name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPassed:
      return "passed";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kRefused:
      return "refused";
    case Verdict::kNotMade:
      break;
  }
  return "not made";
}

std::vector<AnswerCheck> RunAnswerChecks(const Analysis& analysis,
                                         const AnswerCheckLimits& limits) {
  return {CheckExplained(analysis, limits),   CheckSize(analysis, limits),
          CheckShape(analysis, limits),       CheckPath(analysis, limits),
          CheckRestitution(analysis, limits), CheckGap(analysis, limits),
          CheckGravity(analysis, limits)};
}

void CheckAnswer(Analysis& analysis, const AnswerCheckLimits& limits) {
  analysis.checks = RunAnswerChecks(analysis, limits);
  const std::string refusal = FindRefusal(analysis, limits);
  if (!refusal.empty() && analysis.contacts.first.contact.found) {
    Withhold(refusal, analysis);
  }
  for (const AnswerCheck& check : analysis.checks) {
    if (check.verdict != Verdict::kDoubtful) continue;
    if (std::find(analysis.warnings.begin(), analysis.warnings.end(),
                  check.reason) == analysis.warnings.end()) {
      analysis.warnings.push_back(check.reason);
    }
  }
}

}  // namespace touchdown::pipeline
