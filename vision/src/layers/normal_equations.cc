#include "layers/normal_equations.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "layers/columns.h"
#include "numbers/lanes.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

// Sums over frames are taken in so many parts, whatever the threads.
constexpr std::size_t kParts = 4;

// Precision of what is not fitted, far above any that pixels give.
constexpr double kHeld = 1e15;
// Of what no pixel tells: of a parameter, and of a coefficient of T.
constexpr double kLeast = 1e-9;
constexpr float kLeastCell = 1e-3F;

using SharedMatrix = NormalEquations::SharedMatrix;

// Coefficients of T that are unknown: a flat body's picture is shared numbers.
std::size_t CountCells(const Layers& layers) {
  return layers.flat ? 0 : layers.picture.size();
}

// A frame's derivatives by its pose and by the first `shared` of what frames
// share.
ColumnList ListColumns(const FrameSamples& samples, std::size_t shared) {
  ColumnList columns{};
  for (std::size_t a = 0; a < kPose; ++a) {
    columns[a] = samples.by_pose[a].data();
  }
  for (std::size_t a = 0; a < shared; ++a) {
    columns[kPose + a] = samples.by_shared[a].data();
  }
  return columns;
}

// The spline's part of a product: `change` of each sample grows by what `in`
// changes there, takes the sample's weight, and is spread over `out`.
TOUCHDOWN_WIDEST
void PassThroughPicture(const PictureGrid& grid, const FrameSamples& samples,
                        const float* in, float* change, float* out) {
  // Neighbours in a row change the same coefficients, and one would wait for
  // the other: so many samples far from each other are taken together.
  constexpr std::size_t kStrands = 4;
  constexpr std::size_t kMostNodes = 5;  // of the exposure
  std::array<std::array<PictureGrid::PlaceWeights, kStrands>, kMostNodes>
      weights;
  const std::size_t n = samples.size();
  const std::size_t apart = (n + kStrands - 1) / kStrands;
  for (std::size_t i = 0; i < apart; ++i) {
    std::size_t strands = 0;
    for (; strands < kStrands; ++strands) {
      const std::size_t at = strands * apart + i;
      if (at >= n) break;
      float sum = change[at];
      for (std::size_t k = 0; k < samples.nodes; ++k) {
        const std::size_t node = at * samples.nodes + k;
        const SplinePlace& place = samples.place[node];
        weights[k][strands] = PictureGrid::WeighPlace(place);
        sum += samples.share[node] *
               grid.EvaluateSpline(in, place, weights[k][strands]);
      }
      change[at] = samples.weight[at] * sum;
    }
    for (std::size_t k = 0; k < samples.nodes; ++k) {
      for (std::size_t s = 0; s < strands; ++s) {
        const std::size_t at = s * apart + i;
        const std::size_t node = at * samples.nodes + k;
        grid.Spread(samples.share[node] * change[at], samples.place[node],
                    weights[k][s], out);
      }
    }
  }
}

// By how much each direction changes each sample, T aside.
ByDirection ChangesByDirection(const FrameSamples& samples,
                               const Eigen::Matrix3d& axes) {
  ByDirection changes(samples.size(), kDirections);
  for (std::size_t a = 0; a < kQuadratic; ++a) {
    changes.col(static_cast<Eigen::Index>(a)) = AsVector(samples.by_shared[a]);
  }
  Eigen::MatrixX3f by_pose(samples.size(), 3);
  for (std::size_t a = 0; a < kPose; ++a) {
    by_pose.col(static_cast<Eigen::Index>(a)) = AsVector(samples.by_pose[a]);
  }
  changes.rightCols<kPose>() = by_pose * axes.cast<float>();
  return changes;
}

// visit(sample, share, place, weights of the place) of each place that a sample
// sees T at.
template <class Visit>
void VisitNodes(const FrameSamples& samples, const Visit& visit) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t k = 0; k < samples.nodes; ++k) {
      const std::size_t at = i * samples.nodes + k;
      visit(i, samples.share[at], samples.place[at],
            PictureGrid::WeighPlace(samples.place[at]));
    }
  }
}

}  // namespace

