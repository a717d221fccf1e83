#include "touchdown/analysis/statistics/paper_table1.h"

#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

struct Row {
  double angle_deg;
  bool sphere_bounces;
  bool rectangle_bounces;
};

// Table 1 as printed.
constexpr Row kTable1[] = {
    {0.0, false, false}, {3.9, false, false}, {7.8, false, false},
    {11.8, false, true}, {27.4, true, true},  {43.0, true, true},
    {58.7, true, true},  {74.4, true, true},  {90.0, true, true}};

}  // namespace

std::vector<Observation> PaperTable1(core::BodyKind body, double u_rad) {
  std::vector<Observation> out;
  for (const Row& row : kTable1) {
    const bool bounced = body == core::BodyKind::kSphere
                             ? row.sphere_bounces
                             : row.rectangle_bounces;
    out.push_back(
        Observe(row.angle_deg * core::kDegree, u_rad, bounced ? 1.0 : 0.0));
    out.back().set_angle_rad = out.back().angle_rad;
    out.back().trial = out.size() - 1;
  }
  return out;
}

TheoryBoundary PaperTable1Boundary(core::BodyKind body) {
  const double boundary_deg = body == core::BodyKind::kSphere ? 11.8 : 7.8;
  return {"published", boundary_deg * core::kDegree, 0.0};
}

}  // namespace touchdown::analysis
