#include "app/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>
#include <stdexcept>
#include <utility>

#include "app/batch/set_aside.h"
#include "app/batch/triage.h"
#include "app/documents/log_analysis.h"
#include "app/exchange/trial_json.h"
#include "app/measure/options_hash.h"
#include "app/report/sentences.h"
#include "app/text/format.h"
#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::session {
namespace {

namespace fs = std::filesystem;
using core::kDegree;

// Of the kernel's coarse clock, which dates files.
constexpr double kFileClock_s = 0.02;

// Returns when the recording was last written to, s since 1970, by the clock of
// the machine that wrote it; 0 where it has gone.
double WrittenAt_s(const fs::path& recording) {
  const pipeline::Extent extent = pipeline::MeasureExtent(recording);
  if (extent.files == 0) return 0.0;  // it has gone
  const auto written = std::chrono::file_clock::to_sys(extent.written);
  return std::chrono::duration<double>(written.time_since_epoch()).count();
}

// Pictures of a recording that has only grown stay where they were: the bytes
// behind the header, which some programs write anew at the end. Empty for
// folders and what is too short to say.
std::string SomePictures(const fs::path& recording) {
  constexpr std::streamoff kHeader = 64 << 10;
  std::string bytes(64 << 10, '\0');
  std::ifstream in(recording, std::ios::binary);
  in.seekg(kHeader);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    return {};
  }
  return bytes;
}

// Tells the caller that an analysis runs for as long as it lives.
class Analysing {
 public:
  explicit Analysing(const std::function<void(bool)>& tell) : tell_(tell) {
    if (tell_) tell_(true);
  }
  ~Analysing() {
    if (tell_) tell_(false);
  }
  Analysing(const Analysing&) = delete;
  Analysing& operator=(const Analysing&) = delete;

 private:
  const std::function<void(bool)>& tell_;
};

}  // namespace

Session::Session(db::Store& store, const core::Campaign& campaign,
                 Thrower thrower, SessionOptions options, SessionEnds ends,
                 const std::optional<SessionFile>& before)
    : store_(store),
      campaign_(campaign),
      thrower_(std::move(thrower)),
      options_(std::move(options)),
      ends_(std::move(ends)),
      reach_(pipeline::ReachOfThrower(thrower_)) {
  // The next angle is chosen within what the rig can throw.
  options_.study.next.feasible_rad = reach_.angle_rad;
  if (options_.check) check_campaign_ = CheckCampaign(*options_.check);
  file_.campaign = campaign_.name;
  file_.operator_name = options_.operator_name;
  auto trials = store_.Trials({.campaign = campaign_.name});
  // Conventions are accepted once: a campaign with trials has them already.
  file_.phase = trials.empty() ? Phase::kConventions : Phase::kShot;
  if (!trials.empty()) {
    // `undo`, `exclude` and `repeat` also reach the last trial of an earlier
    // session. Its file is not known, so a recording that grew is not
    // recognised.
    core::Trial& trial = trials.back();
    acts_.push_back({trial.excluded ? Act::kExcluded : Act::kLogged, trial.id});
    last_ = LastTaken{"", 0, "", std::move(trial)};
  }
  // What follows is taken from the earlier session's file, if it was of this
  // campaign.
  if (!before || before->campaign != campaign_.name) return;
  if (before->phase != Phase::kConventions) file_.phase = Phase::kShot;
  file_.last = before->last;
  // A shot that was waited for when the session ended, and was not logged.
  // One trial more than when it was planned means that the shot was made and
  // logged.
  resumed_plan_ = before->planned && before->trials_before == CountTrials() &&
                  (!before->is_check || options_.check);
  if (resumed_plan_) {
    file_.planned_at_s = before->planned_at_s;
    file_.angle_rad = before->angle_rad;
    file_.is_check = before->is_check;
  }
}

void Session::Start() {
  if (file_.phase == Phase::kConventions) {
    Say("These conventions are fixed with the first trial: press Enter to "
        "accept them, or quit and change the campaign.");
    Save();
    return;
  }
  Plan();
  SayPlan();
}

void Session::Save() { WriteSession(store_.path(), file_); }

void Session::End() {
  file_.phase =
      file_.phase == Phase::kConventions ? Phase::kConventions : Phase::kEnded;
  Save();
}

