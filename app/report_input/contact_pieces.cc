// From an analysis to a strip of pictures: PosesToShow() picks the frames
// before, at and after touchdown, ChoosePiece() the part of the picture that
// holds the body in all of them. The pieces are read and averaged down,
// stretched to one range of grey, and given the outline, the ground line and
// the flights as lines in px of the whole picture.
#include "app/report_input/contact_pieces.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "app/measure/undistorted_clip.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/footage/encode_image.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::pipeline {
namespace {

using core::PixelPoint;
using core::PixelRect;

// The body travels so much of its size from a picture to the next, where the
// recording has frames for it.
constexpr double kTravel = 0.6;
// About the outlines, in sizes of the body.
constexpr double kMargin = 0.2;
// Five strips of three fit on a page of A4.
constexpr double kAspect = 1.5;
constexpr std::int32_t kLeastWidth_px = 48;
// Wider pieces are averaged down: a page shows no more samples.
constexpr std::int32_t kMostSamples = 320;

// Diameter of a sphere, long side of a rectangle, in px.
double GreatestSize(const vision::BodyImage& body) {
  return body.kind == core::BodyKind::kSphere ? 2 * body.radius_px.value
                                              : 2 * body.half_long_px.value;
}

// The body's outline at a pose as a closed polygon, in px of the picture: 72
// corners for a sphere, four for a rectangle.
std::vector<PixelPoint> TraceOutline(const vision::BodyImage& body,
                                     const vision::Pose& pose) {
  std::vector<PixelPoint> out;
  const double c = std::cos(pose.angle_rad);
  const double s = std::sin(pose.angle_rad);
  // A point of the body, given along and across its long side, turned and moved
  // to the pose. `relative_size` is the body's size in this frame over that of
  // the whole track.
  const auto add = [&](double along, double across) {
    out.push_back(
        {pose.centre.x_px + pose.relative_size * (along * c - across * s),
         pose.centre.y_px + pose.relative_size * (along * s + across * c)});
  };
  if (body.kind == core::BodyKind::kSphere) {
    constexpr int kCorners = 72;
    for (int i = 0; i < kCorners; ++i) {
      const double turn = 2 * std::numbers::pi * i / kCorners;
      add(body.radius_px.value * std::cos(turn),
          body.radius_px.value * std::sin(turn));
    }
    return out;
  }
  const double a = body.half_long_px.value;
  const double b = body.half_short_px.value;
  add(a, b);
  add(a, -b);
  add(-a, -b);
  add(-a, b);
  return out;
}

// The poses to show: before, at, after; fewer where the track has fewer.
// Without a contact the middle of the track stands for it.
std::vector<const vision::Pose*> PosesToShow(const vision::Track& track,
                                             const Analysis& analysis) {
  const auto& poses = track.poses;
  const core::Contact& contact = analysis.contacts.first.contact;
  std::size_t at = poses.size() / 2;
  if (contact.frame) {
    const auto frame =
        static_cast<std::int64_t>(std::lround(contact.frame->value));
    // Poses are sorted by frame, but the body may not have been found in the
    // frame of the touchdown: then the next one after it is shown.
    const auto found = std::lower_bound(
        poses.begin(), poses.end(), frame,
        [](const vision::Pose& p, std::int64_t f) { return p.frame < f; });
    at = found == poses.end() ? poses.size() - 1
                              : static_cast<std::size_t>(found - poses.begin());
  }
  const double far = kTravel * GreatestSize(track.body);
  const auto away = [&](std::size_t i) {
    return std::hypot(poses[i].centre.x_px - poses[at].centre.x_px,
                      poses[i].centre.y_px - poses[at].centre.y_px);
  };
  // Steps away from the touchdown until the body has moved far enough for its
  // outlines not to hide each other, or the track ends.
  std::size_t before = at;
  while (before > 0 && (before == at || away(before) < far)) --before;
  std::size_t after = at;
  while (after + 1 < poses.size() && (after == at || away(after) < far)) {
    ++after;
  }
  std::vector<const vision::Pose*> out;
  for (const std::size_t i : {before, at, after}) {
    if (out.empty() || out.back() != &poses[i]) out.push_back(&poses[i]);
  }
  return out;
}

// One piece for all pictures, so that the ground lies at one height in them:
// whole px of the picture, of the shape kAspect unless the picture is smaller.
// `size` is the body's, in px.
PixelRect ChoosePiece(const std::vector<std::vector<PixelPoint>>& outlines,
                      const std::optional<PixelPoint>& touching, double size,
                      const vision::ClipInfo& info) {
  double left = 1e300;
  double right = -1e300;
  double top = 1e300;
  double bottom = -1e300;
  const auto include = [&](PixelPoint p) {
    left = std::min(left, p.x_px);
    right = std::max(right, p.x_px);
    top = std::min(top, p.y_px);
    bottom = std::max(bottom, p.y_px);
  };
  for (const auto& outline : outlines) {
    for (const PixelPoint p : outline) include(p);
  }
  if (touching) include(*touching);
  const double margin = kMargin * size;
  double width = std::max<double>(kLeastWidth_px, right - left + 2 * margin);
  double height = bottom - top + 2 * margin;
  // The side that is too short for the aspect grows; nothing is cut off.
  if (width < kAspect * height) {
    width = kAspect * height;
  } else {
    height = width / kAspect;
  }
  // The body's way leads down to the ground: room is added above it.
  const double x = 0.5 * (left + right) - 0.5 * width;
  const double y = bottom + margin - height;
  // Moves a stretch into the picture. One that is longer than the picture
  // becomes the whole of it.
  const auto within = [](double begin, double length, std::int32_t all) {
    const auto whole =
        std::min(all, static_cast<std::int32_t>(std::lround(length)));
    const auto first = static_cast<std::int32_t>(std::lround(begin));
    return std::pair(std::clamp(first, 0, all - whole), whole);
  };
  const auto [x_px, width_px] = within(x, width, info.width_px);
  const auto [y_px, height_px] = within(y, height, info.height_px);
  return {x_px, y_px, width_px, height_px};
}

// Grey levels of a piece, averaged over squares of `step` px, row by row from
// the top; in the units of the recording (0 to 4095 for 12 bits).
struct Levels {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<float> level;
};

// Columns and rows at the end that fill no whole square are left out.
Levels Averaged(const core::Frame& frame, std::int32_t step) {
  Levels out{frame.width_px / step, frame.height_px / step, {}};
  for (std::int32_t y = 0; y < out.height; ++y) {
    for (std::int32_t x = 0; x < out.width; ++x) {
      std::uint64_t sum = 0;
      for (std::int32_t v = 0; v < step; ++v) {
        for (std::int32_t u = 0; u < step; ++u) {
          sum += frame.at(x * step + u, y * step + v);
        }
      }
      out.level.push_back(static_cast<float>(sum) /
                          static_cast<float>(step * step));
    }
  }
  return out;
}

// Black and white of all pieces together: one sample in 200 lies beyond each,
// so that a lamp's reflection does not darken the rest. One range for all, as
// the pictures are compared with each other. White is above black always.
std::pair<float, float> Span(const std::vector<Levels>& pieces) {
  std::vector<float> all;
  for (const Levels& piece : pieces) {
    all.insert(all.end(), piece.level.begin(), piece.level.end());
  }
  if (all.empty()) return {0.0F, 1.0F};
  std::sort(all.begin(), all.end());
  const std::size_t beyond = all.size() / 200;
  const float black = all[beyond];
  return {black, std::max(black + 1.0F, all[all.size() - 1 - beyond])};
}

// The bytes of a PNG of 8 bits: black and white of `span` become 0 and 255, and
// what lies beyond them is cut off.
std::string Png(const Levels& piece, std::pair<float, float> span) {
  vision::Image image;
  image.width_px = piece.width;
  image.height_px = piece.height;
  image.pixels.reserve(piece.level.size());
  for (const float level : piece.level) {
    const float share = (level - span.first) / (span.second - span.first);
    image.pixels.push_back(static_cast<std::byte>(
        std::lround(255.0F * std::clamp(share, 0.0F, 1.0F))));
  }
  return vision::EncodePng(image.View());
}

// The fitted flight of the centre between two times as a line of 32 straight
// pieces in the picture; the bend within one is too small to be seen.
std::vector<PixelPoint> FlightLine(const vision::PlaneTrack& plane,
                                   const vision::Flight& flight, double from_s,
                                   double to_s) {
  constexpr int kPieces = 32;
  std::vector<PixelPoint> out;
  for (int i = 0; i <= kPieces; ++i) {
    const vision::FlightState s =
        flight.At(from_s + (to_s - from_s) * i / kPieces);
    out.push_back(vision::ToImage(plane, s.along_px, s.height_px));
  }
  return out;
}

// "before: frame 40, 14.30 ms earlier"; the frame alone where there is no time
// of touchdown. Within one frame of the contact it says "touchdown".
std::string Label(const vision::Pose& pose, const core::Contact& contact) {
  if (!contact.time_s || !contact.frame) {
    return fmt::format("frame {}", pose.frame);
  }
  const double late_ms = (pose.time_s - contact.time_s->value) * 1e3;
  const double off =
      std::abs(static_cast<double>(pose.frame) - contact.frame->value);
  const char* when = off <= 1.0    ? "touchdown"
                     : late_ms < 0 ? "before"
                                   : "after";
  return fmt::format("{}: frame {}, {:.2f} ms {}", when, pose.frame,
                     std::abs(late_ms), late_ms < 0 ? "earlier" : "later");
}

}  // namespace

