// Ends long work from outside: at a deadline, or because somebody said so.
//
//   const core::Cancellation until = core::Cancellation::After(120.0);
//   until.Enter("the body is looked for");
//   for (...) until.Check();  // throws Cancelled
//
// Copies share one state, so that what is handed to threads ends with the rest.
// A Cancellation that was made without a limit never ends anything and costs
// one comparison.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

namespace touchdown::core {

// Why work ended before its time. No InputError: what was read is not damaged,
// and nobody may go on with less.
class Cancelled : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Cancellation {
 public:
  Cancellation() = default;  // never

  // Ends work `limit_s` of wall time from now, in seconds, above 0 (+infinity:
  // only when interrupted), or as soon as `*interrupted` is true, which must
  // outlive all copies; null: by the time alone. `on_stage` is told of each
  // stage as it is entered, by the thread that enters it. Throws
  // std::invalid_argument.
  static Cancellation After(
      double limit_s, const std::atomic<bool>* interrupted = nullptr,
      std::function<void(const char* stage)> on_stage = {});

  // What is done from now on, for the message: a string literal that reads well
  // after "while". Does nothing where nothing ends the work.
  void Enter(const char* stage) const;

  // Throws Cancelled if it is time; the message says while what, and which
  // frame was the last that was looked at. `frame`: looked at now, -1: none.
  void Check(std::int64_t frame = -1) const;

  // The same where the time is at hand: a look at the clock costs as much as
  // all the rest.
  void Check(std::int64_t frame,
             std::chrono::steady_clock::time_point now) const;

 private:
  struct State {
    std::chrono::steady_clock::time_point deadline;
    const std::atomic<bool>* interrupted = nullptr;
    std::atomic<const char*> stage = "the clip is opened";
    std::function<void(const char*)> on_stage;
    // Written by each thread for each frame: apart from what all of them read.
    alignas(64) std::atomic<std::int64_t> frame = -1;
  };

  [[noreturn]] static void Throw(const State& state);

  std::shared_ptr<State> state_;
};

}  // namespace touchdown::core
