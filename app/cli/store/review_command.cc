// touchdown review: serves the local page on which a person looks at trials,
// until Ctrl-C. This file has the flags, the signals and the browser; the page
// itself is app/review.
#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "app/cli/browser.h"
#include "app/cli/command.h"
#include "app/cli/interruption.h"
#include "app/cli/messages.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/review/server.h"
#include "app/shots/thrower.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. Port 0 lets the server choose; an empty `reports`
// is the folder `report` beside the store.
struct ReviewFlags {
  std::string db;
  int port = 0;
  bool no_open = false;
  std::string reports;
  std::vector<std::string> recordings;
  std::string rig;
  double speed_mps = 0.0;
  std::string corner;
};

// Serves the page until SIGINT or SIGTERM; returns 0. Throws core::StoreError
// where the store cannot be opened, core::InputError where the port is taken.
int RunReview(const ReviewFlags& flags) {
  if (flags.port < 0 || flags.port > 65535) {
    throw std::invalid_argument(
        fmt::format("--port is {}, must be in 0 .. 65535", flags.port));
  }
  review::ServerOptions options;
  options.store = flags.db;
  options.http.port = flags.port;
  options.reports =
      flags.reports.empty()
          ? std::filesystem::absolute(flags.db).parent_path() / "report"
          : std::filesystem::path(flags.reports);
  options.recordings.assign(flags.recordings.begin(), flags.recordings.end());
  // The page shows the next angle, which a rig's reach limits as in `next`.
  if (!flags.rig.empty()) {
    options.reach_of = pipeline::ReachOfRig(flags.rig, flags.speed_mps,
                                            ReadCorner(flags.corner), flags.db);
  }
  // The server's threads leave these signals to the one that waits for them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  review::Server server(options);
  fmt::print("{}\n", server.address());
  // Whoever does not learn the address has no page.
  RequireStdoutWritten();
  Tell(fmt::format("the page of {}{}; Ctrl-C ends it", flags.db,
                   std::filesystem::exists(flags.db)
                       ? ""
                       : " (not there yet: the page makes it with the first "
                         "answer that is kept)"));
  // The file by which the browser finds the page lives as long as the server. A
  // machine without a desktop has the address on stdout alone.
  std::optional<BrowserPage> page;
  if (!flags.no_open && HasDesktop()) {
    page.emplace(server.address());
    if (!page->path().empty()) page->Show();
  }
  // A thread of its own waits for the signal: Stop() may be called from any
  // thread, but a handler of signals may call next to nothing.
  std::atomic<bool> ended = false;
  std::thread waiter([&] {
    int signal = 0;
    sigwait(&signals, &signal);
    // A request that is being answered may take long, such as an analysis; the
    // process ends soon in any case.
    if (!ended) EndSoon(signal);
    server.Stop();
  });
  // Where the server ended by itself, the waiter is woken: it waits for the
  // signal, which is blocked everywhere.
  const auto end_waiting = [&] {
    ended = true;
    // NOLINTNEXTLINE(bugprone-bad-signal-to-kill-thread)
    pthread_kill(waiter.native_handle(), SIGTERM);
    waiter.join();
  };
  try {
    server.Run();
  } catch (...) {
    // A thread that was not joined would end the process before main can say
    // what is wrong.
    end_waiting();
    throw;
  }
  end_waiting();
  return 0;
}

}  // namespace

void AddReview(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ReviewFlags>();
  CLI::App* command = AddCommand(
      app, "review", "a local web page: look at trials, correct, log, report");
  AddDbFlag(*command, flags->db);
  AddOption(*command, "--port", flags->port,
            "of 127.0.0.1 (default: any that is free)");
  AddFlag(*command, "--no-open", flags->no_open,
          "do not show the page in a browser");
  AddOption(*command, "--reports", flags->reports,
            "folder for reports built on the page (default: `report` beside "
            "the store)");
  AddOption(*command, "--recordings", flags->recordings,
            "a folder that recordings are chosen from on the page, with all "
            "below it; may be given several times")
      .NameType("DIR")
      .OneAtATime();
  AddOption(*command, "--rig", flags->rig,
            "rig.toml: the next angle stays within its reach");
  AddOption(*command, "--speed-mps", flags->speed_mps,
            "with --rig: speed at touchdown (default: the middle of the "
            "campaign's band)");
  AddOption(*command, "--corner", flags->corner,
            "with --rig: corner that lands first, leading, trailing or flush");
  SetAction(*command, action, [flags] { return RunReview(*flags); });
}

}  // namespace touchdown::cli
