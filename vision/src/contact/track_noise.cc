#include "contact/track_noise.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

// |x(i) - 3 x(i-m) + 3 x(i-2m) - x(i-3m)| for lag m: blind to any parabola,
// thus to free flight. Only where no frame is missing between them.
std::vector<double> ThirdDifferences(const std::vector<PlaneSample>& samples,
                                     double PlaneSample::*value,
                                     std::size_t lag) {
  std::vector<double> differences;
  const auto apart = static_cast<std::int64_t>(3 * lag);
  for (std::size_t i = 3 * lag; i < samples.size(); ++i) {
    if (samples[i].frame - samples[i - 3 * lag].frame != apart) continue;
    differences.push_back(std::abs(
        samples[i].*value - 3.0 * samples[i - lag].*value +
        3.0 * samples[i - 2 * lag].*value - samples[i - 3 * lag].*value));
  }
  return differences;
}

// Standard deviation of one pose's noise from its third differences: their
// variance is 1 + 9 + 9 + 1 = 20 times a pose's. What neighbours have in common
// shows at the longer lags.
double PoseNoise(std::vector<double>& d) {
  // Differences. An impact spoils three differences of neighbours: in a short
  // track that is too many for the median, and the lower third is taken. Not
  // studied.
  constexpr std::size_t kMinForMedian = 12;
  const bool many = d.size() >= kMinForMedian;
  // |normal| lies below 0.674 with probability 1/2, below 0.431 with 1/3.
  const double quantile = many ? 0.6744898 : 0.4307273;  // of |normal|
  const auto at =
      d.begin() + static_cast<std::ptrdiff_t>(d.size() / (many ? 2 : 3));
  std::nth_element(d.begin(), at, d.end());
  return *at / quantile / std::sqrt(20.0);
}

// Widens the claims `u` of one coordinate to its scatter. Returns the excess as
// a standard deviation of one pose.
double WidenToNoise(std::vector<PlaneSample>& samples,
                    double PlaneSample::*value, double PlaneSample::*u) {
  std::vector<double> claims;
  claims.reserve(samples.size());
  for (const PlaneSample& s : samples) claims.push_back(s.*u);
  // px or rad: claims of zero have no ratio.
  constexpr double kMinClaim = 1e-9;
  const double claim = std::max(Median(std::move(claims)), kMinClaim);
  double factor = 1.0;
  double neighbours = 0.0;
  // Samples for each frame of the lag. An impact spoils three differences for
  // each frame of the lag: here a tenth of all, so that the median still tells
  // beside a few impacts. Fewer see farther, but take impacts for noise.
  constexpr std::size_t kSamplesPerLag = 30;
  // Frames. More sees slower drifts, and takes more of a path's own bends for
  // noise. Not studied.
  constexpr std::size_t kMaxLag = 4;
  const std::size_t longest =
      std::clamp<std::size_t>(samples.size() / kSamplesPerLag, 1, kMaxLag);
  for (std::size_t lag = 1; lag <= longest; lag *= 2) {
    std::vector<double> d = ThirdDifferences(samples, value, lag);
    // Differences: fewer have no median worth the name. Not studied.
    constexpr std::size_t kMinDifferences = 5;
    if (d.size() < kMinDifferences) break;
    const double ratio = PoseNoise(d) / claim;
    // An excess within the scatter's own uncertainty is none. Third differences
    // overlap, so that the relative uncertainty of their median is 1.8/sqrt(n),
    // not 1.2/sqrt(n); 4/sqrt(n) lets one honest track in a hundred be widened.
    // Of longer lags fewer are apart from each other.
    const double many =
        static_cast<double>(d.size()) / static_cast<double>(lag);
    // Neighbours share most of a drift; what differs by more over some frames
    // is the path's own: of a body that bounces every few frames.
    // In units of what neighbours differ by. Larger: bounces widen u; smaller:
    // a slow drift of the poses is missed. Not studied.
    constexpr double kMaxDriftRatio = 4.0;
    if (lag > 1 && ratio > kMaxDriftRatio * std::max(1.0, neighbours)) break;
    if (lag == 1) neighbours = ratio;
    if (ratio > 1.0 + 4.0 / std::sqrt(many)) factor = std::max(factor, ratio);
  }
  const double excess = factor * factor - 1.0;
  for (PlaneSample& s : samples) {
    s.*u *= std::sqrt(1.0 + kExcessVariance * excess);
  }
  return claim * std::sqrt(excess);
}

}  // namespace

