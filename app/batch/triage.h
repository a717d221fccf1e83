// What became of each recording of a batch, in the order in which a person
// should look at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/trial.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {

// What was done with a recording.
enum class Done {
  kLogged,  // analysed, and its trial is on the disk
  kKnown,   // the store had the answer: same recording, options, set-points
  kCopy,    // the same recording as an earlier one of the batch; left alone
  kFailed   // no answer; nothing was recorded of it
};
std::string_view Name(Done done);

// Why a person should look, the most pressing first.
enum class Attention {
  kFailed,     // it could not be analysed
  kNoContact,  // no body, several bodies, or no touchdown was seen
  kUndecided,  // neither bounce nor not, at 95 %
  kNoAngle,    // decided, but the contact angle is absent
  kProposed,   // a new analysis differs from a person's correction
  kWarned,     // an answer with warnings
  kCopy,       // recorded twice
  kNone
};
std::string_view Name(Attention attention);

struct TriageEntry {
  std::string clip;  // as the batch listed it
  Done done = Done::kFailed;
  Attention attention = Attention::kFailed;
  // Within one kind of attention, the greater comes first: how close to even an
  // undecided trial is, how many warnings, u of the angle in degrees.
  double urgency = 0.0;
  std::string reason;  // in a sentence; empty where all is well
  std::string trial_id;
  std::int64_t revision = 0;
  // Of the trial, where there is one.
  std::optional<core::MotionState> state;
  std::optional<double> p_bounce;
  std::optional<core::AngleKind> angle_kind;
  core::Measured angle_rad = core::AbsentBecause("not analysed");
};

// The entry of a recording whose trial the store has. `proposal`: a new
// analysis that waits for a person (db::Store::Proposals), or null.
TriageEntry MakeTriageEntry(const std::string& clip, Done done,
                            const core::Trial& trial,
                            const core::Trial* proposal = nullptr);

// What `proposal` would change, and how a person accepts it, in a sentence.
std::string ProposalSentence(const core::Trial& trial,
                             const core::Trial& proposal);

// Whether a person should look at `a` before `b`.
bool NeedsMore(const TriageEntry& a, const TriageEntry& b);

// The most pressing first; what presses alike stays in the order given.
void SortByNeed(std::vector<TriageEntry>& entries);

struct TriageCounts {
  std::size_t logged = 0, known = 0, copies = 0, failed = 0;
  std::size_t to_look_at = 0;  // whatever attention they need
};
TriageCounts Count(std::span<const TriageEntry> entries);

// What the trials of one campaign say together of scale, frame rate and size
// (facts/campaign_checks.h).
struct CampaignWord {
  std::string campaign;
  bool failed = false;
  std::string sentence;  // what would explain it, or what the checks can show
};
// Of each campaign that has a trial among `entries`, by name.
std::vector<CampaignWord> CampaignWords(const db::Store& store,
                                        std::span<const TriageEntry> entries);

// touchdown.batch/1, and the same as CSV (RFC 4180).
std::string TriageJson(std::span<const TriageEntry> entries,
                       std::span<const CampaignWord> campaigns = {});
std::string TriageCsv(std::span<const TriageEntry> entries);

}  // namespace touchdown::pipeline
