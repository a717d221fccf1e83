#include "tests/accuracy/design.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <random>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::accuracy {
namespace {

using core::BodyKind;
using vision::synthetic::Throw;

constexpr double kPxPerM = 1000.0;
constexpr double kRestitution = 0.6;
constexpr int kLeadIn = 24;  // empty frames before the body
// Frames after contact, at least: of a regular film, and of one with few
// frames.
constexpr int kLeastAfter = 6;
constexpr int kLeastShortStay = 2;

// The film's body is off the ground `frames` after contact, not about to come
// down, and has not been in it on the way: a block that turns fast may dip its
// other corner between two frames.
bool IsClear(const Throw& thrown, double frames, double fps) {
  const auto gap_px = [&](double at) {
    const vision::ScenePose pose = thrown.At(thrown.contact_s + at / fps);
    return kPxPerM * (pose.centre.y_m - thrown.Support(pose.angle_rad));
  };
  constexpr double kStep = 0.05;  // frames
  constexpr double kSunk_px = 0.02;
  for (double at = kStep; at < frames; at += kStep) {
    if (gap_px(at) < -kSunk_px) return false;
  }
  constexpr double kMargin_px = 0.5;
  const double gap = gap_px(frames);
  return gap > kMargin_px || gap > gap_px(frames - 1.0);
}

class Drawer {
 public:
  explicit Drawer(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<>()(engine_);
  }
  double Normal() { return std::normal_distribution<>()(engine_); }
  template <typename T>
  T Level(std::initializer_list<T> levels) {
    const auto i = std::min<std::size_t>(
        levels.size() - 1, static_cast<std::size_t>(Uniform(
                               0.0, static_cast<double>(levels.size()))));
    return levels.begin()[i];
  }