// Counts the trials of the campaign and of its check shots, excluded ones too:
// each trial logged after a plan was shown uses that plan up.
std::size_t Session::CountTrials() const {
  db::TrialFilter filter;
  filter.with_documents = false;
  std::size_t count = 0;
  for (const core::Campaign* one :
       {&campaign_, check_campaign_ ? &*check_campaign_ : nullptr}) {
    if (one == nullptr || !store_.FindCampaign(one->name)) continue;
    filter.campaign = one->name;
    count += store_.Trials(filter).size();
  }
  return count;
}

// Once in each day of the universal calendar, as the store dates trials.
bool Session::CheckIsDue() const {
  if (!check_campaign_ || check_skipped_) return false;
  if (check_wanted_) return true;
  if (!store_.FindCampaign(check_campaign_->name)) return true;
  db::TrialFilter filter;
  filter.campaign = check_campaign_->name;
  filter.from_utc = store_.sources().now_utc().substr(0, 10);
  filter.excluded = false;
  filter.with_documents = false;
  return store_.Trials(filter).empty();
}

// Returns what the campaign's trials say now: boundary, next angle, counts.
// Trials of different origins are never pooled; the group is that of the origin
// of the last trial.
report::Group Session::Now() const {
  report::ReportInput input;
  input.campaigns = {campaign_};
  input.study = options_.study;
  input.reach_of = [this](const core::Campaign&) { return reach_; };
  auto trials =
      store_.Trials({.campaign = campaign_.name, .with_documents = false});
  const auto origin =
      trials.empty() ? core::Origin::kRecorded : trials.back().origin;
  report::SortTrials(trials);
  for (report::Group& group : report::MakeGroups(input, trials)) {
    if (group.trials.origin == origin) return std::move(group);
  }
  return report::EmptyGroup(input, campaign_);
}

void Session::Plan() {
  // This counts the trials, estimates the boundary, chooses a check shot or an
  // angle, finds set-points, and writes the session's file for a restart.
  file_.planned = true;
  file_.trials_before = CountTrials();
  const report::Group group = Now();
  boundary_ =
      fmt::format("{} ({} stayed down, {} bounced, {} undecided, {} left out)",
                  report::BoundarySentence(group.study),
                  group.study.counts.not_bounce, group.study.counts.bounce,
                  group.study.counts.undecided, group.left_out.size());
  // A plan that was shown before an interruption is taken up once, with the
  // instant at which it was shown: the shot may have been made since.
  const bool resumed = std::exchange(resumed_plan_, false);
  plan_lines_.clear();
  if (resumed ? file_.is_check : CheckIsDue()) {
    file_.phase = Phase::kCheck;
    file_.is_check = true;
    file_.set_points = nullptr;
    setting_.reset();
    plan_lines_ = {fmt::format(
        "check shot: drop the {} from {} mm, upright; known: {} m/s and 90 deg "
        "at touchdown (or: skip REASON)",
        DroppedBody(*options_.check),
        report::WithU(options_.check->height_m, core::kMillimetre),
        report::WithU(ExpectedSpeed(*options_.check), 1.0))};
  } else {
    file_.phase = Phase::kShot;
    file_.is_check = false;
    if (!resumed) {
      file_.angle_rad =
          skipped_rad_.empty() ? group.study.next.angle_rad : AngleBesides();
    }
    PlanAngle();
    // Another angle is planned after `skip`, or where a plan of before goes on.
    if (skipped_rad_.empty()) {
      constexpr double kShown_rad = 0.005 * kDegree;  // as it is printed
      const bool same =
          std::abs(file_.angle_rad - group.study.next.angle_rad) < kShown_rad;
      plan_lines_.push_back((same ? "  asked for  " : "  now asked for ") +
                            report::NextSentence(group));
    }
    if (group.study.next.stop != analysis::StopReason::kNone) {
      plan_lines_.push_back(
          "  enough     the boundary is known as well as was asked for; more "
          "shots are welcome");
    }
  }
  if (!resumed) file_.planned_at_s = ends_.now_s();
  Save();
}