ShownPixels::ShownPixels(const std::vector<FrameSamples>& frames,
                         std::size_t pixels) {
  std::vector<std::uint32_t> place(pixels);
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      place[static_cast<std::size_t>(samples.pixel[i])] = 1;
    }
  }
  for (std::size_t x = 0; x < pixels; ++x) {
    if (place[x] == 0) continue;
    place[x] = static_cast<std::uint32_t>(pixel.size());
    pixel.push_back(x);
  }
  for (const FrameSamples& samples : frames) {
    std::vector<std::uint32_t>& shown = of_samples.emplace_back();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      shown.push_back(place[static_cast<std::size_t>(samples.pixel[i])]);
    }
  }
}

NormalEquations::NormalEquations(const Layers& layers,
                                 const std::vector<FrameSamples>& frames,
                                 const StillEvidence& evidence,
                                 const SharedPrior& prior, bool turns,
                                 const CoarseSpace& coarse, int threads)
    : layers_(layers),
      frames_(frames),
      evidence_(evidence),
      known_(prior),
      coarse_(coarse),
      turns_(turns),
      threads_(threads),
      shown_(frames, layers.still.size()),
      cells_(CountCells(layers)),
      columns_(layers.flat ? kShared : std::size_t{kQuadratic}),
      parts_(kParts, Unknowns(0, cells_, shown_.size())),
      outside_(cells_) {
  const double variance = layers.noise_dn * layers.noise_dn;
  variance_ = static_cast<float>(variance);
  if (!layers.flat) {
    // Less is as good as none, and no precision is endless.
    constexpr double kLeastTexture = 1e-2;  // of the noise
    Texture texture = layers.texture;
    texture.deviation_dn =
        std::max(texture.deviation_dn, kLeastTexture * layers.noise_dn);
    picture_prior_ = PicturePrior(layers.grid, texture);
  }
  for (std::size_t i = 0; i < kShared; ++i) {
    const double u = prior.u[i];
    prior_[i] = u > 0.0 && i < columns_ ? variance / (u * u) : kHeld;
  }
}

Unknowns NormalEquations::Zero() const {
  return {frames_.size(), cells_, shown_.size()};
}

template <class Work>
void NormalEquations::AccumulateParts(const Work& work) {
  core::InParallel(static_cast<std::int64_t>(kParts), threads_,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto part = static_cast<std::size_t>(begin);
                          part < static_cast<std::size_t>(end); ++part) {
                       Unknowns& sums = parts_[part];
                       sums.shared.fill(0.0);
                       std::fill(sums.picture.begin(), sums.picture.end(),
                                 0.0F);
                       std::fill(sums.still.begin(), sums.still.end(), 0.0F);
                       const std::size_t n = frames_.size();
                       for (std::size_t t = part * n / kParts;
                            t < (part + 1) * n / kParts; ++t) {
                         work(frames_[t], t, sums);
                       }
                     }
                   });
}

void NormalEquations::Collect(Unknowns& out) {
  out.shared.fill(0.0);
  std::fill(out.picture.begin(), out.picture.end(), 0.0F);
  std::fill(out.still.begin(), out.still.end(), 0.0F);
  for (const Unknowns& part : parts_) {
    for (std::size_t i = 0; i < kShared; ++i) out.shared[i] += part.shared[i];
    AsVector(out.picture) += AsVector(part.picture);
    AsVector(out.still) += AsVector(part.still);
  }
}

