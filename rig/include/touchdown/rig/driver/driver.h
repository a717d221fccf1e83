// The rig's hardware: what sets the barrel, latches the springs and lets go.
//
//   auto read = driver.Set(setting);      // moves, reads back
//   auto arming = driver.Arm();           // latched, interlock closed
//   driver.Fire({"A. Lee", arming->number});
//   driver.Stop();                        // always works, also from a signal
//
// The software never fires by itself: Fire() wants a confirmation that names a
// person and the arming that is meant, looks at the interlock once more, and
// uses an arming up. What is refused (interlock open, not armed, stopped) is a
// value with its reason; a controller that does not answer is a
// core::InputError naming its port; a setting that is no number, or a
// confirmation by nobody, is a std::invalid_argument. All functions but Stop()
// belong to one thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "touchdown/core/expected.h"
#include "touchdown/rig/predict.h"

namespace touchdown::rig {

// The guard's switch: closed, nobody can be in the line of fire.
enum class Interlock { kOpen, kClosed };

struct DriverStatus {
  std::optional<Setting> setting;  // as last read; nothing before
  Interlock interlock = Interlock::kOpen;
  bool armed = false;
  bool stopped = false;    // by Stop(); until Reset()
  std::int64_t shots = 0;  // that this hardware counts
};

// One latching of the springs, from Arm() until it is fired or disarmed.
struct Arming {
  std::uint64_t number = 0;  // 1, 2 ...; each is fired at most once
  Setting setting;           // as read back
};

// A person's word for one shot. Never made by a program.
struct FireConfirmation {
  std::string by;            // who says so
  std::uint64_t arming = 0;  // Arming::number
};

class Driver {
 public:
  virtual ~Driver() = default;
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  // Sets elevation and compression (and the muzzle's height where the hardware
  // can); disarms first. Returns what was read back.
  core::Expected<Setting> Set(const Setting& wanted);
  // Latches the springs at the last Set(); only with the interlock closed.
  core::Expected<Arming> Arm();
  void Disarm();
  bool is_armed() const noexcept { return armed_.has_value(); }
  // Fires. Returns the count of shots. Refused where the confirmation means
  // another arming than the last, or the interlock is not closed at this
  // moment (then it is disarmed). Sent once: a lost answer is never made good
  // by firing again, but by Stop() and a reason.
  core::Expected<std::int64_t> Fire(const FireConfirmation& confirmation);
  DriverStatus Status();

  // Emergency stop: whatever is going on ends with a reason, and nothing moves
  // until Reset(). Async-signal-safe; may be called from any thread.
  void Stop() noexcept;
  bool is_stopped() const noexcept { return stops_ != answered_; }
  // A person's word that all is well again.
  core::Expected<void> Reset(const std::string& by);

 private:
  virtual core::Expected<Setting> Move(const Setting& wanted) = 0;
  virtual core::Expected<Interlock> ReadInterlock() = 0;
  virtual core::Expected<void> Latch() = 0;
  virtual void Unlatch() = 0;
  virtual core::Expected<std::int64_t> Release() = 0;
  virtual std::int64_t CountShots() = 0;
  virtual void Halt() noexcept = 0;  // async-signal-safe
  virtual core::Expected<void> Resume() = 0;

  static_assert(std::atomic<std::uint32_t>::is_always_lock_free,
                "Stop() is called from signals");
  // Counted, so that a stop during a Reset() is not lost.
  std::atomic<std::uint32_t> stops_ = 0;
  std::atomic<std::uint32_t> answered_ = 0;  // stops up to here were reset
  std::optional<Setting> setting_;
  std::optional<Arming> armed_;
  std::uint64_t armings_ = 0;
};

}  // namespace touchdown::rig
