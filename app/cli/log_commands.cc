// log, correct: what people state of a trial.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/cli/command.h"
#include "app/cli/condition_flags.h"
#include "app/cli/store_flags.h"
#include "app/cli/store_text.h"
#include "app/pipeline/version.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

// --- what a trial by hand may say --------------------------------------------

struct StatementFlags {
  std::optional<double> angle_deg;
  std::optional<double> angle_u_deg;
  std::string angle_kind;
  std::string state;
  std::string corner;
  std::optional<double> set_angle_deg;
  std::optional<double> set_speed_mps;
  std::string note;
  ConditionFlags conditions;
};

void AddStatementFlags(CLI::App& command, StatementFlags& flags) {
  command.add_option("--angle-deg", flags.angle_deg, "the contact angle");
  command.add_option("--angle-u-deg", flags.angle_u_deg,
                     "its standard uncertainty");
  command.add_option(
      "--angle-kind", flags.angle_kind,
      "approach, radius or face; the campaign's where not given");
  command.add_option("--state", flags.state, kStateWords);
  command.add_option("--corner", flags.corner, "leading, trailing or flush");
  command.add_option("--set-angle-deg", flags.set_angle_deg,
                     "set-point of the varied angle");
  command.add_option("--set-speed-mps", flags.set_speed_mps,
                     "set-point of the launch speed");
  command.add_option("--note", flags.note, "what was seen");
  AddConditionFlag(command, flags.conditions);
}

void RequireAngle(const std::string& flag, double angle_deg, double low_deg) {
  if (!(angle_deg >= low_deg && angle_deg <= 90.0)) {
    throw std::invalid_argument(
        fmt::format("{} is {}, must be in {} .. 90", flag, angle_deg, low_deg));
  }
}

// Puts what was given into `trial`; the rest stays as it is.
void Apply(const StatementFlags& flags, core::Trial& trial) {
  core::Contact& contact = trial.first.contact;
  if (flags.angle_deg.has_value() != flags.angle_u_deg.has_value()) {
    throw std::invalid_argument(
        "--angle-deg and --angle-u-deg go together: a measured angle has an "
        "uncertainty (a good protractor reads to 0.5 deg)");
  }
  if (!flags.angle_kind.empty()) {
    trial.angle_kind = ParseWord<core::AngleKind>(
        "--angle-kind", flags.angle_kind, core::ParseAngleKind,
        "approach, radius or face");
  }
  if (flags.angle_deg) {
    const bool face = trial.angle_kind == core::AngleKind::kFace;
    RequireAngle("--angle-deg", *flags.angle_deg, face ? -90.0 : 0.0);
    RequireAngle("--angle-u-deg", *flags.angle_u_deg, 0.0);
    const core::Estimate angle{*flags.angle_deg * kDegree,
                               *flags.angle_u_deg * kDegree, std::nullopt};
    switch (trial.angle_kind) {
      case core::AngleKind::kApproach:
        contact.approach_angle_rad = angle;
        break;
      case core::AngleKind::kRadius:
        contact.radius_angle_rad = angle;
        break;
      case core::AngleKind::kFace:
        contact.face_angle_rad = angle;
        break;
    }
  }
  if (!flags.state.empty()) {
    trial.first.state.label = ParseWord<core::MotionState>(
        "--state", flags.state, core::ParseMotionState, kStateWords);
    trial.first.state.p_bounce.reset();
    trial.first.state.reason = "stated by hand";
  }
  if (!flags.note.empty()) trial.first.state.reason = flags.note;
  if (!flags.corner.empty()) {
    contact.corner =
        ParseWord<core::Corner>("--corner", flags.corner, core::ParseCorner,
                                "leading, trailing or flush");
  }
  if (flags.set_angle_deg) {
    RequireAngle("--set-angle-deg", *flags.set_angle_deg, -90.0);
    trial.set_angle_rad = *flags.set_angle_deg * kDegree;
  }
  if (flags.set_speed_mps) {
    if (!(*flags.set_speed_mps >= 0.0) ||
        !std::isfinite(*flags.set_speed_mps)) {
      throw std::invalid_argument(
          fmt::format("--set-speed-mps is {}, must be at least 0 and finite",
                      *flags.set_speed_mps));
    }
    trial.set_speed_mps = *flags.set_speed_mps;
  }
  ApplyConditions(flags.conditions, trial.conditions);
}

core::Trial ManualTrial() {
  core::Trial trial;
  trial.origin = core::Origin::kManual;
  trial.software_version = pipeline::Version();
  core::ContactRecord& first = trial.first;
  first.contact.found = true;
  for (core::Measured* measured : {&first.contact.time_s,
                                   &first.contact.frame,
                                   &first.contact.approach_angle_rad,
                                   &first.contact.radius_angle_rad,
                                   &first.contact.face_angle_rad,
                                   &first.contact.duration_s,
                                   &first.state.max_gap_m,
                                   &first.state.bounce_height_m,
                                   &first.state.detectable_gap_m,
                                   &first.motion.before_speed_mps,
                                   &first.motion.before_normal_mps,
                                   &first.motion.before_tangential_mps,
                                   &first.motion.before_omega_rad_per_s,
                                   &first.motion.after_normal_mps,
                                   &first.motion.after_tangential_mps,
                                   &first.motion.after_omega_rad_per_s,
                                   &first.motion.restitution,
                                   &first.motion.centre_rebound_ratio,
                                   &first.motion.impulse_ratio,
                                   &first.motion.gravity_check_mps2}) {
    *measured = core::AbsentBecause("not recorded by hand");
  }
  return trial;
}

