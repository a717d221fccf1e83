#include "touchdown/calib/ground_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "edge_texture.h"
#include "edge_wave.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/normal.h"
#include "touchdown/core/parallel.h"

namespace touchdown::calib {
namespace {

// Step across y: mean of 3 rows below minus mean of 3 rows above.
double VerticalStep(const StillImage& image, std::int32_t x, std::int32_t y) {
  double below = 0.0;
  double above = 0.0;
  for (std::int32_t k = 1; k <= 3; ++k) {
    below += PixelLevel(image, x, y + k);
    above += PixelLevel(image, x, y - k);
  }
  return (below - above) / 3.0;
}

// To the ideal picture; false where the lens has no ideal point.
bool ToIdeal(const std::optional<Lens>& lens, EdgePoint& p) {
  if (!lens) return true;
  const auto ideal = Undistort(*lens, {p.x, p.y});
  if (!ideal) return false;
  p.x = ideal->point.x_px;
  p.y = ideal->point.y_px;
  return true;
}

// Where in column x of the picture the line is seen.
double SeenRow(const std::optional<Lens>& lens, const Line& line, double middle,
               double x) {
  if (!lens) return line.offset + line.slope * (x - middle);
  double along = x;
  core::PixelPoint seen;
  constexpr int kSteps = 6;  // each gains the lens's slope, a digit or more
  for (int k = 0; k < kSteps; ++k) {
    seen = Distort(*lens, {along, line.offset + line.slope * (along - middle)});
    along += x - seen.x_px;
  }
  return seen.y_px;
}

// Columns that are `step` apart, from both sides to the middle: the same ones
// in a mirror.
std::vector<std::int32_t> FromBothSides(std::int32_t first, std::int32_t step,
                                        std::int32_t width_px) {
  std::vector<std::int32_t> columns;
  for (std::int32_t x = first; 2 * x < width_px; x += step) {
    columns.push_back(x);
    if (2 * x != width_px - 1) columns.push_back(width_px - 1 - x);
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

// Columns from one to the next that votes: some hundred are enough.
std::int32_t VoteStep(const StillImage& image) {
  return std::max<std::int32_t>(1, image.width_px / 640);
}

// Of some columns, row after row, as they lie in memory.
void FindEdgePoints(const StillImage& image, double least,
                    std::span<const std::int32_t> columns,
                    std::span<std::vector<EdgePoint>> points) {
  // The steps of three rows.
  std::vector<double> above(columns.size());
  std::vector<double> here(columns.size());
  std::vector<double> below(columns.size());
  for (std::int32_t y = 4; y + 4 < image.height_px; ++y) {
    std::swap(above, here);
    std::swap(here, below);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      below[k] = VerticalStep(image, columns[k], y);
    }
    if (y < 6) continue;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double size = std::abs(here[k]);
      if (size < least) continue;
      if (size > std::abs(above[k]) && size >= std::abs(below[k])) {
        points[k].push_back({static_cast<double>(columns[k]),
                             static_cast<double>(y - 1), here[k]});
      }
    }
  }
}

// Column after column.
std::vector<EdgePoint> EdgePoints(const StillImage& image, double least,
                                  int threads) {
  const std::vector<std::int32_t> columns =
      FromBothSides(0, VoteStep(image), image.width_px);
  std::vector<std::vector<EdgePoint>> in_column(columns.size());
  core::InParallel(static_cast<std::int64_t>(columns.size()), threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     const auto from = static_cast<std::size_t>(begin);
                     const auto count = static_cast<std::size_t>(end - begin);
                     FindEdgePoints(image, least,
                                    std::span(columns).subspan(from, count),
                                    std::span(in_column).subspan(from, count));
                   });
  std::vector<EdgePoint> points;
  for (const std::vector<EdgePoint>& some : in_column) {
    points.insert(points.end(), some.begin(), some.end());
  }
  return points;
}

// px of height in one bin. Larger merges neighbouring lines; smaller spreads
// the votes of one. Not studied.
constexpr double kBin_px = 2.0;
// Tilts from the steepest downward to the steepest upward. More cost time in
// proportion; fewer lose votes at the picture's sides. Not studied.
constexpr std::size_t kTilts = 121;

struct Votes {
  Line line;
  double votes = 0.0;
};

// Votes of points for lines (Hough transform: over tilt and height), one per
// column.
class LineVotes {
 public:
  LineVotes(const StillImage& image, const GroundLineOptions& options)
      : middle_(0.5 * (image.width_px - 1)),
        bins_(static_cast<std::size_t>(image.height_px / kBin_px) + 2),
        threads_(options.threads) {
    for (std::size_t k = 0; k < kTilts; ++k) {
      const double tilt = options.most_tilt_rad *
                          (2.0 * static_cast<double>(k) / (kTilts - 1.0) - 1.0);
      of_slope_.push_back({std::tan(tilt), std::vector<Shares>(bins_)});
    }
  }

