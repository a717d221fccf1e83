#include "synthetic/render_trouble.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace touchdown::vision {
namespace {

// Index of a pixel in the image's row-by-row list.
std::size_t PixelIndex(const CleanImage& image, std::int32_t x,
                       std::int32_t y) {
  return static_cast<std::size_t>(y) *
             static_cast<std::size_t>(image.width_px) +
         static_cast<std::size_t>(x);
}

// Half the body's greatest and smallest size, px.
struct Halves {
  double greatest;
  double smallest;
};
Halves HalfSizes(const Scene& scene) {
  const double half = 0.5 * scene.camera.px_per_m;
  if (scene.body.kind == core::BodyKind::kSphere) {
    const double radius = half * scene.body.diameter_m->value;
    return {radius, radius};
  }
  return {half * std::max(scene.body.long_m->value, scene.body.short_m->value),
          half * std::min(scene.body.long_m->value, scene.body.short_m->value)};
}

// Share of a pixel that the body covers; 0 outside of what was drawn.
double Covered(const CoverageMap& body, std::int32_t x, std::int32_t y) {
  const core::PixelRect& w = body.window();
  if (x < w.x || y < w.y || x >= w.x + w.width || y >= w.y + w.height) {
    return 0.0;
  }
  return body.row(y)[x - w.x];
}

// `value` moved by whole spans into low..high: specks leave on one side and
// come back on the other.
double Wrapped(double value, double low, double high) {
  const double span = high - low;
  return low + (value - low) - span * std::floor((value - low) / span);
}

}  // namespace

// The ground below a sine, as a polygon.
std::vector<core::PixelPoint> WavyGround(const SceneCamera& camera,
                                         const SceneTrouble& trouble,
                                         double margin) {
  std::vector<core::PixelPoint> outline;
  const double c = std::cos(camera.roll_rad);
  const double s = std::sin(camera.roll_rad);
  const double reach = camera.width_px + camera.height_px + margin;
  // Straight pieces of a fortieth of a wave: 0.3 % of its height.
  const double step = trouble.wave_length_px / 40.0;
  const auto pieces = static_cast<int>(std::floor(2.0 * reach / step));
  for (int i = 0; i <= pieces; ++i) {
    const double along = i * step - reach;
    const double up =
        trouble.wave_amplitude_px *
        std::sin(2.0 * std::numbers::pi * along / trouble.wave_length_px);
    outline.push_back({camera.ground_point.x_px + along * c + up * s,
                       camera.ground_point.y_px + along * s - up * c});
  }
  // Closed far below the picture.
  outline.push_back({camera.ground_point.x_px + reach * (c - s),
                     camera.ground_point.y_px + reach * (s + c)});
  outline.push_back({camera.ground_point.x_px - reach * (c + s),
                     camera.ground_point.y_px + reach * (c - s)});
  return outline;
}

TroubleRenderer::TroubleRenderer(const Scene& scene) {
  const SceneCamera& camera = scene.camera;
  const SceneTrouble& trouble = scene.trouble;
  // Places and directions of the specks follow from the scene's seed alone.
  std::mt19937_64 engine(trouble.speck_seed);
  std::uniform_real_distribution<> unit(0.0, 1.0);
  for (std::int32_t i = 0; i < trouble.specks; ++i) {
    const double direction = 2.0 * std::numbers::pi * unit(engine);
    Speck speck;
    speck.start = {camera.width_px * unit(engine),
                   camera.height_px * unit(engine)};
    speck.velocity = {trouble.speck_speed_px * std::cos(direction),
                      trouble.speck_speed_px * std::sin(direction)};
    specks_.push_back(speck);
  }
  if (trouble.obstacle) {
    const core::PixelRect& r = *trouble.obstacle;
    obstacle_.emplace(core::PixelRect{0, 0, camera.width_px, camera.height_px},
                      camera.psf_sigma_px);
    // Pixel centres are at integers: the obstacle's edges lie half a pixel
    // outside of them.
    const double x0 = r.x - 0.5, x1 = r.x + r.width - 0.5;
    const double y0 = r.y - 0.5, y1 = r.y + r.height - 0.5;
    obstacle_->Add(PolygonOutline({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}),
                   1.0);
    obstacle_->Finish();
  }
}

void TroubleRenderer::DrawShadow(const Scene& scene, const ScenePose& pose,
                                 const Layers& layers,
                                 CleanImage& image) const {
  const SceneCamera& camera = scene.camera;
  // Standard deviation of the shadow along the ground at contact, in units of
  // half the body; across it, flattened, since the ground is seen at a slant.
  // Chosen by eye.
  constexpr double kShadowWidth = 0.8;
  constexpr double kShadowFlatness = 0.35;
  const double touching = kShadowWidth * HalfSizes(scene).greatest;
  const double gap_px = std::max(0.0, camera.px_per_m * Gap(scene.body, pose));
  // The higher the body, the wider and fainter its shadow.
  const double along = touching + 0.5 * gap_px;
  const double below = kShadowFlatness * along;
  const double depth = scene.trouble.shadow_depth * touching / along;
  const core::PixelPoint foot = ToImage(camera, {pose.centre.x_m, 0.0});
  const double c = std::cos(camera.roll_rad);
  const double s = std::sin(camera.roll_rad);
  for (std::int32_t y = 0; y < image.height_px; ++y) {
    for (std::int32_t x = 0; x < image.width_px; ++x) {
      const std::size_t i = PixelIndex(image, x, y);
      const double share = static_cast<double>(layers.ground_share[i]) *
                           (1.0 - Covered(layers.body, x, y));
      if (!(share > 0.0)) continue;
      const double dx = x - foot.x_px;
      const double dy = y - foot.y_px;
      const double u = (dx * c + dy * s) / along;
      const double v = (dy * c - dx * s) / below;
      const double ground =
          static_cast<double>(layers.light[i]) * scene.look.background_level +
          static_cast<double>(layers.ground[i]);
      image.dn[i] -= static_cast<float>(share * ground * depth *
                                        std::exp(-0.5 * (u * u + v * v)));
    }
  }
}

