#include "tests/accuracy/face_information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchdown::accuracy {
namespace {

using Eigen::MatrixXd;

// Pixels with less of the body have no part in a frame's information.
constexpr double kLeastCover = 1e-5;
// Waves of which all frames together tell less than this share of what is
// known of them before are left out: they change no bound by 1e-3.
constexpr double kLeastTold = 0.01;
// Period of the waves beyond the body, in correlation lengths: the field on
// one side of the body is not to know that on the other.
constexpr double kMargin = 3.0;

double HalfDiagonal_px(const Case& c) {
  const auto& t = c.film.thrown;
  return c.film.camera.px_per_m *
         (t.kind == core::BodyKind::kSphere
              ? t.half_long_m
              : std::hypot(t.half_long_m, t.half_short_m));
}

double Sinc(double x) { return std::abs(x) < 1e-6 ? 1.0 : std::sin(x) / x; }

}  // namespace

FaceInformation::FaceInformation(const Case& c, double pixel_variance)
    : case_(c), variance_(pixel_variance) {
  const vision::SceneFace& face = *c.film.look.face;
  const double blur2 = c.levels.blur_px * c.levels.blur_px + 1.0 / 12.0;
  const double l = face.correlation_px;
  const double period = 2.0 * HalfDiagonal_px(c) + kMargin * l;
  const double step = 2.0 * std::numbers::pi / period;
  const auto frames = static_cast<double>(c.film.frames - c.film.lead_in);
  // Any level, as wide as the whole scale.
  waves_.push_back({0.0, 0.0, false, 1.0});
  constexpr int kMost = 200;
  for (int i = 0; i <= kMost; ++i) {
    for (int j = i == 0 ? 1 : -kMost; j <= kMost; ++j) {
      const double k2 = step * step * (i * i + j * j);
      const double variance = 2.0 * face.amplitude * face.amplitude * 2.0 *
                              std::numbers::pi * l * l / (period * period) *
                              std::exp(-0.5 * k2 * l * l);
      const double told = variance * std::exp(-k2 * blur2) * frames * period *
                          period / (2.0 * variance_);
      if (told < kLeastTold) continue;
      for (const bool sine : {false, true}) {
        waves_.push_back({step * i, step * j, sine, 1.0 / variance});
      }
    }
  }

  // How much each frame covers: a white body before black.
  vision::Scene scene = SceneWith(0.0, 0.0, {});
  scene.look = {};
  scene.look.body_level = 1.0;
  scene.look.background_level = scene.look.ground_level = 0.0;
  const vision::SceneRenderer covers(scene);
  const auto full = static_cast<float>((1 << c.film.camera.bit_depth) - 1);
  uncovered_.assign(covers.background().dn.size(), 0.0f);
  for (std::int64_t f = 0; f < c.film.frames; ++f) {
    std::vector<float> cover = covers.RenderClean(f).dn;
    for (std::size_t i = 0; i < cover.size(); ++i) {
      cover[i] /= full;
      uncovered_[i] += 1.0f - cover[i];
    }
    covers_.push_back(std::move(cover));
  }
  const auto waves = static_cast<Eigen::Index>(waves_.size());
  picture_ = MatrixXd::Zero(waves, waves);
}

vision::Scene FaceInformation::SceneWith(double long_px, double short_px,
                                         Offsets offsets) const {
  pipeline::filmed::Film film = case_.film;
  const double scale = film.camera.px_per_m;
  film.thrown.contact_s = film.contact_frame / film.camera.fps;
  vision::Scene scene = pipeline::filmed::BuildScene(film);
  const vision::PoseFunction pose = scene.pose;
  if (scene.body.kind == core::BodyKind::kSphere) {
    scene.body.diameter_m->value += 2.0 * long_px / scale;
  } else {
    scene.body.long_m->value += 2.0 * long_px / scale;
    scene.body.short_m->value += 2.0 * short_px / scale;
  }
  scene.pose = [pose, offsets, scale](double t) {
    vision::ScenePose p = pose(t);
    p.centre.x_m += offsets.along_px / scale;
    p.centre.y_m += offsets.up_px / scale;
    p.angle_rad += offsets.angle_rad;
    return p;
  };
  return scene;
}

