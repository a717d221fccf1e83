#include "vision/src/detection/path_linking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace touchdown::vision {
namespace {

using Frames = std::vector<std::vector<PlacedShape>>;

// Falls by a parabola onto y = 100 in frame 20 and leaves at half the speed.
core::PixelPoint BouncingAt(int frame) {
  const double t = frame - 20.0;
  const double fall = 0.1;
  return {10.0 + 4.0 * frame, t < 0.0 ? 100.0 + 5.0 * t + fall * t * t
                                      : 100.0 - 2.5 * t + fall * t * t};
}

TEST(LinkPath, FollowsABodyThroughAnImpact) {
  Frames frames;
  for (int t = 0; t < 40; ++t) {
    const core::PixelPoint p = BouncingAt(t);
    // The true place is the second; the others jump about with a better score.
    frames.push_back(
        {{{p.x_px + 9.0 + 17.0 * (t % 3), p.y_px - 12.0 * (t % 5)}, 0.0, 0.95},
         {{std::round(p.x_px), std::round(p.y_px)}, 0.0, 0.8},
         {{70.0, 30.0 + 5.0 * (t % 7)}, 0.0, 0.6}});
  }
  const LinkedPath path = LinkPath(frames, {});
  for (int t = 0; t < 40; ++t) {
    EXPECT_EQ(path.chosen[static_cast<std::size_t>(t)], 1U) << t;
  }
}

TEST(LinkPath, PassesOverAStandingGhost) {
  Frames frames;
  for (int t = 0; t < 40; ++t) {
    const core::PixelPoint p = BouncingAt(t);
    // The ghost is where the body was for long; while the body is there, too,
    // neither differs from what the mean shows.
    const double apart = std::hypot(p.x_px - 90.0, p.y_px - 100.0);
    const double ghost = std::min(0.85, 0.03 * apart);
    frames.push_back(
        {{{90.0, 100.0}, 0.0, ghost}, {p, 0.0, apart < 15.0 ? 0.4 : 0.9}});
  }
  const LinkedPath path = LinkPath(frames, {});
  for (int t = 0; t < 40; ++t) {
    EXPECT_EQ(path.chosen[static_cast<std::size_t>(t)], 1U) << t;
  }
}

TEST(LinkPath, ChoosesTheAngleThatTurnsSteadily) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  Frames frames;
  for (int t = 0; t < 20; ++t) {
    // Told but for half turns; the false one is across and scores as well.
    const double angle = 0.1 * t + (t % 2) * std::numbers::pi;
    frames.push_back({{{5.0 * t, 0.0}, angle, 0.8},
                      {{5.0 * t, 0.0}, angle + kQuarter, t == 9 ? 0.85 : 0.7}});
  }
  PathCosts costs;
  costs.period_rad = std::numbers::pi;
  const LinkedPath path = LinkPath(frames, costs);
  EXPECT_EQ(path.chosen, std::vector<std::size_t>(20, 0));
}

TEST(LinkPath, RefusesFramesWithoutACandidate) {
  const PlacedShape any;
  EXPECT_THROW(LinkPath(Frames{{any}, {any}}, {}), std::invalid_argument);
  EXPECT_THROW(LinkPath(Frames{{any}, {}, {any}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