// The best angle that is not beside one that was skipped.
double Session::AngleBesides() const {
  const report::Group group = Now();
  // Twice the repeatability of the ejector: another setting, not the same one
  // by chance.
  const double beside = 2.0 * options_.study.next.set_u_rad;
  std::optional<analysis::NextAngle> best;
  // What remains of the reach between the skipped angles is tried interval by
  // interval; the best has the least expected uncertainty of the boundary.
  double low = reach_.angle_rad.low;
  const auto consider = [&](double high) {
    if (!(high > low)) return;
    analysis::NextAngleOptions next = options_.study.next;
    next.feasible_rad = {low, high};
    const auto angle = analysis::ChooseNextAngle(
        group.study.posterior, group.study.counts.total(), next);
    if (!best || angle.expected_sd_rad < best->expected_sd_rad) best = angle;
  };
  for (const double skipped : skipped_rad_) {  // in order
    consider(std::min(skipped - beside, reach_.angle_rad.high));
    low = std::max(low, skipped + beside);
  }
  consider(reach_.angle_rad.high);
  // Where the skipped angles leave nothing, the session asks for the best angle
  // again.
  return best ? best->angle_rad : group.study.next.angle_rad;
}

// Finds set-points and prediction for file_.angle_rad and puts what is to be
// said of them into plan_lines_. Where the rig cannot throw the angle, the
// lines say so and setting_ stays empty.
void Session::PlanAngle() {
  const auto point = PlanNext(thrower_, file_.angle_rad);
  file_.set_points = SetPointsJson(thrower_, point);
  setting_.reset();
  // What the controller read back was of the plan before.
  read_.reset();
  plan_lines_ = {
      fmt::format("next shot: {} angle {:.2f} deg",
                  core::Name(campaign_.angle_kind), file_.angle_rad / kDegree),
      "  set        " + SetPointsText(thrower_, point)};
  if (!point) return;
  setting_ = point->setting;
  const rig::ContactPrediction& contact = point->contact;
  const rig::Predicted& angle =
      campaign_.angle_kind == core::AngleKind::kApproach
          ? contact.approach_angle_rad
      : campaign_.angle_kind == core::AngleKind::kRadius
          ? contact.radius_angle_rad
          : contact.face_angle_rad;
  plan_lines_.push_back(fmt::format(
      "  predicted  {} angle {} deg, {} m/s at touchdown",
      core::Name(campaign_.angle_kind),
      report::WithUOrReason(angle.first_order, kDegree),
      report::WithUOrReason(contact.impact_speed_mps.first_order, 1.0)));
  for (const rig::Finding& finding : contact.findings) {
    plan_lines_.push_back((finding.severity == rig::Severity::kRefusal
                               ? "  REFUSED    "
                               : "  warning    ") +
                          finding.what);
  }
}

void Session::SayPlan() const {
  for (const std::string& line : plan_lines_) Say(line);
}

// Returns why the shot is not the planned one: nothing where it was made after
// its set-points were shown and before now. A camera whose clock is behind
// loses its set-points that way, and so does one whose clock is far ahead, by
// which any recording would be of the plan.
std::optional<std::string> Session::FindWhyNotPlanned(
    const fs::path& recording) const {
  const double written_s = WrittenAt_s(recording);
  if (!file_.planned || written_s < file_.planned_at_s - kFileClock_s) {
    return "recorded before these set-points were shown";
  }
  const std::chrono::duration<double> agree = pipeline::kClocksAgree;
  if (written_s > ends_.now_s() + agree.count()) {
    return "dated after now: the clock of the camera is ahead";
  }
  return std::nullopt;
}

// Returns the trial that this campaign, or its check shots, have of the
// recording; nothing where it is new.
std::optional<std::string> Session::KnownAs(const std::string& clip_id) const {
  for (const core::Campaign* one :
       {&campaign_, check_campaign_ ? &*check_campaign_ : nullptr}) {
    if (one == nullptr) continue;
    if (const auto logged = store_.FindLogged(one->name, clip_id)) {
      return logged->trial_id;
    }
  }
  return std::nullopt;
}

// Throws core::StoreError where the campaign in the store is not the one that
// the technician accepted.
void Session::RequireSameConventions() const {
  const auto now = store_.FindCampaign(campaign_.name);
  if (!now || report::CampaignJson(*now) != report::CampaignJson(campaign_)) {
    throw core::StoreError(
        fmt::format("{}: the conventions of '{}' were changed during the "
                    "session; start it again",
                    store_.path().string(), campaign_.name));
  }
}

