// Every sentence is made here once, and page, terminal and JSON print it alike.
// Angles are in degrees with the digits that their uncertainty allows.
#include "app/report/sentences.h"

#include <fmt/core.h>

#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {

using analysis::DataStatus;
using core::kDegree;

std::string BracketSentence(const analysis::Bracket& bracket) {
  // Both ends exist where outcomes overlap, with the low one above the high
  // one.
  if (bracket.overlap) {
    return fmt::format(
        "no bracket: a body stayed down at {} deg and another bounced at {} "
        "deg",
        Plain(*bracket.low_rad / kDegree), Plain(*bracket.high_rad / kDegree));
  }
  if (bracket.closed()) {
    return fmt::format("bracket {} deg, {} deg wide",
                       HalfOpen(bracket.low_rad, bracket.high_rad, kDegree),
                       Plain((*bracket.high_rad - *bracket.low_rad) / kDegree));
  }
  if (bracket.low_rad) {
    return fmt::format("no bounce up to {} deg",
                       Plain(*bracket.low_rad / kDegree));
  }
  if (bracket.high_rad) {
    return fmt::format("every body bounced, down to {} deg",
                       Plain(*bracket.high_rad / kDegree));
  }
  return "no decided trial";
}

std::string BoundarySentence(const analysis::BoundaryStudy& study) {
  const auto& p = study.posterior;
  // Outcomes of one kind bound one side; the other end, and the median, are the
  // prior's and are not given.
  const analysis::Counts& counts = study.counts;
  if ((counts.bounce == 0) != (counts.not_bounce == 0)) {
    const bool is_below = counts.not_bounce == 0;
    return fmt::format(
        "{} {:.1f} deg (95 %), not bounded {} by these trials",
        is_below ? "below" : "above",
        (is_below ? p.interval95_rad.high : p.interval95_rad.low) / kDegree,
        is_below ? "below" : "above");
  }
  const int decimals = Decimals(p.sd_rad / kDegree);
  return fmt::format("{:.{}f} deg, 95 % interval {:.{}f} to {:.{}f} deg",
                     p.median_rad / kDegree, decimals,
                     p.interval95_rad.low / kDegree, decimals,
                     p.interval95_rad.high / kDegree, decimals);
}

std::string AgreementSentence(const analysis::TheoryComparison& theory) {
  const analysis::Agreement& a = theory.agreement;
  std::string text =
      fmt::format("{} of {} agree with the {} boundary, {} deg", a.all.right(),
                  a.all.total(), theory.theory.name,
                  Plain(theory.theory.boundary_rad / kDegree));
  if (a.decides_nothing > 0) {
    text +=
        fmt::format(", but {} of them {} too near to it to tell (within 2 u)",
                    a.decides_nothing, a.decides_nothing == 1 ? "lies" : "lie");
  }
  if (a.all.total() > 0) {
    text += fmt::format(
        "; every boundary {} deg agrees as well",
        a.same_low_rad && a.same_high_rad
            ? "in " + HalfOpen(a.same_low_rad, a.same_high_rad, kDegree)
            : HalfOpen(a.same_low_rad, a.same_high_rad, kDegree));
  }
  return text + ".";
}

std::string VerdictWord(const Group& group) {
  const analysis::TheoryComparison* theory = group.declared();
  if (group.simulated()) return "no verdict";
  // Published theories are shown for information and never judged.
  if (theory == nullptr) return "no verdict: no theory was declared";
  if (!theory->judgement.verdict) return "no verdict";
  return std::string(core::Name(*theory->judgement.verdict));
}

std::string VerdictSentence(const Group& group) {
  const analysis::TheoryComparison* theory = group.declared();
  if (group.simulated()) {
    return "Simulated trials yield no verdict on a theory: they test the "
           "software.";
  }
  if (theory == nullptr) {
    return "Only a theory that the campaign declares before its first trial "
           "gets a verdict.";
  }
  // There is no verdict, and the judgement says why.
  if (!theory->judgement.verdict) return theory->judgement.reason + ".";
  const std::string boundary =
      fmt::format("the {} boundary, {} deg,", theory->theory.name,
                  Plain(theory->theory.boundary_rad / kDegree));
  const std::string margin = Plain(group.study.margin_rad / kDegree);
  // The smallest margin tells how far from a confirmation the trials are.
  if (theory->judgement.verdict == core::Verdict::kInconclusive) {
    return fmt::format(
        "These trials neither confirm nor contradict {} with a margin of {} "
        "deg: {}. The posterior's 90 % interval would fit a margin of {:.1f} "
        "deg.",
        boundary, margin, theory->judgement.reason,
        theory->smallest_margin_rad / kDegree);
  }
  return fmt::format("These trials {} {} with a margin of {} deg: {}.",
                     theory->judgement.verdict == core::Verdict::kConfirmed
                         ? "confirm"
                         : "contradict",
                     boundary, margin, theory->judgement.reason);
}

