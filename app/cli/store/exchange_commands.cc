// touchdown export, import: trials to and from files.
//   csv    a flat view of the revisions in force, for spreadsheets
//   jsonl  everything, revision by revision; an import gives the same store
//   tidy   export only: a folder with one CSV for each view of the store
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/cli/store/tidy_export.h"
#include "app/exchange/plan_json.h"
#include "app/exchange/register_json.h"
#include "app/exchange/trial_csv.h"
#include "app/exchange/trial_json.h"
#include "app/text/scratch_folder.h"
#include "app/trials/paper_trials.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/core/units.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/names.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// These are the forms of a file of trials that are listed above.
enum class Format { kCsv, kJsonLines, kTidy };

// Returns the format that --format names or, without it, the file's extension.
// `tidy` is a folder and follows from no name. Throws std::invalid_argument
// where neither says it.
Format ChooseFormat(const std::string& flag, const std::string& file) {
  const std::string kind =
      !flag.empty() ? flag : fs::path(file).extension().string();
  if (kind == "csv" || kind == ".csv") return Format::kCsv;
  if (kind == "jsonl" || kind == ".jsonl") return Format::kJsonLines;
  if (flag == "tidy") return Format::kTidy;
  if (flag.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: the format does not follow from the name; give "
                    "--format csv, jsonl or (export) tidy",
                    file.empty() ? "stdout" : file));
  }
  throw std::invalid_argument(fmt::format(
      "--format is '{}', must be csv, jsonl or (export) tidy", flag));
}

// --- export ------------------------------------------------------------------

// Holds the flags of `export` as typed; an empty `out` is stdout, an empty
// `campaign` means all.
struct ExportFlags {
  std::string db;
  std::string out;
  std::string format;
  std::string campaign;
};

// Writes the trials as CSV or JSON lines. The JSON lines stand in the order
// that an import needs: what others refer to comes first (register, campaigns,
// plans, then the revisions of each trial).
void WriteExport(std::ostream& out, const db::Store& store,
                 const ExportFlags& flags, Format format) {
  if (format == Format::kCsv) {
    db::TrialFilter filter;
    if (!flags.campaign.empty()) filter.campaign = flags.campaign;
    // The documents are most of a store's bytes, and no column shows them.
    filter.with_documents = false;
    report::WriteTrialsCsv(out, store.Trials(filter));
    return;
  }
  report::WriteExportHeader(out, store.uuid());
  for (const auto& entry : db::AllVersions(store)) {
    out << report::EntryJson(entry) << '\n';
  }
  for (const auto& campaign : store.Campaigns()) {
    if (flags.campaign.empty() || campaign.name == flags.campaign) {
      out << report::CampaignJson(campaign) << '\n';
    }
  }
  for (const auto& event : db::PlanEvents(store, flags.campaign)) {
    out << report::PlanEventJson(event) << '\n';
  }
  // Trials come one at a time: memory does not grow with the store.
  store.ForEachHistory([&](const std::vector<db::Revision>& history) {
    if (!flags.campaign.empty() &&
        history.front().trial.campaign != flags.campaign) {
      return;
    }
    for (const auto& revision : history) {
      out << report::RevisionJson(revision) << '\n';
    }
  });
}

// Lets the exporters, which write to a std::ostream, write to a
// core::OutputFile, so that an export appears whole or not at all.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(core::OutputFile& file) : file_(file) {}

 private:
  // Takes single characters; most of the text comes through xsputn().
  int overflow(int c) override {
    if (c == EOF) return 0;
    const char byte = static_cast<char>(c);
    file_.Write(std::string_view(&byte, 1));
    return c;
  }
  std::streamsize xsputn(const char* bytes, std::streamsize n) override {
    file_.Write(std::string_view(bytes, static_cast<std::size_t>(n)));
    return n;
  }

  core::OutputFile& file_;
};

