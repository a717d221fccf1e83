// Outlines seen through a lens: what the renderer draws where a scene's camera
// has one.
#pragma once

#include "synthetic/coverage.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::vision {

// The outline's images at one instant: the body, and its part below the ground
// line (empty where the motion is physical).
struct Silhouette {
  ShapeOutline body;
  ShapeOutline below;
  double min_x, max_x, min_y, max_y;
};

// The body's outlines; `ground` is the half-plane below the ground line in the
// ideal picture.
Silhouette DrawThroughLens(const Scene& scene, const ScenePose& pose,
                           const HalfPlane& ground);

// The ground's image, wider than the picture by `margin`, px.
ShapeOutline GroundThroughLens(const SceneCamera& camera, double margin);

}  // namespace touchdown::vision
