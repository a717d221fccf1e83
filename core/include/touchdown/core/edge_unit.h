// The unit at the edge of an inner name: "_rad" is shown in "_deg".
#pragma once

#include <string>
#include <string_view>

namespace touchdown::core {

// inner = edge * factor + offset.
struct EdgeUnit {
  std::string stem;
  std::string suffix;   // with its underscore; empty: no unit
  double factor = 1.0;  // inner units per edge unit
  double offset = 0.0;
};

EdgeUnit AtTheEdge(std::string_view inner);

}  // namespace touchdown::core
