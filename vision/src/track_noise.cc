#include "track_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "track_shape.h"

namespace touchdown::vision {
namespace {

std::vector<double> ThirdDifferences(const std::vector<PlaneSample>& samples,
                                     double PlaneSample::*value) {
  std::vector<double> differences;
  for (std::size_t i = 3; i < samples.size(); ++i) {
    if (samples[i].frame - samples[i - 3].frame != 3) continue;
    differences.push_back(
        std::abs(samples[i].*value - 3.0 * samples[i - 1].*value +
                 3.0 * samples[i - 2].*value - samples[i - 3].*value));
  }
  return differences;
}

void Widen(std::vector<PlaneSample>& samples, double PlaneSample::*value,
           double PlaneSample::*u) {
  std::vector<double> d = ThirdDifferences(samples, value);
  constexpr std::size_t kLeast = 5;
  if (d.size() < kLeast) return;
  // A blow spoils three differences: in short tracks too many for the median.
  constexpr std::size_t kMany = 12;
  const bool many = d.size() >= kMany;
  const double quantile = many ? 0.6744898 : 0.4307273;  // of |normal|
  const auto at =
      d.begin() + static_cast<std::ptrdiff_t>(d.size() / (many ? 2 : 3));
  std::nth_element(d.begin(), at, d.end());
  const double sigma = *at / quantile / std::sqrt(20.0);
  std::vector<double> claims;
  claims.reserve(samples.size());
  for (const PlaneSample& s : samples) claims.push_back(s.*u);
  constexpr double kLeastClaim = 1e-9;
  const double factor =
      sigma / std::max(Median(std::move(claims)), kLeastClaim);
  // An excess within the scatter's own uncertainty is none. Third differences
  // overlap, so that the relative uncertainty of their median is 1.8/sqrt(n),
  // not 1.2/sqrt(n); 4/sqrt(n) lets one honest track in a hundred be widened.
  if (factor <= 1.0 + 4.0 / std::sqrt(static_cast<double>(d.size()))) return;
  for (PlaneSample& s : samples) s.*u *= factor;
}

}  // namespace

void WidenToScatter(PlaneTrack& track) {
  constexpr std::size_t kLeast = 8;
  if (track.samples.size() < kLeast) return;
  Widen(track.samples, &PlaneSample::along_px, &PlaneSample::u_along_px);
  Widen(track.samples, &PlaneSample::height_px, &PlaneSample::u_height_px);
  if (track.kind == core::BodyKind::kRectangle) {
    Widen(track.samples, &PlaneSample::face_rad, &PlaneSample::u_face_rad);
  }
  Widen(track.samples, &PlaneSample::gap_px, &PlaneSample::u_gap_px);
}

}  // namespace touchdown::vision