void NormalEquations::Fill(Unknowns& right) {
  pose_inverse_.assign(frames_.size(), Eigen::Matrix3d::Identity());
  std::vector<SharedMatrix> shared(kParts, SharedMatrix::Zero());
  std::vector<std::vector<float>> picture(kParts, std::vector<float>(cells_));
  std::vector<std::vector<float>> still(kParts,
                                        std::vector<float>(shown_.size()));
  AccumulateParts([&](const FrameSamples& samples, std::size_t t,
                      Unknowns& sums) {
    const std::size_t part = PartOf(sums);
    const std::size_t n = samples.size();
    const ColumnList columns = ListColumns(samples, columns_);
    std::array<double, kMostColumns> along{};
    std::vector<float>& weighted = sums.change;
    weighted.resize(n);
    const auto weigh = [&](const float* column) {
      for (std::size_t i = 0; i < n; ++i) {
        weighted[i] = samples.weight[i] * column[i];
      }
    };
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (std::size_t a = 0; a < kPose; ++a) {
      weigh(columns[a]);
      SumProducts(columns, kPose, weighted.data(), n, along);
      for (std::size_t b = 0; b < kPose; ++b) {
        block(static_cast<int>(a), static_cast<int>(b)) = along[b];
      }
    }
    for (std::size_t a = 0; a < columns_; ++a) {
      weigh(columns[kPose + a]);
      SumProducts(columns, kPose + a + 1, weighted.data(), n, along);
      for (std::size_t b = 0; b <= a; ++b) {
        shared[part](static_cast<int>(a), static_cast<int>(b)) +=
            along[kPose + b];
      }
    }
    weigh(samples.residual.data());
    SumProducts(columns, kPose + columns_, weighted.data(), n, along);
    for (std::size_t a = 0; a < kPose; ++a) {
      right.poses[kPose * t + a] = along[a];
    }
    for (std::size_t a = 0; a < columns_; ++a) {
      sums.shared[a] += along[kPose + a];
    }
    for (std::size_t i = 0; i < n; ++i) {
      const float w = samples.weight[i];
      const float wr = weighted[i];
      const std::size_t pixel = shown_.of_samples[t][i];
      sums.still[pixel] += samples.open[i] * wr;
      still[part][pixel] += w * samples.open[i] * samples.open[i];
      for (std::size_t k = 0; k < samples.nodes; ++k) {
        const std::size_t at = i * samples.nodes + k;
        const float share = samples.share[at];
        layers_.grid.Spread(share * wr, samples.place[at], sums.picture.data());
        layers_.grid.Spread(w * share * samples.cover[i], samples.place[at],
                            picture[part].data());
      }
    }
    if (!turns_) block(2, 2) += kHeld;
    block.diagonal() *= 1.0 + 1e-6;
    block.diagonal().array() += kLeast;
    pose_inverse_[t] = block.inverse();
  });
  Collect(right);
  SharedMatrix all = SharedMatrix::Zero();
  for (const auto& part : shared) all += part;
  InvertCoarse(all.selfadjointView<Eigen::Lower>());
  std::array<double, kShared> now = {layers_.blur,
                                     layers_.exposure * layers_.exposure,
                                     layers_.shape.half_long,
                                     layers_.shape.half_short,
                                     layers_.slope_x,
                                     layers_.slope_y};
  std::copy(layers_.quadratic.begin(), layers_.quadratic.end(),
            now.begin() + kQuadratic);
  for (std::size_t a = 0; a < kShared; ++a) {
    // What is held stays what it is.
    if (a < columns_ && known_.u[a] > 0.0) {
      right.shared[a] -= prior_[a] * (now[a] - known_.value[a]);
    }
  }
  if (cells_ > 0) {
    picture_prior_.Multiply(layers_.picture.data(), outside_.data());
    for (std::size_t c = 0; c < cells_; ++c) {
      right.picture[c] -= variance_ * outside_[c];
    }
    for (std::size_t part = 1; part < kParts; ++part) {
      AsVector(picture[0]) += AsVector(picture[part]);
    }
    picture_factor_ =
        coarse_.empty() ? FactorPicture(picture[0]) : coarse_.factor;
  }
  still_inverse_.assign(shown_.size(), 0.0F);
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    float sum = evidence_.weight[shown_.pixel[i]] + kLeastStill;
    for (const auto& part : still) sum += part[i];
    right.still[i] += evidence_.residual[shown_.pixel[i]];
    still_inverse_[i] = 1.0F / sum;
  }
}

