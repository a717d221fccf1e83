// What the store says beyond core::Trial: revisions, filters, reports.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"
#include "touchdown/core/words.h"

namespace touchdown::db {

// Why a revision exists.
//   logged     a program or a person stated the trial (anew)
//   corrected  a person changed what an earlier revision stated
//   excluded, included   the trial no longer, or again, counts
//   merged     two stores had diverged; restates the later of the two
//   proposed   a program analysed again what a person had corrected: never in
//              force, until a person corrects the trial to what it says
enum class RevisionKind {
  kLogged,
  kCorrected,
  kExcluded,
  kIncluded,
  kMerged,
  kProposed
};
std::string_view Name(RevisionKind kind);
std::optional<RevisionKind> ParseRevisionKind(std::string_view word);

// One revision: the whole trial as it stood from then on. `trial.author`,
// `trial.reason` and `trial.recorded_at_utc` say who, why and when.
struct Revision {
  std::string id;  // UUID of the revision; trial.id is the trial's
  RevisionKind kind = RevisionKind::kLogged;
  core::Trial trial;
};

// The last of `history` (oldest first) that is not a proposal: the revision in
// force. `history` must not be empty; its first is never a proposal.
const Revision& RevisionInForce(std::span<const Revision> history);

// The last proposal of `history`, where nothing was stated after it; null where
// no proposal waits for a person.
const Revision* OpenProposal(std::span<const Revision> history);

// One difference between two revisions, for a person: "approach_angle_rad",
// "0.35 +- 0.001", "0.36 +- 0.001".
struct Change {
  std::string field;
  std::string from;
  std::string to;

  friend bool operator==(const Change&, const Change&) = default;
};

// What differs in the statements themselves; who, when and why do not count.
// Fields of later contacts bear the number: "contact 2: state".
std::vector<Change> Changes(const core::Trial& before,
                            const core::Trial& after);

// Which trials. Every field that is set must hold for the current revision.
struct TrialFilter {
  std::optional<std::string> campaign =
      std::nullopt;  // "" means trials in no campaign
  std::optional<core::Origin> origin = std::nullopt;
  std::optional<core::BodyKind> body = std::nullopt;
  std::optional<core::MotionState> state = std::nullopt;
  // First logged in from_utc <= t < until_utc; ISO 8601 or the beginning of
  // one ("2026-08-01").
  std::optional<std::string> from_utc = std::nullopt;
  std::optional<std::string> until_utc = std::nullopt;
  std::optional<bool> excluded = std::nullopt;  // false: only those that count
  // The analysis documents are most of a store's bytes; without them
  // document_json is empty.
  bool with_documents = true;
};

// Thrown by Store::LogTrials: which of the trials cannot be recorded, and why.
class TrialRefused : public std::invalid_argument {
 public:
  TrialRefused(std::size_t index, const std::string& why)
      : std::invalid_argument(why), index_(index) {}
  std::size_t index() const { return index_; }

 private:
  std::size_t index_;
};

// What a store takes: throws std::invalid_argument naming the field if a number
// is NaN, a u is negative, an interval is upside down, the clip has a path but
// no id, or a convention is impossible. The store asks itself; this is for
// those who want to know before they make one.
void RequireStorable(const core::Trial& trial);
void RequireStorable(const core::Campaign& campaign);

// What was last logged of a clip: whoever would log the same needs not. Later
// corrections and exclusions by people do not count.
struct LastLogged {
  std::string trial_id;
  std::string options_hash;
  std::optional<double> set_angle_rad;
  std::optional<double> set_speed_mps;
};

// What became of a trial that was logged.
struct Logged {
  std::string id;
  std::int64_t revision = 0;
  bool is_new = true;  // false: a further revision of a trial already there
  // A proposal: the person's correction that was there stays in force.
  bool is_proposal = false;
};

}  // namespace touchdown::db
