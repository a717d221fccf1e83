#include "detection/detect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "detection/changed_pixels.h"
#include "footage/opencv_bridge.h"

namespace touchdown::vision {
namespace {

// The part of the frame that is searched, in the frame's own pixels.
cv::Rect SearchRegion(const core::Frame& frame, const core::PixelRect& wanted) {
  const cv::Rect all(0, 0, frame.width_px, frame.height_px);
  if (wanted.width <= 0 || wanted.height <= 0) return all;
  return all & cv::Rect(wanted.x - frame.origin_x_px,
                        wanted.y - frame.origin_y_px, wanted.width,
                        wanted.height);
}

// Noise of the smoothed difference: a 3 x 3 mean divides a pixel's by three.
// `noise` is the frame's factor on it (flicker, compression).
double SmoothedSigma(const Background& background,
                     const DetectOptions& options) {
  return options.noise * std::sqrt(background.UsualVariance()) / 3.0;
}

// Strength, of regions as of blobs.
template <class Part>
double AreaTimesContrast(const Part& part) {
  return part.area_px2 * std::abs(part.contrast_dn);
}

// Keeps the strongest regions.
template <class Part>
void KeepStrongest(std::vector<Part>& parts, const DetectOptions& options) {
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return AreaTimesContrast(a) > AreaTimesContrast(b);
  });
  if (parts.size() > static_cast<std::size_t>(options.most_blobs)) {
    parts.resize(static_cast<std::size_t>(options.most_blobs));
  }
}

// What a part of the picture differs by, in DN.
using DifferenceIn = std::function<cv::Mat(const cv::Rect& box)>;

// A region that may be a blob, by its outer contour; holes (specular spots)
// count as body.
struct ContourRegion {
  std::vector<cv::Point> contour;
  double area_px2 = 0.0;
  double contrast_dn = 0.0;
};

// Area of a region from its contour, which runs through pixel centres: the
// region reaches half a pixel farther on all sides.
double RegionArea(const std::vector<cv::Point>& contour) {
  return cv::contourArea(contour) + 0.5 * cv::arcLength(contour, true) + 1.0;
}

// Adds the regions within some contours that are large enough.
void AddRegions(std::vector<std::vector<cv::Point>> contours,
                const DifferenceIn& difference, const DetectOptions& options,
                std::vector<ContourRegion>& regions) {
  for (std::vector<cv::Point>& contour : contours) {
    const double area = RegionArea(contour);
    if (area < options.least_area_px2) continue;
    // Mean difference over the filled contour.
    const cv::Rect box = cv::boundingRect(contour);
    cv::Mat mask = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::drawContours(mask, std::vector<std::vector<cv::Point>>{contour}, 0, 255,
                     cv::FILLED, cv::LINE_8, cv::noArray(), 0, -box.tl());
    regions.push_back(
        {std::move(contour), area, cv::mean(difference(box), mask)[0]});
  }
}

// Moments of the filled contour give the centre, the tightest rectangle around
// it sides and angle.
Blob MakeBlob(const ContourRegion& part, const cv::Size& searched,
              const core::PixelPoint& origin) {
  Blob blob;
  blob.area_px2 = part.area_px2;
  blob.contrast_dn = part.contrast_dn;
  const cv::Moments m = cv::moments(part.contour);
  const cv::Rect box = cv::boundingRect(part.contour);
  const double cx = m.m00 > 0.0 ? m.m10 / m.m00 : box.x + 0.5 * (box.width - 1);
  const double cy =
      m.m00 > 0.0 ? m.m01 / m.m00 : box.y + 0.5 * (box.height - 1);
  blob.centre = {cx + origin.x_px, cy + origin.y_px};
  const cv::RotatedRect tight = cv::minAreaRect(part.contour);
  double angle = tight.angle * std::numbers::pi / 180.0;
  double width = static_cast<double>(tight.size.width) + 1.0;
  double height = static_cast<double>(tight.size.height) + 1.0;
  if (height > width) {
    std::swap(width, height);
    angle += 0.5 * std::numbers::pi;
  }
  blob.long_px = width;
  blob.short_px = height;
  blob.angle_rad = std::remainder(angle, std::numbers::pi);
  blob.fill = blob.area_px2 / (width * height);
  blob.at_border = box.x <= 0 || box.y <= 0 ||
                   box.x + box.width >= searched.width ||
                   box.y + box.height >= searched.height;
  return blob;
}

// The strongest regions as blobs: only those are worth moments and rectangles.
std::vector<Blob> MakeBlobs(std::vector<ContourRegion> regions,
                            const cv::Rect& searched, const core::Frame& frame,
                            const DetectOptions& options) {
  KeepStrongest(regions, options);
  const core::PixelPoint origin{
      static_cast<double>(searched.x + frame.origin_x_px),
      static_cast<double>(searched.y + frame.origin_y_px)};
  std::vector<Blob> blobs;
  blobs.reserve(regions.size());
  for (const ContourRegion& part : regions) {
    blobs.push_back(MakeBlob(part, searched.size(), origin));
  }
  return blobs;
}

