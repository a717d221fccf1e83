// What the doctor finds of the machine, whatever is measured on it.
#pragma once

#include <vector>

#include "app/doctor/doctor.h"

namespace touchdown::pipeline {

// Program, system, libraries that are loaded, video codecs, the reader's
// confinement, programs that are called.
std::vector<Finding> ExamineMachine();

}  // namespace touchdown::pipeline