// Specks pass in front of ground and background, behind the body.
void TroubleRenderer::DrawSpecks(const Scene& scene, double time_s,
                                 const Layers& layers,
                                 CleanImage& image) const {
  const SceneCamera& camera = scene.camera;
  const double radius = 0.5 * scene.trouble.speck_diameter_px;
  const double margin = radius + kKernelReach * camera.psf_sigma_px + 1.0;
  // Speeds are in px a frame.
  const double frame = time_s * camera.fps;
  for (const Speck& speck : specks_) {
    const double x = Wrapped(speck.start.x_px + frame * speck.velocity.x_px,
                             -margin, camera.width_px + margin);
    const double y = Wrapped(speck.start.y_px + frame * speck.velocity.y_px,
                             -margin, camera.height_px + margin);
    const auto x0 = std::max(0, static_cast<std::int32_t>(x - margin));
    const auto y0 = std::max(0, static_cast<std::int32_t>(y - margin));
    const auto x1 =
        std::min(camera.width_px, static_cast<std::int32_t>(x + margin) + 1);
    const auto y1 =
        std::min(camera.height_px, static_cast<std::int32_t>(y + margin) + 1);
    if (x1 <= x0 || y1 <= y0) continue;
    CoverageMap map({x0, y0, x1 - x0, y1 - y0}, camera.psf_sigma_px);
    map.Add(CircleOutline({x, y}, radius), 1.0);
    map.Finish();
    for (std::int32_t row = y0; row < y1; ++row) {
      for (std::int32_t column = x0; column < x1; ++column) {
        const std::size_t i = PixelIndex(image, column, row);
        const double share = map.row(row)[column - x0] *
                             (1.0 - Covered(layers.body, column, row));
        const double level =
            static_cast<double>(layers.light[i]) * scene.look.body_level;
        image.dn[i] += static_cast<float>(
            share * (level - static_cast<double>(image.dn[i])));
      }
    }
  }
}

// A linear shading and one Gaussian highlight, both fixed to the light: they do
// not turn with the body.
void TroubleRenderer::DrawShading(const Scene& scene, const ScenePose& pose,
                                  const Layers& layers,
                                  CleanImage& image) const {
  const SceneTrouble& trouble = scene.trouble;
  const core::PixelPoint centre = ToImage(scene.camera, pose.centre);
  const Halves half = HalfSizes(scene);
  const core::PixelRect& w = layers.body.window();
  for (std::int32_t y = w.y; y < w.y + w.height; ++y) {
    for (std::int32_t x = w.x; x < w.x + w.width; ++x) {
      const std::size_t i = PixelIndex(image, x, y);
      const double dx = x - centre.x_px;
      const double dy = y - centre.y_px;
      const double shading =
          (trouble.shading_x * dx + trouble.shading_y * dy) / half.greatest;
      const double u =
          (dx / half.smallest - trouble.highlight_x) / trouble.highlight_sigma;
      const double v =
          (dy / half.smallest - trouble.highlight_y) / trouble.highlight_sigma;
      const double change =
          scene.look.body_level * shading +
          trouble.highlight_level * std::exp(-0.5 * (u * u + v * v));
      image.dn[i] += static_cast<float>(Covered(layers.body, x, y) * change *
                                        static_cast<double>(layers.light[i]));
    }
  }
}

void TroubleRenderer::Draw(const Scene& scene, double time_s,
                           const Layers& layers, CleanImage& image) const {
  const SceneTrouble& trouble = scene.trouble;
  const ScenePose pose = scene.pose(time_s);
  if (trouble.shadow_depth > 0.0) DrawShadow(scene, pose, layers, image);
  if (!specks_.empty()) DrawSpecks(scene, time_s, layers, image);
  if (trouble.shading_x != 0.0 || trouble.shading_y != 0.0 ||
      trouble.highlight_level != 0.0) {
    DrawShading(scene, pose, layers, image);
  }
  // The obstacle stands before everything.
  if (obstacle_) {
    for (std::int32_t y = 0; y < image.height_px; ++y) {
      for (std::int32_t x = 0; x < image.width_px; ++x) {
        const std::size_t i = PixelIndex(image, x, y);
        const double level =
            static_cast<double>(layers.light[i]) * trouble.obstacle_level;
        image.dn[i] += static_cast<float>(
            obstacle_->row(y)[x] * (level - static_cast<double>(image.dn[i])));
      }
    }
  }
  // Flicker multiplies the whole picture.
  if (trouble.flicker_amplitude > 0.0) {
    const auto light =
        static_cast<float>(1.0 + trouble.flicker_amplitude *
                                     std::sin(2.0 * std::numbers::pi *
                                              trouble.flicker_hz * time_s));
    for (float& dn : image.dn) dn *= light;
  }
}

}  // namespace touchdown::vision
