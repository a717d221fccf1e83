// What a reader wants first, in plain words: what was tested, what came out,
// how sure that is, whether it agrees with the theory, what may rest on it.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/facts/campaign_checks.h"
#include "app/report/content.h"
#include "app/report/sentences.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using analysis::DataStatus;
using core::kDegree;

// The first letter as a capital: the text begins a sentence.
std::string Upper(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] -= 'a' - 'A';
  return text;
}

// "1 trial", "9 trials".
std::string Trials(std::size_t n) {
  return fmt::format("{} trial{}", n, n == 1 ? "" : "s");
}

// What the angle is, for who does not know the words: the end of a sentence.
const char* AngleMeaning(core::AngleKind kind) {
  switch (kind) {
    case core::AngleKind::kRadius:
      return "between the ground and the line from the body's centre to the "
             "point that touches first";
    case core::AngleKind::kFace:
      return "between the ground and the body's long side as it touches down";
    case core::AngleKind::kApproach:
      break;
  }
  return "between the ground and the path on which the body comes down";
}

// " from 3.9 to 74.4 deg" of the trials that count; empty without any.
std::string AngleRange(const Group& group) {
  double low = 1e300;
  double high = -1e300;
  for (const auto& o : group.trials.observations) {
    low = std::min(low, o.angle_rad);
    high = std::max(high, o.angle_rad);
  }
  if (low > high) return "";
  const std::string from = Plain(low / kDegree, 1);
  const std::string to = Plain(high / kDegree, 1);
  return from == to ? fmt::format(" of {} deg", from)
                    : fmt::format(" from {} to {} deg", from, to);
}

// What was thrown, at what, how often, and how it was seen.
std::string Tested(const Group& group, std::span<const core::Trial> trials) {
  const core::Body& body = group.campaign.body.kind == group.trials.body
                               ? group.campaign.body
                               : trials[group.members.front()].body;
  const char* how = group.trials.origin == core::Origin::kSimulated
                        ? "rendered, not filmed"
                    : group.trials.origin == core::Origin::kManual
                        ? "typed in, without a recording that the program read"
                        : "filmed";
  const std::string& surface = group.campaign.surface;
  return fmt::format(
      "{}: a {} ({}); surface: {}. {}, {}, with the {}{}, which is the one {}.",
      group.trials.campaign.empty() ? "No campaign" : group.trials.campaign,
      core::Name(group.trials.body), SizeText(body),
      surface.empty() ? "not recorded" : surface, Trials(group.members.size()),
      how, AngleName(group), AngleRange(group),
      AngleMeaning(group.trials.angle_kind));
}

// How many stayed down and bounced, and the boundary as far as that tells one.
std::string CameOut(const Group& group) {
  const analysis::Counts& counts = group.study.counts;
  std::string out = fmt::format(
      "It stayed down in {} and bounced in {}",
      Trials(static_cast<std::size_t>(counts.not_bounce)), counts.bounce);
  if (counts.undecided > 0) {
    out += fmt::format("; {} could not be decided", counts.undecided);
  }
  if (!group.left_out.empty()) {
    out += fmt::format("; {} left out, with reasons", group.left_out.size());
  }
  out += ". ";
  const bool both = counts.bounce > 0 && counts.not_bounce > 0;
  if (counts.decided() == 0) return out + "No angle follows from that.";
  // One outcome bounds one side: the sentence says which.
  if (!both) {
    return out + fmt::format("The angle from which it bounces is {}.",
                             BoundarySentence(group.study));
  }
  const auto& p = group.study.posterior;
  return out + fmt::format(
                   "The boundary, above which it bounces, is estimated at "
                   "{:.{}f} deg.",
                   p.median_rad / kDegree, Decimals(p.sd_rad / kDegree));
}

// The 95 % interval, the gap between the outcomes, and the u of a single angle.
std::string HowSure(const Group& group) {
  const analysis::BoundaryStudy& study = group.study;
  std::string out;
  if (study.counts.bounce > 0 && study.counts.not_bounce > 0) {
    const auto& p = study.posterior;
    const int decimals = Decimals(p.sd_rad / kDegree);
    out = fmt::format(
        "The boundary lies between {:.{}f} and {:.{}f} deg with a probability "
        "of 95 %",
        p.interval95_rad.low / kDegree, decimals,
        p.interval95_rad.high / kDegree, decimals);
    out += ". ";
    if (study.bracket.closed()) {
      out += fmt::format(
          "No trial lies between {} deg, the steepest that stayed down, and {} "
          "deg, the flattest that bounced. ",
          Plain(*study.bracket.low_rad / kDegree),
          Plain(*study.bracket.high_rad / kDegree));
    }
  } else {
    out = "Only one side of the boundary is known. ";
  }
  return out + fmt::format(
                   "The angle of a single trial is known to {} deg or better "
                   "(one standard uncertainty).",
                   Plain(study.greatest_u_rad / kDegree, 3));
}

// The verdict, its reason, and what would decide where it is inconclusive.
std::string Agrees(const Group& group) {
  std::string out = Upper(VerdictWord(group));
  out += ". " + VerdictSentence(group);
  const std::string outlook = OutlookSentence(group);
  if (!outlook.empty()) out += " " + outlook;
  return out;
}

// The answer to "May I rely on it?", by the worst thing that is known:
// simulated, scale, frame rate or ground line wrong, labels reversed, no one
// boundary; only then yes.
std::string MayRely(const Group& group, std::span<const core::Trial> trials) {
  if (group.simulated()) {
    return "Not for anything real: the pictures were rendered, to test the "
           "software with known truth.";
  }
  const CampaignChecks checks = CheckCampaign(group.members, trials);
  if (checks.Failed()) {
    return "No: " + checks.Suspects() + " is wrong, see the box below.";
  }
  if (group.study.posterior.status == DataStatus::kReversed) {
    return "No: " + StatusSentence(group.study);
  }
  if (!TellingDependence(group, trials).empty()) {
    return "On each trial, yes; on the one boundary, no: see the box below.";
  }
  const analysis::TheoryComparison* theory = group.declared();
  const bool decided =
      theory != nullptr && theory->judgement.verdict &&
      *theory->judgement.verdict != core::Verdict::kInconclusive;
  std::string out =
      decided ? "Yes, on the verdict, too: by simulation at most 5 of 100 such "
                "campaigns see a false one."
              : "On what was seen and on the interval, yes; the trials are not "
                "enough for a verdict on a theory.";
  // Typed trials have no recording, so that no check speaks of them.
  const bool typed = group.trials.origin == core::Origin::kManual;
  if (typed) {
    return out + " The angles were typed in: nothing here can check them.";
  }
  return out + " " + WhatChecksShow(checks) + ".";
}

}  // namespace

Terms MakeSummary(const Group& group, std::span<const core::Trial> trials) {
  Terms out;
  out.lead = true;
  out.items = {{"What was tested", Tested(group, trials)},
               {"What came out", CameOut(group)},
               {"How sure", HowSure(group)},
               {"Does the theory agree", Agrees(group)},
               {"May I rely on it", MayRely(group, trials)}};
  return out;
}

}  // namespace touchdown::report