 private:
  std::mt19937_64 engine_;
};

void DrawLevels(Levels& l, Drawer& draw) {
  l.kind = draw.Level({BodyKind::kSphere, BodyKind::kRectangle});
  l.size_px = draw.Level({16.0, 24.0, 40.0});
  l.contrast = draw.Level({-0.2, -0.5, 0.2});
  l.noise = draw.Level({0.004, 0.012});
  l.blur_px = draw.Level({0.5, 0.8, 1.4});
  l.speed_px = draw.Level({0.8, 2.0, 5.0});
  l.angle_deg = draw.Level({8.0, 20.0, 40.0, 60.0});
  l.open = draw.Level({0.1, 0.4});
  l.frames_before = draw.Level({12, 25});
  l.bit_depth = draw.Level({8, 12});
  switch (l.hardship) {
    case Hardship::kNone:
    case Hardship::kTexture:
      break;
    case Hardship::kSmall:
      l.size_px = 8.0;
      l.contrast = -0.5;
      break;
    case Hardship::kDim:
      l.noise = std::abs(l.contrast) / 4.0;
      l.size_px = draw.Level({24.0, 40.0});
      break;
    case Hardship::kFewFrames:
      l.frames_before = draw.Level({3, 4, 5});
      l.frames_after = l.frames_before;
      break;
    case Hardship::kFast:
      l.size_px = 16.0;
      l.speed_px = l.size_px * draw.Level({0.5, 1.0, 2.0});
      l.frames_before = l.frames_after = 8;
      break;
    case Hardship::kLongExposure:
      l.open = 0.9;
      break;
    case Hardship::kSlow:
      l.speed_px = draw.Level({0.2, 0.4});
      break;
    case Hardship::kShaded:
    case Hardship::kShadow:
    case Hardship::kFlicker:
    case Hardship::kWavy:
    case Hardship::kSpecks:
    case Hardship::kObstacle:
    case Hardship::kPictured:
      break;  // DrawTrouble
  }
}

double NormalSpeed_px(const Levels& l) {
  return l.speed_px * std::sin(l.angle_deg * core::kDegree);
}

// Gravity in px per frame^2, from which the frame rate follows: a flight that
// curves visibly, and whose body was not at its apex when it entered.
double Gravity_px(const Levels& l) {
  return std::min(
      0.02, 0.4 * NormalSpeed_px(l) / static_cast<double>(l.frames_before));
}

void DrawTrouble(Case& c, Drawer& draw) {
  const Levels& l = c.levels;
  vision::SceneTrouble& trouble = c.film.trouble;
  switch (l.hardship) {
    case Hardship::kShaded: {
      // Within the contrast: an end that is as bright as what lies behind it
      // cannot be seen by anybody.
      const double contrast = std::abs(l.contrast);
      const double relative = std::min(contrast / c.film.look.body_level, 1.5);
      trouble.shading_x = draw.Uniform(-0.3, 0.3) * relative;
      trouble.shading_y = draw.Uniform(-0.5, 0.0) * relative;
      trouble.highlight_level = draw.Uniform(0.3, 1.0) * contrast;
      break;
    }
    case Hardship::kShadow:
      trouble.shadow_depth = draw.Uniform(0.3, 0.8);
      break;
    case Hardship::kFlicker:
      trouble.flicker_amplitude = 0.10;
      // A period of 10 to 40 frames.
      trouble.flicker_hz = c.film.camera.fps / draw.Uniform(10.0, 40.0);
      break;
    case Hardship::kWavy:
      trouble.wave_amplitude_px = 1.0;
      trouble.wave_length_px = draw.Uniform(20.0, 80.0);
      break;
    case Hardship::kSpecks:
      trouble.specks = 5;
      trouble.speck_diameter_px = draw.Uniform(0.08, 0.2) * l.size_px;
      trouble.speck_speed_px = l.speed_px;
      trouble.speck_seed = c.seed;
      break;
    case Hardship::kObstacle: {
      // From the picture's border to where the body is clear of it, after that
      // share of its way.
      const vision::SceneCamera& camera = c.film.camera;
      const double clear =
          0.5 * l.size_px + (1.0 - l.hidden) * l.frames_before * l.speed_px *
                                std::cos(l.angle_deg * core::kDegree);
      const double x =
          camera.ground_point.x_px + (camera.travels_left ? clear : -clear);
      core::PixelRect& obstacle = trouble.obstacle.emplace();
      const auto edge = static_cast<std::int32_t>(std::lround(x));
      obstacle.x = camera.travels_left ? edge : -100;
      obstacle.width =
          camera.travels_left ? camera.width_px + 100 - edge : edge + 100;
      obstacle.height = camera.height_px;
      trouble.obstacle_level = 0.5 * c.film.look.background_level;
      break;
    }
    case Hardship::kPictured: {
      vision::SceneFace& face = c.film.look.face.emplace();
      face.amplitude = draw.Uniform(0.2, 0.6) * std::abs(l.contrast);
      face.correlation_px = draw.Uniform(2.5, 5.0);
      face.seed = c.seed;
      const auto told = [&](double half_m) {
        const double u_m = kSizeRelativeU * half_m;
        return core::Estimate{half_m + u_m * draw.Normal(), u_m, std::nullopt};
      };
      c.told_half_long_m = told(c.film.thrown.half_long_m);
      c.told_half_short_m = told(c.film.thrown.half_short_m);
      if (l.kind == BodyKind::kSphere) {
        // Up to half of rolling either way before, up to rolling after.
        Throw& t = c.film.thrown;
        t.before.omega = draw.Uniform(-0.5, 0.5) * t.before.vx / t.half_long_m;
        t.after.omega = -draw.Uniform(0.0, 1.0) * t.after.vx / t.half_long_m;
      }
      break;
    }
    default:
      break;
  }
}

// The whole case but its seed, from levels that are drawn here.
void DrawFilm(Case& c, Drawer& draw) {
  Levels& l = c.levels;
  const Hardship hardship = l.hardship;

  const double angle = l.angle_deg * core::kDegree;
  const double vn = NormalSpeed_px(l);
  const double fps =
      std::sqrt(core::kStandardGravity_mps2 * kPxPerM / Gravity_px(l));

  pipeline::filmed::Film& film = c.film;
  Throw& t = film.thrown;
  t.kind = l.kind;
  t.gravity_mps2 =
      core::kStandardGravity_mps2 * (1.0 + kGravityRelativeU * draw.Normal());
  c.told_px_per_m = kPxPerM * (1.0 + kScaleRelativeU * draw.Normal());
  t.before = {l.speed_px * std::cos(angle) * fps / kPxPerM, -vn * fps / kPxPerM,
              0.0};
  t.half_long_m = t.half_short_m = 0.5 * l.size_px / kPxPerM;
  if (l.kind == BodyKind::kRectangle) {
    t.half_short_m = t.half_long_m * draw.Level({0.4, 0.7});
    t.face_rad = draw.Uniform(8.0, 30.0) * core::kDegree;
    Rebound(t, kRestitution);
  } else {
    const double up_mps = c.rise_m ? std::sqrt(2.0 * t.gravity_mps2 * *c.rise_m)
                                   : -kRestitution * t.before.vy;
    t.after = {0.85 * t.before.vx, up_mps, 0.0};
    t.stays = up_mps == 0.0;
  }
  film.contact_frame = kLeadIn + l.frames_before + draw.Uniform(-0.5, 0.5);
  t.contact_s = film.contact_frame / fps;
  film.lead_in = kLeadIn;
  // The clip ends before a block's other corner comes down.
  int after = c.rise_m ? l.frames_after : 0;
  while (after < l.frames_after && IsClear(t, after + 1.5, fps)) ++after;
  l.frames_after = after;
  film.frames = kLeadIn + l.frames_before + 1 + after;
  film.noise = l.noise;

  vision::SceneCamera& camera = film.camera;
  camera.px_per_m = kPxPerM;
  camera.fps = fps;
  camera.exposure_s = l.open / fps;
  camera.psf_sigma_px = l.blur_px;
  camera.bit_depth = l.bit_depth;
  camera.roll_rad = draw.Uniform(-2.0, 2.0) * core::kDegree;
  camera.travels_left = draw.Uniform(0.0, 1.0) < 0.5;
  const double room = l.size_px + 12.0;  // beyond the body's centre
  const double back = l.speed_px * (l.frames_before + 1.0);
  const double on = l.speed_px * (after + 1.0);
  const double width =
      std::max(160.0, (back + on) * std::cos(angle) + 2.0 * room);
  const double above = std::max(1.1 * back * std::sin(angle), 10.0) + room +
                       0.5 * l.size_px + 0.02 * width;
  constexpr double kBelow = 28.0;  // of the ground, px
  camera.width_px = static_cast<std::int32_t>(std::ceil(width / 2.0)) * 2;
  camera.height_px =
      static_cast<std::int32_t>(std::ceil((above + kBelow) / 2.0)) * 2;
  const double share = (back * std::cos(angle) + room) /
                       ((back + on) * std::cos(angle) + 2.0 * room);
  const double x = camera.travels_left ? 1.0 - share : share;
  camera.ground_point = {camera.width_px * x + draw.Uniform(-0.5, 0.5),
                         above + draw.Uniform(-0.5, 0.5)};

  vision::SceneLook& look = film.look;
  look.background_level = l.contrast < 0.0 ? 0.7 : 0.3;
  look.body_level = look.background_level + l.contrast;
  look.ground_level = l.contrast < 0.0 ? 0.4 : 0.15;
  look.gradient_x = 0.06;
  look.texture_seed = c.seed;
  look.texture_amplitude = hardship == Hardship::kTexture ? 0.10 : 0.0;
  DrawTrouble(c, draw);
}

}  // namespace

