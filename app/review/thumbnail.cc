#include "app/review/thumbnail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/documents/replay.h"
#include "app/measure/undistorted_clip.h"

namespace touchdown::review {
namespace {

// Of the body's greatest extent, how much is seen beside it.
constexpr double kBodySizes = 3.0;

// Mean level of the samples in a box, which lies partly or wholly beyond the
// frame; at least the sample nearest to its middle.
template <class Sample>
double BoxMean(const core::Frame& frame, double x0, double y0, double size) {
  // Pixel centres are at integers, so a box from x0 on begins with the sample
  // nearest to x0.
  const auto first = [](double at) { return std::lround(at); };
  const long left = first(x0), top = first(y0);
  const long right = std::max(left + 1, first(x0 + size));
  const long bottom = std::max(top + 1, first(y0 + size));
  double sum = 0.0;
  for (long y = std::max(0L, top); y < std::min<long>(bottom, frame.height_px);
       ++y) {
    const auto* const row = frame.row<Sample>(static_cast<std::int32_t>(y));
    for (long x = std::max(0L, left); x < std::min<long>(right, frame.width_px);
         ++x) {
      sum += row[x];
    }
  }
  // The sum is divided by the whole box: what lies beyond the frame counts as
  // black.
  return sum / static_cast<double>((right - left) * (bottom - top));
}

}  // namespace

vision::Image Shrunk(const core::Frame& frame, core::PixelPoint centre,
                     double width_px, std::uint32_t white) {
  if (!(width_px > 0.0)) {
    throw std::invalid_argument(
        fmt::format("width_px is {}, must be above 0", width_px));
  }
  vision::Image image;
  image.width_px = kThumbnailWidth_px;
  image.height_px = kThumbnailHeight_px;
  // One pixel of the thumbnail is so many pixels of the frame wide and high.
  const double step = width_px / kThumbnailWidth_px;
  const double left = centre.x_px - step * kThumbnailWidth_px / 2.0;
  const double top = centre.y_px - step * kThumbnailHeight_px / 2.0;
  for (int y = 0; y < kThumbnailHeight_px; ++y) {
    for (int x = 0; x < kThumbnailWidth_px; ++x) {
      const double at_x = left + x * step, at_y = top + y * step;
      const double level = frame.is_16_bit()
                               ? BoxMean<std::uint16_t>(frame, at_x, at_y, step)
                               : BoxMean<std::uint8_t>(frame, at_x, at_y, step);
      image.pixels.push_back(
          static_cast<std::byte>(std::min(255.0, level * 255.0 / white)));
    }
  }
  return image;
}

Picture RenderThumbnail(ClipShelf& shelf, const core::Trial& trial) {
  ShownRecording shown{trial.clip.path};
  const vision::ClipInfo info = shelf.Info(shown);
  // Without a contact the whole width of the middle frame is shown.
  core::PixelPoint centre{info.width_px / 2.0, info.height_px / 2.0};
  double width_px = info.width_px;
  std::int64_t frame = info.frames / 2;
  const auto analysis = pipeline::Replay(trial);
  if (analysis && !analysis->contacts.evidence.empty() &&
      trial.first.contact.frame) {
    // The larger of the two is half of the body's greatest extent.
    const vision::BodyImage& body = analysis->track->body;
    centre = analysis->contacts.evidence.front().touching;
    width_px = kBodySizes * 2.0 *
               std::max(body.radius_px.value, body.half_long_px.value);
    frame = std::clamp<std::int64_t>(
        std::llround(trial.first.contact.frame->value), 0, info.frames - 1);
    shown.steady = pipeline::SteadyFrames(*analysis);
  }
  return shelf.Small(shown, frame, centre, width_px);
}

}  // namespace touchdown::review
