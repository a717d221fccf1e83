#include "tracking/follow_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "numbers/both_sides.h"
#include "numbers/robust.h"
#include "outline/body_cover.h"
#include "outline/track_shape.h"
#include "touchdown/core/parallel.h"
#include "track/image_size.h"
#include "tracking/pattern.h"

namespace touchdown::vision {
namespace {

// Frames: with fewer the template is hardly better than any one of them, and
// the scatter of third differences tells nothing. Not studied.
constexpr std::size_t kMinFollowed = 8;
// Frames that a template is learnt from, evenly spread. More cost time and
// memory; the template's noise falls as 1/sqrt. Not studied.
constexpr std::size_t kPatternFrames = 120;
// Most templates settle in five rounds; one that does not is reported.
constexpr int kLearningRounds = 12;
// px that a pose may move within the part of the frame that was read. More
// costs memory; less loses poses whose start was worse. Not studied.
constexpr double kSlack_px = 6.0;

double GreatestHalf(const BodyImage& body) {
  return body.kind == core::BodyKind::kSphere ? body.radius_px.value
                                              : body.half_long_px.value;
}

// The body's outline at its median angle.
Outline MiddleOutline(const Track& track) {
  Pose pose;
  std::vector<double> angles;
  angles.reserve(track.poses.size());
  for (const Pose& p : track.poses) angles.push_back(p.angle_rad);
  pose.angle_rad = Median(std::move(angles));
  return PlaceOutline(track.body, pose);
}

// Of a whole that moves as one, whole_body.cc decided whether it turns: its
// poses then have different angles.
bool HasTurned(const Track& track) {
  return std::any_of(track.poses.begin(), track.poses.end(),
                     [&](const Pose& pose) {
                       return pose.angle_rad != track.poses.front().angle_rad;
                     });
}

// A pattern and the poses of the frames that it was learnt from.
struct Learnt {
  Pattern pattern;
  std::vector<Pose> poses;
  double misfit = 0.0;
  bool settled = false;  // within the bound of rounds
};

// Takes the median move of all poses out: the template has moved by it, too,
// and would drift from round to round.
void TakeOutCommonMove(const std::vector<PatternPose>& before,
                       std::vector<PatternPose>& after) {
  std::vector<double> x, y, turn;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const Pose& a = before[k].pose;
    const Pose& b = after[k].pose;
    x.push_back(b.centre.x_px - a.centre.x_px);
    y.push_back(b.centre.y_px - a.centre.y_px);
    turn.push_back(b.angle_rad - a.angle_rad);
  }
  const double dx = Median(std::move(x));
  const double dy = Median(std::move(y));
  const double dt = Median(std::move(turn));
  for (PatternPose& p : after) {
    p.pose.centre.x_px -= dx;
    p.pose.centre.y_px -= dy;
    p.pose.angle_rad -= dt;
  }
}

// Template and poses in turns: the template is the frames' robust mean at their
// poses, and each frame is registered to it again. Frames that cannot be
// registered leave.
std::optional<Learnt> LearnPattern(std::vector<PatternView> views,
                                   std::vector<PatternPose> poses,
                                   Pattern pattern,
                                   const core::Cancellation& until,
                                   int threads) {
  // px: median move of the poses in a round. Smaller costs rounds; the poses' u
  // are larger. Not studied.
  constexpr double kSettled_px = 0.01;
  bool settled = false;
  for (int round = 0; round < kLearningRounds; ++round) {
    if (!pattern.Learn(views, poses)) return std::nullopt;
    std::vector<std::optional<PatternPose>> found(views.size());
    core::InParallel(static_cast<std::int64_t>(views.size()), threads,
                     [&](std::int64_t from, std::int64_t to) {
                       for (auto k = static_cast<std::size_t>(from);
                            k < static_cast<std::size_t>(to); ++k) {
                         until.Check(poses[k].pose.frame);
                         found[k] = pattern.Register(views[k], poses[k].pose);
                       }
                     });
    std::vector<PatternView> kept;
    std::vector<PatternPose> before;
    std::vector<PatternPose> after;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (!found[k]) continue;
      kept.push_back(std::move(views[k]));
      before.push_back(poses[k]);
      after.push_back(*found[k]);
    }
    if (kept.size() < kMinFollowed) return std::nullopt;
    TakeOutCommonMove(before, after);
    std::vector<double> moved;
    for (std::size_t k = 0; k < after.size(); ++k) {
      moved.push_back(
          std::hypot(after[k].pose.centre.x_px - before[k].pose.centre.x_px,
                     after[k].pose.centre.y_px - before[k].pose.centre.y_px));
    }
    views = std::move(kept);
    poses = std::move(after);
    settled = Median(std::move(moved)) < kSettled_px;
    if (settled) break;
  }
  if (!pattern.Learn(views, poses)) return std::nullopt;
  std::vector<Pose> learnt;
  learnt.reserve(poses.size());
  for (const PatternPose& p : poses) learnt.push_back(p.pose);
  const double misfit = MedianMisfit(learnt);
  return Learnt{std::move(pattern), std::move(learnt), misfit, settled};
}

