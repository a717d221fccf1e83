#include "touchdown/calib/lens_calibration.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

namespace touchdown::calib {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct LensFit {
  cv::Mat camera = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat distortion = cv::Mat::zeros(5, 1, CV_64F);
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> shifts;

  Lens lens() const {
    const auto d = [&](int i) { return distortion.at<double>(i); };
    return {camera.at<double>(0, 0),
            camera.at<double>(1, 1),
            camera.at<double>(0, 2),
            camera.at<double>(1, 2),
            d(0),
            d(1),
            d(2),
            d(3),
            d(4)};
  }
};

std::vector<cv::Point3f> BoardPoints(const Board& board) {
  std::vector<cv::Point3f> points;
  for (const core::PlanePoint& p : ListBoardPoints(board)) {
    points.emplace_back(static_cast<float>(p.x_m), static_cast<float>(p.y_m),
                        0.0f);
  }
  return points;
}

LensFit RunFit(const std::vector<std::vector<cv::Point3f>>& board_points,
               const std::vector<std::vector<cv::Point2f>>& image_points,
               cv::Size size, int flags) {
  LensFit fit;
  cv::calibrateCamera(
      board_points, image_points, size, fit.camera, fit.distortion,
      fit.rotations, fit.shifts, flags,
      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100,
                       1e-11));
  return fit;
}

// How much larger the scale is at one side of the board than at the other, of
// the board's own perspective image: (wmax - wmin) / wmean with w the third
// homogeneous coordinate, the depth of the board's points up to a factor.
double Keystone(const std::vector<cv::Point3f>& board,
                const std::vector<cv::Point2f>& image) {
  std::vector<cv::Point2f> flat;
  flat.reserve(board.size());
  for (const cv::Point3f& p : board) flat.emplace_back(p.x, p.y);
  const cv::Mat h = cv::findHomography(flat, image, 0);
  if (h.empty()) return 0.0;
  double least = 1e300;
  double most = -1e300;
  for (const cv::Point2f& p : flat) {
    const double w = h.at<double>(2, 0) * static_cast<double>(p.x) +
                     h.at<double>(2, 1) * static_cast<double>(p.y) +
                     h.at<double>(2, 2);
    least = std::min(least, w);
    most = std::max(most, w);
  }
  return 2.0 * (most - least) / std::abs(most + least);
}

double Median(std::vector<double> values) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::size_t Cell(int row, int column) {
  return static_cast<std::size_t>(row) *
             static_cast<std::size_t>(kCoverageColumns) +
         static_cast<std::size_t>(column);
}

void Cover(const std::vector<BoardView>& views, std::int32_t width_px,
           std::int32_t height_px, LensCalibration& out) {
  for (const BoardView& view : views) {
    for (const core::PixelPoint& p : view.points) {
      const int column = std::clamp(
          static_cast<int>(kCoverageColumns * (p.x_px + 0.5) / width_px), 0,
          kCoverageColumns - 1);
      const int row = std::clamp(
          static_cast<int>(kCoverageRows * (p.y_px + 0.5) / height_px), 0,
          kCoverageRows - 1);
      ++out.cells[Cell(row, column)];
    }
  }
  const auto seen = std::count_if(out.cells.begin(), out.cells.end(),
                                  [](int corners) { return corners > 0; });
  out.coverage =
      static_cast<double>(seen) / static_cast<double>(out.cells.size());
}

// The sides of the picture whose outer two columns or rows of cells are empty.
std::string EmptySides(const LensCalibration& calibration) {
  const auto empty = [&](int column0, int column1, int row0, int row1) {
    for (int row = row0; row < row1; ++row) {
      for (int column = column0; column < column1; ++column) {
        if (calibration.cells[Cell(row, column)] > 0) {
          return false;
        }
      }
    }
    return true;
  };
  std::string sides;
  const auto add = [&](bool is, const char* side) {
    if (is) sides += (sides.empty() ? "" : ", ") + std::string(side);
  };
  add(empty(0, 2, 0, kCoverageRows), "left");
  add(empty(kCoverageColumns - 2, kCoverageColumns, 0, kCoverageRows), "right");
  add(empty(0, kCoverageColumns, 0, 2), "top");
  add(empty(0, kCoverageColumns, kCoverageRows - 2, kCoverageRows), "bottom");
  return sides;
}

// Quantile 0.975 of Student's t over the normal one: Cornish-Fisher, to 1 %
// from 4 degrees of freedom on.
double StudentOverNormal(double dof) {
  const double z = core::kNormal975;
  const double z2 = z * z;
  const double first = (z2 + 1.0) / (4.0 * dof);
  const double second = ((5.0 * z2 + 16.0) * z2 + 3.0) / (96.0 * dof * dof);
  return 1.0 + first + second;
}

