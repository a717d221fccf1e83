#include "contact/motion_segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "numbers/lanes.h"
#include "numbers/moments.h"
#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

// Cost of what is impossible.
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Frames. A parabola has three numbers a coordinate, so that four frames are
// the fewest that can contradict it. Fewer frames fit any motion.
constexpr std::size_t kMinFramesToJudge = 4;

// Residual sum of squares of the best line through a supported stretch's gaps
// by place: min over (a, b) of sum w (gap - a - b x)^2 + prior_level a^2 +
// prior_slope b^2. The priors are precisions (1/u^2) of a level and a slope of
// zero: they say how well the ground line is known.
double RssOfLine(const Moments& gaps, double prior_level, double prior_slope) {
  const double a = gaps.w + prior_level;
  const double c = gaps.tt + prior_slope;
  const double determinant = a * c - gaps.t * gaps.t;
  // Share of the product of the diagonal: rounding alone leaves about 1e-16.
  // Below it all frames lie at one place, no slope is told, and the level alone
  // is fitted.
  constexpr double kSingular = 1e-12;
  if (!(determinant > kSingular * a * c)) {
    return std::max(0.0, gaps.yy - gaps.y * gaps.y / a);
  }
  const double level = (c * gaps.y - gaps.t * gaps.ty) / determinant;
  const double slope = (a * gaps.ty - gaps.t * gaps.y) / determinant;
  return std::max(0.0, gaps.yy - level * gaps.y - slope * gaps.ty);
}

// Variance of a straight line's forecast one frame beyond its n equally spaced
// frames, in units of the variance of one frame: 1/n + (distance from the
// mean)^2 / (sum of squares about the mean) = 2 (2n + 1) / (n (n - 1)).
double ForecastVariance(std::size_t n) {
  const auto m = static_cast<double>(n);
  return 2.0 * (2.0 * m + 1.0) / (m * (m - 1.0));
}

// States of the automaton: what the frames before a boundary were. They forbid
// a path that makes no sense, such as a second flight after one that did not
// end on the ground.
enum State : std::size_t {
  kAtStart,        // no frame yet
  kBeforeFlights,  // in a hand, say: how the next flight starts is free
  kTouched,        // the last stretch ended on the ground
  kInAir,          // a flight ended off the ground: no other flight follows
  kAfterFlights,   // whatever follows the last flight
  kStates
};

// What a flight, or a stretch on the ground, may follow.
constexpr std::initializer_list<State> kMayLand = {kAtStart, kBeforeFlights,
                                                   kTouched};

// The cheapest way to one boundary in one state, and its last stretch.
struct PathStep {
  double cost = kInfinity;
  std::size_t begin = 0;
  State from = kAtStart;
  StretchKind kind = StretchKind::kOther;
  double chi2 = 0.0;
  int degrees = 0;
};

// One motion fitted to one stretch: `rss` in units of u^2.
struct MotionFit {
  StretchKind kind = StretchKind::kOther;
  int parameters = 0;
  double rss = 0.0;
};

// The coordinates of a frame: of the path by time, in frames; the gap by place.
enum Coordinate : int { kAlong, kHeight, kFaceAngle, kGap, kCoordinates };
// What a vector of them takes, and how avx2 wants it aligned.
constexpr std::size_t kBytesOfEach = kCoordinates * sizeof(double);
using Each = double __attribute__((vector_size(kBytesOfEach)));
// AddUntil may take it for aligned as avx2 wants it, of which other functions
// do not know: say so wherever one is kept.
struct alignas(kBytesOfEach) WeightedValues {
  Each at, value, weight;
};

class Segmenter {
 public:
  // `floor_px`: added to the poses' own u.
  Segmenter(const PlaneTrack& track, const SegmentationOptions& options,
            double floor_px);
  Segmentation Run();
  // Moves each cut by some frames to where its neighbours cost the least.
  void PlaceCuts(std::vector<Stretch>& stretches) const;

