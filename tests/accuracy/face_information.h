// What the pixels tell of a body's poses where its face has a picture that
// nobody knows, and the still picture is as unknown: the two-layer bound.
//
// A frame is I = (1 - M) B + M T (M: how much of a pixel the body covers). The
// picture T is a sum of waves on the body,
//   T(u) = sum_k a_k cos(k u) + b_k sin(k u),
// normal with the variances of its random field (vision/synthetic/scene.h): the
// spectral density of exp(-d^2 / (2 l^2)) on a square of period S,
//   var a_k = var b_k = 2 A^2 (2 pi l^2 / S^2) exp(-k^2 l^2 / 2),
// and with a mean level of any value. With J the derivatives of the clean
// picture by the parameters (of rendered frames, central differences) and W
// those by the waves, both over the noise of a pixel, what the parameters are
// told of is the Schur complement
//   sum J'J - (sum J'W) (sum W'W + V^-1)^-1 (sum W'J).
// B is known as well as the frames that do not cover a pixel tell it: the
// variance of that pixel grows by the factor 1 + (1 - M)^2 / n.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tests/accuracy/design.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::accuracy {

// Poses are (along, height, angle, half long or radius, half short), px and
// rad, in the plane frame.
inline constexpr int kPose = 5;

class FaceInformation {
 public:
  // Of a case with look.face; `pixel_variance` in units of full scale.
  FaceInformation(const Case& c, double pixel_variance);

  // Frame `index`, whose pose depends on the parameters by `pose_jacobian`
  // (kPose rows).
  void Add(std::int64_t index, const Eigen::MatrixXd& pose_jacobian);

  // Of the parameters.
  Eigen::MatrixXd Eliminate() const;

 private:
  struct Wave {
    double kx = 0.0;  // rad per px, in the body's frame
    double ky = 0.0;
    bool sine = false;
    double precision = 0.0;  // 1 / variance
  };
  struct Offsets {
    double along_px = 0.0, up_px = 0.0, angle_rad = 0.0;
  };
  vision::Scene SceneWith(double long_px, double short_px,
                          Offsets offsets) const;
  // Of the clean picture of frame `index` by each component of the pose, in
  // units of full scale, all pixels.
  Eigen::MatrixXd ImageJacobian(std::int64_t index) const;

  Case case_;
  double variance_ = 0.0;
  std::vector<Wave> waves_;
  std::vector<std::vector<float>> covers_;  // M of each frame, all pixels
  std::vector<float> uncovered_;            // frames, of each pixel
  Eigen::MatrixXd parameters_;              // sum J'J
  Eigen::MatrixXd cross_;                   // sum W'J
  Eigen::MatrixXd picture_;                 // sum W'W
};

}  // namespace touchdown::accuracy
