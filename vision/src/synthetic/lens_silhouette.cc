#include "synthetic/lens_silhouette.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace touchdown::vision {
namespace {

// The image, through the lens, of an outline in the ideal picture: sides no
// longer than a pixel (a side of L px on a curve of radius R is off by
// L^2 / (8 R); lenses bend lines to R of hundreds of px at least).
ShapeOutline BendOutline(const calib::Lens& lens,
                         const std::vector<core::PixelPoint>& corners) {
  std::vector<core::PixelPoint> bent;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const core::PixelPoint& a = corners[i];
    const core::PixelPoint& b = corners[(i + 1) % corners.size()];
    const int steps = std::max(1, static_cast<int>(std::ceil(std::hypot(
                                      b.x_px - a.x_px, b.y_px - a.y_px))));
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      bent.push_back(calib::Distort(lens, {a.x_px + t * (b.x_px - a.x_px),
                                           a.y_px + t * (b.y_px - a.y_px)}));
    }
  }
  return PolygonOutline(bent);
}

// A body that would be seen far outside the picture, where the lens model may
// fold back, is not seen.
bool IsFarOutOfView(const SceneCamera& camera, core::PixelPoint centre,
                    double reach_px) {
  const double margin = reach_px + 0.25 * (camera.width_px + camera.height_px);
  return centre.x_px < -margin || centre.x_px > camera.width_px + margin ||
         centre.y_px < -margin || centre.y_px > camera.height_px + margin;
}

// The body's corners in the ideal picture; a disc as a polygon of the disc's
// own area, off its circle by less than 1e-4 px at sides of a quarter pixel.
std::vector<core::PixelPoint> IdealOutline(const Scene& scene,
                                           const ScenePose& pose) {
  std::vector<core::PixelPoint> corners;
  if (scene.body.kind != core::BodyKind::kSphere) {
    for (const core::PlanePoint& p : Corners(scene.body, pose)) {
      corners.push_back(ToIdealImage(scene.camera, p));
    }
    return corners;
  }
  const core::PixelPoint c = ToIdealImage(scene.camera, pose.centre);
  // With a yaw it is drawn as a sphere, which is seen round, at its depth.
  const double r = 0.5 * scene.body.diameter_m->value * scene.camera.px_per_m /
                   RelativeDepth(scene.camera, pose.centre);
  // px of a side: the polygon is off the circle by side^2 / (8 r).
  constexpr double kSide_px = 0.25;
  const int sides =
      std::max(64, static_cast<int>(2.0 * std::numbers::pi * r / kSide_px));
  const double step = 2.0 * std::numbers::pi / sides;
  // A polygon on the circle is smaller than the disc: its corners move outward
  // until the areas are equal.
  const double equal_area = r * std::sqrt(step / std::sin(step));
  for (int k = 0; k < sides; ++k) {
    corners.push_back({c.x_px + equal_area * std::cos(k * step),
                       c.y_px + equal_area * std::sin(k * step)});
  }
  return corners;
}

}  // namespace

Silhouette DrawThroughLens(const Scene& scene, const ScenePose& pose,
                           const HalfPlane& ground) {
  const SceneCamera& camera = scene.camera;
  const std::vector<core::PixelPoint> corners = IdealOutline(scene, pose);
  const core::PixelPoint centre = ToIdealImage(camera, pose.centre);
  double reach = 0.0;
  for (const core::PixelPoint& p : corners) {
    reach =
        std::max(reach, std::hypot(p.x_px - centre.x_px, p.y_px - centre.y_px));
  }
  // No outline; its box lies outside the picture.
  if (IsFarOutOfView(camera, centre, reach)) return {{}, {}, -9, -9, -9, -9};
  const auto below = ClipPolygon(corners, ground);
  Silhouette out{
      BendOutline(*camera.lens, corners),
      below.empty() ? ShapeOutline{} : BendOutline(*camera.lens, below),
      1e9,
      -1e9,
      1e9,
      -1e9};
  for (const OutlinePiece& piece : out.body.pieces) {
    out.min_x = std::min(out.min_x, piece.from.x_px);
    out.max_x = std::max(out.max_x, piece.from.x_px);
    out.min_y = std::min(out.min_y, piece.from.y_px);
    out.max_y = std::max(out.max_y, piece.from.y_px);
  }
  return out;
}

ShapeOutline GroundThroughLens(const SceneCamera& camera, double margin) {
  const calib::Lens& lens = *camera.lens;
  const double slope = std::tan(IdealGroundAngle(camera));
  std::vector<core::PixelPoint> outline;
  // From where the line is seen left of the picture to where right of it. The
  // model may fold back out there: then the last point before it must do, and
  // the picture's own width is safe (Validate).
  const double width = camera.width_px;
  for (int step = 0; step <= 2 * camera.width_px; ++step) {
    const double x = -0.5 * width + step;
    const core::PixelPoint seen = calib::Distort(
        lens,
        {x, camera.ground_point.y_px + slope * (x - camera.ground_point.x_px)});
    if (seen.x_px < -margin || seen.x_px > width + margin) continue;
    if (!outline.empty() && seen.x_px <= outline.back().x_px) continue;
    outline.push_back(seen);
  }
  if (outline.empty()) return {};
  // Straight on to the margins, then around below.
  outline.insert(outline.begin(), {-margin - 1.0, outline.front().y_px});
  outline.push_back({width + margin + 1.0, outline.back().y_px});
  const double bottom =
      std::max({camera.height_px + margin, outline.front().y_px + 1.0,
                outline.back().y_px + 1.0});
  outline.push_back({width + margin + 1.0, bottom});
  outline.push_back({-margin - 1.0, bottom});
  return PolygonOutline(outline);
}

}  // namespace touchdown::vision