// Residuals, the lens's covariance and the views' own results.
bool Judge(const LensFit& fit, const std::vector<BoardView>& views,
           const std::vector<cv::Point3f>& board,
           const std::vector<bool>& fixed, LensCalibration& out) {
  // OpenCV's Jacobian has rotation, shift, f, c, distortion.
  constexpr int kPose = 6;
  std::vector<int> free;
  for (int i = 0; i < kLensParameters; ++i) {
    if (!fixed[static_cast<std::size_t>(i)]) free.push_back(i);
  }
  const auto n_free = static_cast<Eigen::Index>(free.size());
  Matrix information = Matrix::Zero(n_free, n_free);
  std::vector<Vector> pulls;
  double squares = 0.0;
  std::int64_t numbers = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::vector<cv::Point2f> projected;
    cv::Mat jacobian;
    cv::projectPoints(board, fit.rotations[v], fit.shifts[v], fit.camera,
                      fit.distortion, projected, jacobian);
    const auto n = static_cast<Eigen::Index>(2 * board.size());
    Matrix poses(n, kPose);
    Matrix lens(n, n_free);
    Vector residual(n);
    ViewResult result{views[v].name, 0.0, 0.0, 0.0};
    double sum = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int row = static_cast<int>(i);
      for (int k = 0; k < kPose; ++k) poses(i, k) = jacobian.at<double>(row, k);
      for (Eigen::Index k = 0; k < n_free; ++k) {
        lens(i, k) =
            jacobian.at<double>(row, kPose + free[static_cast<std::size_t>(k)]);
      }
      const auto point = static_cast<std::size_t>(i / 2);
      const core::PixelPoint& seen = views[v].points[point];
      residual[i] = i % 2 == 0
                        ? seen.x_px - static_cast<double>(projected[point].x)
                        : seen.y_px - static_cast<double>(projected[point].y);
      if (i % 2 == 1) {
        const double d = std::hypot(residual[i - 1], residual[i]);
        sum += d * d;
        result.most_px = std::max(result.most_px, d);
      }
    }
    result.rms_px = std::sqrt(sum / static_cast<double>(board.size()));
    cv::Mat rotation;
    cv::Rodrigues(fit.rotations[v], rotation);
    result.tilt_rad =
        std::acos(std::clamp(std::abs(rotation.at<double>(2, 2)), 0.0, 1.0));
    out.views.push_back(result);
    squares += sum;
    numbers += n;
    // What the pose of this view cannot take up.
    const Matrix pose_information = poses.transpose() * poses;
    const Matrix rest =
        lens - poses * pose_information.ldlt().solve(poses.transpose() * lens);
    information += rest.transpose() * rest;
    pulls.emplace_back(rest.transpose() * residual);
  }
  out.rms_px = std::sqrt(2.0 * squares / static_cast<double>(numbers));
  out.degrees_of_freedom =
      numbers - n_free - kPose * static_cast<std::int64_t>(views.size());
  if (out.degrees_of_freedom < 1) return false;
  const double variance = squares / static_cast<double>(out.degrees_of_freedom);
  out.u_corner_px = std::sqrt(variance);

  // In units of each parameter's own standard deviation, for the inverse.
  const Vector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!unit.allFinite()) return false;
  const Matrix scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::LDLT<Matrix> solver(scaled);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return false;
  const Matrix inverse = unit.asDiagonal() *
                         solver.solve(Matrix::Identity(n_free, n_free)) *
                         unit.asDiagonal();
  Matrix covariance = variance * inverse;
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() <= 0.0) {
    return false;
  }

  Matrix meat = Matrix::Zero(n_free, n_free);
  for (const Vector& pull : pulls) meat += pull * pull.transpose();
  const auto n_views = static_cast<double>(views.size());
  const Matrix sandwich =
      n_views / (n_views - 1.0) * (inverse * meat * inverse);
  const double excess =
      (sandwich.diagonal().array() / covariance.diagonal().array()).mean();
  out.widened = std::sqrt(std::max(1.0, excess));
  if (excess > 1.0) out.widened *= StudentOverNormal(n_views - 1.0);
  covariance *= out.widened * out.widened;
  for (Eigen::Index i = 0; i < n_free; ++i) {
    for (Eigen::Index k = 0; k < n_free; ++k) {
      out.covariance(free[static_cast<std::size_t>(i)],
                     free[static_cast<std::size_t>(k)]) = covariance(i, k);
    }
  }
  return true;
}

void Warn(const LensCalibration& c, std::vector<std::string>& warnings) {
  // Views: with fewer the scatter between views, which gives u, is known badly.
  // For a warning.
  constexpr std::size_t kWantedViews = 10;
  if (c.views.size() < kWantedViews) {
    warnings.push_back(
        fmt::format("only {} views; ten or more make the uncertainties good",
                    c.views.size()));
  }
  std::vector<double> rms;
  for (const ViewResult& view : c.views) rms.push_back(view.rms_px);
  const double median = Median(rms);
  // Ratio to the median view's rms. For a warning. Not studied.
  constexpr double kMaxRmsRatio = 3.0;
  for (const ViewResult& view : c.views) {
    if (view.rms_px > kMaxRmsRatio * median) {
      warnings.push_back(fmt::format(
          "{}: its corners are off by {:.2f} px rms, the others' by {:.2f}; "
          "look at it, and leave it out if it is blurred",
          view.name, view.rms_px, median));
    }
  }
  // Share of the picture that corners cover. For a warning. Not studied.
  constexpr double kGoodCoverage = 0.6;
  const std::string sides = EmptySides(c);
  if (c.coverage < kGoodCoverage || !sides.empty()) {
    warnings.push_back(fmt::format(
        "corners cover {:.0f} % of the picture{}; distortion elsewhere is "
        "extrapolated",
        100.0 * c.coverage, sides.empty() ? "" : ", none at its " + sides));
  }
}

}  // namespace

