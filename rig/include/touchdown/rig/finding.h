// What a check found: evidence, never an exception.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace touchdown::rig {

// kWarning: the number stands, the reader should know. kRefusal: the rig must
// not be used so.
enum class Severity { kWarning, kRefusal };

struct Finding {
  Severity severity = Severity::kWarning;
  std::string what;  // one sentence fragment: what, by how much, what to do

  friend bool operator==(const Finding&, const Finding&) = default;
};

// True where nothing among `findings` refuses.
inline bool Allowed(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) {
    return f.severity == Severity::kRefusal;
  });
}

}  // namespace touchdown::rig
