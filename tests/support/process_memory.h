// The memory of a process, as the kernel counts it.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace touchdown::testing {

// A line of /proc/PID/status, in MB: "VmRSS" now, "VmHWM" at most so far; 0
// where it cannot be read.
inline double Memory_MB(pid_t process, const std::string& name) {
  std::ifstream in("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(name + ":")) {
      return std::atof(line.c_str() + name.size() + 1) * 1024.0 / 1e6;
    }
  }
  return 0.0;
}

}  // namespace touchdown::testing
