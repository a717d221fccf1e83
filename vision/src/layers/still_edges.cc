#include "layers/still_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "touchdown/core/normal.h"

namespace touchdown::vision::layers {
namespace {

// Crossings that tell place, direction and contrast of a short line: twelve
// average the noise of three pixels to a third.
constexpr std::size_t kShort = 12;

// The picture read along its rows or along its columns: (u, v) with edges along
// u, levels that step along v.
struct Axes {
  Axes(const StillPicture& still, bool rows)
      : along_rows(rows),
        length(rows ? still.width : still.height),
        depth(rows ? still.height : still.width),
        by_u(rows ? 1 : still.width),
        by_v(rows ? still.width : 1) {}

  std::size_t PixelAt(std::int32_t u, std::int32_t v) const {
    return static_cast<std::size_t>(u * by_u + v * by_v);
  }

  bool along_rows;
  std::int32_t length;  // u
  std::int32_t depth;   // v
  std::int32_t by_u;    // pixels from one to the next
  std::int32_t by_v;
};

// Where an edge crosses the line u.
struct Crossing {
  std::int32_t u = 0;
  double v = 0.0;
  double contrast = 0.0;  // DN, positive where levels rise with v
};

// Crossings of one edge from left to right.
using Chain = std::vector<Crossing>;

std::vector<StillEdge> SeenByPixels(const StillPicture& still, double blur,
                                    double least_dn) {
  std::vector<StillEdge> seen(static_cast<std::size_t>(still.width) *
                              static_cast<std::size_t>(still.height));
  StillEdges reader(still.levels, still.width, blur, least_dn);
  for (std::int32_t y = 1; y + 1 < still.height; ++y) {
    for (std::int32_t x = 1; x + 1 < still.width; ++x) {
      const std::int32_t pixel = y * still.width + x;
      seen[static_cast<std::size_t>(pixel)] = reader.FindEdge(pixel);
    }
  }
  return seen;
}

// Blurs from an edge, as far as a body's edge has any (kFar in shape_cover.cc).
constexpr double kFarthest = 3.5;

// Where the edge near v crosses the line u: one step of Gauss and Newton from v
// on, of  levels = a + contrast Phi((v' - v) / blur).  Three pixels tell it,
// too, but by their curvature: in a picture that was blurred after it was
// sampled, as a scaled video's, that makes a tenth of the contrast depend on
// where between two pixels the edge lies. Nothing where too few pixels are
// known, or where no edge is near. `blur`: along v.
std::optional<Crossing> FitCrossing(const StillPicture& still, const Axes& axes,
                                    double blur, std::int32_t u, double v) {
  // px to both sides: fewer do not tell three numbers.
  constexpr double kLeast_px = 3.0;
  // px of a step: farther off the edge that was meant is another.
  constexpr double kMost_px = 1.0;
  // Frames that saw a pixel without the body: below it is not known.
  constexpr float kSeen = 1.5F;
  const double reach = std::max(kLeast_px, kFarthest * blur);
  const auto first = static_cast<std::int32_t>(std::ceil(v - reach));
  const auto last = static_cast<std::int32_t>(std::floor(v + reach));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::int32_t at = std::max(first, 0);
       at <= std::min(last, axes.depth - 1); ++at) {
    const std::size_t pixel = axes.PixelAt(u, at);
    if (!still.clear.empty() && still.clear[pixel] < kSeen) continue;
    const double z = (at - v) / blur;
    const Eigen::Vector3d by(1.0, core::NormalCdf(z), core::NormalDensity(z));
    normal += by * by.transpose();
    right += by * static_cast<double>(still.levels[pixel]);
  }
  const Eigen::LDLT<Eigen::Matrix3d> factors(normal);
  // Of a pixel's weight, what the last of the three numbers has after the
  // others. Less: an edge at the end of what is known is told by noise. Not
  // studied.
  constexpr double kKnown = 1e-2;
  if (!(factors.vectorD().minCoeff() > kKnown)) return std::nullopt;
  const Eigen::Vector3d x = factors.solve(right);
  const double step = -x(2) / x(1) * blur;
  if (!(std::abs(step) < kMost_px)) return std::nullopt;
  return Crossing{u, v + step, x(1)};
}

// The edge that lies within a pixel, if one does that is about along u.
std::optional<Crossing> CrossingIn(const StillPicture& still, const Axes& axes,
                                   const std::vector<StillEdge>& seen,
                                   double blur, std::int32_t u,
                                   std::int32_t v) {
  constexpr double kNear_px = 1.0;    // as far as three pixels may be off
  constexpr double kWithin_px = 0.5;  // half a pixel
  const StillEdge& edge = seen[axes.PixelAt(u, v)];
  if (edge.contrast == 0.0F) return std::nullopt;
  const float across = axes.along_rows ? edge.normal_y : edge.normal_x;
  const float beside = axes.along_rows ? edge.normal_x : edge.normal_y;
  if (std::abs(across) < std::abs(beside)) return std::nullopt;
  const double rises = across > 0.0F ? 1.0 : -1.0;
  const double off = rises * static_cast<double>(edge.z) * blur;
  if (std::abs(off) > kNear_px) return std::nullopt;
  const auto crossing = FitCrossing(still, axes, blur, u, v - off);
  if (!crossing || crossing->contrast * rises <= 0.0 ||
      std::abs(crossing->v - v) > kWithin_px) {
    return std::nullopt;
  }
  return crossing;
}

// Links the crossings of neighbouring u to chains.
class Chains {
 public:
  void Add(const Crossing& crossing) {
    Growing* best = nullptr;
    // px off the line so far. More: noise links two edges.
    constexpr double kOff_px = 0.75;
    double least = kOff_px;
    for (Growing& chain : growing_) {
      const Crossing& last = chain.last;
      const double off =
          std::abs(crossing.v - last.v - chain.slope * (crossing.u - last.u));
      if (off >= least || last.u >= crossing.u) continue;
      const double ratio = crossing.contrast / last.contrast;
      // Of one edge's contrasts to each other.
      constexpr double kAlike = 0.5;
      if (ratio < kAlike || ratio > 1.0 / kAlike) continue;
      least = off;
      best = &chain;
    }
    if (best == nullptr) best = &growing_.emplace_back();
    best->Append(crossing);
  }

