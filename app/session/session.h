// A technician's session: plan -> set -> await the recording -> analyse -> log
// -> answer, then the next plan.
//
// Lines come in (what a person types), recordings come in (once complete),
// lines go out; terminal, folder watch and signals are the caller's. Each trial
// is on the disk before a line speaks of it. A recording is logged at most
// once: what the store has of it (its id, in the campaign or among the check
// shots) is not analysed again. So a session that was killed at any instant
// goes on by starting anew over the same folder.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/measure/analyze.h"
#include "app/report/group.h"
#include "app/session/check_shot.h"
#include "app/session/next_shot.h"
#include "app/session/session_file.h"
#include "touchdown/core/campaign.h"
#include "touchdown/db/store.h"
#include "touchdown/rig/driver/driver.h"

namespace touchdown::session {

struct SessionOptions {
  std::string operator_name;
  // As batch takes them; the campaign's conventions where not given.
  pipeline::AnalyzeOptions analyze;
  analysis::StudyOptions study;
  // Of every shot, but for what it was set to and the note, which the session
  // adds; `condition` changes them.
  core::Conditions conditions;
  // Nothing: none is asked for.
  std::optional<CheckShot> check;
  // Take also what is set aside (batch/set_aside.h).
  bool again = false;
};

// The ends of a session that are not its own.
struct SessionEnds {
  std::function<void(const std::string& line)> say;
  // Seconds since 1970, of the clock that dates files.
  std::function<double()> now_s;
  rig::Driver* driver = nullptr;  // nothing: hands only
  // Keeps the picture of a trial's contact; nothing: none is kept.
  std::function<void(const core::Trial&)> keep_picture = {};
  // Told `true` when an analysis begins and `false` when it has ended: the
  // session hears nothing meanwhile. Nothing: nobody is told.
  std::function<void(bool)> analysing = {};
};

// How a typed line came: what was pasted in one go never fires.
struct Arrival {
  // When its first byte was read.
  std::chrono::steady_clock::time_point began =
      std::chrono::steady_clock::now();
  bool is_alone = true;  // no other line came with it, or waits behind it
};

class Session {
 public:
  // `before`: what an earlier session of this store left. Throws
  // std::invalid_argument where the rig reaches no angle, and core::StoreError.
  Session(db::Store& store, const core::Campaign& campaign, Thrower thrower,
          SessionOptions options, SessionEnds ends,
          const std::optional<SessionFile>& before);

  // Says what is next; asks for what must be answered first.
  void Start();
  // A line that a person typed. False: the session is to end. What a person
  // gets wrong is answered with a line and changes nothing.
  // `fire` wants a line of its own, begun after the answer to `arm` was said.
  bool Obey(const std::string& line, const Arrival& arrival = {});
  // A complete recording. One that cannot be analysed is said and logged
  // nowhere. Throws core::StoreError.
  void Take(const std::filesystem::path& recording);
  // Writes the file of the session a last time.
  void End();

  Phase phase() const { return file_.phase; }

 private:
  struct Act {
    enum Kind { kLogged, kExcluded, kIncluded } kind;
    std::string trial;
  };
  struct LastTaken {
    std::string path;
    std::int64_t bytes = 0;
    std::string pictures;  // some of its bytes
    core::Trial trial;
  };

  void Say(const std::string& line) const { ends_.say(line); }
  void SayPlan() const;
  void Save();
  std::size_t CountTrials() const;
  bool CheckIsDue() const;
  report::Group Now() const;
  // What is waited for now, from the store alone.
  void Plan();
  void PlanAngle();  // file_.angle_rad
  double AngleBesides() const;
  std::optional<double> LaunchSpeedOfPlan() const;
  // Of the shot that is logged now.
  core::Conditions ConditionsNow(const std::optional<std::string>& not_planned,
                                 bool is_check) const;
  std::optional<std::string> FindWhyNotPlanned(
      const std::filesystem::path& recording) const;
  std::optional<std::string> KnownAs(const std::string& clip_id) const;
  void Log(const std::filesystem::path& recording, const std::string& clip_id);
  void Answer(const core::Trial& trial, double seconds_since_written,
              bool is_check);
  void RequireSameConventions() const;

  // Of session_acts.cc: one for each word.
  void Help() const;
  void Skip(const std::string& why);
  void Repeat();
  void Angle(const std::string& degrees);
  void Exclude(const std::string& why);
  void Include(const std::string& why);
  void Undo();
  void Operator(const std::string& name);
  void Condition(const std::string& text);
  void Note(const std::string& text);
  void Drive(const std::string& word, const std::string& rest,
             const Arrival& arrival);
  void Fire(rig::Driver& driver, const std::string& arming,
            const Arrival& arrival);
  const core::Trial& RequireLast() const;

  db::Store& store_;
  core::Campaign campaign_;
  Thrower thrower_;
  SessionOptions options_;
  SessionEnds ends_;
  std::optional<core::Campaign> check_campaign_;
  report::Reach reach_;
  SessionFile file_;
  bool resumed_plan_ = false;
  std::optional<rig::Setting> setting_;  // of the plan
  std::optional<rig::Setting> read_;     // as the controller read it back
  std::string note_;                     // of the next shot
  std::vector<std::string> plan_lines_;  // as they were said
  std::string boundary_;                 // in a sentence
  std::set<double> skipped_rad_;         // since the last shot
  bool check_skipped_ = false;
  bool check_wanted_ = false;  // beyond the daily one
  std::optional<LastTaken> last_;
  std::vector<Act> acts_;
  // When the last answer to `arm` was said.
  std::chrono::steady_clock::time_point arming_said_;
  std::vector<std::filesystem::path> held_;  // until conventions are accepted
};

}  // namespace touchdown::session
