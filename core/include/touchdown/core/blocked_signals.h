// Threads that must not run the handlers of signals.
//
//   const core::BlockedSignals blocked;
//   thread = std::thread(...);
//
// A signal ends a wait (EINTR) only in the thread that its handler runs in; so
// threads that serve the one that waits are started while a BlockedSignals
// lives. Signals of a fault (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) go on to
// reach the thread that made it.
#pragma once

#include <csignal>
#include <initializer_list>

namespace touchdown::core {

class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t blocked;
    sigfillset(&blocked);
    for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
      sigdelset(&blocked, fault);
    }
    pthread_sigmask(SIG_SETMASK, &blocked, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_ = {};
};

}  // namespace touchdown::core
