#include "detection/chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numbers/moments.h"
#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

// Median over the detections of a tracklet: a few blobs that merged with a
// shadow do not count.
template <class Get>
double ComputeMedian(const Chain& chain, Get get) {
  std::vector<double> values;
  values.reserve(chain.links.size());
  for (const Link& link : chain.links) values.push_back(get(link));
  return Median(std::move(values));
}

// Whether two blobs have contrast of one sign, and area and contrast within a
// ratio.
bool Alike(double area1, double contrast1, double area2, double contrast2,
           double ratio) {
  return contrast1 * contrast2 > 0.0 && area1 < ratio * area2 &&
         area2 < ratio * area1 &&
         std::abs(contrast1) < ratio * std::abs(contrast2) &&
         std::abs(contrast2) < ratio * std::abs(contrast1);
}

double Distance(const core::PixelPoint& a, const core::PixelPoint& b) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

// How well `blob` continues `chain`: distance from the predicted place over the
// reach. At 1 or more it does not.
double Misfit(const Chain& chain, std::int64_t frame, const Blob& blob) {
  const Link& last = chain.links.back();
  const auto dt = static_cast<double>(frame - last.frame);
  double vx = 0.0;
  double vy = 0.0;
  const double size = std::sqrt(std::max(last.blob.area_px2, blob.area_px2));
  // px. Without a velocity yet: three sizes a frame, and 5 px for small blobs.
  // Larger links other things; smaller loses fast bodies. Not studied.
  double reach = 3.0 * size + 5.0;
  if (chain.links.size() >= 2) {
    const Link& before = chain.links[chain.links.size() - 2];
    const auto gone = static_cast<double>(last.frame - before.frame);
    vx = (last.blob.centre.x_px - before.blob.centre.x_px) / gone;
    vy = (last.blob.centre.y_px - before.blob.centre.y_px) / gone;
    // An impact may turn the velocity round between two frames: the prediction
    // is then off by twice the way, plus the blob's own size.
    reach = size + 2.0 * std::hypot(vx, vy) * dt + 3.0;
  }
  // Ratio of areas and of contrasts: blur and shadow change a blob by so much
  // from frame to frame. Not studied.
  constexpr double kMaxLinkRatio = 4.0;
  if (!blob.at_border && !last.blob.at_border &&
      !Alike(last.blob.area_px2, last.blob.contrast_dn, blob.area_px2,
             blob.contrast_dn, kMaxLinkRatio)) {
    return std::numeric_limits<double>::infinity();
  }
  const core::PixelPoint predicted{last.blob.centre.x_px + vx * dt,
                                   last.blob.centre.y_px + vy * dt};
  return Distance(predicted, blob.centre) / reach;
}

// Joins tracklets of one body that was lost between: the next begins after the
// last has ended, and both are alike. `chains` is in the order of first frames.
void JoinInterrupted(std::vector<Chain>& chains) {
  // Ratio of the medians of area and of contrast; medians are steadier than
  // single blobs. Larger joins two bodies; smaller leaves one body in pieces.
  // Not studied.
  constexpr double kSameBodyRatio = 1.8;
  // Medians are computed once for each tracklet, not once for each pair.
  struct Kind {
    double area = 0.0;
    double contrast = 0.0;
  };
  std::vector<Kind> kinds;
  kinds.reserve(chains.size());
  for (const Chain& chain : chains) {
    kinds.push_back({chain.Area(), chain.Contrast()});
  }
  std::vector<bool> joined(chains.size(), false);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (joined[i]) continue;
    for (std::size_t j = i + 1; j < chains.size(); ++j) {
      if (joined[j] ||
          chains[j].links.front().frame <= chains[i].links.back().frame ||
          !Alike(kinds[i].area, kinds[i].contrast, kinds[j].area,
                 kinds[j].contrast, kSameBodyRatio)) {
        continue;
      }
      chains[i].links.insert(chains[i].links.end(), chains[j].links.begin(),
                             chains[j].links.end());
      kinds[i] = {chains[i].Area(), chains[i].Contrast()};
      joined[j] = true;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (joined[i]) continue;
    if (kept != i) chains[kept] = std::move(chains[i]);
    ++kept;
  }
  chains.resize(kept);
}

}  // namespace

double Chain::Strength() const {
  double sum = 0.0;
  for (const Link& link : links) {
    // The contrast counts squared: a shadow may be larger and be seen longer,
    // but it is fainter.
    sum += link.blob.area_px2 * link.blob.contrast_dn * link.blob.contrast_dn;
  }
  return sum;
}
double Chain::Area() const {
  return ComputeMedian(*this, [](const Link& l) { return l.blob.area_px2; });
}
double Chain::Contrast() const {
  return ComputeMedian(*this, [](const Link& l) { return l.blob.contrast_dn; });
}
double Chain::Extent() const {
  double extent = 0.0;
  for (const Link& link : links) {
    extent =
        std::max(extent, Distance(links.front().blob.centre, link.blob.centre));
  }
  return extent;
}

