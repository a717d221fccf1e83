// What a general tracker does with a clip: OpenCV's TrackerCSRT, given the
// body's box in one frame, on the frames after it. Timed by
// tests/benchmarks/analyze; prints the time a frame, without start-up and
// without reading. Usage: touchdown_csrt_peer CLIP FIRST COUNT X Y WIDTH HEIGHT
#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <opencv2/imgproc.hpp>
#include <opencv2/tracking.hpp>
#include <opencv2/tracking/tracking_legacy.hpp>

#include "touchdown/vision/footage/clip.h"

namespace {

cv::Mat Coloured(touchdown::vision::Clip& clip, std::int64_t index) {
  const touchdown::core::Frame frame = clip.Read(index);
  cv::Mat picture(frame.height_px, frame.width_px,
                  frame.is_16_bit() ? CV_16UC1 : CV_8UC1,
                  const_cast<std::byte*>(frame.data),
                  static_cast<std::size_t>(frame.stride_bytes));
  // It takes eight bits and colours.
  if (frame.is_16_bit()) {
    picture.convertTo(picture, CV_8U, 255.0 / frame.full_scale());
  }
  cv::Mat coloured;
  cv::cvtColor(picture, coloured, cv::COLOR_GRAY2BGR);
  return coloured;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 8) {
    fmt::print(stderr,
               "usage: touchdown_csrt_peer CLIP FIRST COUNT X Y WIDTH "
               "HEIGHT\n");
    return 2;
  }
  const auto number = [&](int i) { return std::strtod(argv[i], nullptr); };
  touchdown::vision::ClipOptions options;
  options.fps = 4000.0;
  const auto clip = touchdown::vision::OpenClip(argv[1], options);
  const auto first = static_cast<std::int64_t>(number(2));
  const auto count = static_cast<std::int64_t>(number(3));
  cv::Rect2d box(number(4), number(5), number(6), number(7));
  const auto tracker = cv::legacy::TrackerCSRT::create();
  double wall_s = 0.0;
  std::clock_t processor = 0;
  int seen = 0;
  for (std::int64_t i = first; i < first + count; ++i) {
    const cv::Mat picture = Coloured(*clip, i);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t start_processor = std::clock();
    if (i == first) {
      tracker->init(picture, box);
    } else if (tracker->update(picture, box)) {
      ++seen;
    }
    processor += std::clock() - start_processor;
    wall_s +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
            .count();
  }
  fmt::print("{:.6f} {:.6f} {} {:.2f} {:.2f}\n",
             wall_s / static_cast<double>(count),
             static_cast<double>(processor) / CLOCKS_PER_SEC /
                 static_cast<double>(count),
             seen, box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  return 0;
}