const char* Name(Hardship hardship) {
  switch (hardship) {
    case Hardship::kNone:
      return "regular";
    case Hardship::kSmall:
      return "small";
    case Hardship::kDim:
      return "dim";
    case Hardship::kFewFrames:
      return "few frames";
    case Hardship::kFast:
      return "fast";
    case Hardship::kLongExposure:
      return "long exposure";
    case Hardship::kTexture:
      return "texture";
    case Hardship::kSlow:
      return "slow";
    case Hardship::kShaded:
      return "shaded";
    case Hardship::kShadow:
      return "shadow";
    case Hardship::kFlicker:
      return "flicker";
    case Hardship::kWavy:
      return "wavy ground";
    case Hardship::kSpecks:
      return "specks";
    case Hardship::kObstacle:
      return "obstacle";
    case Hardship::kPictured:
      return "pictured face";
  }
  return "?";
}

Case Draw(std::uint64_t index, Hardship hardship) {
  Case c;
  c.seed = 1000 * (index + 1) + static_cast<std::uint64_t>(hardship);
  Drawer draw(c.seed);
  // A block that comes down on its other corner at once is drawn again.
  const bool short_stay =
      hardship == Hardship::kFewFrames || hardship == Hardship::kFast;
  const int least_after = short_stay ? kLeastShortStay : kLeastAfter;
  do {
    c.levels = {};
    c.levels.hardship = hardship;
    DrawLevels(c.levels, draw);
    DrawFilm(c, draw);
  } while (c.levels.frames_after < least_after);
  return c;
}

Case DrawAt(std::uint64_t index, const Levels& levels) {
  Case c;
  constexpr std::uint64_t kOwnSeeds = 998;
  c.seed = 1000 * (index + 1) + kOwnSeeds;
  Drawer draw(c.seed);
  const int least_after = std::min(kLeastShortStay, levels.frames_after);
  constexpr int kAttempts = 1000;
  for (int i = 0; i < kAttempts; ++i) {
    c.levels = levels;
    DrawFilm(c, draw);
    if (c.levels.frames_after >= least_after) return c;
  }
  throw std::invalid_argument(
      "levels: a block of this size comes down on its other corner at once");
}

Case DrawRebound(std::uint64_t index) {
  Case c;
  c.seed = 1000 * (index + 1) + 999;
  Drawer draw(c.seed);
  const double size_px = draw.Level({16.0, 24.0, 40.0});
  const double bounce_height_m = core::DefaultBounceHeight(size_px / kPxPerM);
  const bool stays = draw.Uniform(0.0, 1.0) < 0.25;
  c.rise_m =
      stays ? 0.0 : bounce_height_m * std::pow(10.0, draw.Uniform(-1.3, 1.0));
  Levels levels;
  levels.size_px = size_px;
  levels.contrast = draw.Level({-0.2, -0.5, 0.2});
  levels.noise = draw.Level({0.004, 0.012});
  levels.blur_px = draw.Level({0.5, 0.8, 1.4});
  levels.speed_px = draw.Level({2.0, 3.0});
  levels.angle_deg = draw.Level({20.0, 40.0, 60.0});
  levels.bit_depth = draw.Level({8, 12});
  // Until it is well past its apex, or for long enough to see that it stays.
  const double rise_px = *c.rise_m * kPxPerM;
  levels.frames_after =
      8 + static_cast<int>(
              std::ceil(1.4 * std::sqrt(2.0 * rise_px / Gravity_px(levels))));
  c.levels = levels;
  DrawFilm(c, draw);
  return c;
}

}  // namespace touchdown::accuracy