 private:
  struct Fits;
  Segmentation BestPath();
  double ComputeCost(const Stretch& stretch, bool touches_at_end) const;
  double ComputeCost(const Fits& fits, const MotionFit& motion) const;
  void GrowStretches(std::size_t begin);
  void OfferFlight(const Fits& fits);
  void OfferSupport(const Fits& fits);
  void OfferAnyMotion(const Fits& fits);
  bool MayWin(const Fits& fits, const MotionFit& motion,
              std::initializer_list<State> from,
              std::initializer_list<State> to) const;
  void Offer(const Fits& fits, const MotionFit& motion, State from, State to,
             double ends);
  double FlightGap(const Fits& fits, std::size_t at) const;
  double StartCost(const Fits& fits) const;
  double EndCost(const Fits& fits) const;
  double OffGround(double above, std::size_t at, std::size_t frames,
                   double most) const;
  bool MayTouch(std::size_t end) const;

  const PlaneTrack& track_;
  const SegmentationOptions& options_;
  const std::vector<PlaneSample>& samples_;
  bool turns_;
  std::size_t least_flight_;          // frames
  int per_frame_;                     // numbers measured in a frame
  alignas(kBytesOfEach) Each falls_;  // half of gravity, px per frame^2
  // Schwarz's criterion: (ln N) / 2 for each parameter, ln n for each cut (N
  // numbers measured, n frames), in units of ln odds.
  double per_parameter_;
  double per_cut_;
  double level_precision_;  // of a supported stretch's level and slope
  double slope_precision_;
  std::vector<bool> allowed_;      // cuts before these samples
  std::vector<std::size_t> cuts_;  // the same, in order
  // best_[b][s]: the cheapest way to explain the samples before boundary b that
  // ends in state s.
  std::vector<std::array<PathStep, kStates>> best_;  // by boundary
  std::vector<WeightedValues> seen_;
};

// Of the frames from `begin` on, one after the other.
struct Segmenter::Fits {
  std::size_t begin = 0;
  std::size_t frames = 0;
  WeightedValues first;  // but the gap, which is not relative to it
  alignas(kBytesOfEach) MomentsOf<Each> sums;
  double lowest_px = kInfinity;
  double highest_px = -kInfinity;
  // Of the frames so far, once they were fitted.
  Moments gaps;
  Polynomial x, y, f;

  Fits(const Segmenter& of, std::size_t from)
      : begin(from), first(of.seen_[from]) {
    first.at[kGap] = first.value[kGap] = 0.0;
  }
  std::size_t end() const { return begin + frames; }
  // Adds the frames before `end` that are still missing.
  void AddUntil(std::size_t end, const Segmenter& of);
  void Fit();
  double ComputeRss(StretchKind kind, const Segmenter& of) const;
  MotionFit As(StretchKind kind, int parameters, const Segmenter& of) const {
    return {kind, parameters, ComputeRss(kind, of)};
  }
};

// Adds half of gravity times t^2 to each height, so that a flight under known
// gravity becomes a straight line: its residuals are those of degree 1.
// A long clip adds a thousand frames to each of a hundred stretches: most of
// what a segmentation costs.
TOUCHDOWN_WIDEST
void Segmenter::Fits::AddUntil(std::size_t end, const Segmenter& of) {
  alignas(kBytesOfEach) MomentsOf<Each> total = sums;  // in registers
  for (; begin + frames < end; ++frames) {
    const WeightedValues& s = of.seen_[begin + frames];
    const Each at = s.at - first.at;
    total.Add(at, s.value - first.value + of.falls_ * at * at, s.weight);
    lowest_px = std::min(lowest_px, s.value[kGap]);
    highest_px = std::max(highest_px, s.value[kGap]);
  }
  sums = total;
}

void Segmenter::Fits::Fit() {
  x = Polynomial(sums.SelectSeries(kAlong));
  y = Polynomial(sums.SelectSeries(kHeight));
  f = Polynomial(sums.SelectSeries(kFaceAngle));
  gaps = sums.SelectSeries(kGap);
}

// Residuals of the stretch as one kind of motion. On the ground the height is
// not free: it is the ground line's plus the support height, so that the gap is
// what must be zero.
double Segmenter::Fits::ComputeRss(StretchKind kind,
                                   const Segmenter& of) const {
  if (kind == StretchKind::kFlight) {
    const bool known = of.options_.gravity_px_per_s2.has_value();
    return x.rss1 + (known ? y.rss1 : y.rss2) + f.rss1;
  }
  if (kind == StretchKind::kSupported) {
    return x.rss2 + RssOfLine(gaps, 0.0, of.slope_precision_) + f.rss2;
  }
  return frames < kMinFramesToJudge ? 0.0 : x.rss2 + y.rss2 + f.rss2;
}

