#include "layers/joint_step.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "layers/columns.h"
#include "numbers/lanes.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

// Sums over frames are taken in so many parts, whatever the threads.
constexpr std::size_t kParts = 4;

using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;
using SharedVector = Eigen::Matrix<double, kShared, 1>;

// The pixels that some sample shows, by row, and which of them each sample
// does. The body passes over a small share of all (a fifteenth where it crosses
// the picture once): no equation joins the others, and each is solved by
// itself.
struct ShownPixels {
  std::vector<std::size_t> pixel;
  std::vector<std::vector<std::uint32_t>> of_samples;  // by frame

  ShownPixels(const std::vector<FrameSamples>& frames, std::size_t pixels) {
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
  std::size_t size() const { return pixel.size(); }
};

// All unknowns but the still picture where no sample shows it.
struct Unknowns {
  std::vector<double> poses;  // x, y, angle of each frame
  std::array<double, kShared> shared{};
  std::vector<float> picture;
  std::vector<float> still;   // of each shown pixel
  std::vector<float> change;  // of each sample: a part's own

  Unknowns(std::size_t frames, std::size_t cells, std::size_t pixels)
      : poses(kPose * frames), picture(cells), still(pixels) {}
};

double Dot(const Unknowns& a, const Unknowns& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    sum += a.poses[i] * b.poses[i];
  for (std::size_t i = 0; i < kShared; ++i) sum += a.shared[i] * b.shared[i];
  for (std::size_t i = 0; i < a.picture.size(); ++i) {
    sum +=
        static_cast<double>(a.picture[i]) * static_cast<double>(b.picture[i]);
  }
  for (std::size_t i = 0; i < a.still.size(); ++i) {
    sum += static_cast<double>(a.still[i]) * static_cast<double>(b.still[i]);
  }
  return sum;
}

// a += factor * b
void Add(Unknowns& a, double factor, const Unknowns& b) {
  const auto by = static_cast<float>(factor);
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    a.poses[i] += factor * b.poses[i];
  for (std::size_t i = 0; i < kShared; ++i) a.shared[i] += factor * b.shared[i];
  for (std::size_t i = 0; i < a.picture.size(); ++i)
    a.picture[i] += by * b.picture[i];
  for (std::size_t i = 0; i < a.still.size(); ++i)
    a.still[i] += by * b.still[i];
}

// b = a + factor * b
void Turn(Unknowns& b, double factor, const Unknowns& a) {
  const auto by = static_cast<float>(factor);
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    b.poses[i] = a.poses[i] + factor * b.poses[i];
  for (std::size_t i = 0; i < kShared; ++i)
    b.shared[i] = a.shared[i] + factor * b.shared[i];
  for (std::size_t i = 0; i < a.picture.size(); ++i)
    b.picture[i] = a.picture[i] + by * b.picture[i];
  for (std::size_t i = 0; i < a.still.size(); ++i)
    b.still[i] = a.still[i] + by * b.still[i];
}

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

// B of a pixel that nothing tells keeps its level: as if a hundredth of a frame
// had shown it.
constexpr float kLeastStill = 0.01F;

// What the finest pattern of a spline's coefficients is of them in its levels,
// in both directions: (4 - 1 - 1) / 6 each.
constexpr float kFinest = 1.0F / 9.0F;

class NormalEquations {
 public:
  NormalEquations(const Layers& layers, const std::vector<FrameSamples>& frames,
                  const ShownPixels& shown, const StillEvidence& evidence,
                  const FreePart& free, const JointStepOptions& options)
      : layers_(layers),
        frames_(frames),
        shown_(shown),
        evidence_(evidence),
        free_(free),
        options_(options),
        cells_(CountCells(layers)),
        columns_(layers.flat ? kShared : std::size_t{kQuadratic}),
        parts_(kParts, Unknowns(0, cells_, shown.size())),
        outside_(cells_) {
    const double variance = layers.noise_dn * layers.noise_dn;
    const double texture = std::max(layers.texture_dn, 1e-2 * layers.noise_dn);
    stiffness_ = static_cast<float>(variance / (texture * texture));
    for (std::size_t i = 0; i < kShared; ++i) {
      const double u = options.prior.u[i];
      prior_[i] = u > 0.0 && i < columns_ ? variance / (u * u) : kHeld;
    }
  }

