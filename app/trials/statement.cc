#include "app/trials/statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/text/version.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/names.h"
#include "touchdown/db/register.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// Parses the word of a field. `words` is the list that the message shows.
// Throws FieldError where `text` is none of them.
template <class T>
T RequireWord(const char* field, const std::string& text,
              std::optional<T> (*parse)(std::string_view), const char* words) {
  if (const auto word = parse(text)) return *word;
  throw FieldError(field, fmt::format("is '{}', must be {}", text, words));
}

// Refuses an angle outside of low_deg .. 90 degrees; NaN fails as well, since
// the comparison is written so that it must hold.
void RequireAngle(const char* field, double angle_deg, double low_deg) {
  if (!(angle_deg >= low_deg && angle_deg <= 90.0)) {
    throw FieldError(
        field, fmt::format("is {}, must be in {} .. 90", angle_deg, low_deg));
  }
}

// Makes a trial in which nothing is known but that the body touched down:
// whoever logs a shot by hand has seen it land.
core::Trial ManualTrial() {
  core::Trial trial;
  trial.origin = core::Origin::kManual;
  trial.software_version = Version();
  trial.first.contact.found = true;
  for (const auto& quantity : core::kContactQuantities) {
    core::At(trial.first, quantity) =
        core::AbsentBecause("not recorded by hand");
  }
  return trial;
}

}  // namespace

void Apply(const Statement& statement, core::Trial& trial) {
  core::Contact& contact = trial.first.contact;
  // An angle without u could not be weighed against others.
  if (statement.angle_deg.has_value() != statement.angle_u_deg.has_value()) {
    const bool has_angle = statement.angle_deg.has_value();
    throw FieldError(
        has_angle ? "angle-u-deg" : "angle-deg",
        "is missing: an angle and its uncertainty go together (a good "
        "protractor reads to 0.5 deg)");
  }
  // The kind comes before the angle: it says which of the three is stated and
  // whether it may be negative.
  if (!statement.angle_kind.empty()) {
    trial.angle_kind = RequireWord<core::AngleKind>(
        "angle-kind", statement.angle_kind, core::ParseAngleKind,
        "approach, radius or face");
  }
  if (statement.angle_deg) {
    const bool face = trial.angle_kind == core::AngleKind::kFace;
    RequireAngle("angle-deg", *statement.angle_deg, face ? -90.0 : 0.0);
    RequireAngle("angle-u-deg", *statement.angle_u_deg, 0.0);
    core::Angle(contact, trial.angle_kind) =
        core::Estimate{*statement.angle_deg * kDegree,
                       *statement.angle_u_deg * kDegree, std::nullopt};
  }
  if (!statement.state.empty()) {
    trial.first.state.label = RequireWord<core::MotionState>(
        "state", statement.state, core::ParseMotionState, kStateWords);
    // A probability belongs to the evidence of the analysis; a person's word
    // has none.
    trial.first.state.p_bounce.reset();
    trial.first.state.reason = "stated by hand";
  }
  // After the state, so that a note replaces "stated by hand". A note alone
  // keeps label and probability.
  if (!statement.note.empty()) trial.first.state.reason = statement.note;
  if (!statement.corner.empty()) {
    contact.corner =
        RequireWord<core::Corner>("corner", statement.corner, core::ParseCorner,
                                  "leading, trailing or flush");
  }
  // Set-points may be face angles, so the sign is allowed for every kind.
  if (statement.set_angle_deg) {
    RequireAngle("set-angle-deg", *statement.set_angle_deg, -90.0);
    trial.set_angle_rad = *statement.set_angle_deg * kDegree;
  }
  if (statement.set_speed_mps) {
    if (!(*statement.set_speed_mps >= 0.0) ||
        !std::isfinite(*statement.set_speed_mps)) {
      throw FieldError("set-speed-mps",
                       fmt::format("is {}, must be at least 0 and finite",
                                   *statement.set_speed_mps));
    }
    trial.set_speed_mps = *statement.set_speed_mps;
  }
  if (statement.conditions) trial.conditions = statement.conditions;
}

core::Trial Restated(const std::string& field,
                     const std::vector<db::Revision>& history,
                     const core::Trial& seen, std::int64_t number) {
  const auto found = std::find_if(
      history.begin(), history.end(),
      [&](const auto& revision) { return revision.trial.revision == number; });
  if (found == history.end()) {
    throw FieldError(field, fmt::format("is {}, must be a revision in 1 .. {}",
                                        number, history.size()));
  }
  // The content of the old revision with the number of the one in force: the
  // store checks with it that nobody revised the trial meanwhile.
  core::Trial trial = found->trial;
  trial.revision = seen.revision;
  return trial;
}

db::Logged LogByHand(const std::filesystem::path& path,
                     const ManualEntry& entry) {
  core::Trial trial = ManualTrial();
  // The state is the one thing that a trial by hand must say: the boundary is
  // estimated from it.
  if (entry.statement.state.empty()) {
    throw FieldError("state",
                     fmt::format("is missing, must be {}", kStateWords));
  }
  trial.campaign = entry.campaign;
  trial.author = entry.by;
  const auto& body = entry.body;
  if (entry.campaign.empty() && !body) {
    throw FieldError(
        "body",
        "is missing, must be sphere or rectangle (or give --campaign, whose "
        "body it is)");
  }
  if (body) trial.body = *body;
  if (entry.campaign.empty()) {
    trial.angle_kind = core::DefaultAngleKind(body->kind);
    Apply(entry.statement, trial);
    // A store is made only for what has been found right.
    db::RequireStorable(trial);
  }
  // Campaigns and entries of the register are in a store that exists.
  const auto& conditions = entry.statement.conditions;
  const bool refers =
      !entry.campaign.empty() || (conditions && db::NameEntries(*conditions));
  auto store = db::Store::Open(
      path, refers ? db::OpenMode::kWrite : db::OpenMode::kCreate);
  if (!entry.campaign.empty()) {
    const core::Campaign campaign = db::RequireCampaign(store, entry.campaign);
    // A body given beside a campaign is not taken silently: LogTrial refuses
    // one that is not the campaign's.
    if (!body) trial.body = campaign.body;
    // The campaign's conventions hold for the trial, h_c among them; u = 0
    // marks it as a convention and not a measurement.
    trial.angle_kind = campaign.angle_kind;
    trial.first.state.bounce_height_m =
        core::Estimate{campaign.bounce_height_m, 0.0, std::nullopt};
    // Only now, since the kind of angle is the campaign's.
    Apply(entry.statement, trial);
  }
  return store.LogTrial(trial);
}

}  // namespace touchdown::pipeline