// Whether more than half of the frames are in flights: stretches in which the
// blob goes straight along the picture and downward in a parabola that opens
// downward. A stretch grows until it leaves the parabola.
bool Chain::Falls() const {
  // Root mean square off the parabola, as a share of the size and in px. Larger
  // takes a swinging hand for a fall; smaller loses bodies whose blobs change.
  // Set with the recorded table_tennis_door, where a hand was followed before.
  constexpr double kMaxOffShare = 0.05;
  constexpr double kMinMaxOff_px = 1.0;
  // Sagitta of the parabola, as a share of the size: less is no clear fall. At
  // thousands of frames a second no body falls by so much. Set with the same
  // clip.
  constexpr double kMinSagitta = 0.5;
  // Frames: a parabola through fewer judges nothing.
  constexpr std::size_t kMinFlightLinks = 6;
  const double size = std::sqrt(Area());
  const double most_off = std::max(kMinMaxOff_px, kMaxOffShare * size);
  std::size_t in_flight = 0;
  for (std::size_t begin = 0; begin + kMinFlightLinks <= links.size();) {
    Moments x, y;
    std::size_t end = begin;  // of the flight
    std::size_t at = begin;
    for (; at < links.size(); ++at) {
      const Link& first = links[begin];
      const auto t = static_cast<double>(links[at].frame - first.frame);
      x.Add(t, links[at].blob.centre.x_px - first.blob.centre.x_px, 1.0);
      y.Add(t, links[at].blob.centre.y_px - first.blob.centre.y_px, 1.0);
      if (at + 1 - begin < kMinFlightLinks) continue;
      const Polynomial across(x);
      const Polynomial down(y);
      if (std::max(across.rss1, down.rss2) > x.w * most_off * most_off) break;
      if (0.25 * down.bend * t * t > kMinSagitta * size) end = at + 1;
    }
    in_flight += end - begin;
    begin =
        end > begin ? end : begin + std::max<std::size_t>(1, (at - begin) / 2);
  }
  return 2 * in_flight > links.size();
}

// Links one frame's blobs: all pairs of tracklet and blob within reach, the
// best first, each used once. A blob without a tracklet begins one; a tracklet
// that missed too many frames is closed.
void ChainBuilder::Add(std::int64_t frame, double time_s,
                       const std::vector<Blob>& blobs) {
  struct Pair {
    double misfit;
    std::size_t chain;
    std::size_t blob;
  };
  std::vector<Pair> pairs;
  for (std::size_t c = 0; c < open_.size(); ++c) {
    for (std::size_t b = 0; b < blobs.size(); ++b) {
      const double misfit = Misfit(open_[c], frame, blobs[b]);
      // Ties go to the longer tracklet: up to 0.2 of the reach for ten
      // detections and more. Not studied.
      const double lead =
          0.02 *
          std::min<double>(10.0, static_cast<double>(open_[c].links.size()));
      if (misfit < 1.0) pairs.push_back({misfit - lead, c, b});
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return a.misfit < b.misfit; });
  std::vector<bool> chain_taken(open_.size(), false);
  std::vector<bool> blob_taken(blobs.size(), false);
  for (const Pair& pair : pairs) {
    if (chain_taken[pair.chain] || blob_taken[pair.blob]) continue;
    chain_taken[pair.chain] = blob_taken[pair.blob] = true;
    open_[pair.chain].links.push_back({frame, time_s, blobs[pair.blob]});
  }
  for (std::size_t b = 0; b < blobs.size(); ++b) {
    if (!blob_taken[b]) open_.push_back({{{frame, time_s, blobs[b]}}});
  }
  for (std::size_t c = open_.size(); c-- > 0;) {
    if (frame - open_[c].links.back().frame > options_.most_missing) {
      closed_.push_back(std::move(open_[c]));
      open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(c));
    }
  }
}

std::vector<Chain> ChainBuilder::Finish() {
  std::vector<Chain> chains = std::move(closed_);
  for (Chain& chain : open_) chains.push_back(std::move(chain));
  open_.clear();
  closed_.clear();
  // Two detections may be chance; three lie on a path.
  std::erase_if(chains, [](const Chain& c) { return c.links.size() < 3; });
  if (chains.size() > options_.most_chains) {
    left_out_ = chains.size() - options_.most_chains;
    std::stable_sort(chains.begin(), chains.end(),
                     [](const Chain& a, const Chain& b) {
                       return a.Strength() > b.Strength();
                     });
    chains.resize(options_.most_chains);
  }
  std::sort(chains.begin(), chains.end(), [](const Chain& a, const Chain& b) {
    return a.links.front().frame < b.links.front().frame;
  });
  JoinInterrupted(chains);
  std::erase_if(chains, [](const Chain& c) {
    // What moves by less, in px and as a share of its size, is flicker or noise
    // of something at rest. Not studied.
    constexpr double kMinMotion_px = 2.0;
    constexpr double kMinMotionShare = 0.1;
    return c.Extent() <
           std::max(kMinMotion_px, kMinMotionShare * std::sqrt(c.Area()));
  });
  // Factor on the strength of what falls: a hand, a person or a shadow may be
  // larger. Tenfold stands for a body of a third of the other's diameter. Set
  // with the recorded table_tennis_door.
  constexpr double kFallWeight = 10.0;
  struct Ranked {
    double weight;
    std::size_t chain;
  };
  std::vector<Ranked> order;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    order.push_back(
        {chains[i].Strength() * (chains[i].Falls() ? kFallWeight : 1.0), i});
  }
  std::stable_sort(
      order.begin(), order.end(),
      [](const Ranked& a, const Ranked& b) { return a.weight > b.weight; });
  std::vector<Chain> ranked;
  for (const Ranked& r : order) ranked.push_back(std::move(chains[r.chain]));
  return ranked;
}

