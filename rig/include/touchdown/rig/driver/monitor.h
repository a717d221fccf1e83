// Keeps asking a driver's hardware for its state, and tells what is known of it
// whenever that changes.
//
// The questions are the heartbeat of the protocol (line_protocol.h): while a
// DriverMonitor lives, the hardware hears that the program does. An answer that
// fails to come makes the state unknown, and that is told, too.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "touchdown/rig/driver/driver.h"

namespace touchdown::rig {

// What is known now.
struct RigState {
  ArmedState armed = ArmedState::kUnknown;
  bool stopped = false;

  friend bool operator==(const RigState&, const RigState&) = default;
};

struct MonitorOptions {
  // Between two questions. Four a second: two in a row may be lost before a
  // state is unknown (SerialOptions::known), and 9600 baud carry it in a third
  // of the time. At most 1 s.
  std::chrono::milliseconds period{250};
  // Between two looks at what is known: how late a change is told.
  std::chrono::milliseconds look{50};
};

class DriverMonitor {
 public:
  // `tell` is called from a thread of the monitor, first with the state at the
  // start; what it throws is dropped. Both must outlive the monitor.
  DriverMonitor(Driver& driver, std::function<void(const RigState&)> tell,
                MonitorOptions options = {});
  ~DriverMonitor();
  DriverMonitor(const DriverMonitor&) = delete;
  DriverMonitor& operator=(const DriverMonitor&) = delete;

 private:
  void Ask();
  void Watch();
  // False once the monitor ends.
  bool Pause(std::chrono::milliseconds pause);

  Driver& driver_;
  std::function<void(const RigState&)> tell_;
  MonitorOptions options_;
  std::mutex mutex_;
  std::condition_variable end_;
  bool ends_ = false;
  // Two, so that a question that waits for its answer delays no telling.
  std::thread asks_;
  std::thread watches_;
};

}  // namespace touchdown::rig