report::ContactStrip TakeStrip(const Analysis& analysis) {
  // Lines are straight only in a picture without the lens: the recording and
  // its track are straightened where a lens was undone in the analysis.
  const Drawable drawable = OpenToDraw(analysis);
  const vision::Track& track = drawable.track;
  const vision::PlaneTrack& plane = *analysis.plane;
  const core::Contact& contact = analysis.contacts.first.contact;
  // The first contact alone is shown; where none was found there is no
  // evidence, and the strip has neither flights nor a contact point.
  const vision::ContactEvidence* evidence =
      analysis.contacts.evidence.empty() ? nullptr
                                         : &analysis.contacts.evidence.front();
  const std::vector<const vision::Pose*> poses = PosesToShow(track, analysis);
  std::vector<std::vector<PixelPoint>> outlines;
  for (const vision::Pose* pose : poses) {
    outlines.push_back(TraceOutline(track.body, *pose));
  }
  std::optional<PixelPoint> touching;
  if (evidence != nullptr && evidence->before) touching = evidence->touching;
  const PixelRect piece = ChoosePiece(
      outlines, touching, GreatestSize(track.body), drawable.clip->info());
  // The least step that leaves at most kMostSamples on the longer side.
  const std::int32_t step =
      std::max(1, (std::max(piece.width, piece.height) + kMostSamples - 1) /
                      kMostSamples);
  std::vector<Levels> levels;
  for (const vision::Pose* pose : poses) {
    // Only the piece is read: raw recordings are mapped, and three small
    // windows touch little of them.
    levels.push_back(Averaged(drawable.clip->Read(pose->frame, piece), step));
  }
  const auto span = Span(levels);
  // The ground line is drawn through the piece's middle, `far` px to either
  // side: longer than the piece in any direction. The viewer cuts it at the
  // edges.
  const double angle = calib::ImageAngle(plane.ground);
  const double far = 2.0 * (piece.width + piece.height);
  const auto on_ground = [&](double along) {
    return PixelPoint{plane.ground.reference.x_px + along * std::cos(angle),
                      plane.ground.reference.y_px + along * std::sin(angle)};
  };
  const double middle = calib::PositionOnLine(
      plane.ground,
      {piece.x + 0.5 * piece.width, piece.y + 0.5 * piece.height});
  report::ContactStrip out;
  if (analysis.scale) out.px_per_m = analysis.scale->px_per_m.value;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    report::StripPicture picture;
    picture.label = Label(*poses[i], contact);
    picture.png = Png(levels[i], span);
    // The last samples of a piece that no whole step covers are not shown.
    picture.piece = {piece.x, piece.y, levels[i].width * step,
                     levels[i].height * step};
    picture.outline = outlines[i];
    picture.ground = {on_ground(middle - far), on_ground(middle + far)};
    // The flight before touchdown begins with the first picture, or where the
    // track has samples over the ground.
    if (evidence != nullptr && evidence->before) {
      picture.before = FlightLine(
          plane, *evidence->before,
          std::max(poses.front()->time_s, plane.samples.front().time_s),
          evidence->time_s);
      // Between touchdown and release the body is on the ground and no flight
      // is drawn.
      if (evidence->after) {
        picture.after =
            FlightLine(plane, *evidence->after, evidence->release_s,
                       std::max(evidence->release_s, poses.back()->time_s));
      }
      picture.touching = touching;
    }
    out.pictures.push_back(std::move(picture));
  }
  return out;
}

}  // namespace touchdown::pipeline
