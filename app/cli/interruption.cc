// A handler of signals may take no lock and allocate nothing, so it cannot
// remove what is on the list of unfinished files. It writes one byte into a
// pipe instead; a thread of its own (Listen) reads the byte, removes the files
// and ends the process.
#include "app/cli/interruption.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "touchdown/core/unfinished.h"

namespace touchdown::cli {
namespace {

// The handler writes into the second end; the thread reads from the first.
std::array<int, 2> signal_pipe = {-1, -1};

// What the thread is told: the signal's number, and whether the command may end
// by itself first.
constexpr unsigned char kSoon = 0x80;

// This is async-signal-safe. errno is kept: the code that was interrupted may
// be about to read it.
void WakeListener(unsigned char what) {
  const int before = errno;
  // A full pipe has told enough.
  [[maybe_unused]] const auto written = write(signal_pipe[1], &what, 1);
  errno = before;
}

void OnInterruption(int signal) {
  WakeListener(static_cast<unsigned char>(signal));
}

// Calls _exit() and not exit(), which would destroy objects that other threads
// still use.
[[noreturn]] void End(int signal) {
  core::RemoveUnfinished();
  // A progress bar's line is not left half drawn.
  if (isatty(STDERR_FILENO) != 0) {
    [[maybe_unused]] const auto written = write(STDERR_FILENO, "\n", 1);
  }
  _exit(kBySignal + signal);
}

// Waits for the first byte; those that follow change nothing. Ends without a
// word where the pipe is gone.
void Listen() {
  constexpr std::chrono::milliseconds kMoment{100};
  unsigned char told = 0;
  while (read(signal_pipe[0], &told, 1) != 1) {
    if (errno != EINTR) return;
  }
  // The command has its moment to end in good order; where it does, the process
  // is gone before this returns.
  if ((told & kSoon) != 0) std::this_thread::sleep_for(kMoment);
  End(told & ~kSoon);
}

}  // namespace

void CatchInterruptions() {
  // Without a pipe signals end the program as the system has it.
  if (pipe2(signal_pipe.data(), O_CLOEXEC) != 0) return;
  // Signals are for the other threads: waiting must end by them.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread(Listen).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  struct sigaction action = {};
  action.sa_handler = OnInterruption;
  // Until the thread ends the process nothing else may notice the signal: a
  // read that failed with EINTR would be taken for an error of the file.
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    sigaction(signal, &action, nullptr);
  }
}

void EndSoon(int signal) {
  WakeListener(static_cast<unsigned char>(signal) | kSoon);
}

}  // namespace touchdown::cli
