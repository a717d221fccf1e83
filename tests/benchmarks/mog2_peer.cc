// What a general pipeline does with a clip: OpenCV's MOG2, the largest contour,
// its centroid. Timed by tests/benchmarks/analyze; prints the frames in which
// it saw something. Usage: touchdown_mog2_peer CLIP
#include <fmt/core.h>

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <vector>

#include "touchdown/vision/footage/clip.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: touchdown_mog2_peer CLIP\n");
    return 2;
  }
  touchdown::vision::ClipOptions options;
  options.fps = 4000.0;
  const auto clip = touchdown::vision::OpenClip(argv[1], options);
  const auto mog2 = cv::createBackgroundSubtractorMOG2(200, 16.0, false);
  int seen = 0;
  double sum = 0.0;
  for (std::int64_t index = 0; index < clip->info().frames; ++index) {
    const touchdown::core::Frame frame = clip->Read(index);
    cv::Mat picture(frame.height_px, frame.width_px,
                    frame.is_16_bit() ? CV_16UC1 : CV_8UC1,
                    const_cast<std::byte*>(frame.data),
                    static_cast<std::size_t>(frame.stride_bytes));
    // It takes eight bits.
    if (frame.is_16_bit()) {
      picture.convertTo(picture, CV_8U, 255.0 / frame.full_scale());
    }
    cv::Mat mask;
    mog2->apply(picture, mask);
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(mask, contours, cv::RETR_EXTERNAL,
                     cv::CHAIN_APPROX_SIMPLE);
    double most = 0.0;
    for (const auto& contour : contours) {
      const cv::Moments m = cv::moments(contour);
      if (m.m00 <= most) continue;
      most = m.m00;
      sum += m.m10 / m.m00;
    }
    if (most > 0.0) ++seen;
  }
  fmt::print("{} frames, {:.1f}\n", seen, sum);
  return 0;
}
