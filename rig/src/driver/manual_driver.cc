#include "touchdown/rig/driver/manual_driver.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <utility>

namespace touchdown::rig {
namespace {

// Reason where the dialogue ended without an answer.
constexpr const char* kNoAnswer = "nobody answered at the rig";

std::optional<double> Number(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

ManualDriver::ManualDriver(Question ask, ManualOptions options)
    : ask_(std::move(ask)), options_(options) {}

core::Expected<double> ManualDriver::Reading(const std::string& what,
                                             double wanted, double unit,
                                             double tolerance) {
  const std::string order = fmt::format("set {} to {:.2f}", what, wanted);
  std::string question = order + "; it reads [as asked]:";
  for (int i = 0; i < options_.questions; ++i) {
    const auto answer = ask_(question);
    if (is_stopped()) return core::AbsentBecause("stopped");
    if (!answer) return core::AbsentBecause(kNoAnswer);
    const auto read =
        answer->empty() ? std::optional<double>(wanted) : Number(*answer);
    if (!read) {
      question = fmt::format("'{}' is no number; {} reads:", *answer, what);
    } else if (std::abs(*read - wanted) * unit <= tolerance) {
      return *read * unit;
    } else {
      question =
          fmt::format("{:g} is not within {:g} of it: {}; it reads:", *read,
                      tolerance / unit, order);
    }
  }
  return core::AbsentBecause(fmt::format(
      "{} could not be set to {:.2f} in {} readings: look for what is loose, "
      "or choose another angle",
      what, wanted, options_.questions));
}

core::Expected<Setting> ManualDriver::Move(const Setting& wanted) {
  const auto elevation =
      Reading("the elevation, deg,", wanted.elevation_rad / core::kDegree,
              core::kDegree, options_.elevation_tolerance_rad);
  if (!elevation) return tl::unexpected(elevation.error());
  const auto height = Reading("the muzzle height, mm,",
                              wanted.muzzle_height_m / core::kMillimetre,
                              core::kMillimetre, options_.length_tolerance_m);
  if (!height) return tl::unexpected(height.error());
  const auto compression =
      Reading("the compression, mm,", wanted.compression_m / core::kMillimetre,
              core::kMillimetre, options_.length_tolerance_m);
  if (!compression) return tl::unexpected(compression.error());
  return Setting{*compression, *elevation, *height};
}

core::Expected<bool> ManualDriver::Yes(const std::string& question) {
  for (int i = 0; i < options_.questions; ++i) {
    const auto answer = ask_(question + " [yes/no]:");
    if (is_stopped()) return core::AbsentBecause("stopped");
    if (!answer) return core::AbsentBecause(kNoAnswer);
    if (*answer == "yes") return true;
    if (*answer == "no") return false;
  }
  return core::AbsentBecause("neither yes nor no was answered");
}

core::Expected<Interlock> ManualDriver::ReadInterlock() {
  const auto closed = Yes("is the guard closed and everybody clear?");
  if (!closed) return tl::unexpected(closed.error());
  return *closed ? Interlock::kClosed : Interlock::kOpen;
}

core::Expected<void> ManualDriver::Latch() {
  latched_ = ArmedState::kUnknown;
  const auto latched = Yes("latch the springs; are they latched?");
  if (!latched) return tl::unexpected(latched.error());
  latched_ = *latched ? ArmedState::kYes : ArmedState::kNo;
  if (!*latched) return core::AbsentBecause("the springs are not latched");
  return {};
}

void ManualDriver::Unlatch() {
  latched_ = ArmedState::kUnknown;
  if (ask_("unlatch the springs, then press Enter:")) {
    latched_ = ArmedState::kNo;
  }
}

core::Expected<std::int64_t> ManualDriver::Release() {
  latched_ = ArmedState::kUnknown;
  const auto fired = Yes("pull the trigger; did it fire?");
  if (!fired) return tl::unexpected(fired.error());
  latched_ = *fired ? ArmedState::kNo : ArmedState::kYes;
  if (!*fired) return core::AbsentBecause("it did not fire: unlatch it");
  return ++shots_;
}

}  // namespace touchdown::rig