  void Add(const std::vector<EdgePoint>& points) { Count(points, 1.0f); }
  void Remove(const std::vector<EdgePoint>& points) { Count(points, -1.0f); }

  // The line with the most votes.
  Votes FindBest() const;

 private:
  // Between two bins, so that a line on their border loses no votes: what a bin
  // gets of its own points, and what the next one does.
  struct Shares {
    float own = 0.0f;
    float next = 0.0f;
  };
  struct Slope {
    double slope = 0.0;
    std::vector<Shares> bins;
  };

  void Count(const std::vector<EdgePoint>& points, float vote);

  double middle_;
  std::size_t bins_;
  int threads_;
  std::vector<Slope> of_slope_;
};

void LineVotes::Count(const std::vector<EdgePoint>& points, float vote) {
  std::vector<float> right;
  std::vector<float> down;  // in bins
  for (const EdgePoint& p : points) {
    right.push_back(static_cast<float>(p.x - middle_));
    down.push_back(static_cast<float>(p.y / kBin_px));
  }
  const auto end = static_cast<float>(bins_ - 1);
  const auto count = [&](Slope& of) {
    const auto rise = static_cast<float>(of.slope / kBin_px);
    for (std::size_t i = 0; i < down.size(); ++i) {
      const float at = down[i] - rise * right[i];
      if (at < 0.0f || at >= end) continue;
      const auto low = static_cast<int>(at);
      const float next = vote * (at - static_cast<float>(low));
      Shares& bin = of.bins[static_cast<std::size_t>(low)];
      bin.own += vote - next;
      bin.next += next;
    }
  };
  core::InParallel(static_cast<std::int64_t>(kTilts), threads_,
                   [&](std::int64_t from, std::int64_t to) {
                     for (auto k = static_cast<std::size_t>(from);
                          k < static_cast<std::size_t>(to); ++k) {
                       count(of_slope_[k]);
                     }
                   });
}

Votes LineVotes::FindBest() const {
  Votes best;
  std::vector<float> count(bins_);
  for (const Slope& of : of_slope_) {
    float from_before = 0.0f;
    for (std::size_t b = 0; b < bins_; ++b) {
      count[b] = of.bins[b].own + from_before;
      from_before = of.bins[b].next;
    }
    for (std::size_t b = 0; b + 1 < bins_; ++b) {
      const auto sum = static_cast<double>(count[b] + count[b + 1]);
      if (sum <= best.votes) continue;
      const double weight = static_cast<double>(count[b + 1]) / sum;
      best = {{(static_cast<double>(b) + weight) * kBin_px, of.slope}, sum};
    }
  }
  return best;
}

// Straight line through points by iteratively re-weighted least squares
// (Tukey); returns the robust scatter.
double FitLine(const std::vector<EdgePoint>& points, double middle, Line& line,
               std::vector<double>& weights) {
  double scatter = 2.0;
  weights.assign(points.size(), 0.0);
  for (int iteration = 0; iteration < 20; ++iteration) {
    std::vector<double> off;
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    const double cut = 4.685 * std::max(scatter, 1e-4);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = points[i].x - middle;
      const double r = points[i].y - line.offset - line.slope * x;
      const double t = r / cut;
      weights[i] = std::abs(t) < 1.0 ? (1 - t * t) * (1 - t * t) : 0.0;
      if (weights[i] > 0.0) off.push_back(std::abs(r));
      sw += weights[i];
      sx += weights[i] * x;
      sy += weights[i] * points[i].y;
      sxx += weights[i] * x * x;
      sxy += weights[i] * x * points[i].y;
    }
    const double determinant = sw * sxx - sx * sx;
    if (off.size() < 8 || !(determinant > 0.0)) return -1.0;
    line.slope = (sw * sxy - sx * sy) / determinant;
    line.offset = (sy - line.slope * sx) / sw;
    const auto at = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), at, off.end());
    scatter = 1.4826 * *at;
  }
  return std::max(scatter, 1e-4);
}