double ComputeInflation(const std::vector<std::vector<double>>& runs,
                        int degrees) {
  double square = 0.0;
  std::size_t n = 0;
  for (const auto& run : runs) {
    for (const double r : run) square += r * r;
    n += run.size();
  }
  if (degrees < 1 || !(square > 0.0)) return 1.0;
  // A fit takes up what is slow: by so much residuals of white noise go against
  // each other at short lags.
  const double taken_up =
      (static_cast<double>(n) - degrees) / static_cast<double>(n);
  double alike = 1.0;
  // A run tells of lags up to a third of its length; beyond, too few products
  // are left and the sum takes noise for correlation. Not studied.
  constexpr std::size_t kRunPerLag = 3;
  for (std::size_t lag = 1;; ++lag) {
    double product = 0.0;
    bool any = false;
    for (const auto& run : runs) {
      if (kRunPerLag * lag > run.size()) continue;
      any = true;
      for (std::size_t i = lag; i < run.size(); ++i) {
        product += run[i] * run[i - lag];
      }
    }
    const double rho = product / square + taken_up;
    if (!any || rho < 0.0) break;
    alike += 2.0 * rho;
  }
  return std::sqrt(std::max(1.0, square / degrees * alike));
}

bool WidenToCorrelation(const std::vector<Stretch>& stretches,
                        const FlightOptions& options, PlaneTrack& track) {
  std::vector<std::vector<double>> along, height, face;
  int flat_degrees = 0;  // of a straight line
  int bent_degrees = 0;  // of a parabola
  const bool turns = ShowsTurn(track);

  // Frames: residuals of shorter flights are mostly taken up by the fit. Not
  // studied.
  constexpr std::size_t kMinFlight = 8;
  for (const Stretch& stretch : stretches) {
    const std::size_t n = stretch.size();
    if (stretch.kind != StretchKind::kFlight || n < kMinFlight) continue;
    const auto samples = SelectSamples(track, stretch);
    const Flight flight = FitFlight(samples, options);
    std::vector<double> x, y, f;
    for (const PlaneSample& s : samples) {
      const FlightState at = flight.At(s.time_s);
      x.push_back((s.along_px - at.along_px) / s.u_along_px);
      y.push_back((s.height_px - at.height_px) / s.u_height_px);
      if (turns) f.push_back((s.face_rad - at.face_rad) / s.u_face_rad);
    }
    const int degrees = static_cast<int>(n) - 2;
    along.push_back(std::move(x));
    height.push_back(std::move(y));
    face.push_back(std::move(f));
    flat_degrees += degrees;
    bent_degrees += degrees - (options.gravity_px_per_s2 ? 0 : 1);
  }
  const double by_along = ComputeInflation(along, flat_degrees);
  const double by_height = ComputeInflation(height, bent_degrees);
  const double by_face = turns ? ComputeInflation(face, flat_degrees) : 1.0;
  for (PlaneSample& s : track.samples) {
    // The gap's u: height and attitude, each with its own factor.
    const double arm = s.u_face_rad * LowestPointOffset(track, s.face_rad);
    s.u_along_px *= by_along;
    s.u_height_px *= by_height;
    s.u_face_rad *= by_face;
    s.u_gap_px = std::hypot(s.u_height_px, arm * by_face);
  }
  return std::max({by_along, by_height, by_face}) > 1.0;
}

ExcessNoise WidenToScatter(PlaneTrack& track) {
  ExcessNoise excess;
  // Frames: five third differences, as WidenToNoise asks for.
  constexpr std::size_t kMinSamples = 8;
  auto& samples = track.samples;
  if (samples.size() < kMinSamples) return excess;
  WidenToNoise(samples, &PlaneSample::along_px, &PlaneSample::u_along_px);
  excess.height_px =
      WidenToNoise(samples, &PlaneSample::height_px, &PlaneSample::u_height_px);
  if (ShowsTurn(track)) {
    excess.face_rad =
        WidenToNoise(samples, &PlaneSample::face_rad, &PlaneSample::u_face_rad);
    // An attitude that was smoothed over frames does not scatter, and is known
    // no better than this share of what moves an end of the long side by the u
    // of place. Where each frame has its own attitude the ratio is about 1.
    // Larger widens u of face angles. Not studied.
    constexpr double kMinFaceShare = 0.25;
    for (PlaneSample& s : samples) {
      s.u_face_rad = std::max(
          s.u_face_rad, kMinFaceShare * std::min(s.u_along_px, s.u_height_px) /
                            std::max(track.half_long_px, 1.0));
    }
    excess.face_rad =
        std::max(excess.face_rad, kMinFaceShare * excess.height_px /
                                      std::max(track.half_long_px, 1.0));
  }
  WidenToNoise(samples, &PlaneSample::gap_px, &PlaneSample::u_gap_px);
  return excess;
}

}  // namespace touchdown::vision
