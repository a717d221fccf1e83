#include "app/pipeline/answer_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/pipeline/analyze.h"

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
  if (!(explained.near >= limits.least_near)) {
    check.verdict = Verdict::kRefused;
    check.reason = fmt::format(
        "the answer's outline explains none of what changes near it (Q = "
        "{:.2f}, must be at least {:g}): it follows something else than the "
        "body{}; give --region X,Y,W,H or the body's size",
        explained.near, limits.least_near, LostFrames(explained));
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

std::vector<AnswerCheck> ChecksOf(const Analysis& analysis,
                                  const AnswerCheckLimits& limits) {
  return {CheckExplained(analysis, limits)};
}

void CheckAnswer(Analysis& analysis, const AnswerCheckLimits& limits) {
  analysis.checks = ChecksOf(analysis, limits);
  const auto refused =
      std::find_if(analysis.checks.begin(), analysis.checks.end(),
                   [](const AnswerCheck& check) {
                     return check.verdict == Verdict::kRefused;
                   });
  if (refused != analysis.checks.end() &&
      analysis.contacts.first.contact.found) {
    Withhold(refused->reason, analysis);
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
