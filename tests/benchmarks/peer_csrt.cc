#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/tracking.hpp>
#include <opencv2/tracking/tracking_legacy.hpp>

#include "tests/benchmarks/peer_followers.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::accuracy {
namespace {

// It takes eight bits and colours.
cv::Mat Coloured(vision::Clip& clip, std::int64_t index) {
  cv::Mat eight;
  Picture(clip, index).convertTo(eight, CV_8U, 255.0 / FullScale(clip));
  cv::Mat coloured;
  cv::cvtColor(eight, coloured, cv::COLOR_GRAY2BGR);
  return coloured;
}

// The upright box around the body, which has the body's centre.
cv::Rect2d TrueBox(const Case& c, std::int64_t frame) {
  const vision::Scene scene = pipeline::filmed::BuildScene(c.film);
  const vision::SceneTruth truth = vision::ComputeTruth(scene, frame);
  double half_width = truth.radius_px;
  double half_height = truth.radius_px;
  if (c.levels.kind == core::BodyKind::kRectangle) {
    const double cosine = std::abs(std::cos(truth.image_angle_rad));
    const double sine = std::abs(std::sin(truth.image_angle_rad));
    const double a = c.film.thrown.half_long_m * c.film.camera.px_per_m;
    const double b = c.film.thrown.half_short_m * c.film.camera.px_per_m;
    half_width = a * cosine + b * sine;
    half_height = a * sine + b * cosine;
  }
  // A pixel's square reaches half a pixel beyond its centre.
  constexpr double kHalfPixel = 0.5;
  return {truth.centre.x_px - half_width + kHalfPixel,
          truth.centre.y_px - half_height + kHalfPixel, 2.0 * half_width,
          2.0 * half_height};
}

}  // namespace

std::vector<Point> FollowCsrt(vision::Clip& clip, const Case& c) {
  const std::int64_t first = c.film.lead_in;
  const vision::SceneTruth truth =
      vision::ComputeTruth(pipeline::filmed::BuildScene(c.film), first);
  cv::Rect2d box = TrueBox(c, first);
  const double dx = truth.centre.x_px - (box.x + 0.5 * box.width);
  const double dy = truth.centre.y_px - (box.y + 0.5 * box.height);
  const auto tracker = cv::legacy::TrackerCSRT::create();
  std::vector<Point> points;
  if (!tracker->init(Coloured(clip, first), box)) return points;
  points.push_back({first, truth.centre.x_px, truth.centre.y_px});
  for (std::int64_t i = first + 1; i < clip.info().frames; ++i) {
    if (!tracker->update(Coloured(clip, i), box)) continue;
    points.push_back(
        {i, box.x + 0.5 * box.width + dx, box.y + 0.5 * box.height + dy});
  }
  return points;
}

}  // namespace touchdown::accuracy
