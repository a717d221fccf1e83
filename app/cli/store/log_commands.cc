// touchdown log and correct record what people state of a trial. Both share the
// flags of a statement; `log` makes a new trial of origin manual, `correct` a
// further revision of any trial.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/condition_flags.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/trials/statement.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

// --- what a trial by hand may say --------------------------------------------

// Holds a statement as typed. The conditions stay apart until it is known which
// were stated before.
struct StatementFlags {
  pipeline::Statement said;
  ConditionFlags conditions;
};

// Returns the statement with its conditions: `before`, what was known of the
// trial, changed by --condition. Throws std::invalid_argument for a condition
// that cannot be understood.
pipeline::Statement ReadStatement(const StatementFlags& flags,
                                  std::optional<core::Conditions> before) {
  pipeline::Statement statement = flags.said;
  ApplyConditions(flags.conditions, before);
  statement.conditions = std::move(before);
  return statement;
}

// An option that is not given states nothing, so none of them has a default.
void AddStatementFlags(CLI::App& command, StatementFlags& all) {
  pipeline::Statement& flags = all.said;
  AddOption(command, "--angle-deg", flags.angle_deg, "the contact angle");
  AddOption(command, "--angle-u-deg", flags.angle_u_deg,
            "its standard uncertainty");
  AddOption(command, "--angle-kind", flags.angle_kind,
            "approach, radius or face; the campaign's where not given");
  AddOption(command, "--state", flags.state, pipeline::kStateWords);
  AddOption(command, "--corner", flags.corner, "leading, trailing or flush");
  AddOption(command, "--set-angle-deg", flags.set_angle_deg,
            "set-point of the varied angle");
  AddOption(command, "--set-speed-mps", flags.set_speed_mps,
            "set-point of the launch speed");
  AddOption(command, "--note", flags.note, "what was seen");
  AddConditionFlag(command, all.conditions);
}

// Says which revision was recorded, for a person or as touchdown.logged/1.
void PrintLogged(const db::Logged& logged, bool json) {
  if (json) {
    // All values are ASCII (a UUID, a number, a truth value), so nothing is
    // escaped.
    fmt::print(
        "{{\"schema\": \"touchdown.logged/1\", \"id\": \"{}\", \"revision\": "
        "{}, \"is_new\": {}}}\n",
        logged.id, logged.revision, logged.is_new);
  } else {
    fmt::print("trial {} revision {}\n", logged.id, logged.revision);
  }
}

// Holds the flags of `log` as typed; body and campaign may each stand for the
// other.
struct LogByHandFlags {
  std::string db;
  std::string campaign;
  pipeline::BodyEntry body;
  StatementFlags statement;
  std::string by;
  bool json = false;
};

// Records a trial that nobody filmed, or that was judged by eye. Returns 0;
// throws pipeline::FieldError (exit status 2) naming the flag.
int Log(const LogByHandFlags& flags) {
  const pipeline::ManualEntry entry{
      flags.campaign, pipeline::ParseBody(flags.body),
      ReadStatement(flags.statement, std::nullopt), flags.by};
  PrintLogged(pipeline::LogByHand(flags.db, entry), flags.json);
  return 0;
}

// --- correct -----------------------------------------------------------------

// Holds the flags of `correct` as typed.
struct CorrectFlags {
  std::string db;
  std::string id;
  StatementFlags statement;
  std::string by;
  std::string why;
  bool exclude = false;
  bool include = false;
  std::int64_t accept = 0;  // revision; 0: none
  bool json = false;
};

// Records a person's revision: a correction, an exclusion, or an inclusion.
// Returns 0; throws std::invalid_argument where nothing would change.
int Correct(const CorrectFlags& flags) {
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  // The store compares the correction with this state: if somebody revises the
  // trial meanwhile, it refuses instead of overwriting.
  const core::Trial seen = RequireTrial(store, flags.id);
  // --accept begins from the statement of another revision, such as a proposed
  // analysis; the other flags then change that.
  core::Trial corrected =
      flags.accept == 0 ? seen
                        : pipeline::Restated("accept", store.History(seen.id),
                                             seen, flags.accept);
  pipeline::Apply(ReadStatement(flags.statement, corrected.conditions),
                  corrected);
  const bool changed = !db::Changes(seen, corrected).empty();
  if (!changed && !flags.exclude && !flags.include) {
    throw std::invalid_argument(
        "nothing would change; give what is to be corrected, --accept, "
        "--exclude or --include");
  }
  // Each revision says one thing with one reason, or the history could not tell
  // which of the two the reason is for.
  if (changed && (flags.exclude || flags.include)) {
    throw std::invalid_argument(
        "--exclude and --include go alone: correct first, then exclude");
  }
  db::Logged logged;
  if (flags.exclude) {
    logged = store.Exclude(seen.id, flags.by, flags.why);
  } else if (flags.include) {
    logged = store.Include(seen.id, flags.by, flags.why);
  } else {
    logged = store.Correct(corrected, flags.by, flags.why);
  }
  PrintLogged(logged, flags.json);
  return 0;
}

}  // namespace

void AddLog(CLI::App& app, Action& action) {
  auto flags = std::make_shared<LogByHandFlags>();
  CLI::App* command =
      AddCommand(app, "log", "a trial by hand (origin: manual)");
  AddDbFlag(*command, flags->db);
  AddOption(*command, "--campaign", flags->campaign, "its campaign");
  AddBodyFlags(*command, flags->body);
  AddStatementFlags(*command, flags->statement);
  AddOption(*command, "--by", flags->by, "who states this").Require();
  AddFlag(*command, "--json", flags->json, "one JSON document");
  SetAction(*command, action, [flags] { return Log(*flags); });
}

void AddCorrect(CLI::App& app, Action& action) {
  auto flags = std::make_shared<CorrectFlags>();
  CLI::App* command = AddCommand(
      app, "correct", "a person's revision of a trial; nothing is overwritten");
  AddOption(*command, "ID", flags->id, "of the trial, or the beginning of it")
      .Require();
  AddDbFlag(*command, flags->db);
  AddStatementFlags(*command, flags->statement);
  AddOption(*command, "--accept", flags->accept,
            "state again what this revision states, such as an analysis that "
            "was proposed");
  AddOption(*command, "--by", flags->by, "who corrects").Require();
  AddOption(*command, "--why", flags->why, "the reason").Require();
  const Option exclude = AddFlag(*command, "--exclude", flags->exclude,
                                 "the trial no longer counts");
  AddFlag(*command, "--include", flags->include, "it counts again")
      .Exclude(exclude);
  AddFlag(*command, "--json", flags->json, "one JSON document");
  SetAction(*command, action, [flags] { return Correct(*flags); });
}

}  // namespace touchdown::cli
