// Draws what scene_trouble.h describes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "synthetic/coverage.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {

// The ground's visible edge, closed by the picture's lower border widened by
// `margin`.
std::vector<core::PixelPoint> WavyGround(const SceneCamera& camera,
                                         const SceneTrouble& trouble,
                                         double margin);

class TroubleRenderer {
 public:
  explicit TroubleRenderer(const Scene& scene);

  // What the plain picture consists of, a number a pixel; in DN where not a
  // share.
  struct Layers {
    const std::vector<float>& light;         // illumination times full scale
    const std::vector<float>& ground;        // ground minus background
    const std::vector<float>& ground_share;  // empty where it is not needed
    const CoverageMap& body;
  };
  void Draw(const Scene& scene, double time_s, const Layers& layers,
            CleanImage& image) const;

 private:
  struct Speck {
    core::PixelPoint start;
    core::PixelPoint velocity;  // px a frame
  };
  void DrawShadow(const Scene& scene, const ScenePose& pose,
                  const Layers& layers, CleanImage& image) const;
  void DrawSpecks(const Scene& scene, double time_s, const Layers& layers,
                  CleanImage& image) const;
  void DrawShading(const Scene& scene, const ScenePose& pose,
                   const Layers& layers, CleanImage& image) const;

  std::vector<Speck> specks_;
  std::optional<CoverageMap> obstacle_;
};

}  // namespace touchdown::vision