void NormalEquations::Multiply(const Unknowns& in, Unknowns& out) {
  AccumulateParts(
      [&](const FrameSamples& samples, std::size_t t, Unknowns& sums) {
        const std::size_t n = samples.size();
        const std::uint32_t* const shown = shown_.of_samples[t].data();
        std::vector<float>& change = sums.change;
        change.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
          change[i] = samples.open[i] * in.still[shown[i]];
        }
        const ColumnList columns = ListColumns(samples, columns_);
        std::array<float, kMostColumns> factors{};
        for (std::size_t a = 0; a < kPose; ++a) {
          factors[a] = static_cast<float>(in.poses[kPose * t + a]);
        }
        for (std::size_t a = 0; a < columns_; ++a) {
          factors[kPose + a] = static_cast<float>(in.shared[a]);
        }
        AddColumns(columns, kPose + columns_, factors, n, change.data());
        if (samples.nodes > 0) {
          PassThroughPicture(layers_.grid, samples, in.picture.data(),
                             change.data(), sums.picture.data());
        } else {
          for (std::size_t i = 0; i < n; ++i) change[i] *= samples.weight[i];
        }
        std::array<double, kMostColumns> along{};
        SumProducts(columns, kPose + columns_, change.data(), n, along);
        for (std::size_t a = 0; a < kPose; ++a) {
          out.poses[kPose * t + a] = along[a];
        }
        if (!turns_) {
          out.poses[kPose * t + 2] += kHeld * in.poses[kPose * t + 2];
        }
        for (std::size_t a = 0; a < columns_; ++a) {
          sums.shared[a] += along[kPose + a];
        }
        for (std::size_t i = 0; i < n; ++i) {
          sums.still[shown[i]] += samples.open[i] * change[i];
        }
      });
  Collect(out);
  for (std::size_t a = 0; a < kShared; ++a) {
    out.shared[a] += (prior_[a] + kLeast) * in.shared[a];
  }
  if (cells_ > 0) picture_prior_.Multiply(in.picture.data(), outside_.data());
  for (std::size_t c = 0; c < cells_; ++c) {
    out.picture[c] += variance_ * outside_[c] + kLeastCell * in.picture[c];
  }
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    out.still[i] +=
        (evidence_.weight[shown_.pixel[i]] + kLeastStill) * in.still[i];
  }
}

// T's own block, as if each sample lay on a knot: with the levels F of a
// spline's coefficients at the knots, what pixels tell of each level (`weight`)
// and the prior's Q,
//   F' diag(weight) F + s^2 Q.
std::shared_ptr<const PictureFactor> NormalEquations::FactorPicture(
    const std::vector<float>& weight) const {
  const auto cells = static_cast<Eigen::Index>(cells_);
  const std::int32_t columns = layers_.grid.columns();
  const std::int32_t rows = layers_.grid.rows();
  const FourFloats share = SplineWeights(0.0F);  // of three neighbours
  std::vector<Eigen::Triplet<float>> levels;
  for (std::int32_t j = 0; j < rows; ++j) {
    for (std::int32_t i = 0; i < columns; ++i) {
      for (std::int32_t dj = -1; dj <= 1; ++dj) {
        for (std::int32_t di = -1; di <= 1; ++di) {
          if (i + di < 0 || i + di >= columns || j + dj < 0 || j + dj >= rows) {
            continue;
          }
          levels.emplace_back(j * columns + i, (j + dj) * columns + i + di,
                              share[di + 1] * share[dj + 1]);
        }
      }
    }
  }
  Eigen::SparseMatrix<float> seen(cells, cells);
  seen.setFromTriplets(levels.begin(), levels.end());
  Eigen::SparseMatrix<float> block =
      seen.transpose() * AsVector(weight).asDiagonal() * seen;
  block += variance_ * picture_prior_.MakePrecision();
  for (Eigen::Index c = 0; c < cells; ++c) block.coeffRef(c, c) += kLeastCell;
  return std::make_shared<const PictureFactor>(block);
}

void NormalEquations::PreconditionPicture(const float* in, float* out) const {
  if (cells_ == 0) return;
  const auto cells = static_cast<Eigen::Index>(cells_);
  Eigen::Map<Eigen::VectorXf>(out, cells) =
      picture_factor_->solve(Eigen::Map<const Eigen::VectorXf>(in, cells));
}

void NormalEquations::Precondition(const Unknowns& in, Unknowns& out) {
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    const Eigen::Map<const Eigen::Vector3d> from(&in.poses[kPose * t]);
    Eigen::Map<Eigen::Vector3d>(&out.poses[kPose * t]) =
        pose_inverse_[t] * from;
  }
  PreconditionPicture(in.picture.data(), out.picture.data());
  for (std::size_t x = 0; x < out.still.size(); ++x) {
    out.still[x] = still_inverse_[x] * in.still[x];
  }
  AddCoarse(in, out);
}

