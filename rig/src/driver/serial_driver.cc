#include "touchdown/rig/driver/serial_driver.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/rig/driver/line_protocol.h"

namespace touchdown::rig {
namespace {

// The protocol's name and version.
constexpr const char* kVersion = "touchdown-rig/2";

// On the wire angles are in millidegrees and lengths in micrometres, whole
// numbers: nothing to round differently on the two sides.
constexpr double kWireAngle_rad = 1e-3 * core::kDegree;
constexpr double kWireLength_m = 1e-6;

std::int64_t OnWire(double value, double unit) {
  return std::llround(value / unit);
}

}  // namespace

SerialDriver::SerialDriver(const std::string& port, SerialOptions options,
                           SerialTime time)
    : line_(port, options.baud, std::move(time)),
      options_(options),
      // Each stop byte alone is enough.
      farewell_(std::string(3, kStopByte) +
                FormatLine(Request{kAlwaysNew, "disarm", ""})) {
  const auto greeting = Ask("hello");
  const std::string text = greeting ? *greeting : greeting.error().reason;
  const std::string version = text.substr(0, text.find(' '));
  if (!greeting || version != kVersion) {
    throw core::InputError(fmt::format(
        "{}: what answers says '{}', expected {}; see rig/README.md", port,
        text, kVersion));
  }
  if (text.size() > version.size()) name_ = text.substr(version.size() + 1);
  try {
    ReadState(false);
    was_found_armed_ = Armed() != ArmedState::kNo;
    Disarm();
  } catch (...) {
    Stop();
    throw;
  }
}

SerialDriver::~SerialDriver() {
  // As long as 100 bytes take at the slowest baud.
  constexpr std::chrono::milliseconds kLastBytes{100};
  try {
    // Who stopped it does not wait for answers.
    if (!is_stopped()) {
      Forget();
      Disarm();
    }
  } catch (const std::exception&) {  // then it is stopped, no more
  }
  Stop();
  line_.Drain(kLastBytes);
}

core::Expected<std::string> SerialDriver::Ask(const std::string& verb,
                                              const std::string& argument,
                                              Patience patience,
                                              bool even_stopped) {
  const int tries = patience == Patience::kOnce ? 1 : options_.tries;
  // One number for all tries: whichever is answered, the answer is good.
  const Request request{++number_, verb, argument};
  const std::string bytes = FormatLine(request);
  for (int i = 0; i < tries; ++i) {
    if (is_stopped() && !even_stopped) return core::AbsentBecause("stopped");
    if (options_.overhear) options_.overhear(LineWay::kSent, bytes);
    line_.Send(bytes);
    const auto until = line_.Now() + options_.answer;
    while (const auto line = line_.Receive(until)) {
      if (options_.overhear) options_.overhear(LineWay::kHeard, *line);
      const auto answer = ParseAnswer(*line);
      // Damaged, or late: of what was asked before.
      if (!answer || answer->number != number_ || answer->verb != verb) {
        continue;
      }
      if (answer->ok) return answer->text;
      return core::AbsentBecause(
          fmt::format("the controller refuses '{}': {}", verb, answer->text));
    }
  }
  if (is_stopped() && !even_stopped) return core::AbsentBecause("stopped");
  throw core::InputError(fmt::format(
      "{}: no answer to '{}' ({} tries of {} ms); look at the controller's "
      "power and cable",
      line_.port(), verb, tries, options_.answer.count()));
}

// Done only when the controller has said the same value back.
core::Expected<void> SerialDriver::Order(const std::string& verb,
                                         std::int64_t value) {
  const std::string wanted = std::to_string(value);
  std::string heard;
  for (int i = 0; i < options_.tries; ++i) {
    const auto answer = Ask(verb, wanted);
    if (!answer) return tl::unexpected(answer.error());
    if (*answer == wanted) return {};
    heard = *answer;
  }
  throw core::InputError(
      fmt::format("{}: '{} {}' was asked for and '{}' understood, {} times; do "
                  "not use the rig until its controller is repaired",
                  line_.port(), verb, wanted, heard, options_.tries));
}

std::int64_t SerialDriver::RequireField(const std::string& text,
                                        const char* field) const {
  if (const auto value = ReadField(text, field)) return *value;
  throw core::InputError(
      fmt::format("{}: the status '{}' has no '{}'; see rig/README.md",
                  line_.port(), text, field));
}

core::Expected<std::string> SerialDriver::AskStatus(Patience patience,
                                                    bool even_stopped) {
  const auto asked = line_.Now();
  auto status = Ask("status", "", patience, even_stopped);
  if (!status) return status;
  // Only a plain 0 is "not armed", and only a plain 0 "not stopped".
  const bool armed = RequireField(*status, "armed") != 0;
  {
    const std::lock_guard lock(heard_mutex_);
    heard_ = Heard{armed, asked};
  }
  if (RequireField(*status, "stopped") != 0) HearStopped();
  return status;
}

void SerialDriver::ReadState(bool once) {
  const int tries = once ? 1 : options_.tries;
  for (int i = 1;; ++i) {
    try {
      // A number of its own for each try: no old answer is told again.
      if (AskStatus(Patience::kOnce, true)) return;
    } catch (const core::InputError&) {
      if (i == tries) throw;
    }
    if (i == tries) return;
  }
}

ArmedState SerialDriver::KnownLatch() const {
  const auto now = line_.Now();
  const std::lock_guard lock(heard_mutex_);
  if (!heard_ || now - heard_->asked > options_.known) {
    return ArmedState::kUnknown;
  }
  return heard_->armed ? ArmedState::kYes : ArmedState::kNo;
}

void SerialDriver::Forget() {
  const std::lock_guard lock(heard_mutex_);
  heard_.reset();
}

core::Expected<std::int64_t> SerialDriver::AskField(const char* field) {
  const auto status = AskStatus();
  if (!status) return tl::unexpected(status.error());
  return RequireField(*status, field);
}

core::Expected<Setting> SerialDriver::Move(const Setting& wanted) {
  const std::int64_t angle = OnWire(wanted.elevation_rad, kWireAngle_rad);
  const std::int64_t travel = OnWire(wanted.compression_m, kWireLength_m);
  // The springs last: loaded no longer than need be.
  for (const auto& [verb, value] :
       {std::pair{"angle", angle}, std::pair{"compress", travel}}) {
    const auto ordered = Order(verb, value);
    if (!ordered) return tl::unexpected(ordered.error());
  }
  const auto until = line_.Now() + options_.movement;
  while (true) {
    const auto status = AskStatus();
    if (!status) return tl::unexpected(status.error());
    if (RequireField(*status, "moving") == 0) {
      const Setting read{
          static_cast<double>(RequireField(*status, "compress")) *
              kWireLength_m,
          static_cast<double>(RequireField(*status, "angle")) * kWireAngle_rad,
          wanted.muzzle_height_m};
      if (std::abs(read.elevation_rad - wanted.elevation_rad) >
              options_.elevation_tolerance_rad ||
          std::abs(read.compression_m - wanted.compression_m) >
              options_.compression_tolerance_m) {
        return core::AbsentBecause(fmt::format(
            "it stopped at {:.2f} deg and {:.2f} mm, not at {:.2f} deg and "
            "{:.2f} mm",
            read.elevation_rad / core::kDegree,
            read.compression_m / core::kMillimetre,
            wanted.elevation_rad / core::kDegree,
            wanted.compression_m / core::kMillimetre));
      }
      return read;
    }
    if (line_.Now() >= until) {
      return core::AbsentBecause(fmt::format("it still moves after {} s",
                                             options_.movement.count() / 1000));
    }
    line_.Pause(line_.Now() + options_.look);
    if (is_stopped()) return core::AbsentBecause("stopped");
  }
}

core::Expected<Interlock> SerialDriver::ReadInterlock() {
  const auto answer = Ask("interlock");
  if (!answer) return tl::unexpected(answer.error());
  // Only the word itself is closed; whatever else is said is open.
  return *answer == "closed" ? Interlock::kClosed : Interlock::kOpen;
}

core::Expected<void> SerialDriver::Latch() {
  const auto shots = AskField("shots");
  if (!shots) return tl::unexpected(shots.error());
  Forget();
  const auto token = Ask("arm");
  if (!token) return tl::unexpected(token.error());
  if (token->empty()) {
    throw core::InputError(fmt::format(
        "{}: armed without a token; see rig/README.md", line_.port()));
  }
  shots_before_ = *shots;
  token_ = *token;
  return {};
}

void SerialDriver::Unlatch() {
  Forget();
  if (!Ask("disarm", "", Patience::kTries, true)) Stop();
}

core::Expected<std::int64_t> SerialDriver::Release() {
  Forget();
  try {
    const auto fired = Ask("fire", token_, Patience::kOnce);
    if (!fired) return tl::unexpected(fired.error());
    return RequireField(*fired, "shots");
  } catch (const core::InputError&) {
    // The line, or its answer, was lost. Never fire again: ask whether it did.
    try {
      const auto shots = AskField("shots");
      if (shots && *shots > shots_before_) return *shots;
    } catch (const core::InputError&) {
      Stop();
      throw;
    }
    Stop();
    return core::AbsentBecause(
        "no answer to 'fire' and no shot counted: stopped; keep clear, the "
        "springs may be latched");
  }
}

std::int64_t SerialDriver::CountShots() {
  return AskField("shots").value_or(shots_before_);
}

void SerialDriver::Halt() noexcept { line_.Shout(farewell_); }

core::Expected<void> SerialDriver::Resume() {
  const auto answer = Ask("reset", "", Patience::kTries, true);
  if (!answer) return tl::unexpected(answer.error());
  return {};
}

}  // namespace touchdown::rig
