#include "tests/accuracy/monte_carlo.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "app/measure/clip_calibration.h"
#include "app/measure/judge.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/core/units.h"

namespace touchdown::accuracy {
namespace {

using vision::synthetic::Filming;
using vision::synthetic::Throw;
using Normal = std::normal_distribution<double>;

double Move(const core::Estimate& e, std::mt19937_64& engine) {
  return e.value + e.u * Normal(0.0, 1.0)(engine);
}

void MoveTrack(vision::Track& track, std::mt19937_64& engine) {
  Normal normal(0.0, 1.0);
  for (vision::Pose& pose : track.poses) {
    const double a = normal(engine);
    const double b = normal(engine);
    const double r = pose.correlation_xy;
    pose.centre.x_px += pose.u_x_px * a;
    pose.centre.y_px += pose.u_y_px * (r * a + std::sqrt(1.0 - r * r) * b);
    pose.angle_rad += pose.u_angle_rad * normal(engine);
  }
  vision::BodyImage& body = track.body;
  body.radius_px.value = Move(body.radius_px, engine);
  body.half_long_px.value = Move(body.half_long_px, engine);
  body.half_short_px.value = Move(body.half_short_px, engine);
}

// Height and direction, which are independent at the reference point. A line
// through a lens is two points of the image, on which the reference need not
// lie.
void MoveGround(calib::GroundLine& line, std::mt19937_64& engine) {
  Normal normal(0.0, 1.0);
  const double off = line.u_offset_px * normal(engine);
  const double turn = line.u_angle_rad * normal(engine);
  const double angle = calib::ImageAngle(line);
  const auto moved = [&](core::PixelPoint p) {
    const double along = (p.x_px - line.reference.x_px) * std::cos(angle) +
                         (p.y_px - line.reference.y_px) * std::sin(angle);
    const double down = turn * along - off;
    return core::PixelPoint{p.x_px - down * std::sin(angle),
                            p.y_px + down * std::cos(angle)};
  };
  const core::PixelPoint reference = moved(line.reference);
  line.p1 = moved(line.p1);
  line.p2 = moved(line.p2);
  line.reference = reference;
}

calib::Lens MovedLens(const calib::LensRecord& record,
                      std::mt19937_64& engine) {
  const Eigen::SelfAdjointEigenSolver<calib::LensCovariance> solver(
      record.covariance);
  calib::LensVector lens = calib::ToVector(record.lens);
  Normal normal(0.0, 1.0);
  for (int k = 0; k < calib::kLensParameters; ++k) {
    lens += normal(engine) * std::sqrt(std::max(0.0, solver.eigenvalues()[k])) *
            solver.eigenvectors().col(k);
  }
  return calib::ToLens(lens);
}

vision::ContactResult Draw(const BudgetTrial& trial, std::mt19937_64& engine) {
  pipeline::AnalyzeOptions options = trial.analysis.options;
  vision::Track track = *trial.analysis.track;
  MoveTrack(track, engine);
  MoveGround(*options.ground, engine);
  if (options.calibration) {
    calib::Calibration& calibration = *options.calibration;
    if (calibration.lens) {
      calibration.lens->lens = MovedLens(*calibration.lens, engine);
    }
    if (calibration.ground && calibration.ground->yaw_rad) {
      core::Estimate& yaw = *calibration.ground->yaw_rad;
      yaw.value = Move(yaw, engine);
    }
  }
  pipeline::ClipCalibration camera =
      pipeline::FitToClip(options, trial.analysis.clip);
  calib::Scale scale = *trial.analysis.scale;
  scale.px_per_m.value = Move(scale.px_per_m, engine);
  vision::ContactOptions contacts =
      pipeline::MakeContactOptions(options, camera, scale);
  contacts.gravity_mps2.value = Move(contacts.gravity_mps2, engine);
  return pipeline::FindPlaneContacts(
      pipeline::SeenInPlane(camera, pipeline::ToIdealPicture(camera, track),
                            *camera.ideal_ground),
      contacts);
}

struct Named {
  const char* name;
  const core::Measured& (*of)(const core::ContactRecord&);
};

using Record = core::ContactRecord;
constexpr std::array<Named, 6> kQuantitiesDrawn = {
    {{"approach angle, rad",
      [](const Record& r) -> const core::Measured& {
        return r.contact.approach_angle_rad;
      }},
     {"face angle, rad",
      [](const Record& r) -> const core::Measured& {
        return r.contact.face_angle_rad;
      }},
     {"contact, frames",
      [](const Record& r) -> const core::Measured& { return r.contact.frame; }},
     {"speed along, m/s",
      [](const Record& r) -> const core::Measured& {
        return r.motion.before_tangential_mps;
      }},
     {"speed normal, m/s",
      [](const Record& r) -> const core::Measured& {
        return r.motion.before_normal_mps;
      }},
     {"restitution", [](const Record& r) -> const core::Measured& {
        return r.motion.restitution;
      }}}};

struct Batch {
  double mean = 0.0;
  double u = 0.0;
  double low = 0.0;
  double high = 0.0;
};

Batch Summary(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  Batch b;
  for (const double v : values) b.mean += v / n;
  for (const double v : values) b.u += (v - b.mean) * (v - b.mean);
  b.u = std::sqrt(b.u / (n - 1.0));
  const auto at = [&](double p) {  // JCGM 101, 7.7
    return values[static_cast<std::size_t>(p * (n - 1.0) + 0.5)];
  };
  b.low = at(0.025);
  b.high = at(0.975);
  return b;
}

// Mean over the batches, and the standard deviation of that mean.
std::pair<double, double> Over(const std::vector<Batch>& batches,
                               double Batch::*value) {
  const auto n = static_cast<double>(batches.size());
  double mean = 0.0;
  double square = 0.0;
  for (const Batch& b : batches) mean += b.*value / n;
  for (const Batch& b : batches) square += std::pow(b.*value - mean, 2);
  return {mean, std::sqrt(square / (n * std::max(1.0, n - 1.0)))};
}

}  // namespace

double Spread::Tolerance(int digits) const {
  if (!(u > 0.0)) return 0.0;
  const double exponent = std::floor(std::log10(u)) - (digits - 1);
  return 0.5 * std::pow(10.0, exponent);
}

double Spread::FarthestEnd() const {
  const core::Interval stated = core::Interval95(first_order);
  return std::max(std::abs(stated.low - interval95.low),
                  std::abs(stated.high - interval95.high));
}

core::ContactRecord FirstOrder(const BudgetTrial& trial) {
  return pipeline::Rejudge(trial.analysis, {}).contacts.first;
}

std::vector<Spread> DrawnSpreads(const BudgetTrial& trial,
                                 const DrawOptions& options,
                                 std::mt19937_64& engine) {
  const core::ContactRecord stated = FirstOrder(trial);
  std::array<std::vector<Batch>, kQuantitiesDrawn.size()> batches;
  std::vector<Spread> spreads(kQuantitiesDrawn.size());
  bool stable = false;
  for (std::size_t h = 0; h < options.most && !stable; ++h) {
    std::array<std::vector<double>, kQuantitiesDrawn.size()> values;
    for (std::size_t i = 0; i < options.batch; ++i) {
      const core::ContactRecord record = Draw(trial, engine).first;
      for (std::size_t q = 0; q < values.size(); ++q) {
        const core::Measured& m = kQuantitiesDrawn[q].of(record);
        if (m) {
          values[q].push_back(m->value);
        } else {
          ++spreads[q].absent;
        }
      }
    }
    stable = h + 1 >= options.least;
    for (std::size_t q = 0; q < values.size(); ++q) {
      const core::Measured& m = kQuantitiesDrawn[q].of(stated);
      if (!m || values[q].size() < options.batch / 2) continue;
      spreads[q].draws += values[q].size();
      batches[q].push_back(Summary(std::move(values[q])));
      Spread& s = spreads[q];
      const auto& b = batches[q];
      s.mean = Over(b, &Batch::mean).first;
      std::tie(s.u, s.u_tolerance) = Over(b, &Batch::u);
      const auto [low, u_low] = Over(b, &Batch::low);
      const auto [high, u_high] = Over(b, &Batch::high);
      s.interval95 = {low, high};
      s.end_tolerance = std::max(u_low, u_high);
      constexpr double kTwice = 2.0;
      constexpr double kShare = 0.2;
      if (kTwice * std::max(s.u_tolerance, s.end_tolerance) >
          kShare * s.Tolerance(options.digits)) {
        stable = false;
      }
    }
  }
  std::vector<Spread> out;
  for (std::size_t q = 0; q < spreads.size(); ++q) {
    const core::Measured& m = kQuantitiesDrawn[q].of(stated);
    if (!m) continue;
    spreads[q].quantity = kQuantitiesDrawn[q].name;
    spreads[q].first_order = *m;
    out.push_back(spreads[q]);
  }
  return out;
}

// --- the trials --------------------------------------------------------------

namespace {

BudgetTrial Of(std::string name, const Throw& thrown, Filming filming,
               double u_scale) {
  filming.noise = false;
  BudgetTrial trial;
  trial.name = std::move(name);
  pipeline::Analysis& a = trial.analysis;
  a.track = vision::synthetic::FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filming);
  const double px_per_m = filming.camera.px_per_m;
  a.clip.width_px = filming.camera.width_px;
  a.clip.height_px = filming.camera.height_px;
  a.clip.frames = filming.frames;
  a.clip.time_base.fps = filming.camera.fps;
  a.clip.time_base.trusted = true;
  a.options.scale_px_per_m =
      core::Estimate{px_per_m, u_scale * px_per_m, std::nullopt};
  a.scale = calib::Scale{*a.options.scale_px_per_m, calib::ScaleSource::kUser};
  a.options.ground = vision::synthetic::FilmGround(filming);
  a.ground = *a.options.ground;
  return trial;
}

// The same trial, its plane turned and seen through a lens.
void TurnAndBend(BudgetTrial& trial, double yaw_rad, double u_yaw_rad) {
  pipeline::Analysis& a = trial.analysis;
  calib::Calibration calibration;
  calibration.camera = "drawn";
  calibration.date = "2026-01-31";
  calibration.expires = "2027-01-31";
  calibration.picture = {a.clip.width_px, a.clip.height_px,
                         calib::SensorCorner{0, 0}};
  calib::LensRecord lens;
  lens.lens = {900.0, 900.0, 319.5, 120.0, -0.12, 0.02, 5e-4, -3e-4, 0.0};
  calib::LensVector u;
  u << 2.0, 2.0, 1.5, 1.5, 4e-3, 4e-3, 1e-4, 1e-4, 0.0;
  lens.covariance = u.cwiseAbs2().asDiagonal();
  calib::GroundRecord ground;
  ground.p1 = a.options.ground->p1;
  ground.p2 = a.options.ground->p2;
  ground.yaw_rad = core::Estimate{yaw_rad, u_yaw_rad, std::nullopt};
  calibration.ground = ground;
  calibration.lens = lens;
  // What was a straight look becomes the plane's own coordinates.
  const calib::GroundLine& line = *a.options.ground;
  const vision::YawedView view =
      vision::MakeYawedView(line, pipeline::MakePlaneYaw(yaw_rad, lens.lens));
  const vision::PlaneTrack plane = vision::SeenFromGround(*a.track, line);
  for (std::size_t i = 0; i < a.track->poses.size(); ++i) {
    vision::Pose& pose = a.track->poses[i];
    const vision::PlaneSample& s = plane.samples[i];
    const auto seen = [&](double ahead_px) {
      const double c = ahead_px * std::cos(s.face_rad);
      const double n = ahead_px * std::sin(s.face_rad);
      return calib::Distort(
          lens.lens, vision::FromPlane(view, plane.direction * (s.along_px + c),
                                       s.height_px + n));
    };
    pose.centre = seen(0.0);
    const core::PixelPoint tip = seen(1e-3);
    if (a.track->body.kind == core::BodyKind::kRectangle) {
      pose.angle_rad =
          std::atan2(tip.y_px - pose.centre.y_px, tip.x_px - pose.centre.x_px);
    }
  }
  a.options.ground->p1 = calib::Distort(lens.lens, line.p1);
  a.options.ground->p2 = calib::Distort(lens.lens, line.p2);
  a.options.ground->reference = calib::Distort(lens.lens, line.reference);
  a.options.calibration = calibration;
}

}  // namespace

