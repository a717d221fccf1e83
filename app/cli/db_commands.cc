// db check|backup|merge|migrate: care of the store.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/store_flags.h"
#include "app/cli/store_text.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

struct DbFlags {
  std::string db;
  std::string to;
  std::vector<std::string> from;
};

int Check(const DbFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const db::CheckReport report = db::Check(store);
  for (const auto& problem : report.problems) {
    fmt::print("problem: {}\n", Printable(problem));
  }
  fmt::print(
      "{} campaigns, {} trials, {} revisions; {} clips without SHA-256\n",
      report.campaigns, report.trials, report.revisions,
      report.clips_without_digest);
  if (report.problems.empty()) {
    fmt::print("the store is sound\n");
    return 0;
  }
  throw core::StoreError(fmt::format(
      "{}: {} problem{}; go back to a backup, or export what can be read",
      flags.db, report.problems.size(),
      report.problems.size() == 1 ? "" : "s"));
}

int Backup(const DbFlags& flags) {
  db::Backup(db::Store::Open(flags.db, db::OpenMode::kRead), flags.to);
  fmt::print("{}\n", flags.to);
  return 0;
}

int Merge(const DbFlags& flags) {
  auto into = db::Store::Open(flags.db, db::OpenMode::kCreate);
  for (const auto& file : flags.from) {
    const db::MergeReport report =
        db::Merge(into, db::Store::Open(file, db::OpenMode::kRead));
    for (const auto& conflict : report.conflicts) {
      fmt::print("conflict: {}\n", Printable(conflict));
    }
    fmt::print(
        "{}: {} trials, {} revisions, {} campaigns added; {} revisions were "
        "here already; {} conflicts\n",
        Printable(file), report.trials_added, report.revisions_added,
        report.campaigns_added, report.revisions_known,
        report.conflicts.size());
  }
  return 0;
}

int Migrate(const DbFlags& flags) {
  const db::Migration migration = db::Migrate(flags.db);
  if (migration.from_version == migration.to_version) {
    fmt::print("the store has version {}: nothing to do\n",
               migration.to_version);
  } else {
    fmt::print("from version {} to {}\n", migration.from_version,
               migration.to_version);
  }
  return 0;
}

}  // namespace

void AddDb(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("db", "care of the trial store");
  command->require_subcommand(1);
  auto flags = std::make_shared<DbFlags>();
  CLI::App* check = command->add_subcommand(
      "check", "pages, foreign keys, the chain of revisions");
  AddDbFlag(*check, flags->db);
  check->callback(
      [flags, &action] { action = [flags] { return Check(*flags); }; });
  CLI::App* backup =
      command->add_subcommand("backup", "a whole copy, while others write");
  AddDbFlag(*backup, flags->db);
  backup->add_option("TO", flags->to, "a file that does not exist yet")
      ->required();
  backup->callback(
      [flags, &action] { action = [flags] { return Backup(*flags); }; });
  CLI::App* merge = command->add_subcommand(
      "merge", "add what other stores hold; can be repeated");
  AddDbFlag(*merge, flags->db);
  merge->add_option("FROM", flags->from, "the other stores")->required();
  merge->callback(
      [flags, &action] { action = [flags] { return Merge(*flags); }; });
  CLI::App* migrate = command->add_subcommand(
      "migrate", "bring a store of an older touchdown to this one");
  AddDbFlag(*migrate, flags->db);
  migrate->callback(
      [flags, &action] { action = [flags] { return Migrate(*flags); }; });
}

}  // namespace touchdown::cli