// Whether two tracklets keep their distance while they move: parts of one body.
bool MoveAsOne(const Chain& a, const Chain& b) {
  std::vector<double> dx;
  std::vector<double> dy;
  std::vector<double> x;
  std::vector<double> y;
  std::size_t j = 0;
  for (const Link& link : a.links) {
    while (j < b.links.size() && b.links[j].frame < link.frame) ++j;
    if (j == b.links.size()) break;
    if (b.links[j].frame != link.frame) continue;
    dx.push_back(b.links[j].blob.centre.x_px - link.blob.centre.x_px);
    dy.push_back(b.links[j].blob.centre.y_px - link.blob.centre.y_px);
    x.push_back(link.blob.centre.x_px);
    y.push_back(link.blob.centre.y_px);
  }
  // Frames that show both: fewer tell no spread. Not studied.
  constexpr std::size_t kMinTogether = 5;
  if (dx.size() < kMinTogether) return false;
  const auto spread = [](std::vector<double> values) {
    const double centre = Median(values);
    for (double& v : values) v = std::abs(v - centre);
    return Median(std::move(values));
  };
  const double offset = std::hypot(spread(dx), spread(dy));
  const double path = std::hypot(spread(x), spread(y));
  const double size = std::sqrt(std::min(a.Area(), b.Area()));
  // Median spread of the distance, as a share of the smaller one's size (2 px
  // at least) and of the path. Larger takes two bodies for one; smaller takes
  // the ends of a turning block for two. Not studied.
  constexpr double kMaxSpreadOfSize = 0.15;
  constexpr double kMaxSpreadOfPath = 0.1;
  return offset < std::max(2.0, kMaxSpreadOfSize * size) &&
         offset < kMaxSpreadOfPath * path;
}

namespace {

// Whether another tracklet may be a body of its own: seen at the same time,
// alike in size and contrast, and moving.
bool IsLike(const Chain& best, const Chain& other) {
  const std::int64_t from =
      std::max(best.links.front().frame, other.links.front().frame);
  const std::int64_t to =
      std::min(best.links.back().frame, other.links.back().frame);
  const auto shorter =
      static_cast<double>(std::min(best.links.size(), other.links.size()));
  // Share of the shorter one's frames that both must be seen in; share of the
  // contrast; ratio of the areas. Looser calls shadows a second body, and such
  // a clip is not decided; stricter follows one of two. Not studied.
  constexpr double kMinOverlap = 0.3;
  constexpr double kMinContrastShare = 0.7;
  constexpr double kMaxAreaRatio = 2.5;
  return static_cast<double>(to - from + 1) > kMinOverlap * shorter &&
         other.links.size() >= 5 && other.Contrast() * best.Contrast() > 0.0 &&
         std::abs(other.Contrast()) >
             kMinContrastShare * std::abs(best.Contrast()) &&
         other.Area() * kMaxAreaRatio > best.Area() &&
         other.Area() < kMaxAreaRatio * best.Area() &&
         other.Extent() > std::sqrt(other.Area());
}

}  // namespace

// Extent of both parts along the line between them: median distance and half
// the length of each.
double LengthTogether(const Chain& best, const Chain& other) {
  if (!IsLike(best, other) || !MoveAsOne(best, other)) return 0.0;
  std::vector<double> distance;
  std::size_t j = 0;
  for (const Link& link : best.links) {
    while (j < other.links.size() && other.links[j].frame < link.frame) ++j;
    if (j == other.links.size()) break;
    if (other.links[j].frame != link.frame) continue;
    distance.push_back(Distance(link.blob.centre, other.links[j].blob.centre));
  }
  const auto half = [](const Chain& chain) {
    return 0.5 *
           ComputeMedian(chain, [](const Link& l) { return l.blob.long_px; });
  };
  return Median(std::move(distance)) + half(best) + half(other);
}

bool IsAnotherBody(const Chain& best, const Chain& other) {
  return IsLike(best, other) && !MoveAsOne(best, other);
}

}  // namespace touchdown::vision
