#include "touchdown/vision/overlay/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "footage/opencv_bridge.h"
#include "outline/track_shape.h"
#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

// Colours that stay apart for colour-blind eyes (Okabe and Ito), RGB.
const cv::Scalar kOutlineColour(240, 228, 66);
const cv::Scalar kGroundColour(86, 180, 233);
const cv::Scalar kBeforeColour(0, 200, 140);
const cv::Scalar kAfterColour(230, 130, 190);
const cv::Scalar kPathColour(255, 255, 255);
const cv::Scalar kText(255, 255, 255);
// Height of the title's line above the panels: one line of text.
constexpr int kTitle_px = 34;

// One panel: a square of the picture, enlarged.
class Panel {
 public:
  Panel(cv::Mat canvas, const core::Frame& frame, core::PixelPoint centre,
        double side_px)
      : canvas_(std::move(canvas)) {
    zoom_ = canvas_.cols / side_px;
    left_ = centre.x_px - 0.5 * side_px;
    top_ = centre.y_px - 0.5 * side_px;
    cv::Mat eight;
    AsMat(frame).convertTo(eight, CV_8U,
                           255.0 / static_cast<double>(frame.full_scale()));
    // Nearest neighbour: the pixels are what was measured.
    const cv::Mat map = (cv::Mat_<double>(2, 3) << zoom_, 0.0, -left_ * zoom_,
                         0.0, zoom_, -top_ * zoom_);
    cv::Mat gray;
    cv::warpAffine(eight, gray, map, canvas_.size(), cv::INTER_NEAREST,
                   cv::BORDER_CONSTANT, cv::Scalar(24));
    cv::cvtColor(gray, canvas_, cv::COLOR_GRAY2RGB);
  }