  // Right side.
  void Fill(Unknowns& right);
  void Multiply(const Unknowns& in, Unknowns& out);
  void Precondition(const Unknowns& in, Unknowns& out);

 private:
  // Precision of what is not fitted, far above any that pixels give.
  static constexpr double kHeld = 1e15;

  // work(samples, frame, part) over all frames, part by part.
  template <class Work>
  void AccumulateParts(const Work& work);
  void Collect(Unknowns& out);
  void PreconditionPicture(const std::vector<float>& in,
                           std::vector<float>& out);

  const Layers& layers_;
  const std::vector<FrameSamples>& frames_;
  const ShownPixels& shown_;
  const StillEvidence& evidence_;
  const FreePart& free_;
  const JointStepOptions& options_;
  std::size_t cells_;
  std::size_t columns_;          // of the shared parameters that are not held
  std::vector<Unknowns> parts_;  // each part's sums of what frames share
  std::vector<float> outside_;
  float stiffness_ = 0.0F;
  std::array<double, kShared> prior_{};

  // The preconditioner.
  std::vector<Eigen::Matrix3d> pose_inverse_;
  SharedMatrix shared_inverse_;
  std::vector<float> picture_inverse_;
  std::vector<float> picture_finest_;  // see PreconditionPicture
  std::vector<float> still_inverse_;
};

template <class Work>
void NormalEquations::AccumulateParts(const Work& work) {
  core::InParallel(static_cast<std::int64_t>(kParts), options_.threads,
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
    for (std::size_t i = 0; i < out.picture.size(); ++i) {
      out.picture[i] += part.picture[i];
    }
    for (std::size_t i = 0; i < out.still.size(); ++i) {
      out.still[i] += part.still[i];
    }
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
    const auto part = static_cast<std::size_t>(&sums - parts_.data());
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
    if (!options_.turns) block(2, 2) += kHeld;
    block.diagonal() *= 1.0 + 1e-6;
    block.diagonal().array() += 1e-9;
    pose_inverse_[t] = block.inverse();
  });
  Collect(right);
  SharedMatrix all = SharedMatrix::Zero();
  for (const auto& part : shared) all += part;
  all = all.selfadjointView<Eigen::Lower>();
  std::array<double, kShared> now = {layers_.blur,
                                     layers_.exposure * layers_.exposure,
                                     layers_.shape.half_long,
                                     layers_.shape.half_short,
                                     layers_.slope_x,
                                     layers_.slope_y,
                                     layers_.curve};
  std::copy(layers_.quadratic.begin(), layers_.quadratic.end(),
            now.begin() + kQuadratic);
  for (std::size_t a = 0; a < kShared; ++a) {
    all(static_cast<int>(a), static_cast<int>(a)) += prior_[a] + 1e-9;
    // What is held stays what it is.
    if (a < columns_ && options_.prior.u[a] > 0.0) {
      right.shared[a] -= prior_[a] * (now[a] - options_.prior.value[a]);
    }
  }
  shared_inverse_ = all.inverse();
  picture_inverse_.assign(cells_, 0.0F);
  picture_finest_.assign(cells_, 0.0F);
  if (cells_ > 0) {
    free_.RemoveComponent(layers_.picture.data(), outside_.data());
  }
  for (std::size_t c = 0; c < cells_; ++c) {
    float sum = 0.0F;
    for (const auto& part : picture) sum += part[c];
    right.picture[c] -= stiffness_ * outside_[c];
    const float held = stiffness_ + 1e-3F;
    picture_inverse_[c] = 1.0F / (sum + held);
    picture_finest_[c] =
        (std::sqrt((sum + held) / (kFinest * kFinest * sum + held)) - 1.0F) /
        (1.0F / kFinest - 1.0F);
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
        if (!options_.turns) {
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
    out.shared[a] += (prior_[a] + 1e-9) * in.shared[a];
  }
  if (cells_ > 0) free_.RemoveComponent(in.picture.data(), outside_.data());
  for (std::size_t c = 0; c < cells_; ++c) {
    out.picture[c] += stiffness_ * outside_[c] + 1e-3F * in.picture[c];
  }
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    out.still[i] +=
        (evidence_.weight[shown_.pixel[i]] + kLeastStill) * in.still[i];
  }
}

