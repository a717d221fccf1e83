// The rig behind a serial port that speaks touchdown-rig version 1
// (line_protocol.h, rig/README.md).
#pragma once

#include <chrono>
#include <string>

#include "touchdown/core/units.h"
#include "touchdown/rig/driver/driver.h"
#include "touchdown/rig/driver/serial_line.h"

namespace touchdown::rig {

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
  // How far what was reached may lie from what was wanted: of drives with a
  // step of 0.1 deg and 0.1 mm.
  double elevation_tolerance_rad = 0.15 * core::kDegree;
  double compression_tolerance_m = 0.15 * core::kMillimetre;
};

// The muzzle's height is set by hand: Set() returns it as it was wanted.
class SerialDriver final : public Driver {
 public:
  // Opens the port and greets the controller. Throws as SerialLine, and
  // core::InputError where what answers is no controller of version 1.
  explicit SerialDriver(const std::string& port, SerialOptions options = {},
                        SerialTime time = SerialTime::Real());

  const std::string& name() const { return name_; }  // as it greeted

 private:
  core::Expected<Setting> Move(const Setting& wanted) override;
  core::Expected<Interlock> ReadInterlock() override;
  core::Expected<void> Latch() override;
  void Unlatch() override;
  core::Expected<std::int64_t> Release() override;
  std::int64_t CountShots() override;
  void Halt() noexcept override;
  core::Expected<void> Resume() override;

  enum class Patience { kTries, kOnce };
  // The answer's text. Absent where the controller says no, or it was stopped
  // meanwhile. Throws core::InputError where nothing sensible is answered.
  core::Expected<std::string> Ask(const std::string& verb,
                                  const std::string& argument = "",
                                  Patience patience = Patience::kTries,
                                  bool even_stopped = false);
  core::Expected<void> Order(const std::string& verb, std::int64_t value);
  core::Expected<std::int64_t> AskField(const char* field);
  std::int64_t RequireField(const std::string& text, const char* field) const;

  SerialLine line_;
  SerialOptions options_;
  std::string name_;
  std::uint32_t number_ = 0;
  std::string token_;  // of the last latching
  std::int64_t shots_before_ = 0;
};

}  // namespace touchdown::rig
