// What `doctor` is told to look at.
#pragma once

#include <string>

#include "app/doctor/doctor.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

struct DoctorFlags {
  std::string store;
  std::string calibration;
  std::string recordings;
};
void AddDoctorFlags(CLI::App& command, DoctorFlags& flags);
pipeline::DoctorOptions ToOptions(const DoctorFlags& flags);

}  // namespace touchdown::cli
