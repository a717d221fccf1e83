// touchdown session serves a technician at the rig, and a folder that
// recordings appear in. The session itself (app/session) knows neither terminal
// nor signals. This file gives it both: TerminalLines reads what is typed,
// FolderWatch wakes when files change, Serve() hands over lines and recordings
// in turn, and the handlers of signals stop the rig before anything else.
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/cli/analyze/analyze_flags.h"
#include "app/cli/analyze/folder_watch.h"
#include "app/cli/command.h"
#include "app/cli/interruption.h"
#include "app/cli/options.h"
#include "app/cli/store/condition_flags.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/cli/terminal_lines.h"
#include "app/cli/values.h"
#include "app/documents/log_analysis.h"
#include "app/documents/pictures.h"
#include "app/measure/journal.h"
#include "app/session/session.h"
#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/driver/manual_driver.h"
#include "touchdown/rig/driver/monitor.h"
#include "touchdown/rig/driver/serial_driver.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// Holds the flags as typed. `driver` is "manual" or a serial port; `quiet_s` is
// how long, in seconds, a recording must not grow to count as complete.
struct SessionFlags {
  std::string db;
  std::string campaign;
  std::string rig;
  std::string watch;
  std::string operator_name;
  double speed_mps = 0.0;
  std::string corner;
  std::string check_height = "300+-1";
  std::string check_diameter;
  bool no_check = false;
  bool again = false;
  std::string driver = "manual";
  int baud = 115200;
  double quiet_s = 1.0;
  AnalyzeFlags analyze;
  ConditionFlags conditions;
};

// The handlers of signals share this state with Serve(). A handler sets
// session_ended to the signal's number where the session is to end.
volatile std::sig_atomic_t session_ended = 0;
volatile std::sig_atomic_t rig_stopped = 0;  // and nobody was told
// Holds the instant of that stop: a line typed before it must not act after it.
std::atomic<std::chrono::steady_clock::time_point> rig_stopped_at;
// An analysis runs, and does not look at session_ended for seconds.
volatile std::sig_atomic_t analysing_shot = 0;
// Points to the rig's controller while a Driving lives; null with a rig that is
// set by hand.
std::atomic<rig::Driver*> driven_rig = nullptr;
static_assert(std::atomic<rig::Driver*>::is_always_lock_free &&
              decltype(rig_stopped_at)::is_always_lock_free);

// Whatever the signal, a rig that moves is stopped first. Ctrl-C does no more
// than that while there is something to stop; the next one ends the session. An
// analysis that runs then ends with the process; its recording is taken when
// the session is started again.
void OnSessionSignal(int signal) {
  rig::Driver* const driver = driven_rig.load();
  const bool moves = driver != nullptr && !driver->is_stopped();
  if (moves) {
    rig_stopped_at = std::chrono::steady_clock::now();
    driver->Stop();
    rig_stopped = 1;
  }
  if (moves && signal == SIGINT) return;
  session_ended = signal;
  if (analysing_shot != 0) EndSoon(signal);
}

// For signals of a defect (SIGSEGV, SIGABRT ...): the rig is stopped, then the
// signal does what it does by default, such as write a core file.
void OnFault(int signal) {
  if (rig::Driver* const driver = driven_rig.load()) driver->Stop();
  struct sigaction action = {};
  action.sa_handler = SIG_DFL;
  sigaction(signal, &action, nullptr);
  raise(signal);
}

// A fault may be a stack that is used up: its handler has a stack of its own.
constexpr std::size_t kFaultStack_bytes = 64 << 10;
alignas(16) std::array<char, kFaultStack_bytes> fault_stack;

// Takes SIGINT and SIGTERM over from interruption.h, and catches the others
// that end a process: each must stop the rig first.
void CatchSessionSignals() {
  struct sigaction action = {};
  action.sa_handler = OnSessionSignal;
  // A write goes on, or a line would be lost; poll() ends all the same.
  action.sa_flags = SA_RESTART;
  // SIGPIPE: a lost terminal is found out when it is written to.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
    sigaction(signal, &action, nullptr);
  }
  stack_t stack = {};
  stack.ss_sp = fault_stack.data();
  stack.ss_size = fault_stack.size();
  sigaltstack(&stack, nullptr);
  action.sa_handler = OnFault;
  action.sa_flags = SA_ONSTACK | SA_NODEFER;
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
    sigaction(signal, &action, nullptr);
  }
}

// While a Driving lives, signals and the line `stop` stop the rig, each change
// of its state is printed, and its controller hears that the program lives:
// without that heartbeat the hardware stops by itself.
class Driving {
 public:
  explicit Driving(rig::Driver& driver)
      : monitor_(Announced(driver), [](const rig::RigState& state) {
          fmt::print(
              "rig: {}{}\n", rig::Name(state.armed),
              state.stopped ? ", STOPPED: `reset` when all is well" : "");
          std::fflush(stdout);
        }) {}
  ~Driving() { driven_rig = nullptr; }
  Driving(const Driving&) = delete;
  Driving& operator=(const Driving&) = delete;