  // Ends what does not go on at `u`. A line that was followed for long is met
  // again where the body leaves it; one that begins is followed over no more
  // than some noise.
  void End(std::int32_t u) {
    constexpr std::int32_t kShortGap_px = 3;  // longer: of another edge
    std::erase_if(growing_, [&](const Growing& chain) {
      return chain.crossings.size() < kShort && u - chain.last.u > kShortGap_px;
    });
  }

  // Those that are long enough.
  std::vector<Chain> TakeLong() {
    std::vector<Chain> chains;
    for (Growing& chain : growing_) {
      if (chain.crossings.size() >= kShort) {
        chains.push_back(std::move(chain.crossings));
      }
    }
    growing_.clear();
    return chains;
  }

 private:
  struct Growing {
    Crossing last;
    double slope = 0.0;  // of v by u, once the chain is long enough
    Chain crossings;

    void Append(const Crossing& crossing) {
      last = crossing;
      crossings.push_back(crossing);
      if (crossings.size() < kShort) return;
      // Crossings over which the direction is taken: over more an edge may
      // bend.
      constexpr std::size_t kMost = 4 * kShort;
      const Crossing& from =
          crossings[crossings.size() - std::min(crossings.size(), kMost)];
      slope = (last.v - from.v) / (last.u - from.u);
    }
  };

  std::vector<Growing> growing_;
};

// Sums over the crossings of a chain up to each of them.
class ChainSums {
 public:
  explicit ChainSums(const Chain& chain) : origin_(chain.front().u) {
    sums_.push_back({});
    for (const Crossing& c : chain) {
      const double u = c.u - origin_;
      Sums s = sums_.back();
      s.n += 1.0;
      s.u += u;
      s.uu += u * u;
      s.v += c.v;
      s.uv += u * c.v;
      s.vv += c.v * c.v;
      sums_.push_back(s);
    }
  }

  // Through crossings [begin, end): the line of least squares.
  void FitLine(std::size_t begin, std::size_t end, StillLine& line) const {
    const Moments m = Between(begin, end);
    line.slope = m.slope;
    line.at_zero = m.v - m.slope * (m.u + origin_);
  }

  // What that line leaves of them: variance of one, px^2.
  double VarianceAbout(std::size_t begin, std::size_t end) const {
    const Moments m = Between(begin, end);
    return std::max(0.0, m.rest) * m.n / (m.n - 2.0);
  }

