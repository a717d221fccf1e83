// touchdown analyze makes one trial of one recording. The flags become options,
// the clip is measured (app/measure), and only then are outputs touched:
// evidence in --out, the trial in --db, the answer on stdout.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/cli/analyze/analyze_flags.h"
#include "app/cli/command.h"
#include "app/cli/kept_memory.h"
#include "app/cli/options.h"
#include "app/cli/progress.h"
#include "app/cli/store/condition_flags.h"
#include "app/documents/analysis_json.h"
#include "app/documents/analysis_text.h"
#include "app/documents/evidence.h"
#include "app/documents/log_analysis.h"
#include "app/measure/analyze.h"
#include "touchdown/db/identity.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed; an empty string means that the flag was not given.
// `analyze` holds those that batch, session and report-bug have too.
struct AnalyzeCommandFlags {
  std::string clip;
  AnalyzeFlags analyze;
  std::string out;
  std::string db;
  std::string campaign;
  ConditionFlags conditions;
  bool no_digest = false;
  bool json = false;
};

// Returns the touchdown.analysis/1 document. Where the trial was logged, it has
// `logged` besides: the trial's id, its revision, whether a person must accept
// it, and the store.
std::string MakeDocument(const pipeline::Analysis& analysis,
                         const std::optional<pipeline::Logged>& logged,
                         const AnalyzeCommandFlags& flags) {
  std::string document = pipeline::ToJson(analysis);
  if (!logged) return document;
  using nlohmann::ordered_json;
  ordered_json json = ordered_json::parse(document);
  json["logged"] = {{"trial", logged->trial_id},
                    {"revision", logged->revision},
                    {"is_proposal", logged->is_proposal},
                    {"store", flags.db}};
  // A path may hold bytes that are not UTF-8, which JSON cannot. They are
  // replaced; without that dump() would throw.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

// Analyses one clip, and logs it where --db is given. Returns 0 whatever was
// found: an undecided trial is a result. Throws std::invalid_argument for flags
// that contradict each other, core::InputError for the clip, core::StoreError
// for the store.
int RunAnalyze(const AnalyzeCommandFlags& flags) {
  // The process ends after one clip, so that memory kept until then costs
  // nobody anything.
  KeepMemory();
  pipeline::AnalyzeOptions options = ToOptions(flags.analyze);
  // Flags that mean nothing without a store are refused: a user who gives them
  // expects the trial to be recorded.
  if (flags.db.empty() && !flags.campaign.empty()) {
    throw std::invalid_argument("--campaign needs --db, the store it is in");
  }
  if (flags.db.empty() && !flags.conditions.empty()) {
    throw std::invalid_argument("--condition needs --db, the store to log in");
  }
  if (flags.no_digest && !flags.db.empty()) {
    throw std::invalid_argument(
        "--no-digest does not go with --db: a trial is logged by its clip's "
        "digest; leave one of them out");
  }
  options.digest = !flags.no_digest;
  // Names in --condition are looked up before the analysis: a typing error must
  // not cost the minutes that it takes.
  const auto conditions = ReadConditions(flags.conditions, flags.db);
  // Flags take precedence: the campaign fills in only what they leave open.
  if (!flags.campaign.empty()) {
    pipeline::FillFromCampaign(flags.db, flags.campaign, options);
  }
  ProgressBar bar("analyze");
  options.progress = [&bar](double share) { bar.Show(share); };
  // At the time limit a script still gets the document of what is known, with
  // the reason of each absent answer; main turns the exception into the message
  // and exit status 3.
  const pipeline::Analysis analysis = [&] {
    try {
      return pipeline::Analyze(flags.clip, options);
    } catch (const pipeline::Unfinished& unfinished) {
      bar.Finish();
      if (flags.json) {
        fmt::print("{}\n", pipeline::ToJson(unfinished.so_far()));
      }
      throw;
    }
  }();
  bar.Finish();
  // Evidence that cannot be written ends the command before the store is
  // changed.
  if (!flags.out.empty()) pipeline::WriteEvidence(analysis, flags.out);
  std::optional<pipeline::Logged> logged;
  if (!flags.db.empty()) {
    logged =
        pipeline::LogAnalysis(analysis, flags.db, flags.campaign, conditions);
  }
  if (flags.json) {
    fmt::print("{}\n", MakeDocument(analysis, logged, flags));
  } else {
    fmt::print("{}", pipeline::ToText(analysis));
    if (logged) {
      fmt::print("logged     trial {} revision {} in {}\n", logged->trial_id,
                 logged->revision, flags.db);
      // `show` takes the beginning of an id: 8 characters are easy to copy.
      if (logged->is_proposal) {
        fmt::print(
            "proposed   a person's correction stays in force; `touchdown show "
            "{} --db {}` says what differs and how to accept this analysis\n",
            db::ShortId(logged->trial_id), flags.db);
      }
    }
  }
  return 0;
}

}  // namespace

void AddAnalyze(CLI::App& app, Action& action) {
  auto flags = std::make_shared<AnalyzeCommandFlags>();
  CLI::App* command = AddCommand(
      app, "analyze",
      "At what angle did it touch down, and did it slide or bounce?");
  AddOption(*command, "CLIP", flags->clip,
            "a video, an .mraw (or its .cih/.cihx), a TIFF of several pages, "
            "or a folder of PNG, TIFF or JPEG images")
      .Require();
  AddAnalyzeFlags(*command, flags->analyze);
  // The flags from here on decide what becomes of the answer; those above
  // decide the answer itself.
  AddOption(*command, "--out", flags->out,
            "write track.csv, contact.png and analysis.json into this folder");
  AddOption(*command, "--db", flags->db, "log the trial in this store");
  AddOption(*command, "--campaign", flags->campaign,
            "the campaign the trial belongs to (with --db); body, sizes, angle "
            "kind and bounce height are then the campaign's where not given");
  AddConditionFlag(*command, flags->conditions);
  AddFlag(*command, "--no-digest", flags->no_digest,
          "leave clip.id out: nothing is read but what is measured");
  AddFlag(*command, "--json", flags->json, "one JSON document on stdout");
  SetAction(*command, action, [flags] { return RunAnalyze(*flags); });
}

}  // namespace touchdown::cli
