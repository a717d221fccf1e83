#include "touchdown/rig/driver/driver.h"

#include <fmt/core.h>

#include <stdexcept>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

// Answer of every command after a stop, until the operator resets the rig.
constexpr const char* kStopped =
    "the rig was stopped; look at it, then reset it";

}  // namespace

std::string_view Name(ArmedState state) {
  switch (state) {
    case ArmedState::kNo:
      return "not armed";
    case ArmedState::kYes:
      return "ARMED";
    case ArmedState::kUnknown:
      break;
  }
  return "UNKNOWN, take it as ARMED";
}

core::Expected<Setting> Driver::Set(const Setting& wanted) {
  core::RequireNotNegative("compression_m", wanted.compression_m);
  core::RequireFinite("elevation_rad", wanted.elevation_rad);
  core::RequireNotNegative("muzzle_height_m", wanted.muzzle_height_m);
  const std::lock_guard lock(command_);
  if (is_stopped()) return core::AbsentBecause(kStopped);
  Disarm();
  setting_.reset();  // not known while it moves
  auto read = Move(wanted);
  if (read && is_stopped()) return core::AbsentBecause(kStopped);
  if (read) setting_ = *read;
  return read;
}

core::Expected<Arming> Driver::Arm() {
  const std::lock_guard lock(command_);
  if (is_stopped()) return core::AbsentBecause(kStopped);
  if (!setting_) return core::AbsentBecause("nothing is set yet: set it first");
  arming_.reset();
  const auto interlock = ReadInterlock();
  if (!interlock) return tl::unexpected(interlock.error());
  if (*interlock != Interlock::kClosed) {
    return core::AbsentBecause("the interlock is open: close the guard first");
  }
  try {
    const auto latched = Latch();
    if (latched) ReadState(false);
    if (latched && Armed() == ArmedState::kYes && !is_stopped()) {
      arming_ = Arming{++armings_, *setting_};
      return *arming_;
    }
    MakeSafe();
    if (!latched) return tl::unexpected(latched.error());
  } catch (const core::InputError&) {
    MakeSafe();
    throw;
  }
  if (is_stopped()) return core::AbsentBecause(kStopped);
  return core::AbsentBecause(
      "it was latched, and does not say now that it is: disarmed");
}

void Driver::Disarm() {
  const std::lock_guard lock(command_);
  arming_.reset();
  if (Armed() == ArmedState::kNo) return;
  try {
    Unlatch();
    ReadState(false);
  } catch (const core::InputError&) {  // it does not answer
  }
  // What cannot be disarmed must not be fired.
  if (Armed() != ArmedState::kNo && !is_stopped()) Stop();
}

void Driver::MakeSafe() {
  arming_.reset();
  try {
    ReadState(false);
  } catch (const core::InputError&) {  // unknown, then
  }
  Disarm();
}

core::Expected<std::int64_t> Driver::Fire(
    const FireConfirmation& confirmation) {
  if (confirmation.by.empty()) {
    throw std::invalid_argument(
        "by is empty, must name the person who confirms the shot");
  }
  const std::lock_guard lock(command_);
  if (is_stopped()) return core::AbsentBecause(kStopped);
  if (!arming_) return core::AbsentBecause("no arming is in force: arm it");
  if (confirmation.arming != arming_->number) {
    return core::AbsentBecause(
        fmt::format("arming {} is confirmed, but {} is in force",
                    confirmation.arming, arming_->number));
  }
  arming_.reset();  // used up, whatever comes
  try {
    const auto interlock = ReadInterlock();
    if (!interlock || *interlock != Interlock::kClosed) {
      MakeSafe();
      if (!interlock) return tl::unexpected(interlock.error());
      return core::AbsentBecause("the interlock is open: disarmed");
    }
    // A Stop() from here on overtakes the shot in the hardware, which refuses
    // until it is reset.
    if (is_stopped()) return core::AbsentBecause(kStopped);
    auto shots = Release();
    if (shots) {
      Refresh();
    } else {
      MakeSafe();
    }
    return shots;
  } catch (const core::InputError&) {
    MakeSafe();
    throw;
  }
}

DriverStatus Driver::Status() {
  const std::lock_guard lock(command_);
  DriverStatus status;
  status.setting = setting_;
  if (!is_stopped()) {
    if (const auto interlock = ReadInterlock()) status.interlock = *interlock;
    status.shots = CountShots();
  }
  Refresh();
  status.armed = Armed();
  status.stopped = is_stopped();
  return status;
}

void Driver::Refresh() {
  const std::unique_lock lock(command_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  try {
    ReadState(true);
  } catch (const core::InputError&) {  // Armed() becomes unknown
  }
}

void Driver::Stop() noexcept {
  ++stops_;
  Halt();
}

void Driver::HearStopped() noexcept {
  if (!is_stopped()) ++stops_;
}

core::Expected<void> Driver::Reset(const std::string& by) {
  if (by.empty()) {
    throw std::invalid_argument("by is empty, must name the person who resets");
  }
  const std::lock_guard lock(command_);
  arming_.reset();
  setting_.reset();
  // Stopped until the hardware has said that it is ready.
  const std::uint32_t stops = stops_.load();
  auto resumed = Resume();
  if (!resumed) return resumed;
  answered_.store(stops);
  MakeSafe();
  if (is_stopped()) {
    return core::AbsentBecause(
        "it is still stopped; look at its button and at its springs");
  }
  return resumed;
}

}  // namespace touchdown::rig
