#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "tests/accuracy/score.h"
#include "tests/benchmarks/kept_clip.h"
#include "tests/benchmarks/precision.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/outline/outline.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::accuracy {
namespace {

// One frame in which the body is to be found, and where to look.
struct Look {
  core::Frame frame;
  const vision::Background* background = nullptr;
  vision::Outline start;     // off by up to 1.5 px, and 5 % in size
  double radius_px = 0.0;    // true
  double contrast_dn = 0.0;  // true, of the body over what is behind it
  double noise_dn = 0.0;
};

using Finder = std::function<std::optional<core::PixelPoint>(const Look&)>;

struct Method {
  std::string name;
  std::string knob;
  Finder find;
};

Finder Fit(const vision::OutlineOptions& options) {
  return [options](const Look& look) -> std::optional<core::PixelPoint> {
    vision::Outline start = look.start;
    if (!options.fit_size) start.radius_px = look.radius_px;
    const auto fit =
        vision::FitOutline(look.frame, *look.background, start, options);
    if (!fit) return std::nullopt;
    return fit->outline.centre;
  };
}

// What surrounds the start by this much is looked at by the others.
constexpr int kAround_px = 8;

// The frame less its background, where the body is looked for.
struct Difference {
  cv::Mat dn;  // CV_32F
  int x = 0;   // of its first sample, in the picture
  int y = 0;
};

Difference DifferenceOf(const Look& look) {
  const int half =
      static_cast<int>(std::ceil(look.start.radius_px)) + kAround_px;
  const int cx = static_cast<int>(std::lround(look.start.centre.x_px));
  const int cy = static_cast<int>(std::lround(look.start.centre.y_px));
  Difference d;
  d.x = std::max(0, cx - half);
  d.y = std::max(0, cy - half);
  const int right = std::min(look.frame.width_px, cx + half + 1);
  const int low = std::min(look.frame.height_px, cy + half + 1);
  d.dn.create(low - d.y, right - d.x, CV_32F);
  for (int y = d.y; y < low; ++y) {
    for (int x = d.x; x < right; ++x) {
      d.dn.at<float>(y - d.y, x - d.x) =
          static_cast<float>(look.frame.at(x, y)) - look.background->at(x, y);
    }
  }
  return d;
}

core::PixelPoint In(const Difference& d, double x, double y) {
  return {d.x + x, d.y + y};
}

std::optional<std::vector<cv::Point>> LargestContour(const Look& look,
                                                     const Difference& d) {
  const cv::Mat mask = cv::abs(d.dn) > 0.5 * std::abs(look.contrast_dn);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto most = std::max_element(
      contours.begin(), contours.end(), [](const auto& a, const auto& b) {
        return cv::contourArea(a) < cv::contourArea(b);
      });
  constexpr std::size_t kForAnEllipse = 5;
  if (most == contours.end() || most->size() < kForAnEllipse) {
    return std::nullopt;
  }
  return *most;
}

// Every pixel off the background by more than half of the contrast counts one.
std::optional<core::PixelPoint> ThresholdedCentroid(const Look& look) {
  const Difference d = DifferenceOf(look);
  const cv::Mat mask = cv::abs(d.dn) > 0.5 * std::abs(look.contrast_dn);
  const cv::Moments m = cv::moments(mask, /*binaryImage=*/true);
  if (m.m00 <= 0.0) return std::nullopt;
  return In(d, m.m10 / m.m00, m.m01 / m.m00);
}

// Every pixel off the background by more than 3 sigma counts by how far.
std::optional<core::PixelPoint> WeightedCentroid(const Look& look) {
  const Difference d = DifferenceOf(look);
  constexpr double kSigmas = 3.0;
  cv::Mat weight = cv::abs(d.dn);
  weight.setTo(0.0F, weight < kSigmas * look.noise_dn);
  const cv::Moments m = cv::moments(weight);
  if (m.m00 <= 0.0) return std::nullopt;
  return In(d, m.m10 / m.m00, m.m01 / m.m00);
}

std::optional<core::PixelPoint> EnclosingCircle(const Look& look) {
  const Difference d = DifferenceOf(look);
  const auto contour = LargestContour(look, d);
  if (!contour) return std::nullopt;
  cv::Point2f centre;
  float radius = 0.0F;
  cv::minEnclosingCircle(*contour, centre, radius);
  return In(d, centre.x, centre.y);
}

std::optional<core::PixelPoint> Ellipse(const Look& look) {
  const Difference d = DifferenceOf(look);
  const auto contour = LargestContour(look, d);
  if (!contour) return std::nullopt;
  const cv::RotatedRect fitted = cv::fitEllipse(*contour);
  return In(d, fitted.center.x, fitted.center.y);
}

Finder Hough(int mode, double accumulator_px) {
  return [=](const Look& look) -> std::optional<core::PixelPoint> {
    const Difference d = DifferenceOf(look);
    // Eight bits, of which the body takes half.
    const double scale = 128.0 / std::abs(look.contrast_dn);
    cv::Mat eight;
    cv::Mat(cv::abs(d.dn)).convertTo(eight, CV_8U, scale);
    std::vector<cv::Vec3f> circles;
    const int radius = static_cast<int>(std::lround(look.start.radius_px));
    constexpr double kApart_px = 1000.0;  // one circle
    constexpr double kCanny = 100.0;
    const double votes = mode == cv::HOUGH_GRADIENT_ALT ? 0.5 : 8.0;
    cv::HoughCircles(eight, circles, mode, accumulator_px, kApart_px, kCanny,
                     votes, radius - 3, radius + 3);
    if (circles.empty()) return std::nullopt;
    return In(d, circles[0][0], circles[0][1]);
  };
}

std::vector<Method> Methods() {
  std::vector<Method> all;
  for (const int iterations : {3, 4, 5, 6, 8}) {
    vision::OutlineOptions options;
    options.max_iterations = iterations;
    all.push_back({"outline fit, iterations at most",
                   fmt::format("{}", iterations), Fit(options)});
  }
  for (const double tolerance_px : {0.3, 0.03, 3e-3, 1e-4}) {
    vision::OutlineOptions options;
    options.tolerance_px = tolerance_px;
    const bool is_default =
        tolerance_px == vision::OutlineOptions{}.tolerance_px;
    all.push_back(
        {"outline fit, tolerance",
         fmt::format("{} px{}", tolerance_px, is_default ? " (default)" : ""),
         Fit(options)});
  }
  vision::OutlineOptions held;
  held.fit_size = false;
  all.push_back({"outline fit, true size held", "", Fit(held)});
  vision::OutlineOptions own;
  own.surround = vision::OutlineOptions::Surround::kPolynomial;
  all.push_back({"outline fit, background not known", "", Fit(own)});
  all.push_back({"threshold, centroid", "", ThresholdedCentroid});
  all.push_back({"difference-weighted centroid", "", WeightedCentroid});
  all.push_back({"threshold, minEnclosingCircle", "", EnclosingCircle});
  all.push_back({"threshold, fitEllipse", "", Ellipse});
  for (const double dp : {1.0, 2.0}) {
    all.push_back({"HoughCircles, gradient", fmt::format("dp {}", dp),
                   Hough(cv::HOUGH_GRADIENT, dp)});
  }
  all.push_back({"HoughCircles, gradient alt", "dp 1.5",
                 Hough(cv::HOUGH_GRADIENT_ALT, 1.5)});
  return all;
}

// A sphere as a careful set-up films it.
Levels StandardLevels() {
  Levels levels;
  levels.size_px = 24.0;
  levels.contrast = -0.5;
  levels.noise = 0.012;
  levels.blur_px = 0.8;
  levels.speed_px = 2.0;
  levels.open = 0.01;
  levels.frames_before = 20;
  levels.frames_after = 6;
  return levels;
}

constexpr std::int64_t kFitted = 15;  // frames of each clip, well in flight
constexpr std::int64_t kEmpty = 20;   // frames before the body

}  // namespace

