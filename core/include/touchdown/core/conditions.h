// Under what conditions a shot was made: with what of the lab's register, in
// what air, and what was not as it should be.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"

namespace touchdown::core {

// What was not as it should be. `other` needs a note; `not applicable` is for
// shots in which nothing could go wrong (simulated).
enum class Anomaly {
  kNotRecorded,
  kNone,
  kRig,
  kCamera,
  kLight,
  kBody,
  kSurface,
  kOperator,
  kOther,
  kNotApplicable
};
std::string_view Name(Anomaly anomaly);
std::optional<Anomaly> ParseAnomaly(std::string_view word);

// 0 deg C in K, exact by definition.
inline constexpr double kIcePoint_k = 273.15;

// An entry of the lab's register, in the version that was meant.
struct Registered {
  std::string name;  // empty: not recorded
  // UUID of the version. Empty: the one in force when the store takes the
  // trial, which then fills it in.
  std::string id;

  friend bool operator==(const Registered&, const Registered&) = default;
};

struct Conditions {
  Registered rig;
  Registered spring;
  Registered camera;
  Registered calibration;
  Registered body;
  Registered surface;
  Registered person;  // who operated the rig

  Measured temperature_k = AbsentBecause("not recorded");      // of the air
  Measured relative_humidity = AbsentBecause("not recorded");  // 0 .. 1

  // What the rig was set to: as its controller read it, else as it was asked
  // for. Elevation of the barrel above horizontal; travel of the springs; the
  // body's centre above the ground as it leaves the barrel.
  Measured elevation_rad = AbsentBecause("not recorded");
  Measured compression_m = AbsentBecause("not recorded");
  Measured muzzle_height_m = AbsentBecause("not recorded");

  Anomaly anomaly = Anomaly::kNotRecorded;
  std::string anomaly_note;

  std::string note;  // the operator's, whatever it is about

  friend bool operator==(const Conditions&, const Conditions&) = default;
};

}  // namespace touchdown::core