Segmenter::Segmenter(const PlaneTrack& track,
                     const SegmentationOptions& options, double floor_px)
    : track_(track),
      options_(options),
      samples_(track.samples),
      turns_(track.kind == core::BodyKind::kRectangle),
      least_flight_(options.gravity_px_per_s2 ? 2 : kMinFramesToJudge),
      per_frame_(turns_ ? 3 : 2),
      falls_{0.0, 0.5 * options.gravity_px_per_s2.value_or(0.0) *
                      track.frame_interval_s * track.frame_interval_s},
      per_parameter_(
          0.5 * std::log(per_frame_ * static_cast<double>(samples_.size()))),
      per_cut_(std::log(static_cast<double>(samples_.size()))),
      best_(samples_.size() + 1) {
  const auto precision = [](double u) { return 1.0 / std::max(u * u, 1e-12); };
  level_precision_ = precision(std::hypot(
      track.ground.u_offset_px, track.u_half_px, options.edge_bias_px));
  slope_precision_ =
      precision(std::hypot(track.ground.u_angle_rad, kMaxEdgeTilt_rad));
  // The floor of the attitude moves an end of the long side by the floor of
  // place.
  const double floor_rad = floor_px / std::max(track.half_long_px, 1.0);
  for (const PlaneSample& s : samples_) {
    const auto weight = [](double u, double floor) {
      return 1.0 / (u * u + floor * floor);
    };
    const double t = s.time_s / track.frame_interval_s;
    const double face = turns_ ? weight(s.u_face_rad, floor_rad) : 0.0;
    seen_.push_back(WeightedValues{
        {t, t, t, s.along_px},
        {s.along_px, s.height_px, s.face_rad, s.gap_px},
        {weight(s.u_along_px, floor_px), weight(s.u_height_px, floor_px), face,
         weight(s.u_gap_px, floor_px)}});
  }
}

// Gap at sample `at` of the flight fitted to the frames so far: its height less
// the support height at the attitude that the flight has then.
double Segmenter::FlightGap(const Fits& fits, std::size_t at) const {
  const double t = seen_[at].at[kHeight] - fits.first.at[kHeight];
  double height = fits.first.value[kHeight];
  if (options_.gravity_px_per_s2) {
    height += fits.y.Line(t) - falls_[kHeight] * t * t;
  } else {
    height += fits.y.Parabola(t);
  }
  const double face =
      turns_ ? fits.first.value[kFaceAngle] + fits.f.Line(t) : 0.0;
  return height - SupportHeight(track_, face);
}

// Cost of a gap that is `above` zero (or below it, with the sign turned), in
// units of ln odds: half of its square over the variance of line, tilt and
// forecast, at most `most`. The bound keeps one end off the line from buying a
// whole path of unknown motion.
double Segmenter::OffGround(double above, std::size_t at, std::size_t frames,
                            double most) const {
  if (!(above > 0.0)) return 0.0;
  const double tilt = track_.ground.u_angle_rad * samples_[at].along_px;
  const double forecast = ForecastVariance(frames) / seen_[at].weight[kGap];
  const double variance = 1.0 / level_precision_ + tilt * tilt + forecast;
  return std::min(most, 0.5 * above * above / variance);
}

// A flight leaves the ground between the frame before it and its first: its gap
// is not above zero in the one and not below zero in the other.
double Segmenter::StartCost(const Fits& fits) const {
  const std::size_t begin = fits.begin;
  if (begin == 0) return 0.0;
  const double most = options_.off_line_cost;
  return OffGround(FlightGap(fits, begin - 1), begin, fits.frames, most) +
         OffGround(-FlightGap(fits, begin), begin, fits.frames, most);
}

// A flight meets the ground between its last frame and the next.
double Segmenter::EndCost(const Fits& fits) const {
  const std::size_t end = fits.end();
  const double most = options_.off_line_cost;
  const double last =
      OffGround(-FlightGap(fits, end - 1), end - 1, fits.frames, most);
  if (end == samples_.size() || end == options_.touchdown) return last;
  return last + OffGround(FlightGap(fits, end), end, fits.frames, most);
}