// Runs `export`. Returns 0; throws std::invalid_argument for flags,
// core::StoreError where store or campaign is not there, core::OutputError.
int Export(const ExportFlags& flags) {
  const Format format = ChooseFormat(flags.format, flags.out);
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  if (!flags.campaign.empty()) db::RequireCampaign(store, flags.campaign);
  if (format == Format::kTidy) {
    if (flags.out.empty()) {
      throw std::invalid_argument("--out is missing, must be a folder");
    }
    WriteTidy(store, flags.campaign, flags.out);
    return 0;
  }
  if (flags.out.empty()) {
    // Only here can a reader see half an export: a pipe has no temporary name.
    WriteExport(std::cout, store, flags, format);
    std::cout.flush();
    if (!std::cout) {
      throw core::OutputError("stdout: the export could not be written");
    }
    return 0;
  }
  core::OutputFile file(flags.out);
  FileBuffer buffer(file);
  std::ostream out(&buffer);
  // Without this the stream would swallow what the file throws.
  out.exceptions(std::ios::badbit);
  WriteExport(out, store, flags, format);
  // CSV types nothing: its schema says what each column holds. JSON lines name
  // their schema themselves.
  file.Commit();
  if (format == Format::kCsv) WriteTrialsSchema(flags.out);
  return 0;
}

// --- import ------------------------------------------------------------------

// Holds the flags of `import` as typed. `file` is also what errors call the
// source.
struct ImportFlags {
  std::string db;
  std::string file;
  std::string format;
  std::string by;
  bool partial = false;
  bool columns = false;
  bool paper_table1 = false;
  double paper_u_deg = 0.5;
};

// Prints the columns that a CSV of trials may have (`import --columns`).
int PrintTrialColumns() {
  std::vector<std::vector<std::string>> rows = {{"column", "meaning"}};
  for (const auto& column : report::TrialCsvColumns()) {
    rows.push_back({column.name, column.meaning});
  }
  fmt::print("{}", Aligned(rows));
  return 0;
}

// Holds what an import has done; it is printed at the end.
struct Imported {
  std::string summary;
  std::vector<std::string> errors;     // of rows that were passed over
  std::vector<std::string> conflicts;  // of a merge
  std::size_t count = 0;
};

// Imports the rows of a CSV as new trials of the store at `db`. Without
// --partial all rows or none; with it each right row on its own, and the errors
// of the others are returned.
Imported ImportCsv(const ImportFlags& flags, const fs::path& db,
                   std::istream& in) {
  auto read = report::ReadTrialsCsv(in, flags.file, flags.by);
  auto& errors = read.errors;
  // All errors are reported at once, so that a file can be mended in one go:
  // the first in the exception, which main prints last, the others before it.
  if (!flags.partial && !errors.empty()) {
    for (std::size_t i = 1; i < errors.size(); ++i) {
      Tell(errors[i]);
    }
    throw core::InputError(fmt::format(
        "{} ({} error{} in all; nothing was imported, --partial takes the rows "
        "that are right)",
        Printable(errors.front()), errors.size(),
        errors.size() == 1 ? "" : "s"));
  }
  // The rows that are left have the right form; from here on they are held
  // against what the store has.
  auto store = db::Store::Open(db, db::OpenMode::kCreate);
  std::vector<core::Trial> good;
  std::vector<std::size_t> rows;
  for (auto& [row, trial] : read.trials) {
    std::string error;
    // A row with an id that the store has would become a revision of that
    // trial, which is not what an import of trials is for.
    if (!trial.id.empty()) {
      try {
        if (store.Find(trial.id)) {
          error =
              "this trial is in the store already; leave the cell empty "
              "for a new one";
        }
      } catch (const std::invalid_argument& invalid) {
        error = invalid.what();
      }
    }
    // The campaign is looked up here and not when the trial is logged, so that
    // the message can name row and column.
    const bool no_campaign =
        !trial.campaign.empty() && !store.FindCampaign(trial.campaign);
    if (no_campaign) {
      error =
          "there is no such campaign; make it with `touchdown campaign new`";
    }
    if (!error.empty()) {
      errors.push_back(
          fmt::format("{}: row {}, column {}: '{}': {}", flags.file, row,
                      no_campaign ? "campaign" : "id",
                      no_campaign ? trial.campaign : trial.id, error));
      if (!flags.partial) throw core::InputError(Printable(errors.back()));
      continue;
    }
    good.push_back(std::move(trial));
    rows.push_back(row);
  }
  Imported done;
  // LogTrials() takes all in one transaction; it says which trial it refuses by
  // its place in `good`, and `rows` has the line of the file for it.
  if (!flags.partial) {
    try {
      done.count = store.LogTrials(good).size();
    } catch (const db::TrialRefused& refused) {
      throw core::InputError(fmt::format("{}: row {}: {}", flags.file,
                                         rows.at(refused.index()),
                                         Printable(refused.what())));
    }
  } else {
    for (std::size_t i = 0; i < good.size(); ++i) {
      try {
        store.LogTrials({&good[i], 1});
        ++done.count;
      } catch (const db::TrialRefused& refused) {
        errors.push_back(
            fmt::format("{}: row {}: {}", flags.file, rows[i], refused.what()));
      }
    }
  }
  done.summary =
      fmt::format("{} trials imported, {} errors", done.count, errors.size());
  done.errors = std::move(errors);
  return done;
}