// Extrapolates with the acceleration of three poses (second difference), where
// they are neighbours: a body that falls goes farther in each frame than in the
// one before.
Pose Ahead(const Pose& end, const Pose& next, const Pose& third,
           std::int64_t frame) {
  Pose pose = OnTheWay(end, next, frame);
  if (std::abs(third.frame - end.frame) != 2) return pose;
  pose.centre.x_px +=
      end.centre.x_px - 2.0 * next.centre.x_px + third.centre.x_px;
  pose.centre.y_px +=
      end.centre.y_px - 2.0 * next.centre.y_px + third.centre.y_px;
  return pose;
}

// Position noise of poses, from third differences of their centres (Roughness).
double PathRoughness(const std::vector<Pose>& poses) {
  std::vector<Fitted> all(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    all[i].frame = poses[i].frame;
    all[i].fit.outline.centre = poses[i].centre;
  }
  return Roughness(all);
}

// Information of the poses about the path: their number over their variance.
double Telling(const std::vector<Pose>& poses) {
  const double rough = PathRoughness(poses);
  return static_cast<double>(poses.size()) / (rough * rough);
}

class Follower {
 public:
  Follower(Clip& clip, const Track& track, const Learnt& learnt, int threads)
      : clip_(clip), track_(track), learnt_(learnt), threads_(threads) {}

  // In the track's own frames, then on from there.
  std::vector<Pose> All() const;

 private:
  std::vector<std::optional<PatternPose>> At(const std::vector<Pose>& starts,
                                             double within_px) const;
  bool IsGood(const Pose& pose) const {
    // In units of the misfit that the template was learnt with: a worse frame
    // shows something else. Not studied.
    constexpr double kMaxMisfitRatio = 3.0;
    return pose.misfit <= kMaxMisfitRatio * learnt_.misfit;
  }

  Clip& clip_;
  const Track& track_;
  const Learnt& learnt_;
  int threads_;
};

// Registers the template in many frames, in portions that bound the memory.
std::vector<std::optional<PatternPose>> Follower::At(
    const std::vector<Pose>& starts, double within_px) const {
  // Frames in memory at once. Not studied.
  constexpr std::size_t kViewsAtOnce = 64;
  std::vector<std::optional<PatternPose>> found(starts.size());
  for (std::size_t begin = 0; begin < starts.size(); begin += kViewsAtOnce) {
    const std::size_t end = std::min(starts.size(), begin + kViewsAtOnce);
    std::vector<PatternView> views;
    for (std::size_t i = begin; i < end; ++i) {
      views.push_back(
          ReadView(clip_, starts[i].frame, starts[i].centre,
                   learnt_.pattern.reach_px() + within_px + kSlack_px));
    }
    core::InParallel(static_cast<std::int64_t>(views.size()), threads_,
                     [&](std::int64_t from, std::int64_t to) {
                       for (auto k = static_cast<std::size_t>(from);
                            k < static_cast<std::size_t>(to); ++k) {
                         clip_.cancellation().Check(starts[begin + k].frame);
                         found[begin + k] = learnt_.pattern.Register(
                             views[k], starts[begin + k], within_px);
                       }
                     });
  }
  return found;
}

