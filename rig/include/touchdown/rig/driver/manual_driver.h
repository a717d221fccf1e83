// The rig without a motor: the technician sets it, latches it and pulls the
// trigger; the program asks what the protractor and the scale read.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "touchdown/core/units.h"
#include "touchdown/rig/driver/driver.h"

namespace touchdown::rig {

struct ManualOptions {
  // How far a reading may lie from what was wanted before it is asked for
  // again. Half a degree: the reading error of a good protractor; one
  // millimetre: of a scale read at arm's length.
  double elevation_tolerance_rad = 0.5 * core::kDegree;
  double length_tolerance_m = 1.0 * core::kMillimetre;
  int questions = 3;  // of one kind, before it is given up
};

// Asks the person at the rig; nothing where there is no answer.
using Question =
    std::function<std::optional<std::string>(const std::string& question)>;

// The readings are in degrees and millimetres; an empty answer says that it
// reads what was asked for.
class ManualDriver final : public Driver {
 public:
  explicit ManualDriver(Question ask, ManualOptions options = {});

 private:
  core::Expected<Setting> Move(const Setting& wanted) override;
  core::Expected<Interlock> ReadInterlock() override;
  core::Expected<void> Latch() override;
  void Unlatch() override;
  core::Expected<std::int64_t> Release() override;
  std::int64_t CountShots() override { return shots_; }
  void ReadState(bool) override {}  // hands have told what they did
  ArmedState KnownLatch() const override { return latched_; }
  void Halt() noexcept override {}  // hands stop by themselves
  core::Expected<void> Resume() override { return {}; }

  core::Expected<double> Reading(const std::string& what, double wanted,
                                 double unit, double tolerance);
  core::Expected<bool> Yes(const std::string& question);

  Question ask_;
  ManualOptions options_;
  std::int64_t shots_ = 0;
  // What the person said; unknown while a question about it is open.
  std::atomic<ArmedState> latched_ = ArmedState::kNo;
};

}  // namespace touchdown::rig