// A connected region of all that differs, and a bound on the strength of its
// parts.
struct OuterRegion {
  const std::vector<cv::Point>* contour = nullptr;
  cv::Rect box;
  double most = 0.0;
};

// The regions that are large enough, by the bound. In compressed pictures there
// are hundreds of specks, of which none will be among the strongest.
std::vector<OuterRegion> StrongestFirst(
    const std::vector<std::vector<cv::Point>>& contours,
    const DifferenceIn& difference, const DetectOptions& options) {
  std::vector<OuterRegion> out;
  for (const std::vector<cv::Point>& contour : contours) {
    const double area = RegionArea(contour);
    if (area < options.least_area_px2) continue;
    const cv::Rect box = cv::boundingRect(contour);
    const cv::Mat off = difference(box);
    float peak = 0.0F;
    float sum = 0.0F;
    for (int y = 0; y < box.height; ++y) {
      const float* row = off.ptr<float>(y);
      for (int x = 0; x < box.width; ++x) {
        const float size = std::abs(row[x]);
        peak = std::max(peak, size);
        sum += size;
      }
    }
    // RegionArea is at least the number of pixels (Pick's theorem), and of a
    // part, along whose diagonals it is larger, at most sqrt(2) times that.
    out.push_back(
        {&contour, box,
         std::numbers::sqrt2 *
             std::min(area * static_cast<double>(peak), double{sum})});
  }
  std::sort(out.begin(), out.end(),
            [](const OuterRegion& a, const OuterRegion& b) {
              return a.most > b.most;
            });
  return out;
}

// The strength that a further region must have to be among those kept.
double LeastKept(const std::vector<ContourRegion>& found,
                 const DetectOptions& options) {
  const auto kept = static_cast<std::size_t>(options.most_blobs);
  if (found.size() < kept) return 0.0;
  std::vector<double> strengths;
  strengths.reserve(found.size());
  for (const ContourRegion& region : found) {
    strengths.push_back(AreaTimesContrast(region));
  }
  const auto last = strengths.begin() + static_cast<std::ptrdiff_t>(kept) - 1;
  std::nth_element(strengths.begin(), last, strengths.end(), std::greater<>());
  return *last;
}

// Adds the parts of a region that differ strongly.
void AddStrongParts(const OuterRegion& outer, const cv::Mat& magnitude,
                    const DifferenceIn& difference, double threshold,
                    const DetectOptions& options,
                    std::vector<ContourRegion>& found) {
  const cv::Rect& box = outer.box;
  cv::Mat own = cv::Mat::zeros(box.size(), CV_8UC1);
  cv::drawContours(own, std::vector<std::vector<cv::Point>>{*outer.contour}, 0,
                   255, cv::FILLED, cv::LINE_8, cv::noArray(), 0, -box.tl());
  // The region's strong level is the 95th percentile of its difference: a few
  // specks or a highlight do not set it.
  std::vector<float> inside;
  for (int y = 0; y < box.height; ++y) {
    const float* row = magnitude.ptr<float>(y);
    const auto* in = own.ptr<std::uint8_t>(y);
    for (int x = 0; x < box.width; ++x) {
      if (in[x] != 0) inside.push_back(row[x]);
    }
  }
  if (static_cast<double>(inside.size()) < options.least_area_px2) return;
  const auto high =
      inside.begin() + static_cast<std::ptrdiff_t>(inside.size() * 95 / 100);
  std::nth_element(inside.begin(), high, inside.end());
  const double cut =
      std::max(threshold, options.share_of_peak * static_cast<double>(*high));
  const cv::Mat strong = (magnitude > cut) & own;
  std::vector<std::vector<cv::Point>> parts;
  cv::findContours(strong, parts, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE,
                   box.tl());
  AddRegions(std::move(parts), difference, options, found);
}

// What a frame differs from the background by, box by box: of most frames no
// more than the body is asked for. Boxes are in pixels of `region`.
class ChangeFromStill {
 public:
  ChangeFromStill(const core::Frame& frame, const Background& background,
                  const cv::Rect& region)
      : value_(AsMat(frame)(region)),
        still_(cv::Mat(background.height_px, background.width_px, CV_32FC1,
                       const_cast<float*>(background.level.data()))(
            region + cv::Point(frame.origin_x_px, frame.origin_y_px))) {}

  cv::Mat Difference(const cv::Rect& box) const {
    cv::Mat value;
    value_(box).convertTo(value, CV_32F);
    return value - still_(box);
  }

  // Of the 3 x 3 mean.
  cv::Mat Magnitude(const cv::Rect& box) const {
    const cv::Rect around =
        cv::Rect(box.x - 1, box.y - 1, box.width + 2, box.height + 2) &
        cv::Rect({0, 0}, value_.size());
    cv::Mat smooth;
    cv::blur(Difference(around), smooth, {3, 3});
    return cv::abs(smooth(box - around.tl()));
  }

 private:
  cv::Mat value_;
  cv::Mat still_;
};

