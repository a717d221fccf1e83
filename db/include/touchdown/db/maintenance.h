// Care of a store: check, backup, merge, upgrade. Each is safe while other
// processes log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/records.h"
#include "touchdown/db/register.h"
#include "touchdown/db/store.h"

namespace touchdown::db {

// --- check -------------------------------------------------------------------

// SHA-256 of a clip in lower-case hexadecimal, as core::ClipIdentity has it;
// nothing if it cannot be read. This module opens no clips: the caller brings
// it.
using DigestOf =
    std::function<std::optional<std::string>(const std::filesystem::path&)>;

struct CheckReport {
  // One line each, empty if the store is sound: pages and indexes, foreign
  // keys, tables, views and triggers, the revisions of every trial, the hash
  // chain over all that was recorded.
  std::vector<std::string> problems;
  // Where clips were last seen and are no more: gone, or another recording that
  // the store knows has the name now. No damage.
  std::vector<std::string> clips_missing;
  // Files whose bytes are no longer those of the clip that was analysed: not a
  // fault of the store, but of the evidence.
  std::vector<std::string> clips_changed;
  std::int64_t register_versions = 0;
  std::int64_t campaigns = 0;
  std::int64_t trials = 0;
  std::int64_t revisions = 0;
  std::int64_t clips_verified = 0;  // file there, digest as recorded
  std::int64_t clips_without_digest = 0;
};

// Reads the whole file; with `digest`, also every clip that has one recorded.
CheckReport Check(const Store& store, const DigestOf& digest = nullptr);

// --- backup ------------------------------------------------------------------

// Copies the store as it is at one instant into one file, which must not exist;
// writers go on meanwhile. The copy is written beside `to` under a temporary
// name, checked, brought to the disk and renamed: `to` is whole or absent.
void Backup(const Store& store, const std::filesystem::path& to);

// --- merge and import --------------------------------------------------------

struct MergeReport {
  std::int64_t trials_added = 0;
  std::int64_t revisions_added = 0;  // those of new trials included
  std::int64_t revisions_known = 0;  // already here: a merge can be repeated
  std::int64_t campaigns_added = 0;
  std::int64_t register_versions_added = 0;
  std::int64_t plan_events_added = 0;  // plans and looks
  // One line each: what the two stores say differently, and what was done.
  // Nothing of either store is dropped.
  std::vector<std::string> conflicts;
};

// Adds everything that `from` holds and `into` does not, in one transaction.
//   - Versions of the register's entries are all kept; where both stores
//     changed an entry, that of the higher number, then the later one, is in
//     force.
//   - A campaign of the same name with other conventions comes in under the
//     name "NAME (first 8 characters of the other store's id)".
//   - Where a trial was revised in both stores, both chains are kept and the
//     statement recorded later is in force.
//   - Where both logged the same clip in the same campaign as trials of
//     different id, the other's revisions become revisions of the one here.
MergeReport Merge(Store& into, const Store& from);

// The same from anywhere: `next` gives the history of one trial after the
// other, oldest revision first, and nothing at the end; `entries` are versions
// of the register in the order of AllVersions, `plan` events of `campaigns`.
// `source` names the other side in
// new campaign names.
using NextHistory = std::function<std::optional<std::vector<Revision>>()>;
MergeReport Restore(Store& into, std::string_view source,
                    std::span<const Entry> entries,
                    std::span<const core::Campaign> campaigns,
                    std::span<const PlanEvent> plan, const NextHistory& next);

// --- upgrade -----------------------------------------------------------------

struct Migration {
  std::int64_t from_version = 0;
  std::int64_t to_version = 0;
  // A copy of the store as it was, "lab.db.version7"; empty where it is
  // current.
  std::filesystem::path old_store;
};

// Brings a store of an older version to this program's, in one transaction,
// after a copy of it was made beside it; nothing changes if it is current.
// Throws core::StoreError if it is newer, damaged, or not what was recorded.
Migration Migrate(const std::filesystem::path& path, OpenOptions options = {});

}  // namespace touchdown::db
