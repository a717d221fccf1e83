// db check|seal|backup|merge|migrate|columns|relink: care of the store.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/seal_command.h"
#include "app/cli/store_flags.h"
#include "app/cli/store_text.h"
#include "app/documents/pictures.h"
#include "app/trials/relink.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"
#include "touchdown/db/views.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::cli {
namespace {

struct DbFlags {
  std::string db;
  std::string to;
  std::vector<std::string> from;
  bool no_clips = false;
  std::string against;
  std::string folder;
};

std::string Plural(std::size_t n, std::string_view word) {
  return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

int Check(const DbFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
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
  if (!flags.against.empty()) CheckSeal(store, flags.against);
  if (!report.problems.empty()) {
    throw core::StoreError(
        fmt::format("{}: {}; go back to a backup, or export what can be read",
                    flags.db, Plural(report.problems.size(), "problem")));
  }
  fmt::print("the store is sound\n");
  if (!report.clips_changed.empty()) {
    throw core::StoreError(fmt::format(
        "{}: {} changed since the analysis; bring back the recording, or "
        "exclude its trial with the reason",
        flags.db, Plural(report.clips_changed.size(), "clip")));
  }
  return 0;
}

int Backup(const DbFlags& flags) {
  db::Backup(db::Store::Open(flags.db, db::OpenMode::kRead), flags.to);
  fmt::print("{}\n", flags.to);
  return 0;
}

int Merge(const DbFlags& flags) {
  // What cannot be read makes no new store.
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

int Pictures(const DbFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const auto trials = store.Trials();
  const auto there = pipeline::KeptPictures(flags.db, trials);
  std::size_t drawn = 0;
  for (const core::Trial& trial : trials) {
    if (there.contains(trial.id)) continue;
    drawn += pipeline::KeepPicture(flags.db, trial) ? 1 : 0;
  }
  fmt::print("{} in {}: {} were there, {} drawn, {} not to be had\n",
             Plural(trials.size(), "trial"),
             Printable(pipeline::PictureFolder(flags.db).string()),
             there.size(), drawn, trials.size() - there.size() - drawn);
  return 0;
}

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