// Coefficients of a spline whose knots lie a pixel apart are told very
// unequally by levels: a pattern that changes its sign from knot to knot is a
// ninth of its coefficients. So where pixels tell T, its levels are what is
// scaled by their weights (d each); where only the prior does (h each), its
// coefficients are. With the direct transform F, and shares f between the two
// that are right for the finest and for the coarsest pattern:
//   M^-1 = G' D^-1 G,  G = f F + (1 - f),  D = d + h
void NormalEquations::PreconditionPicture(const std::vector<float>& in,
                                          std::vector<float>& out) {
  if (cells_ == 0) return;
  out = in;
  layers_.grid.TransformLevels(out.data());
  for (std::size_t c = 0; c < cells_; ++c) {
    const float f = picture_finest_[c];
    const float scaled =
        picture_inverse_[c] * (f * out[c] + (1.0F - f) * in[c]);
    out[c] = f * scaled;
    outside_[c] = (1.0F - f) * scaled;
  }
  layers_.grid.TransformLevels(out.data());
  for (std::size_t c = 0; c < cells_; ++c) out[c] += outside_[c];
}

void NormalEquations::Precondition(const Unknowns& in, Unknowns& out) {
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    const Eigen::Map<const Eigen::Vector3d> from(&in.poses[kPose * t]);
    Eigen::Map<Eigen::Vector3d>(&out.poses[kPose * t]) =
        pose_inverse_[t] * from;
  }
  const Eigen::Map<const SharedVector> from(in.shared.data());
  Eigen::Map<SharedVector>(out.shared.data()) = shared_inverse_ * from;
  PreconditionPicture(in.picture, out.picture);
  for (std::size_t x = 0; x < out.still.size(); ++x) {
    out.still[x] = still_inverse_[x] * in.still[x];
  }
}

}  // namespace

StillEvidence WeighStill(const PictureStack& stack, const Layers& layers,
                         const std::vector<FrameSamples>& frames, int threads) {
  StillEvidence evidence;
  evidence.weight.assign(stack.pixels(), 0.0F);
  evidence.residual.assign(stack.pixels(), 0.0F);
  const double noise_dn = layers.noise_dn;
  // Row by row, and in a row frame by frame, so that the compiler can take
  // pixels together and threads do not matter.
  const auto weigh_row = [&](std::int32_t row) {
    const std::size_t first =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(stack.width);
    const float* const still = layers.still.data() + first;
    float* const weights = evidence.weight.data() + first;
    float* const residuals = evidence.residual.data() + first;
    float pictures = 0.0F;
    std::vector<float> shown(static_cast<std::size_t>(stack.width));
    for (std::size_t t = 0; t < frames.size(); ++t) {
      if (frames[t].size() == 0) continue;
      pictures += 1.0F;
      const core::PixelRect& window = stack.windows[t];
      if (row < window.y || row >= window.y + window.height) continue;
      const float* const levels = stack.WindowRow(t, row);
      const std::ptrdiff_t left = window.x;
      for (std::ptrdiff_t i = 0; i < window.width; ++i) {
        const float off = levels[i] - still[left + i];
        const float weight = RobustWeight(off, noise_dn);
        weights[left + i] += weight;
        residuals[left + i] += weight * off;
        shown[static_cast<std::size_t>(left + i)] += 1.0F;
      }
    }
    if (stack.outside.empty()) return;
    const float* const outside = stack.outside.data() + first;
    for (std::ptrdiff_t x = 0; x < stack.width; ++x) {
      const float off = outside[x] - still[x];
      const float weight = (pictures - shown[static_cast<std::size_t>(x)]) *
                           RobustWeight(off, noise_dn);
      weights[x] += weight;
      residuals[x] += weight * off;
    }
  };
  core::InParallel(stack.height, threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (std::int64_t row = begin; row < end; ++row) {
                       weigh_row(static_cast<std::int32_t>(row));
                     }
                   });
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto x = static_cast<std::size_t>(samples.pixel[i]);
      const float off = samples.level[i] - layers.still[x];
      const float weight = RobustWeight(off, noise_dn);
      evidence.weight[x] -= weight;
      evidence.residual[x] -= weight * off;
    }
  }
  for (float& weight : evidence.weight) weight = std::max(weight, 0.0F);
  return evidence;
}