 private:
  // Makes the driver known to the handlers before the monitor's first question,
  // from within the list of initialisers.
  static rig::Driver& Announced(rig::Driver& driver) {
    driven_rig = &driver;
    return driver;
  }
  rig::DriverMonitor monitor_;
};

// Returns the daily check shot: a drop whose speed and angle are known without
// a camera. Throws std::invalid_argument where the body has no size or the
// height is not above 0.
session::CheckShot MakeCheckShot(const SessionFlags& flags,
                                 const core::Campaign& campaign,
                                 const rig::Description& rig) {
  session::CheckShot check;
  check.body = flags.check_diameter.empty()
                   ? campaign.body
                   : core::Sphere(ParseEstimate("--check-diameter-mm",
                                                flags.check_diameter,
                                                core::kMillimetre, kPlainSize));
  if (!core::Size(check.body)) {
    throw std::invalid_argument(
        "--check-diameter-mm is missing: the campaign's body has no size");
  }
  check.height_m =
      ParseEstimate("--check-height-mm", flags.check_height, core::kMillimetre);
  check.gravity_mps2 = rig.gravity_mps2;
  session::ExpectedSpeed(check);  // refuses what cannot be
  return check;
}

// Connects to the rig's controller on its serial port; every line to and from
// it is in the journal. Throws core::InputError where no controller answers.
std::unique_ptr<rig::Driver> OpenController(const SessionFlags& flags) {
  rig::SerialOptions options;
  options.baud = flags.baud;
  if (pipeline::JournalIsKept()) {
    options.overhear = [](rig::LineWay way, std::string_view line) {
      while (line.ends_with('\n')) line.remove_suffix(1);
      pipeline::Journal(fmt::format(
          "controller {} {}", way == rig::LineWay::kSent ? "<-" : "->", line));
    };
  }
  auto driver = std::make_unique<rig::SerialDriver>(flags.driver, options);
  // The person must know that the springs were latched before: somebody may
  // have relied on that.
  if (driver->was_found_armed()) {
    fmt::print(
        "the controller was ARMED, or did not say, when it was connected: "
        "disarmed now\n");
  }
  return driver;
}

// Hands what is typed, and each recording that is complete, to the session
// until it ends: by a line, a signal, or the end of the input.
void Serve(const SessionFlags& flags, session::Session& session,
           TerminalLines& lines) {
  FolderWatch changes(flags.watch);
  pipeline::WatchOptions options;
  options.quiet = std::chrono::milliseconds(
      static_cast<std::int64_t>(flags.quiet_s * 1000.0));
  options.now = [] { return std::chrono::steady_clock::now(); };
  // After a stop by a signal: drops the lines that were typed before it and
  // still wait, and says that the rig is stopped. A handler can do neither.
  const auto tell_stop = [&] {
    if (rig_stopped == 0) return;
    rig_stopped = 0;
    lines.DropOldLines(rig_stopped_at);
    fmt::print("STOPPED; `reset` when all is well, Ctrl-C to end\n");
    std::fflush(stdout);
  };
  options.wait = [&](bool growing) {
    // inotify hears nothing of a network drive, so the folder is looked at now
    // and then.
    constexpr std::chrono::milliseconds kNowAndThen{2000};
    if (session_ended != 0) return false;
    changes.Wait(growing ? options.quiet : kNowAndThen, lines.descriptor());
    tell_stop();
    while (const auto line = rig_stopped != 0 ? std::nullopt : lines.Next()) {
      // A log then shows what a person did, and when, beside the controller's
      // lines.
      pipeline::Journal("typed: " + line->text);
      if (!session.Obey(line->text, {line->began, line->is_alone})) {
        return false;
      }
      if (session_ended != 0) return false;
    }
    // The signal may have come while a line was obeyed.
    tell_stop();
    return session_ended == 0 && !lines.at_end();
  };
  pipeline::Watch(flags.watch, options,
                  [&](const std::vector<fs::path>& complete) {
                    for (const fs::path& recording : complete) {
                      if (session_ended != 0) return;
                      session.Take(recording);
                    }
                  });
}

