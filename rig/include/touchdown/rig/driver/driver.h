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
// confirmation by nobody, is a std::invalid_argument.
//
// Whether the springs are latched is what the hardware says, never what was
// last asked for. Whatever fails on the way to a shot (an answer to `arm` that
// is lost, a shot that is refused) ends with springs that the hardware itself
// calls released, or with Stop().
//
// Each function may be called from any thread; all but Stop(), Armed() and
// is_stopped() wait for a command that another thread has begun.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "touchdown/core/expected.h"
#include "touchdown/rig/predict.h"

namespace touchdown::rig {

// The guard's switch: closed, nobody can be in the line of fire.
enum class Interlock { kOpen, kClosed };

// Whether the springs are latched, as far as is known now. Only kNo is safe:
// kUnknown is to be shown, and treated, as kYes.
enum class ArmedState { kNo, kYes, kUnknown };
// "not armed", "ARMED", "UNKNOWN, take it as ARMED"
std::string_view Name(ArmedState state);

struct DriverStatus {
  std::optional<Setting> setting;  // as last read; nothing before
  Interlock interlock = Interlock::kOpen;
  ArmedState armed = ArmedState::kUnknown;
  bool stopped = false;    // by Stop(), or by the hardware; until Reset()
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
  // Stop() where the hardware does not say that it is done.
  void Disarm();
  // As the hardware last said it; kUnknown where that is too long ago.
  ArmedState Armed() const { return KnownLatch(); }
  // Fires. Returns the count of shots. Refused where the confirmation means
  // another arming than the last, or the interlock is not closed at this
  // moment (then it is disarmed). Sent once: a lost answer is never made good
  // by firing again, but by Stop() and a reason.
  core::Expected<std::int64_t> Fire(const FireConfirmation& confirmation);
  DriverStatus Status();
  // Asks the hardware once what it is, which also tells it that this program
  // lives. Does nothing while another thread's command talks to it; an answer
  // that is lost, or a port that is gone, leaves Armed() to become unknown.
  void Refresh();

  // Emergency stop: whatever is going on ends with a reason, and nothing moves
  // until Reset(). Async-signal-safe; may be called from any thread.
  void Stop() noexcept;
  bool is_stopped() const noexcept { return stops_ != answered_; }
  // A person's word that all is well again.
  core::Expected<void> Reset(const std::string& by);

 protected:
  // The hardware is in an emergency stop of its own (a button, the end of
  // another program): nothing moves until Reset().
  void HearStopped() noexcept;

 private:
  virtual core::Expected<Setting> Move(const Setting& wanted) = 0;
  virtual core::Expected<Interlock> ReadInterlock() = 0;
  virtual core::Expected<void> Latch() = 0;
  virtual void Unlatch() = 0;
  virtual core::Expected<std::int64_t> Release() = 0;
  virtual std::int64_t CountShots() = 0;
  // Asks the hardware for its state and remembers the answer for KnownLatch().
  // `once`: without a second try. Throws core::InputError.
  virtual void ReadState(bool once) = 0;
  virtual ArmedState KnownLatch() const = 0;  // from any thread
  virtual void Halt() noexcept = 0;           // async-signal-safe
  virtual core::Expected<void> Resume() = 0;

  // After what may have left the springs latched with nobody to fire them.
  void MakeSafe();

  static_assert(std::atomic<std::uint32_t>::is_always_lock_free,
                "Stop() is called from signals");
  // Counted, so that a stop during a Reset() is not lost.
  std::atomic<std::uint32_t> stops_ = 0;
  std::atomic<std::uint32_t> answered_ = 0;  // stops up to here were reset
  std::recursive_mutex command_;             // one talks to the hardware
  std::optional<Setting> setting_;
  std::optional<Arming> arming_;
  std::uint64_t armings_ = 0;
};

}  // namespace touchdown::rig