void Session::Take(const fs::path& recording) {
  if (file_.phase == Phase::kConventions) {
    // Nothing is logged before the conventions are accepted; then it is taken
    // in the order of arrival (Obey).
    held_.push_back(recording);
    return;
  }
  const Phase waiting = file_.phase;
  try {
    // A recording that is known is passed over, so that a session can start
    // anew over a full folder.
    const std::string id = vision::ClipId(recording);
    if (const auto known = KnownAs(id)) {
      Say(fmt::format("{}: known, trial {}", recording.filename().string(),
                      db::ShortId(*known)));
      return;
    }
    file_.phase = Phase::kAnalysing;
    Save();
    Log(recording, id);
  } catch (const core::StoreError&) {
    // Trouble with the store or the disk ends the session: what it promises (a
    // trial is on the disk before a line speaks of it) cannot be kept.
    throw;
  } catch (const core::OutputError&) {
    throw;
  } catch (const std::exception& error) {
    Say(fmt::format("not logged: {}", error.what()));
    // A recording that cannot be analysed leaves the plan as it is: the
    // technician throws the same shot again.
    file_.phase = waiting;
    Save();
  }
}

void Session::Log(const fs::path& recording, const std::string& clip_id) {
  RequireSameConventions();
  // Set-points and campaign depend on whether it belongs to the plan: a
  // recording from before a check shot was asked for is an ordinary shot.
  const std::optional<std::string> not_planned = FindWhyNotPlanned(recording);
  const bool belongs = !not_planned;
  const bool is_check = belongs && file_.is_check;
  if (is_check && !store_.FindCampaign(check_campaign_->name)) {
    store_.AddCampaign(*check_campaign_);
  }
  const core::Campaign& campaign = is_check ? *check_campaign_ : campaign_;
  pipeline::AnalyzeOptions analyze = options_.analyze;
  if (is_check) {
    // Another body than the one that the options may speak of.
    analyze.body_kind.reset();
    analyze.diameter_m = analyze.long_m = analyze.short_m = std::nullopt;
    analyze.angle_kind.reset();
    analyze.bounce_height_m.reset();
  }
  pipeline::FillFromCampaign(campaign, analyze);
  pipeline::SetAside set_aside(store_.path());
  const pipeline::SetAside::Key key{clip_id, pipeline::OptionsHash(analyze)};
  // A recording that failed twice in the same way is not tried at every start.
  const auto why = set_aside.FindReason(key);
  if (why && !options_.again) {
    throw core::InputError(
        fmt::format("{}: {}", recording.filename().string(), *why));
  }
  core::Trial trial;
  try {
    const Analysing analysing(ends_.analysing);
    // Both read the whole recording: at the same time is nearly twice as fast.
    auto digest = std::async(std::launch::async,
                             [&] { return vision::Sha256(recording); });
    const pipeline::Analysis analysis = pipeline::Analyze(recording, analyze);
    trial = pipeline::LoggableTrial(analysis, &campaign, digest.get());
  } catch (const core::InputError& error) {
    set_aside.Failed(key, recording.string(), error.what());
    throw;
  }
  trial.author = options_.operator_name;
  const std::string pictures = SomePictures(recording);
  // The same path, more bytes and the same pictures behind the header mean that
  // the last recording was taken while it was still being written.
  const bool grown = last_ && last_->path == trial.clip.path &&
                     last_->bytes < trial.clip.size_bytes &&
                     !pictures.empty() && pictures == last_->pictures;
  if (grown) {
    // The same shot. First the half one goes, so that at no instant both count.
    if (!store_.Find(last_->trial.id)->excluded) {
      store_.Exclude(last_->trial.id, options_.operator_name,
                     "the recording was not complete when it was analysed");
    }
    // The plan has moved on since, so set-points and conditions come from the
    // half trial and not from file_.
    trial.set_angle_rad = last_->trial.set_angle_rad;
    trial.set_speed_mps = last_->trial.set_speed_mps;
    trial.conditions = last_->trial.conditions;
  } else if (is_check) {
    trial.set_angle_rad = 90.0 * kDegree;
    trial.reason = Compare(*options_.check, trial).text;
  } else if (belongs) {
    trial.set_angle_rad = file_.angle_rad;
    if (setting_) trial.set_speed_mps = LaunchSpeedOfPlan();
  }
  if (!grown) trial.conditions = ConditionsNow(not_planned, is_check);
  // From here on the trial is on the disk: what fails below loses a line or a
  // picture and no trial.
  trial.id = store_.LogTrial(trial).id;
  note_.clear();
  last_ = LastTaken{trial.clip.path, trial.clip.size_bytes, pictures, trial};
  acts_.push_back({Act::kLogged, trial.id});
  // A shot was made: what was skipped before it may be asked for again.
  skipped_rad_.clear();
  if (is_check) check_wanted_ = false;
  Answer(trial, ends_.now_s() - WrittenAt_s(recording), is_check);
  // The picture comes after the answer, for which a person is waiting.
  if (ends_.keep_picture) ends_.keep_picture(trial);
  if (!belongs) {
    Say(fmt::format("  ({}: logged without set-points)", *not_planned));
  }
  Plan();
  if (!is_check) {
    Say("  boundary   " + boundary_);
    // The boundary was shown: that is a look at the answer, and goes on record.
    db::RecordLook(store_, campaign_.name, "session");
  }
  SayPlan();
}

