#include "synthetic/render_face.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "synthetic/gaussian_field.h"
#include "touchdown/core/normal.h"

namespace touchdown::vision {
namespace {

// Distance of the points at which T is stored, px; between them it is bilinear.
// The picture that is drawn is that bilinear one, so that no error comes of it.
constexpr double kFacePitch_px = 0.25;
// Parts of a pixel along each axis. Within one of them T is taken as constant:
// of T, an error of up to (1/kFine)^2 / (4 l^2), where its bilinear pieces
// meet; 2e-3 at a correlation l of 3 px.
constexpr int kFine = 4;

std::size_t IndexOf(std::int32_t x, std::int32_t y, std::int32_t width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// Pixels are squares about whole numbers, parts too.
double ToFine(double px) { return kFine * (px + 0.5) - 0.5; }
core::PixelPoint ToFine(core::PixelPoint p) {
  return {ToFine(p.x_px), ToFine(p.y_px)};
}

ShapeOutline ToFine(ShapeOutline outline) {
  for (OutlinePiece& piece : outline.pieces) {
    piece.from = ToFine(piece.from);
    piece.to = ToFine(piece.to);
    piece.centre = ToFine(piece.centre);
    piece.radius_px *= kFine;
  }
  return outline;
}

// Weights of the parts -reach .. kFine - 1 + reach of a pixel (0 is its first).
std::vector<float> KernelOfParts(double sigma_px, int reach) {
  std::vector<float> kernel;
  // Of a pixel, in parts.
  constexpr double kMiddle = 0.5 * (kFine - 1);
  for (int k = -reach; k < kFine + reach; ++k) {
    const double d = (k - kMiddle) / kFine;
    double weight = std::abs(d) < 0.5 ? 1.0 : 0.0;
    if (sigma_px > 0.0) {
      weight = core::NormalCdf((d + 0.5) / sigma_px) -
               core::NormalCdf((d - 0.5) / sigma_px);
    }
    kernel.push_back(static_cast<float>(weight / kFine));
  }
  return kernel;
}

int ReachOfKernel_px(double sigma_px) {
  return static_cast<int>(std::ceil(kKernelReach * sigma_px)) + 1;
}

}  // namespace

FacePicture::FacePicture(const Scene& scene) {
  const SceneFace& face = *scene.look.face;
  const double half = 0.5 * scene.camera.px_per_m;
  // In steps, so that a body a little larger has the same picture.
  constexpr double kStep_px = 8.0;
  const double farthest = half * (scene.body.kind == core::BodyKind::kSphere
                                      ? scene.body.diameter_m->value
                                      : std::hypot(scene.body.long_m->value,
                                                   scene.body.short_m->value));
  reach_px_ = kStep_px * std::ceil((farthest + 1.0) / kStep_px);
  side_ = 2 + static_cast<int>(std::ceil(2.0 * reach_px_ / kFacePitch_px));
  field_ = GaussianField(side_, side_, face.correlation_px / kFacePitch_px,
                         face.seed);
  const auto darkest = static_cast<float>(-scene.look.body_level);
  for (float& value : field_) {
    value = std::clamp(value * static_cast<float>(face.amplitude), darkest,
                       darkest + 1.0f);
  }
}

double FacePicture::At(double ahead_px, double up_px) const {
  const double x = (ahead_px + reach_px_) / kFacePitch_px;
  const double y = (up_px + reach_px_) / kFacePitch_px;
  const auto i = static_cast<std::int32_t>(std::floor(x));
  const auto j = static_cast<std::int32_t>(std::floor(y));
  if (i < 0 || j < 0 || i + 1 >= side_ || j + 1 >= side_) return 0.0;
  const double fx = x - i;
  const double fy = y - j;
  const float* low = field_.data() + IndexOf(i, j, side_);
  const float* high = low + side_;
  const auto mix = [fx](const float* of) {
    return static_cast<double>(of[0]) * (1.0 - fx) +
           static_cast<double>(of[1]) * fx;
  };
  return mix(low) * (1.0 - fy) + mix(high) * fy;
}

FaceMap::FaceMap(const SceneCamera& camera, core::PixelRect window)
    : camera_(camera), window_(window) {
  if (window.width <= 0 || window.height <= 0) return;
  const int reach = ReachOfKernel_px(camera.psf_sigma_px);
  fine_window_ = {kFine * (window.x - reach), kFine * (window.y - reach),
                  kFine * (window.width + 2 * reach),
                  kFine * (window.height + 2 * reach)};
  fine_.resize(IndexOf(0, fine_window_.height, fine_window_.width), 0.0f);
}

void FaceMap::Add(const FacePicture& picture, const ShapeOutline& outline,
                  const ScenePose& pose, double weight) {
  if (fine_.empty()) return;
  CoverageMap share(fine_window_, 0.0);
  share.Add(ToFine(outline), weight);
  share.Finish();
  // From the picture to the plane: along the ground, and up from it.
  const core::PixelPoint centre = ToIdealImage(camera_, pose.centre);
  const double c = std::cos(camera_.roll_rad);
  const double s = std::sin(camera_.roll_rad);
  const double travel = camera_.travels_left ? -1.0 : 1.0;
  const double ca = std::cos(pose.angle_rad);
  const double sa = std::sin(pose.angle_rad);
  for (std::int32_t y = 0; y < fine_window_.height; ++y) {
    const double* covered = share.row(fine_window_.y + y);
    const double dy = (fine_window_.y + y + 0.5) / kFine - 0.5 - centre.y_px;
    for (std::int32_t x = 0; x < fine_window_.width; ++x) {
      if (covered[x] == 0.0) continue;
      const double dx = (fine_window_.x + x + 0.5) / kFine - 0.5 - centre.x_px;
      const double along = travel * (dx * c + dy * s);
      const double up = dx * s - dy * c;
      fine_[IndexOf(x, y, fine_window_.width)] += static_cast<float>(
          covered[x] * picture.At(along * ca + up * sa, up * ca - along * sa));
    }
  }
}

void FaceMap::Finish() {
  if (fine_.empty()) return;
  const int reach = kFine * ReachOfKernel_px(camera_.psf_sigma_px);
  const std::vector<float> kernel = KernelOfParts(camera_.psf_sigma_px, reach);
  const auto taps = static_cast<std::int32_t>(kernel.size());
  std::vector<float> rows(IndexOf(0, fine_window_.height, window_.width), 0.0f);
  for (std::int32_t y = 0; y < fine_window_.height; ++y) {
    for (std::int32_t x = 0; x < window_.width; ++x) {
      const float* in =
          fine_.data() + IndexOf(kFine * x, y, fine_window_.width);
      float sum = 0.0f;
      for (std::int32_t k = 0; k < taps; ++k) {
        sum += kernel[static_cast<std::size_t>(k)] * in[k];
      }
      rows[IndexOf(x, y, window_.width)] = sum;
    }
  }
  sum_.assign(IndexOf(0, window_.height, window_.width), 0.0f);
  for (std::int32_t y = 0; y < window_.height; ++y) {
    float* out = sum_.data() + IndexOf(0, y, window_.width);
    for (std::int32_t k = 0; k < taps; ++k) {
      const float* in = rows.data() + IndexOf(0, kFine * y + k, window_.width);
      const float weight = kernel[static_cast<std::size_t>(k)];
      for (std::int32_t x = 0; x < window_.width; ++x) out[x] += weight * in[x];
    }
  }
}

const float* FaceMap::row(std::int32_t y) const {
  return sum_.data() + IndexOf(0, y - window_.y, window_.width);
}

}  // namespace touchdown::vision