// Cost of a stretch without its ends.
double Segmenter::ComputeCost(const Fits& fits, const MotionFit& motion) const {
  return 0.5 * motion.rss + per_parameter_ * motion.parameters +
         (fits.begin > 0 ? per_cut_ : 0.0);
}

// Whether the stretch could be the best way from one of `from` to one of `to`
// if its ends cost nothing: if not, what they cost need not be computed.
bool Segmenter::MayWin(const Fits& fits, const MotionFit& motion,
                       std::initializer_list<State> from,
                       std::initializer_list<State> to) const {
  double before = kInfinity;
  for (const State state : from) {
    before = std::min(before, best_[fits.begin][state].cost);
  }
  if (!(before < kInfinity)) return false;
  const double cost = before + ComputeCost(fits, motion);
  for (const State state : to) {
    if (cost < best_[fits.end()][state].cost) return true;
  }
  return false;
}

// Takes the frames of `fits` as one stretch that leads from state `from` to
// state `to`, if that is cheaper than what leads there already. `ends`: cost of
// its start and its end.
void Segmenter::Offer(const Fits& fits, const MotionFit& motion, State from,
                      State to, double ends) {
  const PathStep& before = best_[fits.begin][from];
  if (!(before.cost < kInfinity)) return;
  const auto [kind, parameters, rss] = motion;
  const double cost = before.cost + ComputeCost(fits, motion) + ends;
  PathStep& best = best_[fits.end()][to];
  if (!(cost < best.cost)) return;
  const int values = static_cast<int>(fits.frames) * per_frame_;
  best = {cost, fits.begin, from, kind, rss, std::max(0, values - parameters)};
}

// Where a person says when it touches down, nothing touches before it, and the
// flight up to it ends there wherever the line is.
bool Segmenter::MayTouch(std::size_t end) const {
  return !options_.touchdown || end >= *options_.touchdown;
}

// One frame at the end of the film may be a flight of its own: the last frame
// alone may have left the ground.
void Segmenter::OfferFlight(const Fits& fits) {
  const bool tail =
      fits.frames == 1 && fits.begin > 0 && fits.end() == samples_.size();
  if (fits.frames < least_flight_ && !tail) return;
  const int values = static_cast<int>(fits.frames) * per_frame_;
  // Place and velocity for each coordinate; the curvature only where gravity is
  // not known.
  const int free = 2 * per_frame_ + (options_.gravity_px_per_s2 ? 0 : 1);
  const MotionFit flight =
      fits.As(StretchKind::kFlight, std::min(values, free), *this);
  if (!MayWin(fits, flight, kMayLand, {kTouched, kInAir})) return;
  const double ending = tail ? 0.0 : EndCost(fits);
  for (const State from : kMayLand) {
    double starting = from == kAtStart ? 0.0 : options_.rebound_cost;
    if (from == kTouched && !tail) starting += StartCost(fits);
    if (MayTouch(fits.end())) {
      Offer(fits, flight, from, kTouched, starting + ending);
    }
    Offer(fits, flight, from, kInAir, starting);
  }
}

// On the ground: one line of gaps, whose level and slope the ground line
// foretells. Another level costs no more than a flight that ends off it.
void Segmenter::OfferSupport(const Fits& fits) {
  // Frames. Two frames cannot show that the gap stays the same. Only the end of
  // the film may leave fewer.
  constexpr std::size_t kMinSupportedFrames = 3;
  const bool last = fits.begin > 0 && fits.end() == samples_.size();
  if ((fits.frames < kMinSupportedFrames && !last) || !MayTouch(fits.begin))
    return;
  // Along the ground it may accelerate (three numbers), and so may its
  // attitude; the level of the gap is one more.
  const int along = static_cast<int>(std::min<std::size_t>(fits.frames, 3));
  const MotionFit down = fits.As(StretchKind::kSupported,
                                 turns_ ? 1 + 2 * along : 1 + along, *this);
  if (!MayWin(fits, down, kMayLand, {kTouched})) return;
  const double off =
      std::min(options_.off_line_cost,
               0.5 * (RssOfLine(fits.gaps, level_precision_, slope_precision_) -
                      RssOfLine(fits.gaps, 0.0, slope_precision_)));
  for (const State from : kMayLand) {
    Offer(fits, down, from, kTouched, off);
  }
}