// Returns the conditions of the shot that is being logged. The rig's settings
// are those that the controller read back, else those that were asked for;
// absent, with the reason, where the shot is not of this plan.
core::Conditions Session::ConditionsNow(
    const std::optional<std::string>& not_planned, bool is_check) const {
  core::Conditions now = options_.conditions;
  now.note = note_;
  // The operator's name refers to the register where it has an entry.
  if (now.person.name.empty()) {
    const auto person = db::FindEntry(store_, db::RegisterKind::kOperator,
                                      options_.operator_name);
    if (person) now.person = {person->name, person->id};
  }
  if (!not_planned && !is_check && setting_) {
    const rig::Setting& set = read_ ? *read_ : *setting_;
    const rig::Description& rig = thrower_.rig;
    now.elevation_rad =
        core::Estimate{set.elevation_rad, rig.u_elevation_rad, std::nullopt};
    now.compression_m =
        core::Estimate{set.compression_m, rig.u_compression_m, std::nullopt};
    now.muzzle_height_m = core::Estimate{set.muzzle_height_m,
                                         rig.u_muzzle_height_m, std::nullopt};
    return now;
  }
  const std::string why =
      is_check ? "dropped, not thrown"
               : not_planned.value_or("the rig cannot throw this angle");
  for (core::Measured* set :
       {&now.elevation_rad, &now.compression_m, &now.muzzle_height_m}) {
    // A setting that --condition stated stays.
    if (!*set) *set = core::AbsentBecause(why);
  }
  return now;
}

// Returns the launch speed that the planned setting predicts, m/s: the
// set-point of the speed is that at the muzzle. Nothing where the rig predicts
// none.
std::optional<double> Session::LaunchSpeedOfPlan() const {
  const auto muzzle =
      rig::LaunchSpeed(rig::MakeLaunch(thrower_.rig, setting_->elevation_rad),
                       setting_->compression_m);
  if (!muzzle) return std::nullopt;
  return muzzle->speed_mps;
}

// Says what a trial is: state, angle and set-point, why to look at it, and how
// long the answer took. Its id is kept in the session's file as well.
void Session::Answer(const core::Trial& trial, double seconds_since_written,
                     bool is_check) {
  const auto entry = pipeline::MakeTriageEntry(trial.clip.path,
                                               pipeline::Done::kLogged, trial);
  std::string text(core::Name(trial.first.state.label));
  if (trial.first.state.p_bounce &&
      trial.first.state.label == core::MotionState::kUndecided) {
    text += fmt::format(", P(bounce) {:.3f}", *trial.first.state.p_bounce);
  }
  text += fmt::format(", {} angle {} deg", core::Name(trial.angle_kind),
                      report::WithUOrReason(entry.angle_rad, kDegree));
  if (trial.set_angle_rad && !is_check) {
    text += fmt::format(" (set {:.2f})", *trial.set_angle_rad / kDegree);
  }
  Say(fmt::format("trial {}: {}", db::ShortId(trial.id), text));
  if (is_check) Say("  " + trial.reason);
  if (!entry.reason.empty()) Say("  look at    " + entry.reason);
  Say(fmt::format("  {}, by {}, {:.1f} s after its last byte",
                  fs::path(trial.clip.path).filename().string(), trial.author,
                  seconds_since_written));
  file_.last = {{"trial", trial.id}};
}

}  // namespace touchdown::session