// Imports what `export` wrote, history by history. What is there already is
// counted and left alone, so an import can be repeated.
Imported ImportJsonLines(const ImportFlags& flags, const fs::path& db,
                         std::istream& in) {
  report::ExportReader reader(in, flags.file);
  auto store = db::Store::Open(db, db::OpenMode::kCreate);
  const db::MergeReport report = db::Restore(
      store, reader.store_uuid(), reader.entries(), reader.campaigns(),
      reader.plan(), [&reader] { return reader.NextHistory(); });
  Imported done;
  done.count = static_cast<std::size_t>(
      report.trials_added + report.revisions_added + report.campaigns_added +
      report.register_versions_added + report.plan_events_added);
  done.conflicts = report.conflicts;
  done.summary = fmt::format(
      "{} trials, {} revisions, {} campaigns, {} versions of the register, {} "
      "plans and looks imported; {} revisions were here already; {} conflicts",
      report.trials_added, report.revisions_added, report.campaigns_added,
      report.register_versions_added, report.plan_events_added,
      report.revisions_known, report.conflicts.size());
  return done;
}

// Prints what an import did. Returns 5 where rows were passed over, else 0.
int PrintImported(const Imported& done) {
  for (const auto& conflict : done.conflicts) {
    fmt::print("conflict: {}\n", Printable(conflict));
  }
  for (const auto& error : done.errors) {
    Tell(error);
  }
  fmt::print("{}\n", done.summary);
  return done.errors.empty() ? 0 : 5;
}

// Imports the paper's Table 1 with its two campaigns; the angles get the u of
// --paper-u-deg, since the paper states none. Refused where the store has a
// campaign of one of these names.
int ImportPaperTable1(const ImportFlags& flags) {
  if (!flags.file.empty()) {
    throw std::invalid_argument(fmt::format(
        "FILE is '{}', must be left out with --paper-table1", flags.file));
  }
  if (!(flags.paper_u_deg >= 0.0 && flags.paper_u_deg <= 90.0)) {
    throw std::invalid_argument(fmt::format(
        "--paper-u-deg is {}, must be from 0 to 90", flags.paper_u_deg));
  }
  RequireDb(flags.db);
  auto paper = pipeline::PaperTable1Trials(flags.paper_u_deg * core::kDegree);
  auto store = db::Store::Open(flags.db, db::OpenMode::kCreate);
  for (const auto& campaign : paper.campaigns) {
    if (store.FindCampaign(campaign.name)) {
      throw core::StoreError(fmt::format(
          "{}: there is a campaign '{}' already; nothing was imported",
          flags.db, campaign.name));
    }
  }
  // Campaigns and trials come into the store in one transaction, that of a
  // merge: an import that is cut off between them would leave campaigns without
  // trials, and every later one would be refused.
  const pipeline::ScratchFolder rehearsal;
  auto made =
      db::Store::Open(rehearsal.path() / "rehearsal.db", db::OpenMode::kCreate);
  for (const auto& campaign : paper.campaigns) made.AddCampaign(campaign);
  for (auto& trial : paper.trials) trial.id.clear();  // the store gives one
  const std::size_t n = made.LogTrials(paper.trials).size();
  db::Merge(store, made);
  fmt::print("{} trials in {} campaigns imported\n", n, paper.campaigns.size());
  return 0;
}

