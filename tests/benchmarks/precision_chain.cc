#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "tests/accuracy/score.h"
#include "tests/benchmarks/kept_clip.h"
#include "tests/benchmarks/precision.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/synthetic/render.h"
#include "touchdown/vision/tracking/tracker.h"
#ifdef TOUCHDOWN_HAS_PEERS
#include "tests/benchmarks/peers.h"
#endif

namespace touchdown::accuracy {
namespace {

// An approach angle in rad, or none.
using Method = std::function<std::optional<double>(const Case&, KeptClip&)>;

struct Configuration {
  std::string method;
  std::string knob;
  Method measure;
};

std::optional<double> ApproachOf(const core::ContactRecord& record) {
  const core::Measured& angle = record.contact.approach_angle_rad;
  if (!angle) return std::nullopt;
  return angle->value;
}

// The true ground line. The peers are told it as exact; here a hundredth of a
// pixel stands for that, of which nothing comes through.
calib::GroundLine TrueGround(const Case& c) {
  constexpr double kExact_px = 0.01;
  calib::GroundLine ground = vision::TrueGroundLine(c.film.camera);
  ground.u_offset_px = kExact_px;
  ground.u_angle_rad = kExact_px / c.film.camera.width_px;
  return ground;
}

Method Analyze(std::int64_t step, bool told_ground, bool told_kind = true) {
  return [=](const Case& c, KeptClip& clip) {
    pipeline::AnalyzeOptions options = Told(c);
    if (told_ground) options.ground = TrueGround(c);
    if (!told_kind) options.body_kind = std::nullopt;
    return ApproachOf(
        pipeline::AnalyzeClip(clip.Every(step), options).contacts.first);
  };
}

// The tracker's outlines as they are, without the second fit that shares among
// all frames what they have in common.
Method FirstFits(std::int64_t step) {
  return [=](const Case& c, KeptClip& kept) -> std::optional<double> {
    const auto clip = kept.Every(step);
    const calib::GroundLine ground = TrueGround(c);
    vision::TrackOptions options;
    options.kind = c.film.thrown.kind;
    options.ground = ground;
    const auto tracked = vision::TrackBody(*clip, options);
    if (!tracked) return std::nullopt;
    vision::ContactOptions contact;
    contact.scale =
        calib::Scale{*Told(c).scale_px_per_m, calib::ScaleSource::kUser};
    return ApproachOf(
        vision::FindContacts(vision::SeenFromGround(tracked->track, ground),
                             contact)
            .first);
  };
}

// Every sample looked at once: what no method that looks at all can undercut.
std::optional<double> ReadOnly(const Case& /*c*/, KeptClip& clip) {
  std::uint64_t sum = 0;
  for (std::int64_t i = 0; i < clip.info().frames; ++i) {
    const core::Frame frame = clip.Read(i);
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      const auto add = [&](const auto* row) {
        for (std::int32_t x = 0; x < frame.width_px; ++x) sum += row[x];
      };
      if (frame.is_16_bit()) {
        add(frame.row<std::uint16_t>(y));
      } else {
        add(frame.row<std::uint8_t>(y));
      }
    }
  }
  // Used, so that the reading is not left out.
  return sum > 0 ? std::nullopt : std::optional(0.0);
}

std::vector<Configuration> Configurations() {
  std::vector<Configuration> all = {
      {"reading alone", "every sample once", ReadOnly}};
  for (const std::int64_t step : {1, 2, 3, 4}) {
    const std::string knob =
        step == 1 ? "default" : fmt::format("every frame in {}", step);
    all.push_back({"touchdown", knob, Analyze(step, false)});
  }
  all.push_back({"touchdown, kind not told", "default",
                 Analyze(1, false, /*told_kind=*/false)});
  for (const std::int64_t step : {1, 2, 3, 4}) {
    const std::string knob =
        step == 1 ? "default" : fmt::format("every frame in {}", step);
    all.push_back({"touchdown, ground told", knob, Analyze(step, true)});
  }
  for (const std::int64_t step : {1, 2, 3, 4}) {
    const std::string knob =
        step == 1 ? "all frames" : fmt::format("every frame in {}", step);
    all.push_back(
        {"touchdown, ground told, first fits", knob, FirstFits(step)});
  }
#ifdef TOUCHDOWN_HAS_PEERS
  for (const Peer peer : Peers()) {
    all.push_back(
        {Name(peer), "",
         [peer](const Case& c, KeptClip& clip) -> std::optional<double> {
           const auto reading = Measure(clip, c, peer);
           if (!reading) return std::nullopt;
           return reading->approach_rad;
         }});
  }
#endif
  return all;
}

}  // namespace

void MeasureChain(std::uint64_t clips) {
  const std::vector<Configuration> configurations = Configurations();
  std::vector<WorkPoint> points;
  for (const Configuration& one : configurations) {
    WorkPoint& point = points.emplace_back();
    point.stage = "chain";
    point.method = one.method;
    point.knob = one.knob;
    point.unit = "deg";
    point.per_item = 0.0;
  }
  double bound2 = 0.0;
  double frames = 0.0;
  for (std::uint64_t i = 0; i < clips; ++i) {
    const Case c = Draw(i, Hardship::kNone);
    const auto scene =
        vision::OpenScene(pipeline::filmed::BuildScene(c.film), c.seed);
    KeptClip clip(*scene);
    frames += static_cast<double>(clip.info().frames);
    const double bound_deg = BoundOf(c).approach_rad / core::kDegree;
    bound2 += bound_deg * bound_deg;
    for (std::size_t m = 0; m < configurations.size(); ++m) {
      std::optional<double> angle;
      points[m].seconds.push_back(
          Timed([&] { angle = configurations[m].measure(c, clip); }));
      if (angle) {
        points[m].errors.push_back((*angle - c.film.thrown.ContactAngle()) /
                                   core::kDegree);
      } else {
        ++points[m].failures;
      }
    }
  }
  const auto n = static_cast<double>(clips);
  for (WorkPoint& point : points) {
    point.bound = std::sqrt(bound2 / n);
    point.per_item = frames / n;
    // It measures nothing, and so cannot fail to.
    if (point.method == "reading alone") point.failures = 0;
    PrintPoint(point);
  }
}

}  // namespace touchdown::accuracy