FreePart::FreePart(const PictureGrid& grid) {
  std::vector<std::vector<double>> columns;
  const double half_x = 0.5 * grid.columns();
  const double half_y = 0.5 * grid.rows();
  for (int power = 0; power < 6; ++power) {
    std::vector<double> column;
    column.reserve(grid.size());
    for (std::int32_t j = 0; j < grid.rows(); ++j) {
      for (std::int32_t i = 0; i < grid.columns(); ++i) {
        const double x = static_cast<double>(grid.x_of(i)) / half_x;
        const double y = static_cast<double>(grid.y_of(j)) / half_y;
        const std::array<double, 6> terms = {1.0, x, y, x * x, x * y, y * y};
        column.push_back(terms[static_cast<std::size_t>(power)]);
      }
    }
    for (const auto& other : columns) {
      double along = 0.0;
      for (std::size_t c = 0; c < column.size(); ++c)
        along += other[c] * column[c];
      for (std::size_t c = 0; c < column.size(); ++c)
        column[c] -= along * other[c];
    }
    double square = 0.0;
    for (const double value : column) square += value * value;
    for (double& value : column) value /= std::sqrt(square);
    columns.push_back(std::move(column));
  }
  for (const auto& column : columns) {
    basis_.emplace_back(column.begin(), column.end());
  }
}

void FreePart::RemoveComponent(const float* from, float* to) const {
  const std::size_t cells = basis_.front().size();
  std::copy(from, from + cells, to);
  for (const std::vector<float>& column : basis_) {
    double along = 0.0;
    for (std::size_t c = 0; c < cells; ++c) {
      along += static_cast<double>(column[c]) * static_cast<double>(from[c]);
    }
    const auto by = static_cast<float>(along);
    for (std::size_t c = 0; c < cells; ++c) to[c] -= by * column[c];
  }
}

JointStep SolveJointStep(const Layers& layers,
                         const std::vector<FrameSamples>& frames,
                         const StillEvidence& evidence, const FreePart& free,
                         const JointStepOptions& options) {
  const std::size_t n = frames.size();
  const ShownPixels shown(frames, layers.still.size());
  NormalEquations equations(layers, frames, shown, evidence, free, options);
  const std::size_t cells = CountCells(layers);
  Unknowns residual(n, cells, shown.size());
  equations.Fill(residual);
  Unknowns step(n, cells, shown.size());
  Unknowns scaled = step;
  equations.Precondition(residual, scaled);
  Unknowns direction = scaled;
  Unknowns product = step;
  double power = Dot(residual, scaled);
  const double goal =
      std::max(power * options.tolerance * options.tolerance,
               options.least_chi2 * layers.noise_dn * layers.noise_dn);
  JointStep out;
  while (out.products < options.most_products && power > goal) {
    equations.Multiply(direction, product);
    ++out.products;
    const double along = Dot(direction, product);
    if (!(along > 0.0)) break;
    const double length = power / along;
    Add(step, length, direction);
    Add(residual, -length, product);
    equations.Precondition(residual, scaled);
    const double next = Dot(residual, scaled);
    Turn(direction, next / power, scaled);
    power = next;
  }
  for (std::size_t t = 0; t < n; ++t) {
    out.poses.push_back({step.poses[kPose * t], step.poses[kPose * t + 1],
                         step.poses[kPose * t + 2]});
  }
  out.shared = step.shared;
  out.picture = std::move(step.picture);
  out.still.resize(layers.still.size());
  for (std::size_t x = 0; x < out.still.size(); ++x) {
    out.still[x] = evidence.residual[x] / (evidence.weight[x] + kLeastStill);
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    out.still[shown.pixel[i]] = step.still[i];
  }
  return out;
}

}  // namespace touchdown::vision::layers