// Position of a blurred step of width `blur` in one column near y0:
// Gauss-Newton in position with the two levels solved exactly. Negative
// strength of success (points.strength = 0) means no edge.
EdgePoint ColumnEdge(const StillImage& image, std::int32_t x, double y0,
                     double blur, double reach, double& residual2) {
  EdgePoint edge{static_cast<double>(x), y0, 0.0};
  residual2 = 0.0;
  std::vector<double> phi;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const auto from = static_cast<std::int32_t>(std::ceil(edge.y - reach));
    const auto to = static_cast<std::int32_t>(std::floor(edge.y + reach));
    if (from < 0 || to >= image.height_px) {
      edge.strength = 0.0;
      return edge;
    }
    // Levels: value = a + b Phi((y - y_edge) / blur).
    double n = 0, sp = 0, spp = 0, sv = 0, spv = 0;
    phi.clear();
    for (std::int32_t y = from; y <= to; ++y) {
      const double p = core::NormalCdf((y - edge.y) / blur);
      phi.push_back(p);
      const auto v = PixelLevel(image, x, y);
      n += 1;
      sp += p;
      spp += p * p;
      sv += v;
      spv += p * v;
    }
    const double determinant = n * spp - sp * sp;
    if (!(determinant > 1e-9)) {
      edge.strength = 0.0;
      return edge;
    }
    const double b = (n * spv - sp * sv) / determinant;
    const double a = (sv - b * sp) / n;
    edge.strength = b;
    if (b == 0.0) return edge;
    double num = 0.0;
    double den = 0.0;
    residual2 = 0.0;
    for (std::int32_t y = from; y <= to; ++y) {
      const double z = (y - edge.y) / blur;
      const double r = PixelLevel(image, x, y) - a -
                       b * phi[static_cast<std::size_t>(y - from)];
      const double slope =
          -b * 0.3989422804014327 * std::exp(-0.5 * z * z) / blur;
      num += r * slope;
      den += slope * slope;
      residual2 += r * r;
    }
    residual2 /= std::max(1.0, n - 3.0);
    const double step = std::clamp(num / den, -1.0, 1.0);
    edge.y += step;
    if (std::abs(edge.y - y0) > reach) {
      edge.strength = 0.0;
      return edge;
    }
    // What is left after it is the square of a step, far below a column's u.
    constexpr double kLast_px = 1e-3;
    if (std::abs(step) < kLast_px) break;
  }
  return edge;
}

struct ColumnFit {
  EdgePoint edge;
  double residual2 = 0.0;
};

// Of each of the columns, near the line.
std::vector<ColumnFit> ColumnEdges(const StillImage& image,
                                   const GroundLineOptions& options,
                                   const std::vector<std::int32_t>& columns,
                                   const Line& line, double middle, double blur,
                                   double reach) {
  std::vector<ColumnFit> fits(columns.size());
  core::InParallel(static_cast<std::int64_t>(columns.size()), options.threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto k = static_cast<std::size_t>(begin);
                          k < static_cast<std::size_t>(end); ++k) {
                       const double y =
                           SeenRow(options.lens, line, middle, columns[k]);
                       fits[k].edge = ColumnEdge(image, columns[k], y, blur,
                                                 reach, fits[k].residual2);
                     }
                   });
  return fits;
}

// How far beside the edge a column is looked at, px. Less does not tell both
// levels from the blur; textures draw the edge along in proportion to more.
double ComputeReach(double blur) { return 3.0 * blur + 2.0; }
// The same, so much farther.
constexpr double kFarther_px = 4.0;

// The edge's blur: the one that explains a sample of columns best.
double EstimateBlur(const StillImage& image, const GroundLineOptions& options,
                    const Line& line, double middle) {
  // px: blurs of lenses in and out of focus. Not studied.
  constexpr std::array<double, 12> kTriedBlurs_px = {
      0.4, 0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.5, 1.9, 2.4, 3.0, 4.0};
  double best = kTriedBlurs_px[0];
  double least = 0.0;
  bool any = false;
  const std::vector<std::int32_t> columns =
      FromBothSides(2, 1 + image.width_px / 120, image.width_px);
  for (const double blur : kTriedBlurs_px) {
    std::vector<double> residuals;
    for (const ColumnFit& fit : ColumnEdges(image, options, columns, line,
                                            middle, blur, ComputeReach(blur))) {
      if (fit.edge.strength != 0.0) residuals.push_back(fit.residual2);
    }
    if (residuals.size() < 8) continue;
    const auto at =
        residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), at, residuals.end());
    if (!any || *at < least) {
      any = true;
      least = *at;
      best = blur;
    }
    // Ever wider ones explain it ever worse, and take ever longer.
    constexpr double kClearlyWorse = 4.0;
    if (*at > kClearlyWorse * least) break;
  }
  return best;
}

