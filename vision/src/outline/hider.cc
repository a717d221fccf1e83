#include "outline/hider.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "numbers/symmetric_factor.h"
#include "outline/outline_pixels.h"

namespace touchdown::vision {
namespace {

// Sums over the frames, for each pixel of the part of the picture where the
// body may be.
struct Sums {
  core::PixelRect box;
  // Of (measured - background) / (body - background): 0 where the body should
  // be and the background is seen, 1 where the body is.
  std::vector<float> shown;
  std::vector<std::uint16_t> frames;
};

// Box around all outlines, with a margin.
core::PixelRect JobsBox(std::span<const OutlineJob> jobs, double margin_px,
                        const ClipInfo& info) {
  double left = info.width_px;
  double top = info.height_px;
  double right = 0.0;
  double bottom = 0.0;
  for (const OutlineJob& job : jobs) {
    const double reach = Extent(job.start) + margin_px;
    left = std::min(left, job.start.centre.x_px - reach);
    right = std::max(right, job.start.centre.x_px + reach);
    top = std::min(top, job.start.centre.y_px - reach);
    bottom = std::max(bottom, job.start.centre.y_px + reach);
  }
  core::PixelRect box;
  box.x = static_cast<std::int32_t>(std::floor(std::max(left, 0.0)));
  box.y = static_cast<std::int32_t>(std::floor(std::max(top, 0.0)));
  box.width = static_cast<std::int32_t>(
                  std::ceil(std::min(right, info.width_px - 1.0))) -
              box.x + 1;
  box.height = static_cast<std::int32_t>(
                   std::ceil(std::min(bottom, info.height_px - 1.0))) -
               box.y + 1;
  return box;
}

// Adds one frame's pixels clear inside the outline. Frames that show next to
// nothing of the body are left out: it may not be there.
void SumShown(Clip& clip, const Background& background, const OutlineJob& job,
              const HiderOptions& options, Sums& sums) {
  // In units of blur_px inside the edge: covered by 0.88 and more. Not studied.
  constexpr double kClearBlurs = 1.2;
  // Standard deviations of a pixel: where the body hardly differs from the
  // background, nothing can be said. Not studied.
  constexpr double kDifferSigmas = 4.0;
  // A pixel shows the body from half of the way on.
  constexpr float kHalf = 0.5f;
  // Share of the pixels inside that must show the body. Not studied.
  constexpr double kMinSeenShare = 0.2;
  OutlineOptions window;
  window.blur_px = options.blur_px;
  const core::Frame frame =
      clip.Read(job.frame, ChooseWindow(job.start, window, clip.info()));
  const double clear =
      kClearBlurs * options.blur_px + 0.5 +
      0.5 * options.open * std::hypot(job.travel_px.x_px, job.travel_px.y_px);
  std::vector<std::pair<std::size_t, float>> shown;
  std::size_t seen = 0;
  for (std::int32_t v = 0; v < frame.height_px; ++v) {
    const std::int32_t y = frame.origin_y_px + v;
    if (y < sums.box.y || y >= sums.box.y + sums.box.height) continue;
    for (std::int32_t u = 0; u < frame.width_px; ++u) {
      const std::int32_t x = frame.origin_x_px + u;
      if (x < sums.box.x || x >= sums.box.x + sums.box.width) continue;
      if (SignedDepth(job.start, x, y) < clear) continue;
      const double still = static_cast<double>(background.at(x, y));
      const double rise = options.body_dn - still;
      const double noise = std::sqrt(background.Variance(still));
      if (std::abs(rise) < kDifferSigmas * noise) continue;
      const auto i = static_cast<std::size_t>(y - sums.box.y) *
                         static_cast<std::size_t>(sums.box.width) +
                     static_cast<std::size_t>(x - sums.box.x);
      const auto share = static_cast<float>((frame.at(u, v) - still) / rise);
      shown.emplace_back(i, share);
      seen += share > kHalf;
    }
  }
  if (static_cast<double>(seen) <
      kMinSeenShare * static_cast<double>(shown.size())) {
    return;
  }
  for (const auto& [i, share] : shown) {
    sums.shown[i] += share;
    ++sums.frames[i];
  }
}

// Marks all pixels within `reach` of the marked ones.
void Dilate(int reach, Hider& hider) {
  const std::int32_t width = hider.box.width;
  const std::int32_t height = hider.box.height;
  const std::vector<std::uint8_t> marked = hider.hides;
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      if (marked[static_cast<std::size_t>(y * width + x)] == 0) continue;
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          if (dx * dx + dy * dy > reach * reach) continue;
          if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) {
            continue;
          }
          hider.hides[static_cast<std::size_t>((y + dy) * width + x + dx)] = 1;
        }
      }
    }
  }
}

