#include "touchdown/core/cancellation.h"

#include <cmath>
#include <utility>

namespace touchdown::core {

using Clock = std::chrono::steady_clock;

Cancellation Cancellation::After(
    double limit_s, const std::atomic<bool>* interrupted,
    std::function<void(const char* stage)> on_stage) {
  if (!(limit_s > 0.0)) {
    throw std::invalid_argument("limit_s is " + std::to_string(limit_s) +
                                ", must be above 0 (seconds)");
  }
  Cancellation cancellation;
  cancellation.state_ = std::make_shared<State>();
  // What the clock cannot hold is no limit.
  constexpr double kMost_s = 1e9;
  cancellation.state_->deadline =
      limit_s < kMost_s
          ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(limit_s))
          : Clock::time_point::max();
  cancellation.state_->interrupted = interrupted;
  cancellation.state_->on_stage = std::move(on_stage);
  return cancellation;
}

void Cancellation::Enter(const char* stage) const {
  if (!state_) return;
  const char* const before =
      state_->stage.exchange(stage, std::memory_order_relaxed);
  if (state_->on_stage && before != stage) state_->on_stage(stage);
}

void Cancellation::Check(std::int64_t frame) const {
  if (state_) Check(frame, Clock::now());
}

void Cancellation::Check(std::int64_t frame, Clock::time_point now) const {
  if (!state_) return;
  if (frame >= 0) state_->frame.store(frame, std::memory_order_relaxed);
  if (state_->interrupted != nullptr && state_->interrupted->load()) {
    throw Cancelled("interrupted");
  }
  if (now >= state_->deadline) Throw(*state_);
}

void Cancellation::Throw(const State& state) {
  std::string what = std::string("while ") + state.stage.load();
  if (const std::int64_t frame = state.frame.load(); frame >= 0) {
    what += ", at frame " + std::to_string(frame);
  }
  throw Cancelled(what);
}

}  // namespace touchdown::core