  void Line(core::PixelPoint a, core::PixelPoint b, const cv::Scalar& colour,
            int width = 1) {
    cv::line(canvas_, At(a), At(b), colour, width, cv::LINE_AA, kShift);
  }
  void Circle(core::PixelPoint centre, double radius_px,
              const cv::Scalar& colour) {
    cv::circle(canvas_, At(centre),
               static_cast<int>(std::lround(radius_px * zoom_ * (1 << kShift))),
               colour, 1, cv::LINE_AA, kShift);
  }
  // A dot of two pixels of the sheet.
  void Dot(core::PixelPoint p, const cv::Scalar& colour) {
    cv::circle(canvas_, At(p), 2 << kShift, colour, cv::FILLED, cv::LINE_AA,
               kShift);
  }
  // Line 0 stands at the panel's top.
  void Text(const std::string& text, int line) {
    const cv::Point at(8, 20 + 18 * line);
    // A dark rim keeps the text readable on any picture.
    cv::putText(canvas_, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45,
                cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
    cv::putText(canvas_, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, kText, 1,
                cv::LINE_AA);
  }

 private:
  // Binary digits of OpenCV's fixed-point coordinates: a 16th of a pixel.
  static constexpr int kShift = 4;
  // A place of the picture in the panel's fixed-point coordinates, within what
  // OpenCV can draw.
  cv::Point At(core::PixelPoint p) const {
    // Nearest neighbour: the enlarged square of a pixel lies about its centre.
    const auto fixed = [&](double v) {
      return static_cast<int>(std::lround(
          std::clamp(v * zoom_, -30000.0, 30000.0) * (1 << kShift)));
    };
    return {fixed(p.x_px - left_), fixed(p.y_px - top_)};
  }

  cv::Mat canvas_;
  double zoom_ = 1.0;
  double left_ = 0.0;
  double top_ = 0.0;
};

// The outline as it was fitted: a circle, or four sides.
void DrawOutline(Panel& panel, const Outline& outline) {
  if (outline.kind == core::BodyKind::kSphere) {
    panel.Circle(outline.centre, outline.radius_px, kOutlineColour);
    return;
  }
  const double c = std::cos(outline.angle_rad);
  const double s = std::sin(outline.angle_rad);
  const auto corner = [&](double u, double v) {
    return core::PixelPoint{outline.centre.x_px + u * c - v * s,
                            outline.centre.y_px + u * s + v * c};
  };
  const double a = outline.half_long_px;
  const double b = outline.half_short_px;
  const core::PixelPoint p[4] = {corner(a, b), corner(a, -b), corner(-a, -b),
                                 corner(-a, b)};
  for (int i = 0; i < 4; ++i) panel.Line(p[i], p[(i + 1) % 4], kOutlineColour);
}

// A flight between two times as a polyline, seen through yaw and ground line
// like the measurement.
void DrawFlight(Panel& panel, const PlaneTrack& plane, const Flight& flight,
                double from_s, double to_s, const cv::Scalar& colour) {
  // Pieces: the parabola of a flight looks smooth.
  constexpr int kPieces = 40;
  for (int i = 0; i < kPieces; ++i) {
    const auto at = [&](int k) {
      const FlightState s =
          flight.At(from_s + (to_s - from_s) * k / double{kPieces});
      return ToImage(plane, s.along_px, s.height_px);
    };
    panel.Line(at(i), at(i + 1), colour, 2);
  }
}

// Frames to show: around the contact, about a quarter of the body apart, or
// each frame if the body moves more than that between two. Without a contact,
// evenly over the track.
std::vector<std::int64_t> FramesToShow(const Track& track,
                                       const ContactResult& contacts,
                                       int count) {
  const std::int64_t first = track.poses.front().frame;
  const std::int64_t last = track.poses.back().frame;
  std::vector<std::int64_t> frames;
  const core::Contact& contact = contacts.first.contact;
  if (!contact.found || !contact.frame) {
    for (int k = 0; k < count; ++k) {
      frames.push_back(first + (last - first) * k / std::max(1, count - 1));
    }
  } else {
    const auto at =
        static_cast<std::int64_t>(std::lround(contact.frame->value));
    double path = 0.0;
    for (std::size_t i = 1; i < track.poses.size(); ++i) {
      path += std::hypot(
          track.poses[i].centre.x_px - track.poses[i - 1].centre.x_px,
          track.poses[i].centre.y_px - track.poses[i - 1].centre.y_px);
    }
    const double per_frame =
        path / static_cast<double>(std::max<std::int64_t>(1, last - first));
    const double size = track.body.kind == core::BodyKind::kSphere
                            ? 2.0 * track.body.radius_px.value
                            : 2.0 * track.body.half_long_px.value;
    const auto step = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(0.25 * size / std::max(per_frame, 1e-3)));
    for (int k = 0; k < count; ++k) {
      frames.push_back(std::clamp(at + (k - count / 2) * step, first, last));
    }
  }
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

// The pose of a frame, or null where none was measured.
const Pose* MeasuredPose(const Track& track, std::int64_t frame) {
  const auto it = std::lower_bound(
      track.poses.begin(), track.poses.end(), frame,
      [](const Pose& p, std::int64_t f) { return p.frame < f; });
  return it != track.poses.end() && it->frame == frame ? &*it : nullptr;
}

}  // namespace

