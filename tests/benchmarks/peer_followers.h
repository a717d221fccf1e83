// The pixels' part of the peers: where each sees the body, frame by frame.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "tests/accuracy/design.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::accuracy {

// In the image, px.
struct Point {
  std::int64_t frame = 0;
  double x = 0.0;
  double y = 0.0;
};

cv::Mat Picture(vision::Clip& clip, std::int64_t index);  // CV_32F, DN
double FullScale(const vision::Clip& clip);               // DN

// The mask's largest contour by area, against MOG2's model of the frames before
// the body.
std::vector<Point> FollowMog2(vision::Clip& clip);

// The largest contour of what is off the mean of the frames before the body by
// more than half of the true contrast.
std::vector<Point> FollowCentroid(vision::Clip& clip, const Case& c);

// Normalised correlation with the body as it looks in the middle of its
// approach, and a parabola through the peak.
std::vector<Point> FollowTemplate(vision::Clip& clip, const Case& c);

#ifdef TOUCHDOWN_HAS_CSRT
// OpenCV's TrackerCSRT (the one with fractional boxes) from the body's true box
// in the first frame that shows it.
std::vector<Point> FollowCsrt(vision::Clip& clip, const Case& c);
#endif

}  // namespace touchdown::accuracy
