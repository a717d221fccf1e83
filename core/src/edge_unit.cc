#include "touchdown/core/edge_unit.h"

#include "touchdown/core/conditions.h"
#include "touchdown/core/units.h"

namespace touchdown::core {

EdgeUnit AtTheEdge(std::string_view inner) {
  struct Rule {
    std::string_view from;
    std::string_view to;
    double factor;
    double offset = 0.0;
  };
  // As rig.toml has them, too. The longer endings first: "_rad_per_s" also ends
  // in "_s", and "_n_per_m" in
  // "_m", though it is no length.
  static constexpr Rule kRules[] = {
      {"_n_per_m", "_n_per_m", 1.0},
      {"_rad_per_s", "_rad_per_s", 1.0},
      {"_rad", "_deg", kDegree},
      {"_mps2", "_mps2", 1.0},
      {"_mps", "_mps", 1.0},
      {"_m", "_mm", kMillimetre},
      {"_s", "_s", 1.0},
      {"_k", "_c", 1.0, kIcePoint_k},
      {"_pa", "_gpa", 1e9},
      {"_kg", "_g", 1e-3},
  };
  for (const Rule& rule : kRules) {
    if (inner.ends_with(rule.from)) {
      return {std::string(inner.substr(0, inner.size() - rule.from.size())),
              std::string(rule.to), rule.factor, rule.offset};
    }
  }
  return {std::string(inner), "", 1.0};
}

}  // namespace touchdown::core
