// The rig behind a serial port that speaks touchdown-rig version 2
// (line_protocol.h, rig/README.md).
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "touchdown/core/units.h"
#include "touchdown/rig/driver/driver.h"
#include "touchdown/rig/driver/serial_line.h"

namespace touchdown::rig {

// Called with each line to (kSent) and from (kHeard) the controller, from any
// thread; must not throw, and must not take long: answers
// are waited for meanwhile. What a signal's handler sends is not told.
enum class LineWay { kSent, kHeard };
using Overhear = std::function<void(LineWay way, std::string_view line)>;

struct SerialOptions {
  int baud = 115200;
  // For an answer: a line takes 20 ms at 9600 baud, a controller some
  // milliseconds.
  std::chrono::milliseconds answer{500};
  // How often something is asked before the controller is given up. Commands
  // may be lost or come twice without harm, but for `fire`, which is sent once.
  int tries = 3;
  // For a movement to end, and how often it is looked at.
  std::chrono::milliseconds movement{30'000};
  std::chrono::milliseconds look{200};
  // How long an answer about the state of the springs is good, from the instant
  // at which it was asked for; then it is unknown. The limit is 1.2 s: what is
  // left of it is for a busy machine to say so.
  std::chrono::milliseconds known{800};
  // How far what was reached may lie from what was wanted: of drives with a
  // step of 0.1 deg and 0.1 mm.
  double elevation_tolerance_rad = 0.15 * core::kDegree;
  double compression_tolerance_m = 0.15 * core::kMillimetre;
  Overhear overhear = {};  // empty: nobody does
};

// The muzzle's height is set by hand: Set() returns it as it was wanted.
class SerialDriver final : public Driver {
 public:
  // Opens the port and greets the controller; one that is found armed is
  // disarmed. Throws as SerialLine, and core::InputError where what answers is
  // no controller of version 2.
  explicit SerialDriver(const std::string& port, SerialOptions options = {},
                        SerialTime time = SerialTime::Real());
  // However the program ends: disarm, answered if it can be, and stop.
  ~SerialDriver() override;

  const std::string& name() const { return name_; }  // as it greeted
  // Whether the springs were, or may have been, latched when it was greeted.
  bool was_found_armed() const { return was_found_armed_; }

 private:
  core::Expected<Setting> Move(const Setting& wanted) override;
  core::Expected<Interlock> ReadInterlock() override;
  core::Expected<void> Latch() override;
  void Unlatch() override;
  core::Expected<std::int64_t> Release() override;
  std::int64_t CountShots() override;
  void ReadState(bool once) override;
  ArmedState KnownLatch() const override;
  void Halt() noexcept override;
  core::Expected<void> Resume() override;

  // What the controller said of itself, and when it was asked for that.
  struct Heard {
    bool armed = true;
    SerialTime::Instant asked;
  };
  enum class Patience { kTries, kOnce };
  // The answer's text. Absent where the controller says no, or it was stopped
  // meanwhile. Throws core::InputError where nothing sensible is answered.
  core::Expected<std::string> Ask(const std::string& verb,
                                  const std::string& argument = "",
                                  Patience patience = Patience::kTries,
                                  bool even_stopped = false);
  core::Expected<void> Order(const std::string& verb, std::int64_t value);
  // The status; remembers what it says of the springs.
  core::Expected<std::string> AskStatus(Patience patience = Patience::kTries,
                                        bool even_stopped = false);
  core::Expected<std::int64_t> AskField(const char* field);
  void Forget();  // what was heard: it may change from now on
  std::int64_t RequireField(const std::string& text, const char* field) const;

  SerialLine line_;
  SerialOptions options_;
  std::string name_;
  std::uint32_t number_ = 0;
  std::string token_;  // of the last latching
  std::int64_t shots_before_ = 0;
  bool was_found_armed_ = false;
  std::string farewell_;  // what Halt() sends
  mutable std::mutex heard_mutex_;
  std::optional<Heard> heard_;  // guarded by it
};

}  // namespace touchdown::rig
