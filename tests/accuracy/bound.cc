#include "tests/accuracy/bound.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/accuracy/face_information.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::accuracy {
namespace {

using core::BodyKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Variance of a pixel in units of full scale.
double PixelVariance(const Case& c) {
  const double full = std::pow(2.0, c.levels.bit_depth) - 1.0;
  return c.levels.noise * c.levels.noise + 1.0 / (12.0 * full * full);
}

double PixelBlur2(const Case& c) {
  return c.levels.blur_px * c.levels.blur_px + 1.0 / 12.0;
}

double EdgeInformation(double contrast, double blur2, double variance) {
  return contrast * contrast /
         (2.0 * std::sqrt(std::numbers::pi * blur2) * variance);
}

// What follows is written apart from vision's own fit on purpose: a bound that
// shared its parameters would share its mistakes.
using PoseMatrix = Eigen::Matrix<double, kPose, kPose>;

// Whether an obstacle hides a point that is so far from the contact, px along
// the ground and upwards.
bool IsHidden(const Case& c, double along_px, double up_px) {
  if (!c.film.trouble.obstacle) return false;
  const vision::SceneCamera& camera = c.film.camera;
  const core::PixelPoint seen = vision::ToImage(
      camera, {along_px / camera.px_per_m, up_px / camera.px_per_m});
  const core::PixelRect& box = *c.film.trouble.obstacle;
  return seen.x_px >= box.x && seen.x_px < box.x + box.width &&
         seen.y_px >= box.y && seen.y_px < box.y + box.height;
}

// Of the body at `pose`; `vx`, `vy` in px per frame, for the blur of the
// motion.
PoseMatrix PoseInformation(const Case& c,
                           const Eigen::Matrix<double, kPose, 1>& pose,
                           double vx, double vy) {
  const Levels& l = c.levels;
  const double face = pose[2];
  const double variance = PixelVariance(c);
  PoseMatrix information = PoseMatrix::Zero();
  const auto add = [&](double nx, double ny, double lever, double long_side,
                       double short_side, double length) {
    // The side's middle lies half the other side along the normal.
    const double out = long_side * pose[3] + short_side * pose[4];
    if (IsHidden(c, pose[0] + nx * out + ny * lever,
                 pose[1] + ny * out - nx * lever)) {
      return;
    }
    const double along = l.open * (nx * vx + ny * vy);
    const double blur2 = PixelBlur2(c) + along * along / 12.0;
    Eigen::Matrix<double, kPose, 1> p;
    p << nx, ny, lever, long_side, short_side;
    information += length * EdgeInformation(l.contrast, blur2, variance) * p *
                   p.transpose();
  };
  const double a = c.film.thrown.half_long_m * c.film.camera.px_per_m;
  const double b = c.film.thrown.half_short_m * c.film.camera.px_per_m;
  constexpr int kSteps = 180;
  if (l.kind == BodyKind::kSphere) {
    for (int i = 0; i < kSteps; ++i) {
      const double t = 2.0 * std::numbers::pi * (i + 0.5) / kSteps;
      add(std::cos(t), std::sin(t), 0.0, 1.0, 0.0,
          2.0 * std::numbers::pi * a / kSteps);
    }
    return information;
  }
  const double blur = std::sqrt(PixelBlur2(c));
  const auto side = [&](double half, double nx, double ny, bool is_long) {
    const double length = std::max(0.0, 2.0 * (half - blur));
    for (int i = 0; i < kSteps; ++i) {
      const double s = length * ((i + 0.5) / kSteps - 0.5);
      add(nx, ny, s, is_long ? 0.0 : 1.0, is_long ? 1.0 : 0.0, length / kSteps);
    }
  };
  const double cf = std::cos(face);
  const double sf = std::sin(face);
  side(a, -sf, cf, true);
  side(a, sf, -cf, true);
  side(b, cf, sf, false);
  side(b, -cf, -sf, false);
  return information;
}

// Information on (height at the picture's middle, slope) of the ground line.
Eigen::Matrix2d GroundInformation(const Case& c) {
  const vision::SceneLook& look = c.film.look;
  const double contrast = look.ground_level - look.background_level;
  const double variance = PixelVariance(c) / static_cast<double>(c.film.frames);
  const double blur2 = PixelBlur2(c);
  double density = EdgeInformation(contrast, blur2, variance);
  if (look.texture_amplitude > 0.0) {
    constexpr int kColumns = 48;
    const int half = static_cast<int>(std::ceil(3.0 * std::sqrt(blur2))) + 2;
    const int rows = 2 * half + 1;
    const int n = kColumns * rows;
    const double b = std::sqrt(blur2);
    const auto cover = [&](int row) {
      return 0.5 * std::erfc((row - half) / (b * std::numbers::sqrt2));
    };
    MatrixXd covariance(n, n);
    VectorXd derivative(n);
    const double sigma = look.texture_amplitude * look.ground_level;
    const double reach2 =
        2.0 * look.texture_correlation_px * look.texture_correlation_px;
    for (int i = 0; i < n; ++i) {
      const int xi = i / rows;
      const int yi = i % rows;
      const double z = (yi - half) / b;
      derivative[i] = contrast * std::exp(-0.5 * z * z) /
                      (b * std::sqrt(2.0 * std::numbers::pi));
      for (int j = 0; j < n; ++j) {
        const int dx = xi - j / rows;
        const int dy = yi - j % rows;
        covariance(i, j) = sigma * sigma * cover(yi) * cover(j % rows) *
                           std::exp(-(dx * dx + dy * dy) / reach2);
      }
      covariance(i, i) += variance;
    }
    density = derivative.dot(covariance.llt().solve(derivative)) / kColumns;
  }
  const double width = c.film.camera.width_px;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  information(0, 0) = density * width;
  information(1, 1) = density * width * width * width / 12.0;
  return information;
}

// Parameters, px and frames: the ground's are relative to the truth.
enum Parameter {
  kTime,
  kPlace,
  kVx,
  kVy,
  kVx2,
  kVy2,
  kGround,  // at the picture's middle
  kSlope,
  kHalfLong,
  kHalfShort,
  kFace,
  kOmega,
  kOmega2,
  kGravity,
  kParameters
};

struct Model {
  double middle = 0.0;  // of the picture, from the contact, along the ground
  bool turns = false;