MatrixXd FaceInformation::ImageJacobian(std::int64_t index) const {
  constexpr double kStep = 0.01;  // px; of the angle, rad
  const double full = (1 << case_.film.camera.bit_depth) - 1;
  MatrixXd j(static_cast<Eigen::Index>(uncovered_.size()), kPose);
  for (int p = 0; p < kPose; ++p) {
    const auto at = [&](double by) {
      Offsets offsets;
      double long_px = 0.0;
      double short_px = 0.0;
      double* const moved[kPose] = {&offsets.along_px, &offsets.up_px,
                                    &offsets.angle_rad, &long_px, &short_px};
      *moved[p] = by;
      return vision::SceneRenderer(SceneWith(long_px, short_px, offsets))
          .RenderClean(index);
    };
    const vision::CleanImage up = at(kStep);
    const vision::CleanImage down = at(-kStep);
    for (Eigen::Index i = 0; i < j.rows(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      j(i, p) =
          (static_cast<double>(up.dn[k]) - static_cast<double>(down.dn[k])) /
          (2.0 * kStep * full);
    }
  }
  return j;
}

void FaceInformation::Add(std::int64_t index, const MatrixXd& pose_jacobian) {
  const vision::SceneCamera& camera = case_.film.camera;
  pipeline::filmed::Film film = case_.film;
  film.thrown.contact_s = film.contact_frame / camera.fps;
  const double middle_s = static_cast<double>(index) / camera.fps;
  const vision::ScenePose pose = film.thrown.At(middle_s);
  const vision::ScenePose first =
      film.thrown.At(middle_s - 0.5 * camera.exposure_s);
  const vision::ScenePose last =
      film.thrown.At(middle_s + 0.5 * camera.exposure_s);
  const double ca = std::cos(pose.angle_rad);
  const double sa = std::sin(pose.angle_rad);
  // Into the body's frame.
  const auto ahead = [&](double x, double y) { return x * ca + y * sa; };
  const auto up = [&](double x, double y) { return y * ca - x * sa; };
  const double mx = camera.px_per_m * (last.centre.x_m - first.centre.x_m);
  const double my = camera.px_per_m * (last.centre.y_m - first.centre.y_m);
  const double blur2 = case_.levels.blur_px * case_.levels.blur_px + 1.0 / 12.0;
  std::vector<double> seen;  // what blur and motion leave of each wave
  for (const Wave& w : waves_) {
    seen.push_back(std::exp(-0.5 * blur2 * (w.kx * w.kx + w.ky * w.ky)) *
                   Sinc(0.5 * (w.kx * ahead(mx, my) + w.ky * up(mx, my))));
  }

  const std::vector<float>& cover = covers_[static_cast<std::size_t>(index)];
  std::vector<Eigen::Index> pixels;
  for (std::size_t i = 0; i < cover.size(); ++i) {
    if (static_cast<double>(cover[i]) > kLeastCover) {
      pixels.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const MatrixXd image = ImageJacobian(index);
  const auto n = static_cast<Eigen::Index>(pixels.size());
  MatrixXd by_pose(n, kPose);
  MatrixXd by_wave(n, static_cast<Eigen::Index>(waves_.size()));
  const core::PixelPoint centre = ToIdealImage(camera, pose.centre);
  const double c = std::cos(camera.roll_rad);
  const double s = std::sin(camera.roll_rad);
  const double travel = camera.travels_left ? -1.0 : 1.0;
  for (Eigen::Index row = 0; row < n; ++row) {
    const auto i =
        static_cast<std::size_t>(pixels[static_cast<std::size_t>(row)]);
    const auto m = static_cast<double>(cover[i]);
    const double behind = (1.0 - m) * (1.0 - m) /
                          std::max(1.0, static_cast<double>(uncovered_[i]));
    const double weight = 1.0 / std::sqrt(variance_ * (1.0 + behind));
    by_pose.row(row) = weight * image.row(static_cast<Eigen::Index>(i));
    const auto width = static_cast<std::size_t>(camera.width_px);
    const double dx = static_cast<double>(i % width) - centre.x_px;
    const double dy = static_cast<double>(i / width) - centre.y_px;
    const double x = travel * (dx * c + dy * s);
    const double y = dx * s - dy * c;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const Wave& w = waves_[k];
      const double phase = w.kx * ahead(x, y) + w.ky * up(x, y);
      by_wave(row, static_cast<Eigen::Index>(k)) =
          weight * m * seen[k] * (w.sine ? std::sin(phase) : std::cos(phase));
    }
  }
  const MatrixXd by_parameter = by_pose * pose_jacobian;
  if (parameters_.size() == 0) {
    parameters_ = MatrixXd::Zero(pose_jacobian.cols(), pose_jacobian.cols());
    cross_ = MatrixXd::Zero(by_wave.cols(), pose_jacobian.cols());
  }
  parameters_ += by_parameter.transpose() * by_parameter;
  cross_ += by_wave.transpose() * by_parameter;
  picture_.selfadjointView<Eigen::Lower>().rankUpdate(by_wave.transpose());
}

MatrixXd FaceInformation::Eliminate() const {
  MatrixXd picture = picture_.selfadjointView<Eigen::Lower>();
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    picture(i, i) += waves_[k].precision;
  }
  return parameters_ - cross_.transpose() * picture.llt().solve(cross_);
}

}  // namespace touchdown::accuracy