// Runs `import` in its three forms: columns, the paper's trials, a file.
int Import(const ImportFlags& flags) {
  if (flags.columns) return PrintTrialColumns();
  if (flags.paper_table1) return ImportPaperTable1(flags);
  if (flags.file.empty()) {
    throw std::invalid_argument(
        "FILE is missing, must be a .csv or .jsonl file (or --columns, or "
        "--paper-table1)");
  }
  RequireDb(flags.db);
  const Format format = ChooseFormat(flags.format, flags.file);
  if (format == Format::kTidy) {
    throw std::invalid_argument("--format is 'tidy', must be csv or jsonl");
  }
  // Imports the file into the store at `db`; it is opened anew each time.
  const auto import_into = [&](const fs::path& db) {
    std::ifstream in(flags.file, std::ios::binary);
    if (!in || fs::is_directory(flags.file)) {
      throw core::InputError(
          fmt::format("{}: cannot be read; check the path and its permissions",
                      flags.file));
    }
    return format == Format::kCsv ? ImportCsv(flags, db, in)
                                  : ImportJsonLines(flags, db, in);
  };
  // The first import into a new store is tried in another folder before: a file
  // of which nothing can be imported leaves no store behind. A pipe can be read
  // only once, and is imported without a trial run.
  std::error_code ignored;
  if (!fs::exists(flags.db, ignored) &&
      fs::is_regular_file(flags.file, ignored) &&
      fs::is_directory(fs::absolute(flags.db).parent_path(), ignored)) {
    const pipeline::ScratchFolder rehearsal;
    const Imported tried = import_into(rehearsal.path() / "rehearsal.db");
    if (tried.count == 0) return PrintImported(tried);
  }
  return PrintImported(import_into(flags.db));
}

}  // namespace

void AddExport(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command =
      AddCommand(app, "export",
                 "trials as CSV (flat, with its schema beside it), tidy CSV (a "
                 "table for each view) or JSON lines (lossless)");
  AddDbFlag(*command, flags->db);
  AddOption(*command, "--out", flags->out,
            "FILE.csv or FILE.jsonl; or stdout; of tidy, a folder");
  AddOption(*command, "--format", flags->format, "csv, jsonl or tidy");
  AddOption(*command, "--campaign", flags->campaign, "only of this campaign");
  SetAction(*command, action, [flags] { return Export(*flags); });
}

void AddImport(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ImportFlags>();
  CLI::App* command = AddCommand(
      app, "import", "trials from CSV, or what `export` wrote as JSON lines");
  AddOption(*command, "FILE", flags->file, "FILE.csv or FILE.jsonl");
  AddOption(*command, "--db", flags->db, "the trial store, e.g. lab.db");
  AddOption(*command, "--format", flags->format, "csv or jsonl");
  AddOption(*command, "--by", flags->by,
            "who states rows without an author (CSV)");
  AddFlag(*command, "--partial", flags->partial,
          "import the rows that are right, report the others (CSV)");
  AddFlag(*command, "--columns", flags->columns, "print the columns of a CSV");
  AddFlag(*command, "--paper-table1", flags->paper_table1,
          "the eighteen trials of the paper's Table 1, in place of FILE");
  AddOption(*command, "--paper-u-deg", flags->paper_u_deg,
            "assumed u of the paper's angles")
      .ShowDefault();
  SetAction(*command, action, [flags] { return Import(*flags); });
}

}  // namespace touchdown::cli
