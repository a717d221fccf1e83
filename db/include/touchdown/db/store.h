// The trial store: one SQLite file in which nothing recorded is lost or
// silently changed.
//
//   Store store = Store::Open("lab.db", OpenMode::kCreate);
//   store.AddCampaign(campaign);
//   const Logged logged = store.LogTrial(trial);    // on the disk on return
//   for (const core::Trial& t : store.Trials({.campaign = "asphalt"})) ...
//
// Any number of processes may read and write one file at once, on one machine
// (SQLite's log does not work over network file systems). One Store belongs to
// one thread. Every failure of the file, the disk or another process is a
// core::StoreError of one line; a wrong argument is a std::invalid_argument. A
// function that throws has recorded nothing.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/records.h"

namespace touchdown::db {

class Connection;

enum class OpenMode {
  kRead,   // an existing store; never changes nor creates one
  kWrite,  // an existing store
  kCreate  // a new one where there is none
};

struct OpenOptions {
  // How long another process may hold the store before a call gives up, s. A
  // durable commit takes some milliseconds, a bulk import seconds: 60 s waits
  // for either, and still ends when a process has been stopped while writing.
  double patience_s = 60.0;
  Sources sources = SystemSources();
};

class Store {
 public:
  // Throws core::StoreError if the file is absent (kRead, kWrite), is not a
  // trial store, is damaged, is read-only (kWrite, kCreate) or was made by a
  // newer or older program (the message says what to do).
  static Store Open(const std::filesystem::path& path, OpenMode mode,
                    OpenOptions options = {});
  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  const std::filesystem::path& path() const;
  const std::string& uuid() const;  // of the store; given when it was made

  // --- campaigns -------------------------------------------------------------
  // Conventions are fixed before the first trial: a campaign can be added once,
  // and changed only while it has no trials (StoreError otherwise).
  void AddCampaign(const core::Campaign& campaign);
  void ChangeCampaign(const core::Campaign& campaign);
  std::optional<core::Campaign> FindCampaign(std::string_view name) const;
  std::vector<core::Campaign> Campaigns() const;  // by name

  // --- trials ----------------------------------------------------------------
  // Records a trial: a new one, or, where the same clip is already in the same
  // campaign (or `trial.id` names a trial), a further revision of it. Ignores
  // revision and recorded_at_utc, which the store gives. A trial that had been
  // excluded stays so. An analysis (a trial with a document) of what a person
  // has corrected becomes a proposal: it is kept, and the correction stays in
  // force. Body and angle kind must be those of the campaign, which
  // must exist; the origin of a trial cannot change.
  Logged LogTrial(const core::Trial& trial);
  // The same for many, in one transaction: all or none. A trial that LogTrial
  // would refuse is a TrialRefused.
  std::vector<Logged> LogTrials(std::span<const core::Trial> trials);

  // A person's revision. `seen` is the trial as Find gave it, with the fields
  // changed that are wrong; if somebody revised the trial since (seen.revision
  // is no longer in force), throws StoreError. Changes() tells from what to
  // what.
  Logged Correct(const core::Trial& seen, std::string_view who,
                 std::string_view why);
  // Takes a trial out of, or back into, what counts. Nothing is removed. With
  // `seen`, the revision that the person looked at, like Correct.
  Logged Exclude(std::string_view id, std::string_view who,
                 std::string_view why,
                 std::optional<std::int64_t> seen = std::nullopt);
  Logged Include(std::string_view id, std::string_view who,
                 std::string_view why,
                 std::optional<std::int64_t> seen = std::nullopt);

  // The current revision of each trial, in the order in which they were logged.
  std::vector<core::Trial> Trials(const TrialFilter& filter = {}) const;
  // One trial by its id or by the beginning of it (at least 4 characters);
  // nothing if there is none, StoreError naming the candidates if several.
  std::optional<core::Trial> Find(std::string_view id_or_prefix) const;
  // Of the trial that a campaign ("": none) has of a clip (core::ClipIdentity,
  // its id); nothing where it has none.
  std::optional<LastLogged> FindLogged(std::string_view campaign,
                                       std::string_view clip_id) const;
  // Analyses that wait for a person (OpenProposal). With `id`, of that trial
  // alone.
  std::vector<core::Trial> Proposals(std::string_view id = "") const;
  // Every revision of a trial, oldest first; empty if there is no such id.
  std::vector<Revision> History(std::string_view id) const;
  // Calls `visit` with the history of every trial, oldest trial first, from one
  // snapshot: memory does not grow with the store.
  void ForEachHistory(
      const std::function<void(const std::vector<Revision>&)>& visit) const;

  // For the other sources of db/src.
  Connection& connection() const;
  const Sources& sources() const;

 private:
  struct Impl;
  explicit Store(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchdown::db
