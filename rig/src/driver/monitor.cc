#include "touchdown/rig/driver/monitor.h"

#include <optional>
#include <utility>

#include "touchdown/core/blocked_signals.h"

namespace touchdown::rig {

DriverMonitor::DriverMonitor(Driver& driver,
                             std::function<void(const RigState&)> tell,
                             MonitorOptions options)
    : driver_(driver), tell_(std::move(tell)), options_(options) {
  const core::BlockedSignals blocked;
  asks_ = std::thread([this] { Ask(); });
  watches_ = std::thread([this] { Watch(); });
}

DriverMonitor::~DriverMonitor() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  end_.notify_all();
  asks_.join();
  watches_.join();
}

bool DriverMonitor::Pause(std::chrono::milliseconds pause) {
  std::unique_lock lock(mutex_);
  return !end_.wait_for(lock, pause, [this] { return ends_; });
}

void DriverMonitor::Ask() {
  do {
    driver_.Refresh();
  } while (Pause(options_.period));
}

void DriverMonitor::Watch() {
  std::optional<RigState> told;
  bool was_unknown = false;
  do {
    const RigState now{driver_.Armed(), driver_.is_stopped()};
    // Each command makes the state unknown for the moment until its answer.
    const bool is_unknown = now.armed == ArmedState::kUnknown;
    const bool passing = is_unknown && !was_unknown && told.has_value();
    was_unknown = is_unknown;
    if (passing || told == now) continue;
    told = now;
    try {
      tell_(now);
    } catch (const std::exception&) {  // who cannot be told
    }
  } while (Pause(options_.look));
}

}  // namespace touchdown::rig