  double Support(const VectorXd& p, double face) const {
    if (!turns) return p[kHalfLong];
    return p[kHalfLong] * std::abs(std::sin(face)) +
           p[kHalfShort] * std::abs(std::cos(face));
  }
  Eigen::Matrix<double, kPose, 1> PoseAt(const VectorXd& p, double t) const {
    const double s = t - p[kTime];
    const bool before = s < 0.0;
    const double down = p[kGround] + p[kSlope] * (p[kPlace] - middle) +
                        Support(p, p[kFace] - p[kSlope]);
    Eigen::Matrix<double, kPose, 1> pose;
    pose << p[kPlace] + (before ? p[kVx] : p[kVx2]) * s,
        down + (before ? p[kVy] : p[kVy2]) * s - 0.5 * p[kGravity] * s * s,
        p[kFace] + (before ? p[kOmega] : p[kOmega2]) * s, p[kHalfLong],
        p[kHalfShort];
    return pose;
  }
};

}  // namespace

Bound BoundOf(const Case& c) {
  const pipeline::filmed::Film& film = c.film;
  const vision::synthetic::Throw& t = film.thrown;
  const double scale = film.camera.px_per_m;
  const double fps = film.camera.fps;
  Model model;
  model.turns = c.levels.kind == BodyKind::kRectangle;
  model.middle = (0.5 * film.camera.width_px - film.camera.ground_point.x_px) *
                 (film.camera.travels_left ? -1.0 : 1.0);
  VectorXd truth = VectorXd::Zero(kParameters);
  truth[kTime] = film.contact_frame;
  truth[kVx] = t.before.vx * scale / fps;
  truth[kVy] = t.before.vy * scale / fps;
  truth[kVx2] = t.after.vx * scale / fps;
  truth[kVy2] = t.after.vy * scale / fps;
  truth[kHalfLong] = t.half_long_m * scale;
  truth[kHalfShort] = t.half_short_m * scale;
  truth[kFace] = t.face_rad;
  truth[kOmega] = t.before.omega / fps;
  truth[kOmega2] = t.after.omega / fps;
  truth[kGravity] = t.gravity_mps2 * scale / (fps * fps);

  const auto gradient = [&](const auto& f) {
    constexpr double kStep = 1e-6;
    const auto at = f(truth);
    MatrixXd j(at.size(), kParameters);
    for (int i = 0; i < kParameters; ++i) {
      VectorXd up = truth;
      VectorXd down = truth;
      up[i] += kStep;
      down[i] -= kStep;
      j.col(i) = (f(up) - f(down)) / (2.0 * kStep);
    }
    return j;
  };

  MatrixXd information = MatrixXd::Zero(kParameters, kParameters);
  std::optional<FaceInformation> face;
  if (film.look.face) face.emplace(c, PixelVariance(c));
  Bound bound;
  for (std::int64_t f = film.lead_in; f < film.frames; ++f) {
    const double time = static_cast<double>(f);
    const bool before = time < film.contact_frame;
    const auto pose = model.PoseAt(truth, time);
    const PoseMatrix pixels =
        PoseInformation(c, pose, before ? truth[kVx] : truth[kVx2],
                        before ? truth[kVy] : truth[kVy2]);
    const MatrixXd j =
        gradient([&](const VectorXd& p) { return model.PoseAt(p, time); });
    if (face) {
      face->Add(f, j);
    } else {
      information += j.transpose() * pixels * j;
    }
    if (f == film.lead_in) bound.centre_px = 1.0 / std::sqrt(pixels(0, 0));
  }
  if (face) information += face->Eliminate();
  const Eigen::Matrix2d ground = GroundInformation(c);
  information.block<2, 2>(kGround, kGround) += ground;
  const double u_gravity =
      truth[kGravity] * std::hypot(kScaleRelativeU, kGravityRelativeU);
  information(kGravity, kGravity) += 1.0 / (u_gravity * u_gravity);
  const auto tell = [&](Parameter size,
                        const std::optional<core::Estimate>& told_m) {
    if (!told_m) return;
    const double u_px = told_m->u * scale;
    information(size, size) += 1.0 / (u_px * u_px);
  };
  tell(kHalfLong, c.told_half_long_m);
  tell(kHalfShort, c.told_half_short_m);
  if (!model.turns) {
    // A ball's picture tells how fast it turns, not where it began.
    std::vector<int> unused_parameters = {kHalfShort, kFace};
    if (!face)
      unused_parameters.insert(unused_parameters.end(), {kOmega, kOmega2});
    for (const int unused : unused_parameters) {
      information.row(unused).setZero();
      information.col(unused).setZero();
      information(unused, unused) = 1.0;
    }
  }
  const MatrixXd covariance = information.inverse();
  const auto deviation = [&](const std::function<double(const VectorXd&)>& q) {
    const MatrixXd j = gradient(
        [&](const VectorXd& p) { return VectorXd::Constant(1, q(p)); });
    return std::sqrt((j * covariance * j.transpose())(0, 0));
  };
  // Wider than all there could be, it is what rounding left of no information.
  const auto or_none = [](double wide, double most) {
    return wide < most ? wide : std::numeric_limits<double>::quiet_NaN();
  };
  constexpr double kRightAngle_rad = 0.5 * std::numbers::pi;
  bound.approach_rad = deviation([](const VectorXd& p) {
    return std::atan2(-p[kVy], p[kVx]) + p[kSlope];
  });
  bound.frame = deviation([](const VectorXd& p) { return p[kTime]; });
  bound.face_rad = bound.radius_rad = std::numeric_limits<double>::quiet_NaN();
  if (model.turns) {
    bound.face_rad =
        deviation([](const VectorXd& p) { return p[kFace] - p[kSlope]; });
    bound.radius_rad = deviation([](const VectorXd& p) {
      return p[kFace] - p[kSlope] + std::atan2(p[kHalfShort], p[kHalfLong]);
    });
  }
  bound.approach_rad = or_none(bound.approach_rad, kRightAngle_rad);
  bound.frame = or_none(bound.frame, static_cast<double>(film.frames));
  bound.face_rad = or_none(bound.face_rad, kRightAngle_rad);
  bound.radius_rad = or_none(bound.radius_rad, kRightAngle_rad);
  return bound;
}

}  // namespace touchdown::accuracy