std::string OutlookSentence(const Group& group) {
  const analysis::TheoryComparison* theory = group.declared();
  // A forecast for one boundary would be of no use.
  if (!group.dependence.empty()) {
    return "More trials of the same kind cannot confirm it: first what moves "
           "the boundary must be found and removed.";
  }
  if (theory == nullptr || !theory->trials_to_decide) return "";
  // A forecast beyond this means: not by more of the same trials.
  constexpr int kHopeless = 1000;
  if (*theory->trials_to_decide > kHopeless) {
    return group.study.posterior.common_u_rad > 0.0
               ? "More trials of this kind would hardly decide: the scatter of "
                 "the boundary, or the error that all trials of a set-up "
                 "share, is too large for the margin."
               : "More trials of this kind would hardly decide: the scatter of "
                 "the boundary is too large for the margin.";
  }
  return fmt::format(
      "About {} would decide, if boundary and scatter are what they now seem; "
      "the next would tell most near {:.1f} deg.",
      *theory->trials_to_decide == 1
          ? std::string("one more trial")
          : fmt::format("{} more trials", *theory->trials_to_decide),
      (theory->deciding ? theory->deciding->angle_rad
                        : group.study.posterior.median_rad) /
          kDegree);
}

namespace {

// Where the next angle may lie, in brackets: the reach of the rig, or why none
// is known.
std::string ReachClause(const Group& group) {
  if (!group.reach) {
    return fmt::format(" (not bounded by a rig: {})",
                       group.reach.error().reason);
  }
  return fmt::format(" ({} {:.2f} to {:.2f} deg, {})",
                     group.study.next.clipped ? "the nearer end of" : "within",
                     group.reach->angle_rad.low / kDegree,
                     group.reach->angle_rad.high / kDegree, group.reach->by);
}

// What is done where all trials say the same; empty where both outcomes were
// seen.
std::string OneSidedClause(const Group& group) {
  const analysis::BoundaryStudy& study = group.study;
  const DataStatus status = study.posterior.status;
  if (status == DataStatus::kNoTrials) {
    return ". No trial is decided: this angle says most beforehand";
  }
  const bool all_bounced = status == DataStatus::kOnlyBounces;
  if (!all_bounced && status != DataStatus::kOnlySlides) return "";
  const std::string seen =
      all_bounced ? ". Every body bounced: the boundary lies lower"
                  : ". Every body stayed down: the boundary lies higher";
  // The rule still finds an angle on the open side that can be thrown.
  if (!study.next.clipped) {
    return fmt::format("{}, and the angle goes {}", seen,
                       all_bounced ? "down" : "up");
  }
  // The angle is the end of the reach: if nothing changes there, no further
  // trial of this campaign finds the boundary.
  return fmt::format(
      "{}, perhaps beyond what can be thrown; where this angle says the same "
      "again, a new campaign with another speed or bounce height can bring it "
      "within reach",
      seen);
}

}  // namespace

std::string NextSentence(const Group& group) {
  return fmt::format("{:.2f} deg{}{}.", group.study.next.angle_rad / kDegree,
                     ReachClause(group), OneSidedClause(group));
}

std::string StatusSentence(const analysis::BoundaryStudy& study) {
  std::string text;
  // How the outcomes lie to each other decides what the estimate rests on.
  switch (study.posterior.status) {
    case DataStatus::kNoTrials:
      text = "No trial is decided: the estimate is nothing but its prior.";
      break;
    case DataStatus::kOnlySlides:
      text =
          "Every body stayed down: the boundary lies above, and its upper "
          "limit is prior.";
      break;
    case DataStatus::kOnlyBounces:
      text =
          "Every body bounced: the boundary lies below, and its lower limit "
          "is prior.";
      break;
    case DataStatus::kSeparated:
      text =
          "Slides and bounces do not overlap, so the trials alone do not tell "
          "how much the boundary scatters: the width beyond the bracket comes "
          "from two priors on that scatter, and the interval holds under both.";
      break;
    case DataStatus::kTouching:
      text =
          "Slides and bounces share one angle and overlap no further: the "
          "scatter is hardly known, and the interval holds under two priors on "
          "it.";
      break;
    case DataStatus::kOverlap:
      text = "Slides and bounces overlap, so the scatter is seen in the data.";
      break;
    case DataStatus::kNoTrend:
      text =
          "Bounces lie no higher than slides, and no lower than chance would "
          "put them: the scatter is seen, and no trend with the angle, so that "
          "the trials tell no boundary.";
      break;
    case DataStatus::kReversed:
      text =
          "Inconsistent: bounces lie on the whole no higher than slides. Check "
          "labels "
          "and angles before using any number of this group.";
      break;
  }
  if (study.posterior.few_trials) {
    text += fmt::format(" Fewer than {} decided trials.", analysis::kFewTrials);
  }
  if (study.posterior.lapse > 0.0) {
    text += fmt::format(
        " The data ask for trials that went wrong: a lapse rate of {:.2f} is "
        "allowed for.",
        study.posterior.lapse);
  }
  if (study.posterior.binned) {
    text += " The trials were binned.";
  }
  return text;
}

}  // namespace touchdown::report