// How many times fewer columns are independent: 1 + 2 sum of the residuals'
// autocorrelation, as far as it is positive.
double CorrelationLength(const std::vector<EdgePoint>& points,
                         const std::vector<double>& weights, const Line& line,
                         double middle) {
  std::vector<double> r;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (weights[i] > 0.0) {
      r.push_back(points[i].y - line.offset -
                  line.slope * (points[i].x - middle));
    }
  }
  double variance = 0.0;
  for (const double v : r) variance += v * v;
  double sum = 1.0;
  for (std::size_t lag = 1; lag < std::min<std::size_t>(60, r.size() / 4);
       ++lag) {
    double c = 0.0;
    for (std::size_t i = lag; i < r.size(); ++i) c += r[i] * r[i - lag];
    c /= std::max(variance, 1e-300);
    if (c < 0.05) break;
    sum += 2.0 * c;
  }
  return sum;
}

// A straight line through the edge's places in all columns.
struct EdgeLine {
  Line line;
  double centre = 0.0;       // of the columns, px
  core::Estimate height_px;  // of the line, there
  core::Estimate slope;
  double wave_px = 0.0;
};

std::optional<EdgeLine> FitEdgeLine(std::vector<EdgePoint>& edge,
                                    const Line& near, double middle) {
  EdgeLine out;
  out.line = near;
  std::vector<double> weights;
  double scatter = FitLine(edge, middle, out.line, weights);
  if (scatter < 0.0) return std::nullopt;
  // Neighbours that go up and down together may do so evenly.
  constexpr double kAlike = 3.0;
  if (CorrelationLength(edge, weights, out.line, middle) > kAlike) {
    out.wave_px = TakeOutWave(out.line, middle, weights, edge);
  }
  if (out.wave_px > 0.0) {
    scatter = FitLine(edge, middle, out.line, weights);
    if (scatter < 0.0) return std::nullopt;
  }
  double sw = 0, sx = 0;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    sw += weights[i];
    sx += weights[i] * edge[i].x;
  }
  out.centre = sx / sw;
  double sxx = 0.0;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    sxx += weights[i] * std::pow(edge[i].x - out.centre, 2);
  }
  const double alike = CorrelationLength(edge, weights, out.line, middle);
  out.height_px = {out.line.At(out.centre - middle),
                   scatter * std::sqrt(alike / sw), std::nullopt};
  out.slope = {out.line.slope, scatter * std::sqrt(alike / sxx), std::nullopt};
  return out;
}

// Two measurements from the same pixels: no better than the better one, and as
// far off as they are apart.
core::Estimate Agreed(const core::Estimate& a, const core::Estimate& b) {
  core::Estimate both = core::Combined(a, b);
  both.u = std::max(both.u, std::min(a.u, b.u));
  return both;
}

// The direction of an edge of textured ground from the edge's foot, where that
// is clearly better known; not its height, which hangs there on the blur.
core::Estimate SlopeOfTexture(const StillImage& image,
                              const std::optional<Lens>& lens, double blur,
                              double middle, const EdgeLine& plain) {
  std::vector<double> seen(static_cast<std::size_t>(image.width_px));
  for (std::size_t x = 0; x < seen.size(); ++x) {
    seen[x] = SeenRow(lens, plain.line, middle, static_cast<double>(x));
  }
  // In units of the edge's blur: beyond it the strip shows the ground alone.
  constexpr double kClearBlurs = 3.0;
  const auto texture = LearnTexture(image, seen, kClearBlurs * blur);
  if (!texture) return plain.slope;
  std::vector<EdgePoint> edge;
  for (std::int32_t x = 0; x < image.width_px; ++x) {
    EdgePoint p = TexturedEdge(image, *texture, x,
                               seen[static_cast<std::size_t>(x)], blur);
    if (p.strength != 0.0 && ToIdeal(lens, p)) edge.push_back(p);
  }
  const auto better = FitEdgeLine(edge, plain.line, middle);
  if (!better || better->slope.u >= plain.slope.u) return plain.slope;
  return Agreed(plain.slope, better->slope);
}

}  // namespace