std::vector<Pose> Follower::All() const {
  std::vector<Pose> poses;
  std::vector<Pose> starts;
  // A pose that the template was learnt from is nearer to it than the
  // outline's.
  for (const Pose& pose : track_.poses) {
    const auto known =
        std::find_if(learnt_.poses.begin(), learnt_.poses.end(),
                     [&](const Pose& p) { return p.frame == pose.frame; });
    starts.push_back(known == learnt_.poses.end() ? pose : *known);
  }
  for (const auto& found : At(starts, 0.0)) {
    if (found && IsGood(found->pose)) poses.push_back(found->pose);
  }
  if (poses.size() < kMinFollowed) return poses;
  // Then the frames within the track that have none, started from both
  // neighbours; then frame by frame beyond its ends, for as long as the body is
  // found where it should be: within 3 px or 15 % of its greatest half side.
  // Larger jumps to other things; smaller loses it at an impact. Not studied.
  const double near = std::max(3.0, 0.15 * GreatestHalf(track_.body));
  Track now = track_;
  now.poses = poses;
  starts.clear();
  for (std::int64_t f = poses.front().frame + 1; f < poses.back().frame; ++f) {
    const bool has = std::any_of(poses.begin(), poses.end(),
                                 [&](const Pose& p) { return p.frame == f; });
    if (!has) starts.push_back(*InterpolatePose(now, f));
  }
  const auto is_near = [&](const Pose& start, const Pose& found) {
    return std::hypot(found.centre.x_px - start.centre.x_px,
                      found.centre.y_px - start.centre.y_px) <= near;
  };
  const auto between = At(starts, near);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (between[i] && IsGood(between[i]->pose) &&
        is_near(starts[i], between[i]->pose)) {
      poses.push_back(between[i]->pose);
    }
  }
  const auto by_frame = [](const Pose& a, const Pose& b) {
    return a.frame < b.frame;
  };
  std::sort(poses.begin(), poses.end(), by_frame);
  for (const bool on : {true, false}) {
    for (std::size_t i = 1; i < poses.size(); ++i) {
      // From the last two on, whichever way, into each gap and beyond the end.
      const std::size_t at = on ? i : poses.size() - 1 - i;
      const Pose& end = poses[at];
      const Pose& next = on ? poses[at - 1] : poses[at + 1];
      const std::int64_t frame = end.frame + (on ? 1 : -1);
      if (frame < track_.first_frame || frame >= track_.last_frame) break;
      const std::size_t beyond = on ? at + 1 : at - 1;
      if (beyond < poses.size() && poses[beyond].frame == frame) continue;
      const Pose last = end;
      const std::size_t third_at = on ? at - 2 : at + 2;
      const Pose straight = third_at < poses.size()
                                ? Ahead(end, next, poses[third_at], frame)
                                : OnTheWay(end, next, frame);
      // The path goes straight on; or an impact stopped the body, or turned it
      // round.
      for (const double way : {1.0, 0.0, -1.0}) {
        Pose start = straight;
        start.centre.x_px =
            last.centre.x_px + way * (straight.centre.x_px - last.centre.x_px);
        start.centre.y_px =
            last.centre.y_px + way * (straight.centre.y_px - last.centre.y_px);
        const auto found = At({start}, near).front();
        if (!found || !IsGood(found->pose) || !is_near(start, found->pose)) {
          continue;
        }
        poses.insert(
            poses.begin() + static_cast<std::ptrdiff_t>(on ? at + 1 : at),
            found->pose);
        break;
      }
    }
  }
  return poses;
}

}  // namespace

