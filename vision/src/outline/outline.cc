#include "touchdown/vision/outline/outline.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "numbers/robust.h"
#include "numbers/symmetric_factor.h"
#include "outline/outline_image.h"
#include "outline/outline_inside.h"
#include "outline/outline_pixels.h"
#include "outline/outline_sums.h"
#include "outline/shared_fit.h"
#include "outline/track_shape.h"

namespace touchdown::vision {
namespace {

// Geometry (x, y, size, size, angle), blur, open share, six interior and six
// outer polynomial terms.
static_assert(kMostTerms <= static_cast<std::size_t>(kMostUnknowns));
// px of movement. A fit from a near start that moves by less may keep its set
// of pixels: those that come and go at the band's borders tell nothing of its
// place, and residuals at its edge are no outliers yet. Larger: the result
// depends on the start; smaller: more rounds. Not studied.
constexpr double kNearStart_px = 0.05;

// Iteratively reweighted Gauss-Newton on the pixels of one frame: predicted
// level = out + coverage (in - behind), with Tukey's weights on residuals in
// units of the noise.
class Fitter {
 public:
  Fitter(const core::Frame& frame, const Background& background,
         const Outline& start, const OutlineOptions& options, Inside inside)
      : frame_(frame),
        background_(background),
        options_(options),
        height_(options.ground),
        behind_(background, Models() ? height_ : Height(), Zone_px()),
        usable_(Models() ? Height() : height_, options.ground_margin_px,
                options.hider),
        outline_(start),
        blur_(options.blur_px),
        open_(options.open),
        smear_(options.travel_px, options.turn_rad, Extent(start)) {
    geometry_ = start.kind == core::BodyKind::kSphere ? 3 : 5;
    // px, half the smallest side. A smaller body cannot tell shading from
    // shape; with an appearance it has a shading, too, which other frames tell.
    // Not studied.
    const double small_px = options.appearance != nullptr ? 3.0 : 5.0;
    const bool flat =
        inside == Inside::kOneLevel || SmallestHalf(start) < small_px;
    interior_ = flat ? 1 : 6;
    outer_ = options.surround == OutlineOptions::Surround::kPolynomial ? 6 : 0;
  }

  core::Expected<OutlineFit> Run();

 private:
  bool Models() const {
    return options_.near_ground == OutlineOptions::NearGround::kModelled;
  }
  // Height above which the picture behind the body is free of the ground's
  // blurred edge. That edge has ended, to 2e-4, after 3.5 blurs; half of the 3
  // x 3 pixels that are averaged there comes on top.
  double Zone_px() const {
    // In units of blur_px, and px; see above.
    constexpr double kZoneBlurs = 3.5;
    constexpr double kHalf_px = 1.5;
    return kZoneBlurs * options_.blur_px + kHalf_px;
  }
  void CollectPixels();
  std::string Gather();
  std::string Iterate(int& iterations);
  bool SetAsideUnexplained();
  void SetSmear() { smear_.Set(blur_, open_, options_.fit_open); }
  // Share of the outline that lies in the picture and can be used.
  double Visible() const {
    return VisibleShare(frame_, outline_, cosine_, sine_, usable_);
  }
  void SolveLevels();
  bool NearLevels();
  static constexpr std::size_t At(int k) { return static_cast<std::size_t>(k); }
  void Accumulate(bool robust);
  void Sum(const OutlineRound& round);
  OutlineRound Round() const;
  NormalMatrix Regular() const;
  bool Step(double longer, double& geometric_step);
  // Order of the parameters: geometry, blur, shutter, then the levels.
  int OpenIndex() const { return geometry_ + 1; }
  int LevelsBegin() const { return geometry_ + 2; }
  int Parameters() const { return LevelsBegin() + interior_ + outer_; }
  bool Free(int k) const;
  double full_scale() const { return background_.full_scale_dn; }
  bool HasPrior() const { return options_.shading && interior_ == 6; }