void MeasureOutline(std::uint64_t clips) {
  const std::vector<Method> methods = Methods();
  std::vector<WorkPoint> points;
  for (const Method& method : methods) {
    WorkPoint& point = points.emplace_back();
    point.stage = "outline";
    point.method = method.name;
    point.knob = method.knob;
    point.unit = "px";
  }
  double bound2 = 0.0;
  for (std::uint64_t i = 0; i < clips; ++i) {
    const Case c = DrawAt(i, StandardLevels());
    const vision::Scene scene = pipeline::filmed::BuildScene(c.film);
    const auto rendered = vision::OpenScene(scene, c.seed);
    KeptClip clip(*rendered);
    std::vector<std::int64_t> empty(kEmpty);
    std::iota(empty.begin(), empty.end(), 0);
    const vision::Background background =
        vision::EstimateBackgroundFromFrames(clip, empty);
    bound2 += BoundOf(c).centre_px * BoundOf(c).centre_px;
    std::mt19937_64 engine(c.seed);
    std::uniform_real_distribution<double> off_px(-1.5, 1.5);
    std::uniform_real_distribution<double> off_size(0.95, 1.05);
    const double full = background.full_scale_dn;
    for (std::int64_t f = c.film.lead_in; f < c.film.lead_in + kFitted; ++f) {
      const vision::SceneTruth truth = vision::ComputeTruth(scene, f);
      Look look;
      look.frame = clip.Read(f);
      look.background = &background;
      look.radius_px = truth.radius_px;
      look.contrast_dn = c.levels.contrast * full;
      look.noise_dn = c.levels.noise * full;
      look.start.centre = {truth.centre.x_px + off_px(engine),
                           truth.centre.y_px + off_px(engine)};
      look.start.radius_px = truth.radius_px * off_size(engine);
      for (std::size_t m = 0; m < methods.size(); ++m) {
        std::optional<core::PixelPoint> centre;
        points[m].seconds.push_back(
            Timed([&] { centre = methods[m].find(look); }));
        if (!centre) {
          ++points[m].failures;
          continue;
        }
        points[m].errors.push_back(centre->x_px - truth.centre.x_px);
        points[m].errors.push_back(centre->y_px - truth.centre.y_px);
      }
    }
  }
  for (WorkPoint& point : points) {
    point.bound = std::sqrt(bound2 / static_cast<double>(clips));
    PrintPoint(point);
  }
}

}  // namespace touchdown::accuracy
