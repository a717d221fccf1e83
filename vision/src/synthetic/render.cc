#include "touchdown/vision/synthetic/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "synthetic/coverage.h"
#include "synthetic/gaussian.h"
#include "synthetic/gaussian_field.h"
#include "synthetic/lens_silhouette.h"
#include "synthetic/render_face.h"
#include "synthetic/render_trouble.h"

namespace touchdown::vision {
namespace {

// One quadrature node of the exposure.
struct SubExposure {
  double time_s;
  double weight;
};

HalfPlane Ground(const SceneCamera& camera) {
  // The normal points up, away from the ground.
  const double angle = IdealGroundAngle(camera);
  return {camera.ground_point, std::sin(angle), -std::cos(angle)};
}

// The body's outline in the picture, the part of it below the ground line, and
// its box.
Silhouette Draw(const Scene& scene, const ScenePose& pose) {
  const HalfPlane ground = Ground(scene.camera);
  if (scene.camera.lens) return DrawThroughLens(scene, pose, ground);
  if (scene.body.kind == core::BodyKind::kSphere) {
    const core::PixelPoint c = ToImage(scene.camera, pose.centre);
    const double r = 0.5 * scene.body.diameter_m->value * scene.camera.px_per_m;
    return {CircleOutline(c, r), ClipCircle(c, r, ground),
            c.x_px - r,          c.x_px + r,
            c.y_px - r,          c.y_px + r};
  }
  std::vector<core::PixelPoint> corners;
  for (const core::PlanePoint& p : Corners(scene.body, pose)) {
    corners.push_back(ToImage(scene.camera, p));
  }
  const auto [left, right] = std::minmax_element(
      corners.begin(), corners.end(),
      [](const auto& p, const auto& q) { return p.x_px < q.x_px; });
  const auto [top, bottom] = std::minmax_element(
      corners.begin(), corners.end(),
      [](const auto& p, const auto& q) { return p.y_px < q.y_px; });
  return {PolygonOutline(corners),
          PolygonOutline(ClipPolygon(corners, ground)),
          left->x_px,
          right->x_px,
          top->y_px,
          bottom->y_px};
}

// The scene's pose function, which the caller wrote, is checked at each use.
ScenePose EvaluatePose(const Scene& scene, double time_s) {
  const ScenePose pose = scene.pose(time_s);
  if (!std::isfinite(pose.centre.x_m) || !std::isfinite(pose.centre.y_m) ||
      !std::isfinite(pose.angle_rad)) {
    throw std::invalid_argument(
        fmt::format("scene: pose at {} s is not finite", time_s));
  }
  return pose;
}

// How far the image of the body's fastest point moves between two poses, px.
double MotionPx(const Scene& scene, const ScenePose& p, const ScenePose& q,
                double radius_px) {
  const core::PixelPoint a = ToIdealImage(scene.camera, p.centre);
  const core::PixelPoint b = ToIdealImage(scene.camera, q.centre);
  return std::hypot(b.x_px - a.x_px, b.y_px - a.y_px) +
         radius_px * std::abs(q.angle_rad - p.angle_rad);
}

double HalfSmallest(const core::Body& body) {
  return body.kind == core::BodyKind::kSphere
             ? 0.5 * body.diameter_m->value
             : 0.5 * std::min(body.long_m->value, body.short_m->value);
}

// A disc on the body: the mark, or a hole at distance 0.
Silhouette DrawDisc(const Scene& scene, const ScenePose& pose, double distance,
                    double radius) {
  const double half_m = HalfSmallest(scene.body);
  Scene disc = scene;
  disc.body = core::Sphere({2.0 * radius * half_m, 0.0});
  const double reach_m = distance * half_m;
  return Draw(disc, {{pose.centre.x_m + reach_m * std::cos(pose.angle_rad),
                      pose.centre.y_m + reach_m * std::sin(pose.angle_rad)},
                     pose.angle_rad});
}

// Gauss-Legendre nodes over the exposure. For an edge blurred by sigma and
// moving m within the exposure the error is, of the contrast: one node
// 0.01 (m/sigma)^2, two 1.3e-4 (m/sigma)^4, three 1.2e-6 (m/sigma)^6 a panel.
std::vector<SubExposure> SubExposures(const Scene& scene, double middle_s) {
  const double exposure = scene.camera.exposure_s;
  const ScenePose first = EvaluatePose(scene, middle_s - 0.5 * exposure);
  const ScenePose middle = EvaluatePose(scene, middle_s);
  const ScenePose last = EvaluatePose(scene, middle_s + 0.5 * exposure);
  // A turning disc looks the same.
  double turning_radius =
      scene.body.kind == core::BodyKind::kSphere
          ? 0.0
          : 0.5 * scene.camera.px_per_m *
                std::hypot(scene.body.long_m->value, scene.body.short_m->value);
  if (scene.look.face && scene.body.kind == core::BodyKind::kSphere) {
    turning_radius = HalfSmallest(scene.body) * scene.camera.px_per_m;
  }
  if (const auto& mark = scene.look.mark) {
    turning_radius = std::max(turning_radius, (mark->distance + mark->radius) *
                                                  HalfSmallest(scene.body) *
                                                  scene.camera.px_per_m);
  }
  const double motion = MotionPx(scene, first, middle, turning_radius) +
                        MotionPx(scene, middle, last, turning_radius);
  // px. Without blur the pixel's own square is the blur.
  const double sigma = std::max(scene.camera.psf_sigma_px, 0.25);
  // One node is good to 3e-5 of the contrast there.
  if (motion <= 0.05 * sigma) return {{middle_s, 1.0}};
  struct Rule {
    std::array<double, 3> node;
    std::array<double, 3> weight;
    int size;
  };
  // Gauss-Legendre on 0..1 with two and with three nodes.
  constexpr Rule kTwo{
      {0.21132486540518712, 0.78867513459481288, 0.0}, {0.5, 0.5, 0.0}, 2};
  constexpr Rule kThree{{0.11270166537925831, 0.5, 0.88729833462074169},
                        {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0},
                        3};
  // Two nodes err by 2e-5 at 0.6 sigma; three, in panels of 2 sigma, by 8e-5.
  const Rule& rule = motion <= 0.6 * sigma ? kTwo : kThree;
  const int panels =
      std::max(1, static_cast<int>(std::ceil(motion / (2.0 * sigma))));
  std::vector<SubExposure> nodes;
  for (int panel = 0; panel < panels; ++panel) {
    for (int k = 0; k < rule.size; ++k) {
      const auto i = static_cast<std::size_t>(k);
      nodes.push_back(
          {middle_s + exposure * ((panel + rule.node[i]) / panels - 0.5),
           rule.weight[i] / panels});
    }
  }
  return nodes;
}

// Whole pixels within `margin` of the given box, inside the picture.
core::PixelRect ClippedWindow(double min_x, double max_x, double min_y,
                              double max_y, double margin,
                              const SceneCamera& camera) {
  const auto clip = [](double value, double high) {
    return static_cast<std::int32_t>(std::clamp(value, 0.0, high));
  };
  const std::int32_t x0 = clip(std::floor(min_x - margin), camera.width_px);
  const std::int32_t x1 = clip(std::ceil(max_x + margin) + 1, camera.width_px);
  const std::int32_t y0 = clip(std::floor(min_y - margin), camera.height_px);
  const std::int32_t y1 = clip(std::ceil(max_y + margin) + 1, camera.height_px);
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

// Factor of a linear gradient of light, 1 in the middle of the picture.
double Illumination(const SceneLook& look, const SceneCamera& camera, int x,
                    int y) {
  const double across =
      camera.width_px > 1 ? x / (camera.width_px - 1.0) - 0.5 : 0.0;
  const double down =
      camera.height_px > 1 ? y / (camera.height_px - 1.0) - 0.5 : 0.0;
  return std::max(0.0, 1.0 + look.gradient_x * across + look.gradient_y * down);
}

}  // namespace

core::Frame SensorImage::view() const {
  core::Frame frame;
  frame.data = samples.data();
  frame.stride_bytes =
      static_cast<std::ptrdiff_t>(width_px) * (bit_depth > 8 ? 2 : 1);
  frame.width_px = width_px;
  frame.height_px = height_px;
  frame.bit_depth = bit_depth;
  frame.index = index;
  frame.time_s = time_s;
  return frame;
}

SceneRenderer::SceneRenderer(Scene scene) : scene_(std::move(scene)) {
  Validate(scene_);
  const SceneCamera& camera = scene_.camera;
  const SceneLook& look = scene_.look;
  const int width = camera.width_px;
  const int height = camera.height_px;
  const double full_scale = (1 << camera.bit_depth) - 1;

  // The ground: the picture, widened by more than the blur's reach, below the
  // line.
  const double margin = kKernelReach * camera.psf_sigma_px + 2.0;
  const std::vector<core::PixelPoint> picture{{-margin, -margin},
                                              {width + margin, -margin},
                                              {width + margin, height + margin},
                                              {-margin, height + margin}};
  CoverageMap coverage({0, 0, width, height}, camera.psf_sigma_px);
  const SceneTrouble& trouble = scene_.trouble;
  if (camera.lens) {
    coverage.Add(GroundThroughLens(camera, margin), 1.0);
  } else if (trouble.wave_amplitude_px > 0.0) {
    coverage.Add(PolygonOutline(WavyGround(camera, trouble, margin)), 1.0);
  } else {
    coverage.Add(PolygonOutline(ClipPolygon(picture, Ground(camera))), 1.0);
  }
  coverage.Finish();

  const auto pixels =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> texture;
  if (look.texture_amplitude > 0.0) {
    texture = GaussianField(width, height, look.texture_correlation_px,
                            look.texture_seed);
  }
  if (look.face) face_ = std::make_shared<FacePicture>(scene_);
  background_ = {width, height, std::vector<float>(pixels)};
  ground_.resize(pixels);
  light_.resize(pixels);
  if (HasTrouble(trouble)) {
    trouble_ = std::make_shared<TroubleRenderer>(scene_);
    ground_share_.resize(pixels);
  }
  for (int y = 0; y < height; ++y) {
    const double* covered = coverage.row(y);
    for (int x = 0; x < width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
          static_cast<std::size_t>(x);
      const double light = full_scale * Illumination(look, camera, x, y);
      double ground = look.ground_level;
      if (!texture.empty()) {
        ground *=
            1.0 + look.texture_amplitude * static_cast<double>(texture[i]);
      }
      // What the ground adds to the background where it covers a pixel wholly.
      const double contrast = light * (ground - look.background_level);
      light_[i] = static_cast<float>(light);
      if (trouble_) ground_share_[i] = static_cast<float>(covered[x]);
      ground_[i] = static_cast<float>(contrast);
      background_.dn[i] = static_cast<float>(light * look.background_level +
                                             contrast * covered[x]);
    }
  }
}

namespace {

// The body during one exposure.
struct Exposed {
  struct Part {
    ScenePose pose;
    Silhouette body;
    std::optional<Silhouette> hole;
    std::optional<Silhouette> mark;
    double weight = 1.0;
  };
  std::vector<Part> parts;
  double min_x, max_x, min_y, max_y;
  bool dips = false;
};

Exposed Expose(const Scene& scene, double middle_s) {
  Exposed e;
  e.min_x = e.min_y = std::numeric_limits<double>::max();
  e.max_x = e.max_y = std::numeric_limits<double>::lowest();
  for (const SubExposure& sub : SubExposures(scene, middle_s)) {
    const ScenePose pose = EvaluatePose(scene, sub.time_s);
    Exposed::Part part{pose, Draw(scene, pose), std::nullopt, std::nullopt,
                       sub.weight};
    const SceneLook& look = scene.look;
    if (look.hole > 0.0) part.hole = DrawDisc(scene, pose, 0.0, look.hole);
    if (look.mark) {
      part.mark = DrawDisc(scene, pose, look.mark->distance, look.mark->radius);
    }
    e.min_x = std::min(e.min_x, part.body.min_x);
    e.max_x = std::max(e.max_x, part.body.max_x);
    e.min_y = std::min(e.min_y, part.body.min_y);
    e.max_y = std::max(e.max_y, part.body.max_y);
    e.dips = e.dips || !part.body.below.pieces.empty();
    e.parts.push_back(std::move(part));
  }
  return e;
}

}  // namespace

// Shares of the pixels of a window.
struct SceneRenderer::Covers {
  Covers(const SceneCamera& camera, const FacePicture* picture,
         const Exposed& exposed, const core::PixelRect& window)
      : body(window, camera.psf_sigma_px),
        below(exposed.dips ? window : core::PixelRect{}, camera.psf_sigma_px),
        mark(exposed.parts[0].mark ? window : core::PixelRect{},
             camera.psf_sigma_px),
        face(camera, picture ? window : core::PixelRect{}) {
    for (const Exposed::Part& part : exposed.parts) {
      body.Add(part.body.body, part.weight);
      if (exposed.dips) below.Add(part.body.below, part.weight);
      // A hole is a disc of negative weight.
      if (part.hole) {
        body.Add(part.hole->body, -part.weight);
        if (exposed.dips) below.Add(part.hole->below, -part.weight);
      }
      if (part.mark) mark.Add(part.mark->body, part.weight);
      if (picture) {
        face.Add(*picture, part.body.body, part.pose, part.weight);
        if (part.hole) {
          face.Add(*picture, part.hole->body, part.pose, -part.weight);
        }
      }
    }
    body.Finish();
    below.Finish();
    mark.Finish();
    face.Finish();
  }