// Of any kind: pressed to the ground, or in something's hand. Up to three
// frames have a number of their own for each of theirs.
void Segmenter::OfferAnyMotion(const Fits& fits) {
  const std::size_t n = fits.frames;
  const int k = static_cast<int>(std::min<std::size_t>(n, 3)) * per_frame_;
  const MotionFit any = fits.As(StretchKind::kOther, k, *this);
  // A stretch of unknown motion mostly is one that is known, badly seen: it
  // costs much. A few frames say nothing of their motion and cost two cuts.
  // After an impact they cost a rebound more, because they would be one.
  const double few = 2.0 * per_cut_;
  const bool told = n >= kMinFramesToJudge;
  const double before = told ? options_.unknown_cost : few;
  const double after =
      told ? options_.unknown_cost : few + options_.rebound_cost;
  const auto offer_other = [&](State from, State to, double ends) {
    Offer(fits, any, from, to, ends);
  };
  // A contact that lasts. What is pressed down gives way by less than half of
  // its size. It costs twice as much as a rebound: where the line is not known,
  // or is not quite where the flights meet, a contact could stand for one
  // impact.
  if (fits.highest_px - fits.lowest_px < track_.half_short_px) {
    const double above = fits.gaps.y / fits.gaps.w;
    Offer(fits, {StretchKind::kContact, k, any.rss}, kTouched, kTouched,
          2.0 * options_.rebound_cost + OffGround(above, fits.begin,
                                                  std::max<std::size_t>(n, 2),
                                                  kInfinity));
  }
  offer_other(kAtStart, kBeforeFlights, before);
  if (told) offer_other(kBeforeFlights, kBeforeFlights, before);
  if (!MayTouch(fits.begin)) return;
  offer_other(kTouched, kAfterFlights, after);
  offer_other(kInAir, kAfterFlights, after);
  if (told) offer_other(kAfterFlights, kAfterFlights, after);
}

void Segmenter::GrowStretches(std::size_t begin) {
  double least = kInfinity;
  for (const PathStep& step : best_[begin]) least = std::min(least, step.cost);
  if (!(least < kInfinity)) return;
  // No stretch may span the touchdown that a person states.
  const bool early = options_.touchdown && begin < *options_.touchdown;
  const std::size_t limit = early ? *options_.touchdown : samples_.size();
  Fits fits(*this, begin);
  for (auto cut = std::upper_bound(cuts_.begin(), cuts_.end(), begin);
       cut != cuts_.end() && *cut <= limit; ++cut) {
    const std::size_t end = *cut;
    fits.AddUntil(end, *this);
    fits.Fit();
    OfferFlight(fits);
    OfferSupport(fits);
    OfferAnyMotion(fits);
    if (fits.frames < 2) continue;
    // No stretch from here can become the best once even the loosest one, which
    // later frames only make worse, has lost to what leads there already.
    const double loosest = 0.5 * (fits.x.rss2 + fits.y.rss2 + fits.f.rss2);
    double leads = kInfinity;
    for (const State state : {kBeforeFlights, kTouched, kAfterFlights}) {
      leads = std::min(leads, best_[end][state].cost);
    }
    // ln odds. A later stretch may still save two end terms (off_line_cost
    // each) and some cuts. More costs time only; less may prune the best path.
    constexpr double kPruningMargin = 80.0;
    if (least + loosest > leads + kPruningMargin) return;
  }
}

// Of one stretch, for the choice of its ends.
double Segmenter::ComputeCost(const Stretch& stretch,
                              bool touches_at_end) const {
  Fits fits(*this, stretch.begin);
  fits.AddUntil(stretch.end, *this);
  fits.Fit();
  double cost = 0.5 * fits.ComputeRss(stretch.kind, *this);
  if (stretch.kind != StretchKind::kFlight) return cost;
  cost += StartCost(fits);
  if (touches_at_end) cost += EndCost(fits);
  return cost;
}