Track FollowPattern(Clip& clip, const Background& background,
                    const Track& track, int threads) {
  if (!track.known_background || track.step > 1 || !IsSteady(track) ||
      track.poses.size() < kMinFollowed) {
    return track;
  }
  if (!(MedianMisfit(track.poses) > kCrude)) return track;
  clip.cancellation().Enter("the body's own picture is followed");
  const std::size_t step =
      (track.poses.size() + kPatternFrames - 1) / kPatternFrames;
  const Outline outline = MiddleOutline(track);
  std::optional<Learnt> best;
  std::vector<Pose> poses;
  for (const bool turns : {false, true}) {
    if (turns &&
        !(track.outlined ? track.body.kind == core::BodyKind::kRectangle
                         : HasTurned(track))) {
      continue;
    }
    if (!turns && !track.outlined && HasTurned(track)) continue;
    Pattern pattern(outline, turns, background);
    std::vector<PatternView> views;
    std::vector<PatternPose> starts;
    for (const std::size_t i : FromBothSides(track.poses.size(), step)) {
      const Pose& pose = track.poses[i];
      starts.push_back({pose, {}});
      views.push_back(ReadView(clip, pose.frame, pose.centre,
                               pattern.reach_px() + kSlack_px));
    }
    auto learnt =
        LearnPattern(std::move(views), std::move(starts), std::move(pattern),
                     clip.cancellation(), threads);
    if (!learnt) continue;
    std::vector<Pose> all = Follower(clip, track, *learnt, threads).All();
    if (!best || Telling(all) > Telling(poses)) {
      best = std::move(learnt);
      poses = std::move(all);
    }
  }
  // Share of the track's frames that the template must be found in. Not
  // studied.
  constexpr double kMinFoundShare = 0.9;
  if (!best || static_cast<double>(poses.size()) <
                   kMinFoundShare * static_cast<double>(track.poses.size())) {
    return track;
  }
  // Ratio of what template and outlines tell of the path. Outlines of a crude
  // body wander with what lies behind it, which neighbouring frames share and
  // their scatter does not show: the template is taken unless it tells clearly
  // less. A dozen frames tell the ratio to a half. Set with 16 copies of the
  // recorded hoops, of which 14 were right and none wrong.
  constexpr double kMinTellingRatio = 0.5;
  if (!(Telling(poses) > kMinTellingRatio * Telling(track.poses))) return track;
  Track patterned = track;
  patterned.poses = std::move(poses);
  patterned.patterned = true;
  Track put = AlignToOutlines(track, patterned);
  if (!best->settled) {
    put.warnings.push_back(fmt::format(
        "the body's own picture had not come to rest after {} rounds of "
        "learning it; its places may wander",
        kLearningRounds));
  }
  return put;
}

Track AlignToOutlines(const Track& outlines, const Track& patterned) {
  Track put = outlines;
  put.patterned = true;
  put.poses = patterned.poses;
  std::vector<double> x, y, turn, u_x, u_y;
  for (const Pose& pose : patterned.poses) {
    const auto same =
        std::find_if(outlines.poses.begin(), outlines.poses.end(),
                     [&](const Pose& p) { return p.frame == pose.frame; });
    if (same == outlines.poses.end()) continue;
    x.push_back(same->centre.x_px - pose.centre.x_px);
    y.push_back(same->centre.y_px - pose.centre.y_px);
    turn.push_back(same->angle_rad - pose.angle_rad);
    u_x.push_back(same->u_x_px);
    u_y.push_back(same->u_y_px);
  }
  if (x.empty()) return outlines;
  // A template has no centre of its own: the outlines' mean tells where the
  // body's centre lies in it.
  const core::Estimate dx = RobustMean(x, u_x);
  const core::Estimate dy = RobustMean(y, u_y);
  const double dt = Median(std::move(turn));
  for (Pose& pose : put.poses) {
    pose.centre.x_px += dx.value;
    pose.centre.y_px += dy.value;
    pose.angle_rad += dt;
  }
  return put;
}

}  // namespace touchdown::vision