core::Estimate LensCalibration::Parameter(int index) const {
  return {ToVector(lens)[index], std::sqrt(covariance(index, index)),
          std::nullopt};
}

core::Expected<LensCalibration> CalibrateLens(
    const std::vector<BoardView>& views, const Board& board,
    std::int32_t width_px, std::int32_t height_px,
    const LensCalibrationOptions& options) {
  if (width_px < 1 || height_px < 1) {
    throw std::invalid_argument(fmt::format(
        "picture size is {}x{}, must be positive", width_px, height_px));
  }
  const std::vector<cv::Point3f> points = BoardPoints(board);
  std::vector<std::vector<cv::Point2f>> image_points;
  for (const BoardView& view : views) {
    if (view.points.size() != points.size()) {
      throw std::invalid_argument(
          fmt::format("{} has {} points, must have the board's {}", view.name,
                      view.points.size(), points.size()));
    }
    std::vector<cv::Point2f> image;
    for (const core::PixelPoint& p : view.points) {
      image.emplace_back(static_cast<float>(p.x_px),
                         static_cast<float>(p.y_px));
    }
    image_points.push_back(std::move(image));
  }
  if (views.size() < static_cast<std::size_t>(options.least_views)) {
    return core::AbsentBecause(fmt::format(
        "too few views: the board was found in {}, at least {} are needed; "
        "film it in ten or more places, tilted to different sides",
        views.size(), options.least_views));
  }
  double keystone = 0.0;
  for (const auto& image : image_points) {
    keystone = std::max(keystone, Keystone(points, image));
  }
  const auto straight_on = [&] {
    return core::AbsentBecause(fmt::format(
        "all views look at the board straight on (its scale changes by {:.1f} "
        "% at most over the board): focal length and distance cannot be told "
        "apart; tilt the board by 20 to 40 degrees, left, right, up and down",
        100.0 * keystone));
  };
  if (keystone < options.least_keystone) return straight_on();
  LensCalibration out;
  Cover(views, width_px, height_px, out);
  if (out.coverage < options.least_coverage) {
    const std::string sides = EmptySides(out);
    return core::AbsentBecause(fmt::format(
        "poor coverage: corners were seen in {:.0f} % of the picture, at least "
        "{:.0f} % are needed{}; move the board over the whole picture, into "
        "its corners too",
        100.0 * out.coverage, 100.0 * options.least_coverage,
        sides.empty() ? "" : " (none at its " + sides + ")"));
  }

  const cv::Size size(width_px, height_px);
  const std::vector<std::vector<cv::Point3f>> board_points(views.size(),
                                                           points);
  std::vector<bool> fixed(kLensParameters, false);
  try {
    LensFit fit = RunFit(board_points, image_points, size, 0);
    // k3 is there for strong lenses; where little is seen of the picture's
    // corners it may bend the rest of them over.
    if (!IsInvertible(fit.lens(), width_px, height_px)) {
      fit = RunFit(board_points, image_points, size, cv::CALIB_FIX_K3);
      fixed.back() = true;
      out.warnings.emplace_back(
          "k3 was left out: with it the lens model folds the picture's corners "
          "back");
    }
    out.lens = fit.lens();
    if (!IsInvertible(out.lens, width_px, height_px)) {
      return core::AbsentBecause(fmt::format(
          "the lens model folds the picture back on itself (k1 {:.3g}, k2 "
          "{:.3g}); film the board nearer to the picture's corners",
          out.lens.k1, out.lens.k2));
    }
    if (!Judge(fit, views, points, fixed, out)) {
      return core::AbsentBecause(
          "the views do not determine the lens: they are too much alike; tilt "
          "the board to different sides and move it over the whole picture");
    }
  } catch (const cv::Exception& trouble) {
    return core::AbsentBecause(fmt::format(
        "the fit failed ({}); the views may be too much alike: tilt the board "
        "to different sides and move it over the whole picture",
        trouble.err));
  }
  const core::Estimate fx = out.Parameter(0);
  const core::Estimate fy = out.Parameter(1);
  const double u_focal = std::max(fx.u / fx.value, fy.u / fy.value);
  if (!(u_focal < options.most_u_focal)) {
    // Distortion changes a board's scale, too, off the picture's middle: this
    // much is still no tilt to speak of.
    constexpr double kHardlyTilted = 0.12;
    if (keystone < kHardlyTilted) return straight_on();
    return core::AbsentBecause(fmt::format(
        "the focal length is known to {:.1f} % only, {:.0f} % are needed: the "
        "views are too much alike; tilt the board by 20 to 40 degrees, left, "
        "right, up and down",
        100.0 * u_focal, 100.0 * options.most_u_focal));
  }
  Warn(out, out.warnings);
  return out;
}

}  // namespace touchdown::calib
