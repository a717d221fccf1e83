#include "tests/accuracy/score.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "tests/support/statistics.h"
#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::accuracy {

pipeline::AnalyzeOptions Told(const Case& c) {
  pipeline::AnalyzeOptions options;
  options.body_kind = c.film.thrown.kind;
  options.gamma = 1.0;  // bounds are those of a linear camera
  options.scale_px_per_m = core::Estimate{
      c.told_px_per_m, kScaleRelativeU * c.told_px_per_m, std::nullopt};
  const auto whole = [](const core::Estimate& half) {
    return core::Estimate{2.0 * half.value, 2.0 * half.u, std::nullopt};
  };
  if (c.told_half_long_m) {
    const core::Estimate size = whole(*c.told_half_long_m);
    if (options.body_kind == core::BodyKind::kSphere) {
      options.diameter_m = size;
    } else {
      options.long_m = size;
      options.short_m = whole(*c.told_half_short_m);
    }
  }
  return options;
}

Outcome Analyse(const Case& c) {
  const pipeline::AnalyzeOptions options = Told(c);
  auto clip = vision::OpenScene(pipeline::filmed::BuildScene(c.film), c.seed);
  const auto start = std::chrono::steady_clock::now();
  const pipeline::Analysis analysis =
      pipeline::AnalyzeClip(std::move(clip), options);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  Outcome outcome = Compare(c, analysis.contacts.first);
  outcome.seconds = seconds;
  return outcome;
}

std::vector<Outcome> AnalyseAll(const std::vector<Case>& cases) {
  std::vector<Outcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++) {
      outcomes[i] = Analyse(cases[i]);
    }
  };
  std::vector<std::jthread> threads;
  const unsigned count = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < count; ++i) threads.emplace_back(work);
  threads.clear();
  return outcomes;
}

Outcome Compare(const Case& c, const core::ContactRecord& first) {
  Outcome outcome;
  outcome.made = c;
  const vision::synthetic::Throw& t = c.film.thrown;
  const Bound bound = BoundOf(c);
  outcome.state = first.state.label;
  outcome.state_reason = first.state.reason;
  if (first.state.max_gap_m) outcome.u_gap_m = first.state.max_gap_m->u;
  if (first.state.bounce_height_m) {
    outcome.bounce_height_m = first.state.bounce_height_m->value;
  }
  const auto read = [&](Quantity quantity, const core::Measured& measured,
                        double truth, double of_bound) {
    if (!measured) {
      outcome.reasons[quantity] =
          first.contact.found ? measured.error().reason : first.contact.reason;
      return;
    }
    const core::Interval interval = core::Interval95(*measured);
    outcome.readings[quantity] =
        Reading{measured->value - truth, measured->u,
                interval.low <= truth && truth <= interval.high, of_bound};
  };
  read(kApproach, first.contact.approach_angle_rad, t.ContactAngle(),
       bound.approach_rad);
  read(kFrame, first.contact.frame, c.film.contact_frame, bound.frame);
  if (t.kind == core::BodyKind::kRectangle) {
    read(kFace, first.contact.face_angle_rad, t.face_rad, bound.face_rad);
    read(kRadius, first.contact.radius_angle_rad,
         std::atan2(t.Support(t.face_rad), std::abs(t.Arm())),
         bound.radius_rad);
  }
  return outcome;
}

core::Interval RmsInterval95(const std::vector<double>& errors) {
  constexpr int kDraws = 1000;
  std::mt19937_64 engine(1);
  std::uniform_int_distribution<std::size_t> any(0, errors.size() - 1);
  std::vector<double> drawn;
  std::vector<double> sample(errors.size());
  drawn.reserve(kDraws);
  for (int i = 0; i < kDraws; ++i) {
    for (double& v : sample) v = errors[any(engine)];
    drawn.push_back(testing::Rms(sample));
  }
  std::sort(drawn.begin(), drawn.end());
  return {drawn[kDraws / 40], drawn[kDraws - 1 - kDraws / 40]};
}

double Sum::RmseOverBound() const {
  return std::sqrt(square_of_ratio / static_cast<double>(measured));
}

double Sum::Rmse() const {
  return std::sqrt(square / static_cast<double>(measured));
}

double Sum::Coverage() const {
  return static_cast<double>(covered) / static_cast<double>(measured);
}

double Sum::MeanZ() const { return z / static_cast<double>(measured); }

double Sum::MeanZBand() const {
  constexpr double kNormal995 = 2.5758293035489;
  const double n = static_cast<double>(measured);
  const double variance = (z2 - z * z / n) / (n - 1.0);
  return kNormal995 * std::sqrt(variance / n);
}

core::Interval Sum::CoverageBand() const {
  return analysis::WilsonInterval(static_cast<int>(covered),
                                  static_cast<int>(measured), 0.99);
}

void Add(Sum& sum, const Outcome& outcome, Quantity quantity) {
  const auto& reading = outcome.readings[quantity];
  if (!reading && outcome.reasons[quantity].empty()) return;
  ++sum.expected;
  if (!reading) return;
  ++sum.measured;
  if (reading->covered) ++sum.covered;
  const double ratio = reading->error / reading->bound;
  sum.square_of_ratio += ratio * ratio;
  sum.square += reading->error * reading->error;
  const double z = reading->error / reading->u;
  sum.z += z;
  sum.z2 += z * z;
}

void Add(States& states, const Outcome& outcome) {
  ++states.cases;
  const double off = *outcome.made.rise_m - outcome.bounce_height_m;
  const bool clear = std::abs(off) > 2.0 * outcome.u_gap_m;
  const bool far = std::abs(off) > 4.0 * outcome.u_gap_m;
  const bool undecided = outcome.state == core::MotionState::kUndecided;
  const bool bounce = outcome.state == core::MotionState::kBounce;
  states.clear += clear;
  states.far += far;
  states.false_bounces += clear && bounce && off < 0.0;
  states.missed_bounces += clear && !bounce && !undecided && off > 0.0;
  states.undecided += far && undecided;
}

}  // namespace touchdown::accuracy
