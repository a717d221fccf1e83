// What a person may type.
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/session/session.h"
#include "app/text/parse_number.h"
#include "app/trials/statement.h"
#include "app/trials/typed_values.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::session {
namespace {

using core::kDegree;

// Divides a line into its first word and the rest, both without blanks at their
// ends. A carriage return counts as blank: lines may be piped in from Windows.
std::pair<std::string, std::string> Split(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  const auto end = line.find_last_not_of(" \t\r") + 1;
  const std::string text = line.substr(begin, end - begin);
  const auto space = text.find_first_of(" \t");
  if (space == std::string::npos) return {text, ""};
  return {text.substr(0, space),
          text.substr(text.find_first_not_of(" \t", space))};
}

// A revision needs a reason. Throws std::invalid_argument, which Obey says.
void RequireReason(const std::string& word, const std::string& why) {
  if (why.empty()) {
    throw std::invalid_argument(word + " wants a reason: " + word + " REASON");
  }
}

// Returns a finite number; nothing where the text is none, "nan" and "inf"
// included.
std::optional<double> Number(const std::string& text) {
  const auto value = report::ParseNumber<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace

bool Session::Obey(const std::string& line, const Arrival& arrival) {
  const auto [word, rest] = Split(line);
  if (word == "quit") return false;
  try {
    // Until the conventions are accepted, an empty line is the only answer.
    if (file_.phase == Phase::kConventions) {
      if (!word.empty()) {
        Say("press Enter to accept the conventions, or quit");
        return true;
      }
      file_.phase = Phase::kShot;
      Plan();
      SayPlan();
      // Recordings that arrived meanwhile are taken now.
      for (const auto& recording : std::exchange(held_, {})) Take(recording);
      return true;
    }
    if (word.empty()) {
      SayPlan();
    } else if (word == "help") {
      Help();
    } else if (word == "skip") {
      Skip(rest);
    } else if (word == "repeat") {
      Repeat();
    } else if (word == "angle") {
      Angle(rest);
    } else if (word == "exclude") {
      Exclude(rest);
    } else if (word == "include") {
      Include(rest);
    } else if (word == "undo") {
      Undo();
    } else if (word == "operator") {
      Operator(rest);
    } else if (word == "condition") {
      Condition(rest);
    } else if (word == "note") {
      Note(rest);
    } else if (word == "check") {
      if (!check_campaign_) {
        throw std::invalid_argument(
            "no check shot is declared: start with --check-height-mm");
      }
      // A person may ask for a check shot beyond the daily one.
      check_wanted_ = true;
      check_skipped_ = false;
      Plan();
      SayPlan();
    } else if (word == "set" || word == "arm" || word == "fire" ||
               word == "stop" || word == "reset" || word == "rig") {
      Drive(word, rest, arrival);
    } else {
      Say(fmt::format("'{}' is no command; `help` lists them", word));
    }
  } catch (const std::invalid_argument& mistake) {
    Say(mistake.what());
  } catch (const core::OutputError&) {
    // OutputError is an InputError, but ends the session.
    throw;
  } catch (const core::InputError& trouble) {  // the rig's controller
    Say(trouble.what());
  }
  return true;
}

void Session::Help() const {
  for (const char* line :
       {"Enter            what is waited for",
        "skip [REASON]    another angle than this one; or no check shot today",
        "repeat           the angle of the last shot once more",
        "angle DEG        an angle of your own",
        "exclude REASON   the last trial does not count (include REASON)",
        "undo             take back the last log, exclude or include",
        "operator NAME    who is at the rig now",
        "condition K=V    of the shots from now on, as temperature_c=21+-0.5",
        "note TEXT        your words, logged with the next shot",
        "check            a check shot now",
        "set              bring the rig to the set-points",
        "arm              latch the springs",
        "fire N           fire arming N: your word that all are clear",
        "stop, reset      emergency stop; and all is well again",
        "rig              where the rig is",
        "quit             end; starting again goes on here"}) {
    Say(line);
  }
}

// Skips what is planned. A check shot wants a reason, as a day without one must
// be explained; an angle does not. The reason goes on record as an event of the
// campaign's plan, which stays as it is.
void Session::Skip(const std::string& why) {
  if (file_.is_check) {
    RequireReason("skip", why);
    db::Plan plan;
    for (const db::PlanEvent& event : db::PlanEvents(store_, campaign_.name)) {
      if (event.kind == db::PlanEventKind::kPlan) plan = event.plan;
    }
    db::SetPlan(store_, campaign_.name, plan, options_.operator_name,
                "check shot skipped: " + why);
    check_skipped_ = true;
    check_wanted_ = false;
    Say("check shot skipped: " + why);
  } else {
    skipped_rad_.insert(file_.angle_rad);
  }
  Plan();
  SayPlan();
}

// Plans the angle of the last trial once more. A check shot, or a trial that
// was logged without set-points, has none.
void Session::Repeat() {
  const core::Trial& last = RequireLast();
  if (!last.set_angle_rad || last.campaign != campaign_.name) {
    throw std::invalid_argument("the last trial has no set-points to repeat");
  }
  Angle(fmt::format("{}", *last.set_angle_rad / kDegree));
}

// Plans an angle that the operator chose, in degrees, within the rig's reach;
// 1e-9 rad forgives the rounding of the ends that are shown. The choice
// replaces a check shot that was waited for.
void Session::Angle(const std::string& degrees) {
  const auto value = Number(degrees);
  if (!value || *value * kDegree < reach_.angle_rad.low - 1e-9 ||
      *value * kDegree > reach_.angle_rad.high + 1e-9) {
    throw std::invalid_argument(fmt::format(
        "angle is '{}', must be {:.2f} to {:.2f} deg, what the rig can throw",
        degrees, reach_.angle_rad.low / kDegree,
        reach_.angle_rad.high / kDegree));
  }
  file_.angle_rad = *value * kDegree;
  file_.is_check = false;
  file_.phase = Phase::kShot;
  PlanAngle();
  file_.planned_at_s = ends_.now_s();
  Save();
  SayPlan();
}

// Returns the last trial of the session or of an earlier one. Throws
// std::invalid_argument where the campaign has none.
const core::Trial& Session::RequireLast() const {
  if (last_) return last_->trial;
  throw std::invalid_argument("there is no trial yet");
}

// The trial stays in the store and no longer counts for the boundary; so the
// next angle is planned anew.
void Session::Exclude(const std::string& why) {
  RequireReason("exclude", why);
  const core::Trial& last = RequireLast();
  store_.Exclude(last.id, options_.operator_name, why);
  acts_.push_back({Act::kExcluded, last.id});
  Say(fmt::format("trial {} no longer counts: {}", db::ShortId(last.id), why));
  Plan();
  SayPlan();
}

void Session::Include(const std::string& why) {
  RequireReason("include", why);
  const core::Trial& last = RequireLast();
  store_.Include(last.id, options_.operator_name, why);
  acts_.push_back({Act::kIncluded, last.id});
  Say(fmt::format("trial {} counts again: {}", db::ShortId(last.id), why));
  Plan();
  SayPlan();
}

// A revision, as all that is said of a trial: nothing is removed.
void Session::Undo() {
  if (acts_.empty()) throw std::invalid_argument("there is nothing to undo");
  const Act act = acts_.back();
  if (act.kind == Act::kExcluded) {
    store_.Include(act.trial, options_.operator_name, "undo of the exclusion");
  } else {
    store_.Exclude(
        act.trial, options_.operator_name,
        act.kind == Act::kLogged ? "undo of the log" : "undo of the inclusion");
  }
  // The undoing itself is no act: typed again, `undo` goes one act further
  // back.
  acts_.pop_back();
  Say(fmt::format(
      "trial {} {}", db::ShortId(act.trial),
      act.kind == Act::kExcluded ? "counts again" : "no longer counts"));
  Plan();
  SayPlan();
}

// Says who is at the rig from now on; trials that are logged keep their author.
void Session::Operator(const std::string& name) {
  if (name.empty()) throw std::invalid_argument("operator wants a name");
  options_.operator_name = name;
  file_.operator_name = name;
  Save();
  Say("operator: " + name);
}

// Sets one condition of the shots from now on, "temperature_c=21+-0.5". A note
// belongs to one shot and has a word of its own.
void Session::Condition(const std::string& text) {
  const std::size_t sign = text.find('=');
  core::Conditions changed = options_.conditions;
  const std::string key = text.substr(0, sign);
  bool is_known = sign != std::string::npos;
  try {
    is_known = is_known && key != "note" &&
               pipeline::SetCondition(key, text.substr(sign + 1), changed);
  } catch (const pipeline::FieldError& mistake) {
    throw std::invalid_argument(
        fmt::format("condition {} {}", mistake.field(), mistake.problem()));
  }
  if (!is_known) {
    throw std::invalid_argument(fmt::format(
        "condition '{}', must be KEY=VALUE, as temperature_c=21.5+-0.5 or "
        "spring=S 3",
        text));
  }
  // A name that the register does not have is refused now, not at the next
  // shot.
  options_.conditions = db::Resolved(store_, changed);
  Say(fmt::format("from now on: {}", text));
}

void Session::Note(const std::string& text) {
  if (text.empty()) throw std::invalid_argument("note wants words: note TEXT");
  note_ = text;
  Say("logged with the next shot: " + text);
}

// Obeys a word for the rig. What the rig refuses is said with its reason.
// Throws core::InputError where the controller does not answer.
void Session::Drive(const std::string& word, const std::string& rest,
                    const Arrival& arrival) {
  if (ends_.driver == nullptr) {
    throw std::invalid_argument("no rig is driven: start with --driver");
  }
  rig::Driver& driver = *ends_.driver;
  const auto refused = [&](const core::Absent& absent) {
    Say(fmt::format("{}: refused: {}", word, absent.reason));
  };
  if (word == "stop") {
    driver.Stop();
    Say("STOPPED; `reset` when all is well");
  } else if (word == "reset") {
    const auto reset = driver.Reset(options_.operator_name);
    if (!reset) return refused(reset.error());
    Say("ready; set it again");
  } else if (word == "rig") {
    const rig::DriverStatus status = driver.Status();
    Say(fmt::format(
        "interlock {}, {}, {}, {} shots",
        status.interlock == rig::Interlock::kClosed ? "closed" : "OPEN",
        rig::Name(status.armed), status.stopped ? "STOPPED" : "not stopped",
        status.shots));
  } else if (word == "set") {
    if (!setting_) throw std::invalid_argument("there are no set-points now");
    // What the controller reads back is stored with the shot, not what was
    // asked.
    const auto read = driver.Set(*setting_);
    if (!read) return refused(read.error());
    read_ = *read;
    Say(fmt::format("set: it reads elevation {:.2f} deg, compression {:.2f} mm",
                    read->elevation_rad / kDegree,
                    read->compression_m / core::kMillimetre));
  } else if (word == "arm") {
    const auto arming = driver.Arm();
    if (!arming) return refused(arming.error());
    // Before, for whoever answers at once to what is shown.
    arming_said_ = std::chrono::steady_clock::now();
    Say(fmt::format("ARMED. When all are clear: fire {}", arming->number));
  } else {
    Fire(driver, rest, arrival);
  }
}

// Fires once, on a person's word. The line must have been typed on its own
// after the answer to `arm` was said: a pasted `arm` and `fire 1` would release
// the springs before anybody had looked.
void Session::Fire(rig::Driver& driver, const std::string& arming,
                   const Arrival& arrival) {
  const auto number = report::ParseNumber<std::uint64_t>(arming);
  if (!number || *number == 0) {
    throw std::invalid_argument(fmt::format(
        "fire '{}': fire wants the number of the arming, a whole number as "
        "`arm` has said it",
        arming));
  }
  if (!arrival.is_alone || arrival.began <= arming_said_) {
    Say("fire: refused: it came together with other lines, or before the "
        "answer to `arm` was shown; type it on its own");
    return;
  }
  const auto shots = driver.Fire({options_.operator_name, *number});
  if (!shots) {
    Say("fire: refused: " + shots.error().reason);
    return;
  }
  Say(fmt::format("fired ({} shots)", *shots));
}

}  // namespace touchdown::session