// Regions that differ from the background after a 3 x 3 mean. kDifference keeps
// the strong part of each region, which leaves out penumbras and faint shadows;
// kChange keeps all of it.
std::vector<Blob> FromDifference(const core::Frame& frame,
                                 const Background& background,
                                 const DetectOptions& options) {
  const cv::Rect region = SearchRegion(frame, options.region);
  if (region.empty()) return {};
  const double threshold =
      options.threshold_sigmas * SmoothedSigma(background, options);
  ChangedPixels changed;
  FindChangedPixels(frame, background,
                    {region.x, region.y, region.width, region.height},
                    static_cast<float>(threshold), changed);
  if (changed.first_row == changed.last_row) return {};
  cv::Mat mask(region.size(), CV_8UC1, changed.mask.data());
  const ChangeFromStill change(frame, background, region);
  const auto difference = [&](const cv::Rect& box) {
    return change.Difference(box);
  };
  const auto magnitude = [&](const cv::Rect& box) {
    return change.Magnitude(box);
  };
  std::vector<ContourRegion> found;
  if (options.detector == Detector::kChange) {
    // px, diameter of the disc that closes and opens the mask: it bridges lines
    // where body and background are alike, and removes what is thin (penumbras,
    // the body's wake in compressed pictures). Larger merges neighbours. Set
    // with the recorded hoops.
    constexpr int kBridge_px = 5;
    const cv::Mat disc =
        cv::getStructuringElement(cv::MORPH_ELLIPSE, {kBridge_px, kBridge_px});
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, disc);
    std::vector<std::vector<cv::Point>> parts;
    cv::findContours(mask.clone(), parts, cv::RETR_EXTERNAL,
                     cv::CHAIN_APPROX_NONE);
    cv::drawContours(mask, parts, -1, 255, cv::FILLED);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, disc);
    cv::findContours(mask, parts, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    AddRegions(std::move(parts), magnitude, options, found);
    return MakeBlobs(std::move(found), region, frame, options);
  }
  std::vector<std::vector<cv::Point>> regions;
  cv::findContours(mask.rowRange(changed.first_row, changed.last_row), regions,
                   cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE,
                   {0, changed.first_row});
  for (const OuterRegion& outer :
       StrongestFirst(regions, difference, options)) {
    if (outer.most < LeastKept(found, options)) break;
    AddStrongParts(outer, magnitude(outer.box), difference, threshold, options,
                   found);
  }
  return MakeBlobs(std::move(found), region, frame, options);
}

// Without a background: the picture's two levels by Otsu's threshold, and the
// regions of either side.
std::vector<Blob> FromLevels(const core::Frame& frame,
                             const DetectOptions& options) {
  const cv::Rect region = SearchRegion(frame, options.region);
  if (region.empty()) return {};
  std::vector<ContourRegion> found;
  cv::Mat value;
  AsMat(frame)(region).convertTo(value, CV_32F);
  cv::blur(value, value, {3, 3});
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(value, &low, &high);
  if (!(high > low)) return {};
  // Otsu's threshold between the two levels.
  cv::Mat eight;
  value.convertTo(eight, CV_8U, 255.0 / (high - low),
                  -255.0 * low / (high - low));
  cv::Mat bright;
  cv::threshold(eight, bright, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  const double mean = cv::mean(value)[0];
  const cv::Mat difference = value - mean;
  for (const cv::Mat& mask : {bright, cv::Mat(~bright)}) {
    std::vector<std::vector<cv::Point>> regions;
    cv::findContours(mask.clone(), regions, cv::RETR_EXTERNAL,
                     cv::CHAIN_APPROX_NONE);
    // Share of the picture: a region that spans more is background.
    constexpr double kMaxShareOfPicture = 0.5;
    std::erase_if(regions, [&](const auto& outer) {
      return RegionArea(outer) >=
             kMaxShareOfPicture * static_cast<double>(region.area());
    });
    AddRegions(
        std::move(regions),
        [&](const cv::Rect& box) { return difference(box); }, options, found);
  }
  return MakeBlobs(std::move(found), region, frame, options);
}

}  // namespace

double Strength(const Blob& blob) { return AreaTimesContrast(blob); }

void KeepLargest(std::vector<Blob>& blobs, const DetectOptions& options) {
  KeepStrongest(blobs, options);
}

std::vector<Blob> DetectBlobs(const core::Frame& frame,
                              const Background& background,
                              const DetectOptions& options) {
  return options.detector == Detector::kLevels
             ? FromLevels(frame, options)
             : FromDifference(frame, background, options);
}

Outline MakeStart(const Blob& blob, core::BodyKind kind) {
  Outline start;
  start.kind = kind;
  start.centre = blob.centre;
  if (kind == core::BodyKind::kSphere) {
    start.radius_px = std::sqrt(blob.area_px2 / std::numbers::pi);
    return start;
  }
  // The box around a blurred rectangle is larger than it: it keeps its
  // proportions and takes its size from the area.
  const double shrink = std::sqrt(std::min(1.0, blob.fill));
  start.half_long_px = 0.5 * blob.long_px * shrink;
  start.half_short_px = 0.5 * blob.short_px * shrink;
  start.angle_rad = blob.angle_rad;
  return start;
}

}  // namespace touchdown::vision