 private:
  struct Sums {
    double n = 0.0, u = 0.0, uu = 0.0, v = 0.0, uv = 0.0, vv = 0.0;
  };
  struct Moments {
    double n, u, v, slope, rest;
  };

  Moments Between(std::size_t begin, std::size_t end) const {
    const Sums& a = sums_[begin];
    const Sums& b = sums_[end];
    Moments m{};
    m.n = b.n - a.n;
    m.u = (b.u - a.u) / m.n;
    m.v = (b.v - a.v) / m.n;
    const double spread = (b.uu - a.uu) / m.n - m.u * m.u;
    m.slope = spread > 0.0 ? ((b.uv - a.uv) / m.n - m.u * m.v) / spread : 0.0;
    m.rest = (b.vv - a.vv) / m.n - m.v * m.v - m.slope * m.slope * spread;
    return m;
  }

  double origin_;
  std::vector<Sums> sums_;
};

// Adds crossings [begin, end) as one line if they are on one, else in two
// parts. The longest line that they allow is taken.
void AddLines(const Chain& chain, const ChainSums& sums, std::size_t begin,
              std::size_t end, StillLine line, std::vector<StillLine>& lines) {
  // Variance of a crossing about short lines.
  double near = 0.0;
  double parts = 0.0;
  for (std::size_t at = begin; at + kShort <= end; at += kShort) {
    near += sums.VarianceAbout(at, at + kShort);
    parts += 1.0;
  }
  near /= parts;
  // px, of one crossing: more is no edge that single pixels are about.
  constexpr double kRough_px = 0.25;
  // Of the variance about a long line over that about short ones. More: bent
  // edges are taken for straight; less: noise cuts lines short.
  constexpr double kAlike = 1.5;
  // px, as the place of a crossing between two pixels goes to and fro where the
  // blur is not known yet: no bend.
  constexpr double kBend_px = 0.06;
  if (sums.VarianceAbout(begin, end) > kAlike * near + kBend_px * kBend_px) {
    if (end - begin < 2 * kShort) return;
    const std::size_t middle = begin + (end - begin) / 2;
    AddLines(chain, sums, begin, middle, line, lines);
    AddLines(chain, sums, middle, end, line, lines);
    return;
  }
  if (near > kRough_px * kRough_px) return;
  line.rises = chain[begin].contrast > 0.0;
  line.begin = chain[begin].u;
  line.end = chain[end - 1].u;
  sums.FitLine(begin, end, line);
  lines.push_back(line);
}

// Writes one line over the edges of single pixels.
class LineDrawer {
 public:
  LineDrawer(const StillPicture& still, const std::vector<StillEdge>& seen,
             double blur)
      : still_(still),
        blur_(blur),
        edges_(seen),
        distance_(seen.size(), static_cast<float>(kFarthest)) {}

  void Draw(const StillLine& line) {
    const Axes axes(still_, line.along_rows);
    const std::int32_t begin = std::max(line.begin, 1);
    const std::int32_t end = std::min(line.end, axes.length - 2);
    const std::vector<Crossing> on = CrossingsOn(line, axes, begin, end);
    std::size_t next = 0;  // the first at or beyond u
    for (std::int32_t u = begin; u <= end && !on.empty(); ++u) {
      while (next + 1 < on.size() && on[next].u < u) ++next;
      // As many on both sides, as far as there are.
      const std::size_t count = std::min(on.size(), kShort);
      const std::size_t from =
          std::min(std::max(next, kShort / 2) - kShort / 2, on.size() - count);
      const auto contrast = MeanContrast(std::span(on).subspan(from, count));
      if (contrast) DrawAt(line, axes, u, *contrast);
    }
  }

  std::vector<StillEdge> Take() { return std::move(edges_); }

 private:
  std::vector<Crossing> CrossingsOn(const StillLine& line, const Axes& axes,
                                    std::int32_t begin,
                                    std::int32_t end) const {
    const double blur = blur_ * std::hypot(1.0, line.slope);
    std::vector<Crossing> on;
    for (std::int32_t u = begin; u <= end; ++u) {
      const auto crossing = FitCrossing(still_, axes, blur, u, line.At(u));
      if (!crossing || (crossing->contrast > 0.0) != line.rises) continue;
      on.push_back(*crossing);
    }
    return on;
  }

