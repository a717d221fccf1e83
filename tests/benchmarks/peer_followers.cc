#include "tests/benchmarks/peer_followers.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <optional>

namespace touchdown::accuracy {
namespace {

constexpr int kEmpty = 20;  // frames before the body, at least

std::optional<Point> LargestCentroid(const cv::Mat& mask, std::int64_t frame) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  double most = 0.0;
  std::optional<Point> best;
  for (const auto& contour : contours) {
    const cv::Moments m = cv::moments(contour);
    constexpr double kLeastArea = 12.0;
    if (m.m00 <= std::max(most, kLeastArea)) continue;
    most = m.m00;
    best = Point{frame, m.m10 / m.m00, m.m01 / m.m00};
  }
  return best;
}

// Vertex of the parabola through three values, from the middle one.
double Vertex(double a, double b, double c) {
  const double bend = a - 2.0 * b + c;
  return bend < 0.0 ? 0.5 * (a - c) / bend : 0.0;
}

}  // namespace

cv::Mat Picture(vision::Clip& clip, std::int64_t index) {
  const core::Frame frame = clip.Read(index);
  cv::Mat picture(frame.height_px, frame.width_px, CV_32F);
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      picture.at<float>(y, x) = static_cast<float>(frame.at(x, y));
    }
  }
  return picture;
}

double FullScale(const vision::Clip& clip) {
  return std::pow(2.0, clip.info().bit_depth) - 1.0;
}

std::vector<Point> FollowMog2(vision::Clip& clip) {
  const double full = FullScale(clip);
  const auto subtractor =
      cv::createBackgroundSubtractorMOG2(kEmpty, 16.0, false);
  std::vector<Point> points;
  cv::Mat eight;
  cv::Mat mask;
  for (std::int64_t i = 0; i < clip.info().frames; ++i) {
    Picture(clip, i).convertTo(eight, CV_8U, 255.0 / full);
    subtractor->apply(eight, mask, i < kEmpty ? -1.0 : 0.0);
    if (i < kEmpty) continue;
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN,
                     cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
    if (const auto p = LargestCentroid(mask, i)) points.push_back(*p);
  }
  return points;
}

std::vector<Point> FollowCentroid(vision::Clip& clip, const Case& c) {
  const double contrast_dn = std::abs(c.levels.contrast) * FullScale(clip);
  cv::Mat mean = Picture(clip, 0);
  for (int i = 1; i < kEmpty; ++i) mean += Picture(clip, i);
  mean /= kEmpty;
  std::vector<Point> points;
  for (std::int64_t i = kEmpty; i < clip.info().frames; ++i) {
    cv::Mat mask = cv::abs(Picture(clip, i) - mean) > 0.5 * contrast_dn;
    if (const auto p = LargestCentroid(mask, i)) points.push_back(*p);
  }
  return points;
}

std::vector<Point> FollowTemplate(vision::Clip& clip, const Case& c) {
  // The user marks the body in the middle of its approach.
  const std::vector<Point> marked = FollowCentroid(clip, c);
  const auto middle = static_cast<std::int64_t>(c.film.contact_frame) -
                      c.levels.frames_before / 2;
  const auto at =
      std::find_if(marked.begin(), marked.end(),
                   [&](const Point& p) { return p.frame >= middle; });
  if (at == marked.end()) return {};
  const int half = static_cast<int>(std::ceil(0.5 * c.levels.size_px)) + 2;
  const cv::Mat picture = Picture(clip, at->frame);
  const int x0 = static_cast<int>(std::lround(at->x)) - half;
  const int y0 = static_cast<int>(std::lround(at->y)) - half;
  const cv::Rect box(x0, y0, 2 * half + 1, 2 * half + 1);
  if (x0 < 0 || y0 < 0 || box.br().x > picture.cols ||
      box.br().y > picture.rows) {
    return {};
  }
  const cv::Mat pattern = picture(box).clone();
  const double dx = at->x - x0;
  const double dy = at->y - y0;
  std::vector<Point> points;
  cv::Mat score;
  for (std::int64_t i = kEmpty; i < clip.info().frames; ++i) {
    cv::matchTemplate(Picture(clip, i), pattern, score, cv::TM_CCOEFF_NORMED);
    double best = 0.0;
    cv::Point peak;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &peak);
    constexpr double kAccepted = 0.7;
    if (best < kAccepted || peak.x < 1 || peak.y < 1 ||
        peak.x + 1 >= score.cols || peak.y + 1 >= score.rows) {
      continue;
    }
    const auto s = [&](int x, int y) {
      return static_cast<double>(score.at<float>(peak.y + y, peak.x + x));
    };
    points.push_back({i, peak.x + Vertex(s(-1, 0), s(0, 0), s(1, 0)) + dx,
                      peak.y + Vertex(s(0, -1), s(0, 0), s(0, 1)) + dy});
  }
  return points;
}

}  // namespace touchdown::accuracy