ColourImage DrawContactSheet(Clip& clip, const Track& track,
                             const PlaneTrack& plane,
                             const ContactResult& contacts,
                             const ContactSheetOptions& options) {
  ColourImage sheet;
  if (track.poses.empty()) return sheet;
  const std::vector<std::int64_t> frames =
      FramesToShow(track, contacts, options.columns * options.rows);
  const int side = options.panel_px;
  const int rows =
      (static_cast<int>(frames.size()) + options.columns - 1) / options.columns;
  cv::Mat canvas(rows * side + kTitle_px, options.columns * side, CV_8UC3,
                 cv::Scalar(16, 16, 16));
  cv::putText(canvas, options.title, {10, 23}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              kText, 1, cv::LINE_AA);
  const core::Contact& contact = contacts.first.contact;
  const ContactEvidence* evidence =
      contacts.evidence.empty() ? nullptr : &contacts.evidence.front();
  const double extent = track.body.kind == core::BodyKind::kSphere
                            ? track.body.radius_px.value
                            : std::hypot(track.body.half_long_px.value,
                                         track.body.half_short_px.value);
  // Side of a panel in units of the body's extent: the body and its way beside
  // it. Smaller enlarges more. Chosen by eye.
  constexpr double kExtentsPerPanel = 4.5;
  // At least 24 px, so that a small body is not enlarged without end.
  const double view_px = std::max(24.0, kExtentsPerPanel * extent);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const int column = static_cast<int>(k) % options.columns;
    const int row = static_cast<int>(k) / options.columns;
    const cv::Rect at(column * side + 1, row * side + kTitle_px + 1, side - 2,
                      side - 2);
    const Pose* pose = MeasuredPose(track, frames[k]);
    core::PixelPoint centre = track.poses.front().centre;
    if (pose != nullptr) {
      centre = pose->centre;
    } else if (evidence != nullptr) {
      centre = evidence->centre;
    }
    // The whole frame: a panel shows whatever of it lies in view.
    const core::Frame frame = clip.Read(frames[k]);
    cv::Mat target = canvas(at);
    Panel panel(target, frame, centre, view_px);
    const calib::GroundLine& g = plane.ground;
    const double angle = calib::ImageAngle(g);
    // Ends of the line far outside of any panel.
    const double far = 4.0 * (clip.info().width_px + clip.info().height_px);
    panel.Line({g.reference.x_px - far * std::cos(angle),
                g.reference.y_px - far * std::sin(angle)},
               {g.reference.x_px + far * std::cos(angle),
                g.reference.y_px + far * std::sin(angle)},
               kGroundColour);
    // Both flights as fitted; where no contact was found, the poses alone.
    if (evidence != nullptr && evidence->before) {
      const double dt = plane.frame_interval_s;
      DrawFlight(
          panel, plane, *evidence->before,
          std::max(evidence->time_s - 400 * dt, plane.samples.front().time_s),
          evidence->time_s, kBeforeColour);
      if (evidence->after) {
        DrawFlight(panel, plane, *evidence->after, evidence->release_s,
                   evidence->release_s + (evidence->after->frames - 1) * dt,
                   kAfterColour);
      }
    } else {
      for (const Pose& p : track.poses) panel.Dot(p.centre, kPathColour);
    }
    if (pose != nullptr) DrawOutline(panel, PlaceOutline(track.body, *pose));
    panel.Text(fmt::format("frame {}", frames[k]), 0);
    for (const PlaneSample& s : plane.samples) {
      if (s.frame == frames[k]) {
        panel.Text(fmt::format("gap {:.2f} +- {:.2f} px", s.gap_px, s.u_gap_px),
                   1);
      }
    }
    const bool is_contact =
        contact.frame &&
        std::lround(contact.frame->value) == static_cast<long>(frames[k]);
    if (is_contact && contact.approach_angle_rad && evidence != nullptr) {
      panel.Text(fmt::format("touchdown at {:.3f}", contact.frame->value), 2);
      panel.Text(fmt::format("approach {:.3f} +- {:.3f} deg",
                             contact.approach_angle_rad->value / core::kDegree,
                             contact.approach_angle_rad->u / core::kDegree),
                 3);
      // The direction of approach through the contact point, and beyond.
      const FlightState s = evidence->before->At(evidence->time_s);
      const double speed = std::max(1e-12, std::hypot(s.v_t, s.v_n));
      const double reach = 1.6 * extent;
      panel.Line(ToImage(plane, s.along_px - reach * s.v_t / speed,
                         s.height_px - reach * s.v_n / speed),
                 ToImage(plane, s.along_px + reach * s.v_t / speed,
                         s.height_px + reach * s.v_n / speed),
                 kBeforeColour, 2);
      panel.Dot(evidence->touching, kOutlineColour);
    }
  }
  sheet.width_px = canvas.cols;
  sheet.height_px = canvas.rows;
  sheet.rgb.assign(canvas.data, canvas.data + canvas.total() * 3);
  return sheet;
}

}  // namespace touchdown::vision
