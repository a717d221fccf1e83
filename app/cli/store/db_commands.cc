// touchdown db check|seal|backup|columns|pictures|merge|relink|migrate takes
// care of the store. The work is done in db/maintenance.h and app/trials; here
// its reports become lines. `seal` is in seal_command.cc.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/seal_command.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/documents/pictures.h"
#include "app/trials/relink.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"
#include "touchdown/db/views.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::cli {
namespace {

// Holds the flags of all subcommands as typed; each uses some.
struct DbFlags {
  std::string db;
  std::string to;
  std::vector<std::string> from;
  bool no_clips = false;
  std::string against;
  std::string folder;
};

// Returns "1 problem", "2 problems". `word` takes a plain s.
std::string Plural(std::size_t n, std::string_view word) {
  return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

// Checks the store and, unless --no-clips, every recording that it knows.
// Everything found is printed first. Then damage of the store, or a recording
// whose bytes changed, is a core::StoreError (exit status 4); a recording that
// is only not where it was is no error.
int Check(const DbFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  // db opens no recordings itself. A recording that cannot be read counts as
  // missing, which is told below.
  db::DigestOf digest;
  if (!flags.no_clips) {
    digest =
        [](const std::filesystem::path& clip) -> std::optional<std::string> {
      try {
        return vision::Sha256(clip);
      } catch (const core::InputError&) {
        return std::nullopt;
      }
    };
  }
  const db::CheckReport report = db::Check(store, digest);
  for (const auto& problem : report.problems) {
    fmt::print("problem: {}\n", Printable(problem));
  }
  for (const auto& clip : report.clips_changed) {
    fmt::print("changed: {}: not the bytes that were analysed\n",
               Printable(clip));
  }
  for (const auto& clip : report.clips_missing) {
    fmt::print("not where last seen: {}\n", Printable(clip));
  }
  fmt::print(
      "{} campaigns, {} trials, {} revisions, {} in the register\n",
      report.campaigns, report.trials, report.revisions,
      Plural(static_cast<std::size_t>(report.register_versions), "version"));
  fmt::print(
      "clips: {} as they were analysed, {} changed, {} not where last seen, {} "
      "without SHA-256{}\n",
      report.clips_verified, report.clips_changed.size(),
      report.clips_missing.size(), report.clips_without_digest,
      flags.no_clips ? "; not looked at (--no-clips)" : "");
  // A seal finds what the store's own chain cannot: rows that were altered and
  // given new digests. Damage that was found is printed already, so it is not
  // lost where this throws.
  if (!flags.against.empty()) CheckSeal(store, flags.against);
  if (!report.problems.empty()) {
    throw core::StoreError(
        fmt::format("{}: {}; go back to a backup, or export what can be read",
                    flags.db, Plural(report.problems.size(), "problem")));
  }
  // The store itself is sound even where a recording changed, which follows.
  fmt::print("the store is sound\n");
  if (!report.clips_changed.empty()) {
    throw core::StoreError(fmt::format(
        "{}: {} changed since the analysis; bring back the recording, or "
        "exclude its trial with the reason",
        flags.db, Plural(report.clips_changed.size(), "clip")));
  }
  return 0;
}

// Copies the store to TO, which must not exist, and prints its name.
int Backup(const DbFlags& flags) {
  db::Backup(db::Store::Open(flags.db, db::OpenMode::kRead), flags.to);
  fmt::print("{}\n", flags.to);
  return 0;
}

// Adds the other stores one after the other, each in one transaction, and
// prints what came of each. Conflicts are told and are no error: nothing of
// either side is dropped.
int Merge(const DbFlags& flags) {
  // Each is opened once before --db is made: a file that cannot be read must
  // not leave a new, empty store behind.
  for (const auto& file : flags.from) {
    db::Store::Open(file, db::OpenMode::kRead);
  }
  auto into = db::Store::Open(flags.db, db::OpenMode::kCreate);
  for (const auto& file : flags.from) {
    const db::MergeReport report =
        db::Merge(into, db::Store::Open(file, db::OpenMode::kRead));
    for (const auto& conflict : report.conflicts) {
      fmt::print("conflict: {}\n", Printable(conflict));
    }
    fmt::print(
        "{}: {} trials, {} revisions, {} campaigns, {} versions of the "
        "register, {} plans and looks added; {} revisions were here already; "
        "{} conflicts\n",
        Printable(file), report.trials_added, report.revisions_added,
        report.campaigns_added, report.register_versions_added,
        report.plan_events_added, report.revisions_known,
        report.conflicts.size());
  }
  return 0;
}

// Prints the dictionary of the views (`db columns`). It is the same for every
// store, so none is opened.
int Columns() {
  std::vector<std::vector<std::string>> rows = {
      {"view", "column", "type", "unit", "meaning"}};
  for (const db::View& view : db::Views()) {
    for (const db::ViewColumn& column : view.columns) {
      rows.push_back({view.name, column.name, std::string(Name(column.type)),
                      column.unit, column.meaning});
    }
  }
  fmt::print("{}", Aligned(rows));
  return 0;
}

// Draws the missing pictures of contacts beside the store. A recording that is
// gone is counted and is no error: the picture is for people only.
int Pictures(const DbFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const auto trials = store.Trials();
  const auto there = pipeline::KeptPictures(flags.db, trials);
  std::size_t drawn = 0;
  for (const core::Trial& trial : trials) {
    // A picture that is there is kept, even if the trial was revised since.
    if (there.contains(trial.id)) continue;
    drawn += pipeline::KeepPicture(flags.db, trial) ? 1 : 0;
  }
  fmt::print("{} in {}: {} were there, {} drawn, {} not to be had\n",
             Plural(trials.size(), "trial"),
             Printable(pipeline::PictureFolder(flags.db).string()),
             there.size(), drawn, trials.size() - there.size() - drawn);
  return 0;
}

// Finds moved recordings below FOLDER and writes where they are into the store.
// Returns 0 whether or not all were found.
int Relink(const DbFlags& flags) {
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  const pipeline::Relinked relinked = pipeline::Relink(store, flags.folder);
  for (const auto& move : relinked.found) {
    fmt::print("found: {} -> {}\n", Printable(move.from), Printable(move.to));
  }
  for (const auto& path : relinked.missing) {
    fmt::print("not found: {}\n", Printable(path));
  }
  fmt::print("{} found, {} not found, {} where last seen; {} in {}\n",
             Plural(relinked.found.size(), "recording"),
             relinked.missing.size(), relinked.in_place,
             Plural(relinked.looked_at, "recording"), Printable(flags.folder));
  return 0;
}

// Brings the store to this program's version; a copy of it as it was stays
// beside it.
int Migrate(const DbFlags& flags) {
  const db::Migration migration = db::Migrate(flags.db);
  if (migration.from_version == migration.to_version) {
    fmt::print("the store has version {}: nothing to do\n",
               migration.to_version);
  } else {
    fmt::print("from version {} to {}; as it was, it is {}\n",
               migration.from_version, migration.to_version,
               Printable(migration.old_store.string()));
  }
  return 0;
}

}  // namespace

// `check` and `seal` guard against alteration, `backup` against loss; `merge`,
// `relink` and `migrate` change the store, the others read it.
void AddDb(CLI::App& app, Action& action) {
  CLI::App* command = AddCommand(app, "db", "care of the trial store");
  RequireSubcommand(*command);
  auto flags = std::make_shared<DbFlags>();
  CLI::App* check = AddCommand(
      *command, "check",
      "pages, tables, the hash chain over all that was recorded, the clips");
  AddDbFlag(*check, flags->db);
  AddFlag(*check, "--no-clips", flags->no_clips,
          "do not read the clips again (it takes as long as reading all their "
          "bytes)");
  AddOption(*check, "--against", flags->against,
            "a seal that was kept apart, its file or its head: names the first "
            "row that is not as it was sealed");
  SetAction(*check, action, [flags] { return Check(*flags); });
  AddSeal(*command, action);
  CLI::App* backup =
      AddCommand(*command, "backup", "a whole copy, while others write");
  AddDbFlag(*backup, flags->db);
  AddOption(*backup, "TO", flags->to, "a file that does not exist yet")
      .Require();
  SetAction(*backup, action, [flags] { return Backup(*flags); });
  CLI::App* columns = AddCommand(
      *command, "columns",
      "the views that other programs read (docs/reading-the-store.md): every "
      "column with its unit and meaning");
  SetAction(*columns, action, [] { return Columns(); });
  CLI::App* pictures =
      AddCommand(*command, "pictures",
                 "draw the contact of every trial that has no picture yet, "
                 "from its recording, into DB.evidence");
  AddDbFlag(*pictures, flags->db);
  SetAction(*pictures, action, [flags] { return Pictures(*flags); });
  CLI::App* merge = AddCommand(*command, "merge",
                               "add what other stores hold; can be repeated");
  AddDbFlag(*merge, flags->db);
  AddOption(*merge, "FROM", flags->from, "the other stores").Require();
  SetAction(*merge, action, [flags] { return Merge(*flags); });
  CLI::App* relink =
      AddCommand(*command, "relink",
                 "find recordings that were moved, by what they are and not by "
                 "their names; nothing else of the store changes");
  AddDbFlag(*relink, flags->db);
  AddOption(*relink, "FOLDER", flags->folder, "where they are, or above")
      .Require();
  SetAction(*relink, action, [flags] { return Relink(*flags); });
  CLI::App* migrate = AddCommand(
      *command, "migrate", "bring a store of an older touchdown to this one");
  AddDbFlag(*migrate, flags->db);
  SetAction(*migrate, action, [flags] { return Migrate(*flags); });
}

}  // namespace touchdown::cli
