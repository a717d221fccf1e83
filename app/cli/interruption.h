// Ctrl-C (SIGINT) and SIGTERM end the program at once, whatever it does:
// decoding, fitting, writing, waiting for a thread.
//
// A thread of its own waits for them. It removes what is not complete
// (core/unfinished.h) and ends the process without waiting for any other
// thread, with status 130 or 143. The trial store needs nothing: what was not
// committed did not happen.
//
// Commands that go on until they are told to end (`session`, `batch --watch`,
// `review`) catch the signals themselves, end what they do in good order with
// their usual status, and are ended like all others where that takes too long.
#pragma once

namespace touchdown::cli {

// The exit status of a process that a signal ended is this and the signal's
// number, as shells count.
inline constexpr int kBySignal = 128;

// Once, before any other thread is started.
void CatchInterruptions();

// From a handler or a thread that has caught `signal` itself: ends the process
// as above if it is still there after a moment (a tenth of a second). May be
// called in signal handlers.
void EndSoon(int signal);

}  // namespace touchdown::cli