  CoverageMap body;
  CoverageMap below;
  CoverageMap mark;  // of the body
  FaceMap face;      // of full scale
};

// Adds the body to rows `window`, over the background.
void SceneRenderer::DrawBody(const Covers& covers, bool dips,
                             CleanImage& image) const {
  const SceneCamera& camera = scene_.camera;
  const SceneLook& look = scene_.look;
  const bool wavy = scene_.trouble.wave_amplitude_px > 0.0;
  const double contrast = look.body_level - look.background_level;
  const core::PixelRect& window = covers.body.window();
  for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
    const double* covered = covers.body.row(y);
    const double* hidden = dips ? covers.below.row(y) : nullptr;
    const double* marked = look.mark ? covers.mark.row(y) : nullptr;
    const float* pictured = face_ ? covers.face.row(y) : nullptr;
    const std::size_t first = static_cast<std::size_t>(y) *
                                  static_cast<std::size_t>(camera.width_px) +
                              static_cast<std::size_t>(window.x);
    for (std::int32_t x = 0; x < window.width; ++x) {
      const std::size_t i = first + static_cast<std::size_t>(x);
      // As if the body hid background everywhere; then the ground that it hides
      // is taken away.
      double change = static_cast<double>(light_[i]) * contrast * covered[x];
      // Where the body hides ground instead of background.
      if (wavy) {
        change -=
            static_cast<double>(ground_[i] * ground_share_[i]) * covered[x];
      } else if (hidden != nullptr) {
        change -= static_cast<double>(ground_[i]) * hidden[x];
      }
      if (marked != nullptr) {
        change += static_cast<double>(light_[i]) *
                  (look.mark->level - look.body_level) * marked[x];
      }
      if (pictured != nullptr) {
        change += static_cast<double>(light_[i] * pictured[x]);
      }
      image.dn[i] += static_cast<float>(change);
    }
  }
}

CleanImage SceneRenderer::RenderClean(std::int64_t index) const {
  const SceneCamera& camera = scene_.camera;
  const double middle_s = static_cast<double>(index) / camera.fps;
  const double margin = kKernelReach * camera.psf_sigma_px + 1.0;
  // The still picture is drawn once; a frame adds the body to a copy.
  CleanImage image = background_;
  if (camera.row_delay_s > 0.0) {
    // Each row at its own time.
    for (std::int32_t y = 0; y < camera.height_px; ++y) {
      const Exposed exposed = Expose(scene_, middle_s + y * camera.row_delay_s);
      if (y < exposed.min_y - margin || y > exposed.max_y + margin) continue;
      core::PixelRect row =
          ClippedWindow(exposed.min_x, exposed.max_x, y, y, margin, camera);
      row.y = y;
      row.height = 1;
      DrawBody(Covers(camera, face_.get(), exposed, row), exposed.dips, image);
    }
    return image;
  }
  const Exposed exposed = Expose(scene_, middle_s);
  const Covers covers(camera, face_.get(), exposed,
                      ClippedWindow(exposed.min_x, exposed.max_x, exposed.min_y,
                                    exposed.max_y, margin, camera));
  DrawBody(covers, exposed.dips, image);
  if (trouble_) {
    trouble_->Draw(scene_, middle_s,
                   {light_, ground_, ground_share_, covers.body}, image);
  }
  return image;
}

CleanImage RenderClean(const Scene& scene, std::int64_t index) {
  return SceneRenderer(scene).RenderClean(index);
}

// Variance = read^2 + shot * level; the normal distribution stands for the
// photons' Poisson distribution.
void AddSensorNoise(CleanImage& image, const SensorNoise& noise,
                    std::mt19937_64& engine) {
  const auto read = static_cast<float>(noise.read_dn * noise.read_dn);
  const auto shot = static_cast<float>(noise.shot_dn2_per_dn);
  if (read == 0.0f && shot == 0.0f) return;
  const GaussianSource gaussian;
  for (float& value : image.dn) {
    const float variance = read + shot * std::max(value, 0.0f);
    value += std::sqrt(variance) * gaussian(engine);
  }
}

// Rounds to whole levels and clips at both ends, as a sensor does.
SensorImage Quantize(const CleanImage& image, std::int32_t bit_depth) {
  if (bit_depth < 1 || bit_depth > 16) {
    throw std::invalid_argument(
        fmt::format("bit_depth is {}, must be within 1 .. 16", bit_depth));
  }
  SensorImage out;
  out.width_px = image.width_px;
  out.height_px = image.height_px;
  out.bit_depth = bit_depth;
  const auto full_scale = static_cast<float>((1 << bit_depth) - 1);
  const auto sample = [&](float value) {
    return std::clamp(value, 0.0f, full_scale) + 0.5f;
  };
  if (bit_depth <= 8) {
    out.samples.resize(image.dn.size());
    auto* to = reinterpret_cast<std::uint8_t*>(out.samples.data());
    for (std::size_t i = 0; i < image.dn.size(); ++i) {
      to[i] = static_cast<std::uint8_t>(sample(image.dn[i]));
    }
  } else {
    out.samples.resize(2 * image.dn.size());
    // operator new aligns the vector's storage for every fundamental type.
    auto* to = reinterpret_cast<std::uint16_t*>(out.samples.data());
    for (std::size_t i = 0; i < image.dn.size(); ++i) {
      to[i] = static_cast<std::uint16_t>(sample(image.dn[i]));
    }
  }
  return out;
}

// Clean picture, noise, levels: what a camera would have given.
SensorImage RenderFrame(const SceneRenderer& renderer, std::int64_t index,
                        std::mt19937_64& engine) {
  CleanImage clean = renderer.RenderClean(index);
  AddSensorNoise(clean, renderer.scene().noise, engine);
  SensorImage image = Quantize(clean, renderer.scene().camera.bit_depth);
  image.index = index;
  image.time_s = static_cast<double>(index) / renderer.scene().camera.fps;
  return image;
}

}  // namespace touchdown::vision