  const core::Frame& frame_;
  const Background& background_;
  const OutlineOptions& options_;
  Height height_;
  Behind behind_;
  UsablePart usable_;
  Outline outline_;
  double blur_;
  double open_;
  Smear smear_;
  int geometry_ = 3;
  int interior_ = 6;
  int outer_ = 0;
  bool saturated_ = false;  // what lies around the body
  double cosine_ = 1.0;
  double sine_ = 0.0;
  NormalVector levels_;  // interior then outer polynomial coefficients, DN
  OutlinePixels pixels_;
  std::vector<double> residuals_;  // in units of the expected noise
  double robust_scale_ = 0.0;      // 0: plain least squares
  OutlineSums sums_;
  NormalMatrix normal_;
  NormalVector gradient_;
  double contrast_ = 0.0;
  double misfit_ = 0.0;
  double inliers_ = 0.0;
  bool converged_ = false;
  double before_aside_ = 0.0;  // visible share, where something was set aside
  bool telling_ = false;       // of what is held
};

void Fitter::CollectPixels() {
  SetSmear();
  PixelBand band;
  // In units of blur_px: farther from the edge the coverage is within 0.2 % of
  // 0 or 1. A wider band costs time; a narrower one loses the tail that tells
  // the blur.
  constexpr double kBandBlurs = 3.0;
  band.margin_px =
      kBandBlurs * std::max(blur_, 0.5) + 1.0 + 0.5 * smear_.way_px();
  // Inside, so much is needed to tell shading from blur.
  band.inner_px = saturated_ ? Extent(outline_) : std::max(12.0, 6.0 * blur_);
  band.known_background = outer_ == 0;
  band.appearance = outer_ == 0 ? options_.appearance : nullptr;
  CollectOutlinePixels(frame_, behind_, outline_, cosine_, sine_, usable_, band,
                       pixels_);
}

// Collects the pixels of the present outline. Returns why they are too few, or
// an empty text.
std::string Fitter::Gather() {
  // Share of the outline: a third of a circle still tells its centre; less is
  // known to a fraction of the size only. Not studied.
  constexpr double kMinVisible = 1.0 / 3.0;
  if (Visible() < kMinVisible) {
    return "less than a third of the outline is visible";
  }
  CollectPixels();
  if (static_cast<int>(pixels_.size) < 2 * Parameters()) {
    return "too few pixels of the outline are visible";
  }
  return {};
}

// Which of the geometry's parameters, blur and shutter the fit may change. Held
// ones become free for the sums that all frames share (tell_shared).
bool Fitter::Free(int k) const {
  if (k == geometry_) return options_.fit_blur || telling_;
  if (k == OpenIndex()) {
    return options_.fit_open || (telling_ && smear_.IsResolved());
  }
  if (options_.fit_size || telling_) return true;
  return !(k == 2 || (geometry_ == 5 && k == 3));
}

// Adds up the pixels and spreads the sums over all parameters; one that is held
// has no row. A prior of the shading is added to the levels' diagonal.
void Fitter::Sum(const OutlineRound& round) {
  sums_.SumPixels(pixels_, OutlineImage(outline_, smear_), round, residuals_);
  std::array<int, kMostTerms> at{};
  for (std::size_t k = 0; k < round.shapes; ++k) {
    at[k] = round.shape[k] == OutlineRound::kBlur ? geometry_
            : round.shape[k] == OutlineRound::kOpen
                ? OpenIndex()
                : static_cast<int>(round.shape[k]);
  }
  for (std::size_t k = round.shapes; k < round.terms(); ++k) {
    at[k] = LevelsBegin() + static_cast<int>(k - round.shapes);
  }
  normal_ = NormalMatrix::Zero(Parameters(), Parameters());
  gradient_ = NormalVector::Zero(Parameters());
  for (std::size_t i = 0; i < round.terms(); ++i) {
    gradient_[at[i]] = sums_.gradient(i);
    for (std::size_t j = 0; j <= i; ++j) {
      normal_(at[i], at[j]) = normal_(at[j], at[i]) = sums_.normal(i, j);
    }
  }
  if (!HasPrior()) return;
  for (int k = 0; k < interior_; ++k) {
    const double u = options_.shading->u[At(k)];
    const int row = LevelsBegin() + k;
    normal_(row, row) += 1.0 / (u * u);
    gradient_[row] +=
        (options_.shading->level[At(k)] - round.levels[At(k)]) / (u * u);
  }
}

OutlineRound Fitter::Round() const {
  OutlineRound round;
  round.interior = At(interior_);
  round.outer = At(outer_);
  return round;
}

// Levels that fit best at the present geometry: linear least squares. They give
// a start from which the joint iteration does not jump.
void Fitter::SolveLevels() {
  Sum(Round());
  const int n = interior_ + outer_;
  NormalMatrix a = normal_.bottomRightCorner(n, n);
  // A trace of ridge keeps an unseen polynomial term at zero.
  a.diagonal().array() += 1e-9 * (1e-12 + a.diagonal().maxCoeff());
  levels_ = SymmetricFactor(a).Solve(gradient_.tail(n));
}

// Takes the levels that the other frames tell, where the start is near, and
// assumes that residuals are of the noise's size. Returns false elsewhere.
bool Fitter::NearLevels() {
  if (!options_.starts_near || !HasPrior() || outer_ != 0) return false;
  levels_ = Eigen::Map<const Eigen::Vector<double, 6>>(
      options_.shading->level.data());
  robust_scale_ = 1.0;
  return true;
}

// Builds the normal equations at the present parameters, and the misfit: the
// rms of the inliers' residuals in units of the noise. Clipped pixels of a
// saturated surround fit by themselves and count for nothing.
void Fitter::Accumulate(bool robust) {
  OutlineRound round = Round();
  for (int k = 0; k < geometry_; ++k) {
    if (Free(k)) round.shape[round.shapes++] = At(k);
  }
  if (Free(geometry_)) round.shape[round.shapes++] = OutlineRound::kBlur;
  if (Free(OpenIndex())) round.shape[round.shapes++] = OutlineRound::kOpen;
  std::copy(levels_.begin(), levels_.end(), round.levels.begin());
  if (robust) round.cut = kTukeyCut * robust_scale_;
  Sum(round);
  contrast_ = sums_.contrast_dn;
  const double clipped =
      saturated_ ? ClippedAsExpected(pixels_, residuals_, full_scale()) : 0.0;
  inliers_ = (sums_.inliers - clipped) /
             std::max(1.0, static_cast<double>(pixels_.size) - clipped);
  const double spare = sums_.inliers - clipped - Parameters();
  misfit_ = spare > 0.0 ? std::sqrt(sums_.square / spare) : 0.0;
}

// The normal equations with held parameters held, and a trace of ridge against
// rounding.
NormalMatrix Fitter::Regular() const {
  NormalMatrix a = normal_;
  for (int k = 0; k < Parameters(); ++k) {
    a(k, k) =
        (k < LevelsBegin() && !Free(k)) ? 1.0 : a(k, k) * (1 + 1e-9) + 1e-12;
  }
  return a;
}

// Takes one Gauss-Newton step, made `longer` by a factor. Returns false where
// the equations are degenerate or the body vanishes.
bool Fitter::Step(double longer, double& geometric_step) {
  const SymmetricFactor factor(Regular());
  if (!factor.succeeded()) return false;
  NormalVector step = longer * factor.Solve(gradient_);
  if (!step.allFinite()) return false;
  // No parameter may jump farther than the linearisation holds: a quarter of
  // half the smallest side, and half a pixel at least. Not studied.
  const double size = SmallestHalf(outline_);
  const double limit = std::max(0.5, 0.25 * size);
  double shrink = 1.0;
  for (int k = 0; k < geometry_; ++k) {
    const double reach =
        k == 4 ? limit / std::max(outline_.half_long_px, 1.0) : limit;
    shrink = std::min(shrink, reach / std::max(std::abs(step[k]), 1e-300));
  }
  step.head(LevelsBegin()) *= std::min(1.0, shrink);
  outline_.centre.x_px += step[0];
  outline_.centre.y_px += step[1];
  geometric_step = std::hypot(step[0], step[1]);
  Grow(step[2], geometry_ == 5 ? step[3] : 0.0, outline_);
  // px, half the smallest side: a smaller body lies within one or two pixels,
  // which tell no shape. Not studied.
  constexpr double kMinHalf_px = 0.7;
  if (!(SmallestHalf(outline_) > kMinHalf_px)) return false;
  geometric_step = std::max(geometric_step, std::abs(step[2]));
  if (outline_.kind == core::BodyKind::kRectangle) {
    outline_.angle_rad += step[4];
    geometric_step = std::max({geometric_step, std::abs(step[3]),
                               std::abs(step[4]) * outline_.half_long_px});
    cosine_ = std::cos(outline_.angle_rad);
    sine_ = std::sin(outline_.angle_rad);
  }
  // px. A pixel is a box of variance 1/12, so that no image is sharper than
  // 0.29 px; a little less lets the fit approach that from both sides.
  constexpr double kMinBlur_px = 0.25;
  blur_ = std::clamp(blur_ + step[geometry_], kMinBlur_px,
                     std::max(2.0 * options_.blur_px, 0.5 * size));
  open_ = std::clamp(open_ + step[OpenIndex()], 0.0, 1.0);
  levels_ += step.tail(interior_ + outer_);
  SetSmear();
  return true;
}

// Gauss-Newton to convergence. Returns why it fails, or an empty text.
std::string Fitter::Iterate(int& iterations) {
  double step = std::numeric_limits<double>::infinity();
  converged_ = false;
  core::PixelPoint collected = outline_.centre;
  double collected_blur = blur_;
  int robust_rounds = 0;
  bool near = NearLevels();
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    ++iterations;
    // Back to the ordinary start: the near start was not near enough, or the
    // body is crudely modelled.
    const auto begin_again = [&] {
      near = false;
      robust_rounds = 0;
      iteration = -1;
      step = std::numeric_limits<double>::infinity();
      SolveLevels();
    };
    // px of the last step: before the outline is so nearly in place its
    // residuals are no outliers. After two rounds they are taken for such all
    // the same. Not studied.
    constexpr double kInPlace_px = 0.1;
    const bool robust = near || iteration >= 2 || step < kInPlace_px;
    const double last_step = step;
    Accumulate(robust);
    robust_rounds += robust ? 1 : 0;
    // Rounds in which the robust scale follows the residuals: it is at least
    // the expected noise, and more where the model is crude. A scale that
    // follows the weights for longer never settles. Not studied.
    constexpr int kScaleRounds = 5;
    if (iteration < kScaleRounds) {
      robust_scale_ = RobustScale(residuals_);
    }
    // Robust scale, in units of the noise, that a good fit does not exceed.
    // With more the near start is given up. Not studied.
    constexpr double kMaxNearScale = 1.25;
    if (near && robust_scale_ > kMaxNearScale) {
      begin_again();
      continue;
    }
    // Held weights make a step too short, since the weights change with the
    // residuals. For normal residuals Newton's step is longer by the mean of
    // Tukey's weights over the mean slope of the influence: 1.2. Without it
    // each round gains a factor of five only.
    constexpr double kToNewton = 1.2;
    if (!Step(near ? kToNewton : 1.0, step)) {
      return "the outline's fit is degenerate";
    }
    if (near && step >= kNearStart_px) {
      begin_again();
      continue;
    }
    // With the shape held and a near start, the next step is smaller than this
    // one by the same factor as this one was: within so many tolerances that
    // forecast is believed. It saves a round (3.8 rounds became 2.2 over 607
    // fits).
    constexpr double kFewTolerances = 10.0;
    // Factor of safety of the forecast: what is left is alike in all frames and
    // does not average out. Not studied.
    constexpr double kForecastSafety = 5.0;
    const double next_step =
        near && step < kFewTolerances * options_.tolerance_px
            ? kForecastSafety * step * (step / last_step)
            : step;
    if (std::min(step, next_step) < options_.tolerance_px &&
        robust_rounds >= 2) {
      converged_ = true;
      break;
    }
    // The set of pixels follows the body while it still moves; in the first
    // three rounds closely, so that the set does not depend on the start.
    const double same_place_px = near ? kNearStart_px : 0.003;
    // px. An appearance that was added to the shading moves with the body, and
    // must be added anew. Not studied.
    const double far_px = options_.appearance != nullptr ? 0.02 : 0.5;
    const double moved = std::hypot(outline_.centre.x_px - collected.x_px,
                                    outline_.centre.y_px - collected.y_px);
    const double spread = std::abs(blur_ - collected_blur);
    if (moved > far_px ||
        (iteration < 3 && std::max({moved, spread, step}) > same_place_px)) {
      if (std::string why = Gather(); !why.empty()) return why;
      collected = outline_.centre;
      collected_blur = blur_;
    }
  }
  // px of the last step. Robust weights may make the fit oscillate by a
  // hundredth of a pixel; more is no outline. Not studied.
  constexpr double kMaxOscillation_px = 0.02;
  if (!converged_ && !(step < kMaxOscillation_px)) {
    return "the outline's fit does not converge";
  }
  return {};
}

// Excludes what lies clear inside the body and is not explained by it: a thing
// in front of it, or a highlight. Its neighbourhood goes as well, since its
// blurred rim biases the edge. Returns whether there was enough of it to fit
// again.
bool Fitter::SetAsideUnexplained() {
  // A body that is crudely modelled has such pixels everywhere.
  if (robust_scale_ > kWellModelled) return false;
  // In units of blur_px, inside the edge: nearer to it a residual may be the
  // edge's own. Not studied.
  constexpr double kClearBlurs = 1.5;
  // In units of blur_px around each such pixel: there its tail is 1e-4.
  constexpr double kExcludeBlurs = 4.0;
  const std::vector<core::PixelPoint> unexplained =
      Unexplained(pixels_, residuals_, kTukeyCut * robust_scale_, outline_,
                  cosine_, sine_, kClearBlurs * blur_ + 0.5 * smear_.way_px());
  if (unexplained.empty()) return false;
  before_aside_ = Visible();
  usable_.ExcludePixels(unexplained, kExcludeBlurs * blur_ + 1.0);
  return true;
}

core::Expected<OutlineFit> Fitter::Run() {
  cosine_ = std::cos(outline_.angle_rad);
  sine_ = std::sin(outline_.angle_rad);
  std::string why = Gather();
  if (!why.empty()) return core::AbsentBecause(why);
  // Before a saturated surround the outer half of the edge's tail is cut off.
  // Its inner half must then not pass for shading, which would shift the edge
  // outwards: the body gets one level.
  if (IsSurroundSaturated(pixels_, outline_, cosine_, sine_, full_scale())) {
    saturated_ = true;
    interior_ = 1;
    CollectPixels();
  }
  if (!NearLevels()) SolveLevels();
  int iterations = 0;
  why = Iterate(iterations);
  if (why.empty() && SetAsideUnexplained()) {
    why = Gather();
    if (why.empty()) why = Iterate(iterations);
  }
  if (!why.empty()) return core::AbsentBecause(why);
  // The sums of the last round are good enough for the covariance: the step
  // after them was below the tolerance.
  telling_ = options_.tell_shared;
  if (!converged_ || telling_) Accumulate(true);
  const double noise =
      std::sqrt(background_.Variance(pixels_.MeanBackground()));
  // In units of one pixel's noise. Less is a fluctuation of the background;
  // more loses faint bodies. Not studied.
  constexpr double kMinContrast = 3.0;
  // The same for the whole body, contrast times the square root of its pixels:
  // noise has blobs of a pixel or two that pass the limit above. Not studied.
  constexpr double kMinTotalContrast = 12.0;
  const double area = Area(outline_);
  if (!(std::abs(contrast_) > kMinContrast * noise) ||
      !(std::abs(contrast_) * std::sqrt(area) > kMinTotalContrast * noise)) {
    return core::AbsentBecause(
        fmt::format("contrast {:.1f} DN is below {:.0f} times the noise {:.1f}",
                    std::abs(contrast_), kMinContrast, noise));
  }

  const NormalMatrix covariance = SymmetricFactor(Regular()).Inverse();
  // Residuals beyond the noise widen all u (Birge's ratio).
  const double widen = std::max(1.0, misfit_);
  const auto u = [&](int k) {
    return k >= LevelsBegin() || Free(k)
               ? widen * std::sqrt(std::max(0.0, covariance(k, k)))
               : 0.0;
  };
  OutlineFit fit;
  fit.outline = outline_;
  if (telling_) {
    // Size, blur and shutter are eliminated of this frame's own parameters, for
    // the joint step of all frames (shared_fit.h).
    const NormalVector step = covariance * gradient_;
    Grow(step[2], geometry_ == 5 ? step[3] : 0.0, fit.outline);
    const auto row = [&](int k) { return Free(k) ? k : -1; };
    fit.shared =
        WithoutOwn(Regular() / (widen * widen), gradient_ / (widen * widen),
                   {2, geometry_ == 5 ? 3 : -1, geometry_, row(OpenIndex())});
  }
  fit.blur_px = blur_;
  fit.u_blur_px = u(geometry_);
  fit.open = open_;
  fit.u_open = u(OpenIndex());
  if (interior_ == 6) {
    Shading shading;
    for (int k = 0; k < interior_; ++k) {
      shading.level[At(k)] = levels_[k];
      shading.u[At(k)] = u(LevelsBegin() + k);
    }
    fit.shading = shading;
  }
  fit.u_x_px = u(0);
  fit.u_y_px = u(1);
  fit.correlation_xy =
      covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
  fit.u_size_px = u(2);
  if (geometry_ == 5) {
    fit.u_size_short_px = u(3);
    fit.u_angle_rad = u(4);
  }
  fit.contrast_dn = contrast_;
  fit.misfit = misfit_;
  fit.inliers = inliers_;
  fit.visible = Visible();
  fit.hidden = std::max(0.0, before_aside_ - fit.visible);
  fit.pixels = static_cast<int>(pixels_.size);
  fit.iterations = iterations;
  const NearGroundPixels near =
      LookNearGround(pixels_, residuals_, height_, options_.ground_margin_px);
  fit.pixels_near_ground = near.pixels;
  fit.excess_near_ground = near.excess;
  // An outline known to no better than half its size is none.
  const double vague = 0.5 * SmallestHalf(outline_);
  if (!(std::max({fit.u_x_px, fit.u_y_px, fit.u_size_px, fit.u_size_short_px}) <
        vague) ||
      !std::isfinite(fit.u_angle_rad) || inliers_ == 0.0) {
    return core::AbsentBecause("the outline's covariance is degenerate");
  }
  return fit;
}

}  // namespace

core::Expected<OutlineFit> FitOutlineModel(Inside inside,
                                           const core::Frame& frame,
                                           const Background& background,
                                           const Outline& start,
                                           const OutlineOptions& options) {
  return Fitter(frame, background, start, options, inside).Run();
}

}  // namespace touchdown::vision