// W (W' A W)^-1 W' `in`; without a coarse space W is the shared parameters.
void NormalEquations::AddCoarse(const Unknowns& in, Unknowns& out) {
  out.shared.fill(0.0);
  if (!coarse_.empty()) {
    coarse_.Prolong(coarse_inverse_ * coarse_.Restrict(in), out);
    return;
  }
  const auto columns = static_cast<Eigen::Index>(columns_);
  Eigen::Map<Eigen::VectorXd>(out.shared.data(), columns) =
      coarse_inverse_ *
      Eigen::Map<const Eigen::VectorXd>(in.shared.data(), columns);
}

// `shared`: what pixels say of the shared parameters.
void NormalEquations::InvertCoarse(const SharedMatrix& shared) {
  const auto columns = static_cast<Eigen::Index>(columns_);
  NormalMatrix all = shared.topLeftCorner(columns, columns);
  if (!coarse_.empty()) all = coarse_.stiffness;
  all.diagonal().head(columns) +=
      Eigen::Map<const Eigen::VectorXd>(prior_.data(), columns);
  all.diagonal().array() += kLeast;
  if (!coarse_.empty() && !turns_) all.diagonal().tail<1>().array() += kHeld;
  coarse_inverse_ = SymmetricFactor(all).Inverse();
}

CoarseSpace NormalEquations::FindCoarseSpace(
    const std::vector<LayerPose>& poses) {
  CoarseSpace coarse;
  coarse.factor = picture_factor_;
  for (const LayerPose& pose : poses) {
    Eigen::Matrix3d& axes = coarse.axes.emplace_back();
    axes = Eigen::AngleAxisd(pose.angle_rad, Eigen::Vector3d::UnitZ());
  }
  const auto cells = static_cast<Eigen::Index>(cells_);
  // What T does to undo each direction.
  std::vector<ByDirection> undone(kParts,
                                  ByDirection::Zero(cells, kDirections));
  AccumulateParts(
      [&](const FrameSamples& samples, std::size_t t, Unknowns& sums) {
        ByDirection& picture = undone[PartOf(sums)];
        const ByDirection changes = ChangesByDirection(samples, coarse.axes[t]);
        VisitNodes(samples, [&](std::size_t i, float share,
                                const SplinePlace& place, const auto& weights) {
          const auto row = static_cast<Eigen::Index>(i);
          for (Eigen::Index d = 0; d < changes.cols(); ++d) {
            layers_.grid.Spread(-share * samples.weight[i] * changes(row, d),
                                place, weights, picture.col(d).data());
          }
        });
      });
  for (std::size_t part = 1; part < kParts; ++part) undone[0] += undone[part];
  coarse.picture.resize(cells, kDirections);
  for (Eigen::Index d = 0; d < coarse.picture.cols(); ++d) {
    PreconditionPicture(undone[0].col(d).data(), coarse.picture.col(d).data());
  }
  using Stiffness = decltype(coarse.stiffness);
  std::vector<Stiffness> stiffness(kParts, Stiffness::Zero());
  AccumulateParts([&](const FrameSamples& samples, std::size_t t,
                      Unknowns& sums) {
    ByDirection changes = ChangesByDirection(samples, coarse.axes[t]);
    VisitNodes(samples, [&](std::size_t i, float share,
                            const SplinePlace& place, const auto& weights) {
      const auto row = static_cast<Eigen::Index>(i);
      for (Eigen::Index d = 0; d < changes.cols(); ++d) {
        changes(row, d) +=
            share * layers_.grid.EvaluateSpline(coarse.picture.col(d).data(),
                                                place, weights);
      }
    });
    const auto exact = changes.cast<double>().eval();
    const auto weighted =
        (AsVector(samples.weight).cast<double>().asDiagonal() * exact).eval();
    stiffness[PartOf(sums)] += exact.transpose().lazyProduct(weighted);
  });
  coarse.stiffness.setZero();
  for (const Stiffness& sum : stiffness) coarse.stiffness += sum;
  ByDirection outside(cells, kDirections);
  for (Eigen::Index d = 0; d < outside.cols(); ++d) {
    picture_prior_.Multiply(coarse.picture.col(d).data(),
                            outside.col(d).data());
  }
  outside = variance_ * outside + kLeastCell * coarse.picture;
  coarse.stiffness +=
      outside.transpose().lazyProduct(coarse.picture).cast<double>();
  return coarse;
}

}  // namespace touchdown::vision::layers
