#include "touchdown/rig/driver/driver.h"

#include <fmt/core.h>

#include <stdexcept>
#include <utility>

#include "require.h"

namespace touchdown::rig {
namespace {

constexpr const char* kStopped =
    "the rig was stopped; look at it, then reset it";

}  // namespace

core::Expected<Setting> Driver::Set(const Setting& wanted) {
  RequireAtLeastZero("compression_m", wanted.compression_m);
  RequireFinite("elevation_rad", wanted.elevation_rad);
  RequireAtLeastZero("muzzle_height_m", wanted.muzzle_height_m);
  if (is_stopped()) return core::AbsentBecause(kStopped);
  Disarm();
  setting_.reset();  // not known while it moves
  auto read = Move(wanted);
  if (read && is_stopped()) return core::AbsentBecause(kStopped);
  if (read) setting_ = *read;
  return read;
}

core::Expected<Arming> Driver::Arm() {
  if (is_stopped()) return core::AbsentBecause(kStopped);
  if (!setting_) return core::AbsentBecause("nothing is set yet: set it first");
  armed_.reset();
  const auto interlock = ReadInterlock();
  if (!interlock) return tl::unexpected(interlock.error());
  if (*interlock != Interlock::kClosed) {
    return core::AbsentBecause("the interlock is open: close the guard first");
  }
  const auto latched = Latch();
  if (!latched) return tl::unexpected(latched.error());
  if (is_stopped()) return core::AbsentBecause(kStopped);
  armed_ = Arming{++armings_, *setting_};
  return *armed_;
}

void Driver::Disarm() {
  if (!armed_) return;
  armed_.reset();
  Unlatch();
}

core::Expected<std::int64_t> Driver::Fire(
    const FireConfirmation& confirmation) {
  if (confirmation.by.empty()) {
    throw std::invalid_argument(
        "by is empty, must name the person who confirms the shot");
  }
  if (is_stopped()) return core::AbsentBecause(kStopped);
  if (!armed_) return core::AbsentBecause("not armed: arm it first");
  if (confirmation.arming != armed_->number) {
    return core::AbsentBecause(
        fmt::format("arming {} is confirmed, but {} is in force",
                    confirmation.arming, armed_->number));
  }
  const auto interlock = ReadInterlock();
  if (!interlock || *interlock != Interlock::kClosed) {
    Disarm();
    if (!interlock) return tl::unexpected(interlock.error());
    return core::AbsentBecause("the interlock is open: disarmed");
  }
  // A Stop() from here on overtakes the shot in the hardware, which refuses
  // until it is reset.
  if (is_stopped()) return core::AbsentBecause(kStopped);
  armed_.reset();  // used up, whatever comes
  return Release();
}

DriverStatus Driver::Status() {
  DriverStatus status;
  status.setting = setting_;
  status.armed = armed_.has_value();
  status.stopped = is_stopped();
  if (status.stopped) return status;
  if (const auto interlock = ReadInterlock()) status.interlock = *interlock;
  status.shots = CountShots();
  status.stopped = is_stopped();
  return status;
}

void Driver::Stop() noexcept {
  ++stops_;
  Halt();
}

core::Expected<void> Driver::Reset(const std::string& by) {
  if (by.empty()) {
    throw std::invalid_argument("by is empty, must name the person who resets");
  }
  armed_.reset();
  setting_.reset();
  // Stopped until the hardware has said that it is ready.
  const std::uint32_t stops = stops_.load();
  auto resumed = Resume();
  if (resumed) answered_.store(stops);
  return resumed;
}

}  // namespace touchdown::rig