  // Nothing where they have not one.
  static std::optional<double> MeanContrast(std::span<const Crossing> on) {
    // Of the contrast, rms. More: the edge between two textures is taken for
    // one of two levels.
    constexpr double kOneContrast = 0.3;
    double sum = 0.0;
    double squares = 0.0;
    for (const Crossing& crossing : on) {
      sum += std::abs(crossing.contrast);
      squares += crossing.contrast * crossing.contrast;
    }
    const double n = static_cast<double>(on.size());
    const double mean = sum / n;
    if (squares / n - mean * mean > std::pow(kOneContrast * mean, 2)) {
      return std::nullopt;
    }
    return mean;
  }

  void DrawAt(const StillLine& line, const Axes& axes, std::int32_t u,
              double contrast) {
    const double v_edge = line.At(u);
    const double cosine = 1.0 / std::hypot(1.0, line.slope);
    const double reach = kFarthest * blur_ / cosine;
    const auto top =
        std::max(1, static_cast<std::int32_t>(std::ceil(v_edge - reach)));
    const auto bottom = std::min(
        axes.depth - 2, static_cast<std::int32_t>(std::floor(v_edge + reach)));
    const double rises = line.rises ? 1.0 : -1.0;
    const auto across = static_cast<float>(rises * cosine);
    const auto beside = static_cast<float>(-rises * cosine * line.slope);
    for (std::int32_t v = top; v <= bottom; ++v) {
      const std::size_t pixel = axes.PixelAt(u, v);
      const auto z = static_cast<float>(rises * cosine * (v - v_edge) / blur_);
      // Of two lines beside a pixel the nearer one.
      if (std::abs(z) >= distance_[pixel]) continue;
      distance_[pixel] = std::abs(z);
      StillEdge& edge = edges_[pixel];
      edge.contrast = static_cast<float>(contrast);
      edge.z = z;
      edge.normal_x = axes.along_rows ? beside : across;
      edge.normal_y = axes.along_rows ? across : beside;
    }
  }

  const StillPicture& still_;
  double blur_;
  std::vector<StillEdge> edges_;
  std::vector<float> distance_;  // to the line that was drawn, in blurs
};

}  // namespace

StillLine StillLine::Within(std::int32_t x, std::int32_t y) const {
  const std::int32_t du = along_rows ? x : y;
  const std::int32_t dv = along_rows ? y : x;
  StillLine out = *this;
  out.begin -= du;
  out.end -= du;
  out.at_zero += slope * du - dv;
  return out;
}

std::vector<StillLine> FindStillLines(const StillPicture& still, double blur,
                                      double least_dn) {
  const std::vector<StillEdge> seen = SeenByPixels(still, blur, least_dn);
  std::vector<StillLine> lines;
  for (const bool along_rows : {true, false}) {
    const Axes axes(still, along_rows);
    Chains chains;
    for (std::int32_t u = 1; u + 1 < axes.length; ++u) {
      chains.End(u);
      // Two pixels may both claim an edge between them: the nearer one has it.
      std::optional<Crossing> held;
      double off = 0.0;
      for (std::int32_t v = 1; v + 1 < axes.depth; ++v) {
        const auto crossing = CrossingIn(still, axes, seen, blur, u, v);
        if (!crossing) continue;
        const double own_off = std::abs(crossing->v - v);
        if (held && crossing->v - held->v < 1.0) {
          if (own_off >= off) continue;
        } else if (held) {
          chains.Add(*held);
        }
        held = crossing;
        off = own_off;
      }
      if (held) chains.Add(*held);
    }
    StillLine line;
    line.along_rows = along_rows;
    for (const Chain& chain : chains.TakeLong()) {
      AddLines(chain, ChainSums(chain), 0, chain.size(), line, lines);
    }
  }
  return lines;
}

std::vector<StillEdge> FindStillEdges(const StillPicture& still,
                                      std::span<const StillLine> lines,
                                      double blur, double least_dn) {
  std::vector<StillEdge> seen = SeenByPixels(still, blur, least_dn);
  if (lines.empty()) return seen;
  LineDrawer drawer(still, seen, blur);
  for (const StillLine& line : lines) drawer.Draw(line);
  return drawer.Take();
}

}  // namespace touchdown::vision::layers