void Segmenter::PlaceCuts(std::vector<Stretch>& stretches) const {
  // Frames. The floor of u blurs where a cut lies; without the floor it is
  // sought again within so many frames. More costs time, and may move a cut
  // across a short stretch. Not studied.
  constexpr int kMaxShift = 3;
  for (std::size_t k = 0; k + 1 < stretches.size(); ++k) {
    Stretch& a = stretches[k];
    Stretch& b = stretches[k + 1];
    // Stretches with a number for each of theirs explain any frame.
    if (a.kind == StretchKind::kOther || b.kind == StretchKind::kOther ||
        a.kind == StretchKind::kContact || b.kind == StretchKind::kContact ||
        b.begin == options_.touchdown) {
      continue;
    }
    std::size_t best = b.begin;
    double best_cost = kInfinity;
    for (int shift = -kMaxShift; shift <= kMaxShift; ++shift) {
      const std::size_t cut =
          b.begin + static_cast<std::size_t>(shift);  // wraps: beyond an end
      if (cut < a.begin + least_flight_ || cut > a.end + kMaxShift ||
          cut + least_flight_ > b.end) {
        continue;
      }
      Stretch left = a;
      Stretch right = b;
      left.end = right.begin = cut;
      const bool ends = k + 2 < stretches.size();
      const double cost = ComputeCost(left, true) + ComputeCost(right, ends);
      if (cost < best_cost) {
        best_cost = cost;
        best = cut;
      }
    }
    a.end = b.begin = best;
  }
}

Segmentation Segmenter::Run() {
  const std::size_t n = samples_.size();
  if (n < 2) return {};
  // Cuts at every few frames first; then at every frame beside those found,
  // until they stay. What a coarse cut cannot explain asks for cuts beside it.
  // Boundaries. Up to so many frames each frame may be a cut, which takes about
  // a millisecond; the time grows with the square of this number. Coarse to
  // fine takes some milliseconds for 600 frames.
  constexpr std::size_t kMaxCoarseCuts = 120;
  const std::size_t step = (n + kMaxCoarseCuts - 1) / kMaxCoarseCuts;
  std::vector<bool> grid(n + 1, false);
  for (std::size_t i = 0; i <= n; i += step) grid[i] = true;
  grid[n] = true;
  if (options_.touchdown) grid[*options_.touchdown] = true;
  allowed_ = grid;
  Segmentation best = BestPath();
  // A bound on time only: the cuts found last stand if it is reached. Not
  // studied.
  constexpr int kMaxRefinements = 4;
  for (int round = 0; round < kMaxRefinements && step > 1; ++round) {
    const std::vector<bool> before = allowed_;
    for (const Stretch& stretch : best.stretches) {
      const std::size_t reach = 2 * step;
      const std::size_t from =
          stretch.begin > reach ? stretch.begin - reach : 0;
      const std::size_t to = std::min(n, stretch.begin + reach);
      for (std::size_t i = from; i <= to; ++i) allowed_[i] = true;
    }
    if (allowed_ == before) break;
    best = BestPath();
  }
  return best;
}

// Dynamic programming over boundaries (Jackson et al. 2005): each boundary
// offers all stretches that begin there, then the path is read backwards from
// the cheapest state at the end.
Segmentation Segmenter::BestPath() {
  const std::size_t n = samples_.size();
  best_.assign(n + 1, {});
  best_[0][kAtStart].cost = 0.0;
  cuts_.clear();
  for (std::size_t i = 0; i <= n; ++i) {
    if (allowed_[i]) cuts_.push_back(i);
  }
  for (const std::size_t begin : cuts_) {
    if (begin < n) GrowStretches(begin);
  }
  State state = kTouched;
  for (const State other : {kBeforeFlights, kInAir, kAfterFlights}) {
    if (best_[n][other].cost < best_[n][state].cost) state = other;
  }
  Segmentation best;
  best.cost = best_[n][state].cost;
  for (std::size_t end = n; end > 0;) {
    const PathStep& step = best_[end][state];
    if (!(step.cost < kInfinity)) return {};
    best.stretches.push_back(
        {{step.begin, end}, step.kind, step.chi2, step.degrees});
    end = step.begin;
    state = step.from;
  }
  std::reverse(best.stretches.begin(), best.stretches.end());
  return best;
}

}  // namespace

Segmentation SegmentMotion(const PlaneTrack& track,
                           const SegmentationOptions& options) {
  Segmentation best = Segmenter(track, options, options.floor_px).Run();
  Segmenter(track, options, 0.0).PlaceCuts(best.stretches);
  return best;
}

}  // namespace touchdown::vision