std::vector<GroundLine> FindGroundLines(const StillImage& image,
                                        const GroundLineOptions& options) {
  std::vector<GroundLine> lines;
  // px: a smaller picture has no columns enough for a line. Not studied.
  constexpr std::int32_t kMinSide_px = 16;
  if (image.width_px < kMinSide_px || image.height_px < kMinSide_px) {
    return lines;
  }
  const double middle = 0.5 * (image.width_px - 1);
  // A mean of three rows on each side has noise sqrt(2/3) sigma.
  const double least = options.least_contrast_sigmas * image.noise_dn;
  // A line's points step in one direction.
  std::vector<EdgePoint> rising;
  std::vector<EdgePoint> falling;
  for (EdgePoint p : EdgePoints(image, least, options.threads)) {
    if (!ToIdeal(options.lens, p)) continue;
    (p.strength > 0.0 ? rising : falling).push_back(p);
  }
  std::vector<std::int32_t> all_columns(
      static_cast<std::size_t>(image.width_px));
  std::iota(all_columns.begin(), all_columns.end(), 0);
  const double step = VoteStep(image);
  LineVotes of_rising(image, options);
  LineVotes of_falling(image, options);
  of_rising.Add(rising);
  of_falling.Add(falling);
  for (int found = 0; found < options.most_lines; ++found) {
    const Votes up = of_rising.FindBest();
    const Votes down = of_falling.FindBest();
    const Line best = down.votes > up.votes ? down.line : up.line;
    if (std::max(up.votes, down.votes) * step <
        options.least_share * image.width_px)
      break;
    const auto is_near = [&](const EdgePoint& p) {
      // px: points so near to a line that was found are its own, and vote for
      // no other. Not studied.
      constexpr double kSameLine_px = 4.0;
      return std::abs(p.y - best.At(p.x - middle)) < kSameLine_px;
    };
    const auto take_away = [&](std::vector<EdgePoint>& points,
                               LineVotes& votes) {
      const auto near = std::stable_partition(points.begin(), points.end(),
                                              std::not_fn(is_near));
      votes.Remove({near, points.end()});
      points.erase(near, points.end());
    };
    take_away(rising, of_rising);
    take_away(falling, of_falling);
    // To sub-pixel, from every column.
    const double blur = EstimateBlur(image, options, best, middle);
    const auto line_within = [&](double reach) -> std::optional<EdgeLine> {
      std::vector<EdgePoint> edge;
      for (const ColumnFit& fit : ColumnEdges(image, options, all_columns, best,
                                              middle, blur, reach)) {
        EdgePoint p = fit.edge;
        if (std::abs(p.strength) > least && ToIdeal(options.lens, p)) {
          edge.push_back(p);
        }
      }
      if (static_cast<double>(edge.size()) <
          options.least_share * image.width_px) {
        return std::nullopt;
      }
      return FitEdgeLine(edge, best, middle);
    };
    const std::optional<EdgeLine> seen = line_within(ComputeReach(blur));
    if (!seen) continue;
    EdgeLine at = *seen;
    // What more of the picture changes is not known to better than that.
    if (const auto wider = line_within(ComputeReach(blur) + kFarther_px)) {
      at.slope.u = std::hypot(at.slope.u, wider->slope.value - at.slope.value);
      at.height_px.u =
          std::hypot(at.height_px.u,
                     wider->line.At(at.centre - middle) - at.height_px.value);
    }
    at.slope = SlopeOfTexture(image, options.lens, blur, middle, at);
    const auto y_at = [&](double x) {
      return at.height_px.value + at.slope.value * (x - at.centre);
    };
    const double cosine = 1.0 / std::hypot(1.0, at.slope.value);
    GroundLine line;
    line.p1 = {0.0, y_at(0.0)};
    line.p2 = {static_cast<double>(image.width_px - 1),
               y_at(image.width_px - 1.0)};
    line.reference = {at.centre, y_at(at.centre)};
    line.u_offset_px = cosine * at.height_px.u;
    line.u_angle_rad = cosine * cosine * at.slope.u;
    line.source = GroundSource::kDetected;
    line.wave_px = at.wave_px;
    lines.push_back(line);
  }
  return lines;
}

}  // namespace touchdown::calib