std::vector<BudgetTrial> BudgetTrials() {
  std::vector<BudgetTrial> trials;
  Filming filming;
  filming.frames = 40;
  filming.first_time_s = 0.005;
  const Throw sphere;
  trials.push_back(Of("sphere", sphere, filming, 1e-3));
  Throw block = vision::synthetic::Block(25.0 * core::kDegree);
  vision::synthetic::Rebound(block, 0.5);
  trials.push_back(Of("block", block, filming, 1e-3));
  trials.push_back(Of("sphere, yaw, lens", sphere, filming, 1e-3));
  TurnAndBend(trials.back(), 4.0 * core::kDegree, 0.5 * core::kDegree);
  Throw flat;
  flat.before = {6.0, -0.25, 0.0};
  flat.after = {5.5, 0.12, 0.0};
  Filming coarse = filming;
  coarse.u_ground_rad = 1.5 * core::kDegree;
  trials.push_back(Of("flat, 2.4 deg", flat, coarse, 1e-3));
  Filming few = filming;
  few.camera.fps = 1000.0;
  few.first_time_s = 0.0095;
  few.frames = 12;
  few.u_px = 0.1;
  trials.push_back(Of("few frames", sphere, few, 1e-3));
  Filming paper = filming;
  paper.u_px = 0.3;
  paper.u_ground_rad = 0.5 * core::kDegree;
  paper.u_ground_px = 0.5;
  trials.push_back(Of("coarse", sphere, paper, 1e-2));
  return trials;
}

}  // namespace touchdown::accuracy