// Runs a session from its first line to its last. Returns 0. Throws
// std::invalid_argument for flags, core::InputError for folder, rig and port,
// core::StoreError for the store or where another session has it.
int RunSession(const SessionFlags& flags) {
  if (!fs::is_directory(flags.watch)) {
    throw core::InputError(fmt::format(
        "{}: there is no such folder; --watch expects the one that recordings "
        "appear in",
        flags.watch));
  }
  // A longer wait would make a technician believe that nothing happens.
  if (!(flags.quiet_s > 0.0 && flags.quiet_s <= 60.0)) {
    throw std::invalid_argument(fmt::format(
        "--quiet-s is {:g}, must be above 0, up to 60", flags.quiet_s));
  }
  const std::optional<core::Corner> corner = ReadCorner(flags.corner);
  // All that can be refused without touching the rig comes first.
  session::SessionOptions options;
  options.analyze = ToOptions(flags.analyze);
  options.again = flags.again;
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  const core::Campaign campaign =
      pipeline::RequireCampaign(store, flags.campaign);
  pipeline::Thrower thrower = pipeline::MakeThrower(
      flags.rig, campaign, flags.speed_mps, corner, flags.db);
  if (!flags.no_check)
    options.check = MakeCheckShot(flags, campaign, thrower.rig);
  // Two sessions on one store would each plan the same shot.
  const session::SessionLock lock(flags.db);
  const auto before = session::ReadSession(flags.db);
  // Who was at the rig last time is taken for who is there now.
  options.operator_name = flags.operator_name;
  if (options.operator_name.empty() && before) {
    options.operator_name = before->operator_name;
  }
  if (options.operator_name.empty()) {
    throw std::invalid_argument(
        "--operator is missing, must name who is at the rig");
  }
  core::Conditions conditions =
      ReadConditions(flags.conditions, flags.db).value_or(core::Conditions{});
  // Each trial refers to the rig as it was: its rig.toml is kept in the
  // register, where it is not there already.
  if (conditions.rig.name.empty()) {
    conditions.rig = pipeline::KeepRig(store, thrower, options.operator_name);
  }
  options.conditions = conditions;
  // From here on the order of declarations is the order in which things must
  // end, backwards: the session, then the monitor, then the controller, which
  // disarms, then the lines.
  CatchSessionSignals();
  TerminalLines lines([] {
    if (rig::Driver* const driver = driven_rig.load()) driver->Stop();
  });
  // This is made in any case: without a controller the person is the driver.
  rig::ManualDriver hands(
      [&lines](const std::string& question) { return lines.Ask(question); });
  // The controller is destroyed before the lines are; it then stops and disarms
  // the rig.
  const auto controller =
      flags.driver == "manual" ? nullptr : OpenController(flags);
  std::optional<Driving> driving;
  if (controller) driving.emplace(*controller);
  rig::Driver& driver = controller ? *controller : hands;
  // These are the ends of the session: the terminal, the clock that dates
  // files, the driver, and where pictures go.
  session::SessionEnds ends;
  ends.say = [](const std::string& line) {
    pipeline::Journal("said: " + line);
    fmt::print("{}\n", Printable(line));
    std::fflush(stdout);
  };
  ends.now_s = [] {
    return std::chrono::duration<double>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  ends.driver = &driver;
  ends.keep_picture = [&store](const core::Trial& trial) {
    pipeline::KeepPicture(store.path(), trial);
  };
  ends.analysing = [](bool runs) {
    analysing_shot = runs ? 1 : 0;
    // The signal may have come a moment before.
    if (runs && session_ended != 0) EndSoon(session_ended);
  };
  fmt::print("{}", CampaignText(campaign));
  session::Session session(store, campaign, std::move(thrower), options, ends,
                           before);
  session.Start();
  Serve(flags, session, lines);
  session.End();
  // A controller disarms when it is closed; a person must be asked to.
  if (!controller && hands.Armed() != rig::ArmedState::kNo) {
    fmt::print("the springs are latched, or may be: unlatch them\n");
  }
  return 0;
}

}  // namespace

void AddSession(CLI::App& app, Action& action) {
  auto flags = std::make_shared<SessionFlags>();
  CLI::App* command =
      AddCommand(app, "session",
                 "at the rig: set-points, new recording, answer, next angle; "
                 "can be killed and started again");
  AddDbFlag(*command, flags->db);
  AddOption(*command, "--campaign", flags->campaign, "what is thrown for")
      .Require();
  AddOption(
      *command, "--rig", flags->rig,
      "rig.toml, which is kept in the register; or the name of a rig there")
      .Require();
  AddConditionFlag(*command, flags->conditions);
  AddOption(*command, "--watch", flags->watch,
            "the folder that recordings appear in")
      .Require();
  AddOption(*command, "--operator", flags->operator_name,
            "who is at the rig (as last time where not given)");
  AddOption(*command, "--speed-mps", flags->speed_mps,
            "speed at touchdown (default: the middle of the campaign's band)");
  AddOption(*command, "--corner", flags->corner,
            "corner that lands first, leading, trailing or flush");
  AddOption(*command, "--check-height-mm", flags->check_height,
            "daily check shot: the height that a body is dropped from, below "
            "it to the ground")
      .ShowDefault();
  AddOption(*command, "--check-diameter-mm", flags->check_diameter,
            "the sphere that is dropped (default: the campaign's body)");
  AddFlag(*command, "--no-check", flags->no_check, "ask for no check shot");
  AddOption(*command, "--driver", flags->driver,
            "manual, or the serial port of the rig's controller (/dev/ttyUSB0)")
      .ShowDefault();
  AddOption(*command, "--baud", flags->baud, "of the serial port")
      .ShowDefault();
  AddOption(*command, "--quiet-s", flags->quiet_s,
            "a recording is complete when it has not grown for so long; one "
            "taken too early is taken again")
      .ShowDefault();
  AddFlag(*command, "--again", flags->again,
          "take also recordings that failed twice");
  AddAnalyzeFlags(*command, flags->analyze);
  SetAction(*command, action, [flags] { return RunSession(*flags); });
}

}  // namespace touchdown::cli