void PrintLogged(const db::Logged& logged, bool json) {
  if (json) {
    // Of ASCII only: a UUID, a number, a truth value.
    fmt::print(
        "{{\"schema\": \"touchdown.logged/1\", \"id\": \"{}\", \"revision\": "
        "{}, \"is_new\": {}}}\n",
        logged.id, logged.revision, logged.is_new);
  } else {
    fmt::print("trial {} revision {}\n", logged.id, logged.revision);
  }
}

struct LogFlags {
  std::string db;
  std::string campaign;
  BodyFlags body;
  StatementFlags statement;
  std::string by;
  bool json = false;
};

int Log(const LogFlags& flags) {
  core::Trial trial = ManualTrial();
  if (flags.statement.state.empty()) {
    throw std::invalid_argument(
        fmt::format("--state is missing, must be {}", kStateWords));
  }
  trial.campaign = flags.campaign;
  trial.author = flags.by;
  const auto body = ParseBody(flags.body);
  if (flags.campaign.empty() && !body) {
    throw std::invalid_argument(
        "--body is missing, must be sphere or rectangle (or give --campaign, "
        "whose body it is)");
  }
  // A store is made only for what has been found right.
  core::Trial rehearsal = trial;
  if (body) {
    rehearsal.body = *body;
    rehearsal.angle_kind = core::DefaultAngleKind(body->kind);
  }
  Apply(flags.statement, rehearsal);
  db::RequireStorable(rehearsal);
  // Campaigns and entries of the register are in a store that exists.
  const bool refers =
      !flags.campaign.empty() ||
      (rehearsal.conditions && db::NameEntries(*rehearsal.conditions));
  auto store = db::Store::Open(
      flags.db, refers ? db::OpenMode::kWrite : db::OpenMode::kCreate);
  if (!flags.campaign.empty()) {
    const auto campaign = store.FindCampaign(flags.campaign);
    if (!campaign) {
      throw core::StoreError(fmt::format(
          "{}: there is no campaign '{}'; make it with `touchdown campaign "
          "new`, or see `touchdown campaign list`",
          flags.db, flags.campaign));
    }
    trial.body = campaign->body;
    trial.angle_kind = campaign->angle_kind;
    trial.first.state.bounce_height_m =
        core::Estimate{campaign->bounce_height_m, 0.0, std::nullopt};
  }
  if (body) {
    trial.body = *body;
    if (flags.campaign.empty()) {
      trial.angle_kind = core::DefaultAngleKind(body->kind);
    }
  }
  Apply(flags.statement, trial);
  PrintLogged(store.LogTrial(trial), flags.json);
  return 0;
}

// --- correct -----------------------------------------------------------------

struct CorrectFlags {
  std::string db;
  std::string id;
  StatementFlags statement;
  std::string by;
  std::string why;
  bool exclude = false;
  bool include = false;
  bool json = false;
};

int Correct(const CorrectFlags& flags) {
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  const core::Trial seen = RequireTrial(store, flags.id);
  core::Trial corrected = seen;
  Apply(flags.statement, corrected);
  const bool changed = !db::Changes(seen, corrected).empty();
  if (!changed && !flags.exclude && !flags.include) {
    throw std::invalid_argument(
        "nothing would change; give what is to be corrected, --exclude or "
        "--include");
  }
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
  auto flags = std::make_shared<LogFlags>();
  CLI::App* command =
      app.add_subcommand("log", "a trial by hand (origin: manual)");
  AddDbFlag(*command, flags->db);
  command->add_option("--campaign", flags->campaign, "its campaign");
  AddBodyFlags(*command, flags->body);
  AddStatementFlags(*command, flags->statement);
  command->add_option("--by", flags->by, "who states this")->required();
  command->add_flag("--json", flags->json, "one JSON document");
  command->callback(
      [flags, &action] { action = [flags] { return Log(*flags); }; });
}

void AddCorrect(CLI::App& app, Action& action) {
  auto flags = std::make_shared<CorrectFlags>();
  CLI::App* command = app.add_subcommand(
      "correct", "a person's revision of a trial; nothing is overwritten");
  command->add_option("ID", flags->id, "of the trial, or the beginning of it")
      ->required();
  AddDbFlag(*command, flags->db);
  AddStatementFlags(*command, flags->statement);
  command->add_option("--by", flags->by, "who corrects")->required();
  command->add_option("--why", flags->why, "the reason")->required();
  CLI::Option* exclude = command->add_flag("--exclude", flags->exclude,
                                           "the trial no longer counts");
  command->add_flag("--include", flags->include, "it counts again")
      ->excludes(exclude);
  command->add_flag("--json", flags->json, "one JSON document");
  command->callback(
      [flags, &action] { action = [flags] { return Correct(*flags); }; });
}

}  // namespace touchdown::cli
