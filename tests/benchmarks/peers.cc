#include "tests/benchmarks/peers.h"

#include <algorithm>
#include <cmath>

#include "tests/benchmarks/peer_followers.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::accuracy {
namespace {

// Seen from the true ground line: along the direction of travel, and upward.
std::vector<vision::PlaneSample> FromGround(const std::vector<Point>& points,
                                            const Case& c) {
  const vision::SceneCamera& camera = c.film.camera;
  const double cosine = std::cos(camera.roll_rad);
  const double sine = std::sin(camera.roll_rad);
  std::vector<vision::PlaneSample> samples;
  for (const Point& p : points) {
    const double x = p.x - camera.ground_point.x_px;
    const double y = p.y - camera.ground_point.y_px;
    vision::PlaneSample s;
    s.frame = p.frame;
    s.time_s = static_cast<double>(p.frame);
    s.along_px = (cosine * x + sine * y) * (camera.travels_left ? -1.0 : 1.0);
    s.height_px = sine * x - cosine * y;
    s.u_along_px = s.u_height_px = 1.0;
    samples.push_back(s);
  }
  return samples;
}

}  // namespace

const char* Name(Peer peer) {
  switch (peer) {
    case Peer::kMog2:
      return "MOG2, centroid, central differences";
    case Peer::kCentroid:
      return "threshold, centroid, ballistic fits";
    case Peer::kTemplate:
      return "template, parabola, ballistic fits";
    case Peer::kCsrt:
      return "CSRT, centre of the box, ballistic fits";
  }
  return "?";
}

std::vector<Peer> Peers() {
  return {Peer::kMog2, Peer::kCentroid, Peer::kTemplate,
#ifdef TOUCHDOWN_HAS_CSRT
          Peer::kCsrt
#endif
  };
}

std::optional<PeerReading> Measure(const Case& c, Peer peer) {
  const auto clip =
      vision::OpenScene(pipeline::filmed::BuildScene(c.film), c.seed);
  return Measure(*clip, c, peer);
}

std::optional<PeerReading> Measure(vision::Clip& clip, const Case& c,
                                   Peer peer) {
  std::vector<Point> points;
  switch (peer) {
    case Peer::kMog2:
      points = FollowMog2(clip);
      break;
    case Peer::kCentroid:
      points = FollowCentroid(clip, c);
      break;
    case Peer::kTemplate:
      points = FollowTemplate(clip, c);
      break;
    case Peer::kCsrt:
#ifdef TOUCHDOWN_HAS_CSRT
      points = FollowCsrt(clip, c);
#endif
      break;
  }
  const std::vector<vision::PlaneSample> samples = FromGround(points, c);
  if (samples.size() < 6) return std::nullopt;
  const auto lowest = static_cast<std::size_t>(
      std::min_element(samples.begin(), samples.end(),
                       [](const auto& a, const auto& b) {
                         return a.height_px < b.height_px;
                       }) -
      samples.begin());
  PeerReading reading;
  if (peer == Peer::kMog2) {
    if (lowest < 2) return std::nullopt;
    const auto& a = samples[lowest - 2];
    const auto& b = samples[lowest];
    reading.frame = b.time_s;
    reading.approach_rad = std::atan2(a.height_px - b.height_px,
                                      std::abs(b.along_px - a.along_px));
    return reading;
  }
  constexpr std::size_t kLeast = 3;
  if (lowest < kLeast) return std::nullopt;
  const vision::synthetic::Throw& t = c.film.thrown;
  const double scale = c.film.camera.px_per_m;
  vision::FlightOptions options;
  const double g =
      t.gravity_mps2 * scale / (c.film.camera.fps * c.film.camera.fps);
  options.gravity_px_per_s2 = core::Estimate{g, 1e-6 * g, std::nullopt};
  const vision::Flight flight =
      vision::FitFlight({samples.data(), lowest}, options);
  // Where the fitted height is that of the body on the ground.
  const double down = t.Support(t.face_rad) * scale;
  double time = samples[lowest].time_s;
  for (int i = 0; i < 30; ++i) {
    const vision::FlightState s = flight.At(time);
    if (!(s.v_n < 0.0)) return std::nullopt;
    time -= (s.height_px - down) / s.v_n;
  }
  const vision::FlightState s = flight.At(time);
  reading.frame = time;
  reading.approach_rad = std::atan2(-s.v_n, std::abs(s.v_t));
  return reading;
}

}  // namespace touchdown::accuracy