// The outline at `frame` on the flight through some fits: straight along the
// ground, a parabola normal to it, a steady turn. Nothing where they are not of
// one flight.
std::optional<OutlineJob> OnPath(std::span<const Fitted* const> fits,
                                 std::int64_t frame, double ground_angle_rad) {
  const auto [first, last] = std::minmax_element(
      fits.begin(), fits.end(),
      [](const Fitted* a, const Fitted* b) { return a->frame < b->frame; });
  const double span = static_cast<double>((*last)->frame - (*first)->frame);
  // Distance in units of what the fits span: farther, the parabola is
  // guesswork. Not studied.
  constexpr double kMaxExtrapolation = 2.0;
  if (static_cast<double>(std::abs(fits.front()->frame - frame)) >
      kMaxExtrapolation * span) {
    return std::nullopt;
  }
  const double cosine = std::cos(ground_angle_rad);
  const double sine = std::sin(ground_angle_rad);
  const auto n = static_cast<Eigen::Index>(fits.size());
  Eigen::MatrixX3d powers(n, 3);
  Eigen::VectorXd along(n);
  Eigen::VectorXd down(n);
  Eigen::VectorXd angle(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Fitted& f = *fits[static_cast<std::size_t>(i)];
    const core::PixelPoint& centre = f.fit.outline.centre;
    // Time from the frame sought, in units of the span: the constant terms are
    // its place, the linear ones its motion.
    const double t = static_cast<double>(f.frame - frame) / span;
    powers.row(i) << 1.0, t, t * t;
    along[i] = cosine * centre.x_px + sine * centre.y_px;
    down[i] = cosine * centre.y_px - sine * centre.x_px;
    angle[i] = f.fit.outline.angle_rad;
  }
  const auto fit = [&](const Eigen::VectorXd& values, Eigen::Index terms) {
    const auto rows = powers.leftCols(terms);
    const SymmetricFactor normal(rows.transpose().lazyProduct(rows));
    const NormalVector curve = normal.Solve(rows.transpose() * values);
    const double off = (values - rows * curve).cwiseAbs().maxCoeff();
    return std::pair(curve, off);
  };
  const auto [x, off_x] = fit(along, 2);
  const auto [y, off_y] = fit(down, 3);
  const auto [turn, off_turn] = fit(angle, 2);
  // px of the worst residual: more, and an impact lies between. Not studied.
  constexpr double kMaxOff_px = 0.7;
  if (std::max(off_x, off_y) > kMaxOff_px) return std::nullopt;
  OutlineJob job;
  job.frame = frame;
  job.start = fits.front()->fit.outline;
  job.start.centre = {cosine * x[0] - sine * y[0], sine * x[0] + cosine * y[0]};
  job.start.angle_rad = turn[0];
  job.travel_px = {(cosine * x[1] - sine * y[1]) / span,
                   (sine * x[1] + cosine * y[1]) / span};
  job.turn_rad = turn[1] / span;
  return job;
}

}  // namespace

bool Hider::Hides(double x_px, double y_px) const {
  const auto x = static_cast<std::int64_t>(std::lround(x_px)) - box.x;
  const auto y = static_cast<std::int64_t>(std::lround(y_px)) - box.y;
  return x >= 0 && y >= 0 && x < box.width && y < box.height &&
         hides[static_cast<std::size_t>(y * box.width + x)] != 0;
}

std::shared_ptr<const Hider> FindHider(Clip& clip, const Background& background,
                                       std::span<const OutlineJob> jobs,
                                       const HiderOptions& options) {
  if (jobs.empty()) return nullptr;
  // In units of blur_px, from clear inside the body (1.2) to where the outer
  // tail of its edge ends. Larger loses pixels; smaller leaves the obstacle's
  // blurred edge in the fits. Not studied.
  constexpr double kDilateBlurs = 5.0;
  const int reach =
      static_cast<int>(std::ceil(kDilateBlurs * options.blur_px + 2.0));
  Sums sums;
  sums.box = JobsBox(jobs, reach, clip.info());
  if (sums.box.width < 1 || sums.box.height < 1) return nullptr;
  const auto pixels = static_cast<std::size_t>(sums.box.width) *
                      static_cast<std::size_t>(sums.box.height);
  sums.shown.assign(pixels, 0.0f);
  sums.frames.assign(pixels, 0);
  for (const OutlineJob& job : jobs) {
    SumShown(clip, background, job, options, sums);
  }
  // Frames in which the body should be seen at a pixel: one may have another
  // cause.
  constexpr int kMinFrames = 2;
  // Mean of `shown` up to which the pixel hides the body. Larger marks dark
  // parts of the body; smaller misses half of an obstacle's rim. Set with the
  // obstacle part of the accuracy design.
  constexpr float kMaxShown = 0.25f;
  // Pixels that an obstacle has at least, as a share of the body and in number.
  // Not studied.
  constexpr double kMinShare = 0.01;
  constexpr double kMinPixels = 4.0;
  auto hider = std::make_shared<Hider>();
  hider->box = sums.box;
  hider->hides.assign(pixels, 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const int n = sums.frames[i];
    if (n < kMinFrames) continue;
    if (sums.shown[i] > kMaxShown * static_cast<float>(n)) continue;
    hider->hides[i] = 1;
    ++count;
  }
  if (static_cast<double>(count) <
      std::max(kMinPixels, kMinShare * Area(jobs[0].start))) {
    return nullptr;
  }
  Dilate(reach, *hider);
  return hider;
}

std::optional<OutlineJob> Predict(std::span<const Fitted> fits,
                                  std::int64_t frame, double ground_angle_rad) {
  std::vector<const Fitted*> near;
  near.reserve(fits.size());
  for (const Fitted& f : fits) near.push_back(&f);
  std::sort(near.begin(), near.end(), [&](const Fitted* a, const Fitted* b) {
    return std::abs(a->frame - frame) < std::abs(b->frame - frame);
  });
  // Fits of the same flight agree with one parabola: fewer and fewer of the
  // nearest are tried until they do.
  for (const std::size_t most : {24, 12, 6}) {
    if (near.size() < std::min<std::size_t>(most, 6)) continue;
    const std::span<const Fitted* const> some(near.data(),
                                              std::min(most, near.size()));
    if (auto job = OnPath(some, frame, ground_angle_rad)) return job;
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
