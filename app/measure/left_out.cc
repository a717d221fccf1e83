#include "app/measure/left_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// What of an approach angle's neighbourhood the effects need.
struct ApproachFacts {
  double angle_rad = 0.0;
  double u_rad = 0.0;
  core::Estimate speed_mps;
  double down_mps = 0.0;
  double px_per_m = 0.0;
  double lever = 0.0;  // r / f
  double flight_s = 0.0;
};

// Nothing where a number is missing that every effect needs: then no effect is
// stated at all, and not some of them.
std::optional<ApproachFacts> SeenAtContact(const Analysis& a) {
  const core::ContactRecord& first = a.contacts.first;
  const auto& angle = first.contact.approach_angle_rad;
  const auto& speed = first.motion.before_speed_mps;
  const auto& down = first.motion.before_normal_mps;
  if (!angle || !speed || !down || !a.scale || !a.track ||
      a.track->poses.empty() || first.contact.from_start ||
      !(speed->value > 0.0) || !first.contact.frame) {
    return std::nullopt;
  }
  ApproachFacts out{angle->value, angle->u, *speed, std::abs(down->value),
                    a.scale->px_per_m.value};
  const double frame = first.contact.frame->value;
  const auto& poses = a.track->poses;
  // The pose next to the contact tells where in the picture the body was.
  const auto at =
      std::min_element(poses.begin(), poses.end(),
                       [frame](const vision::Pose& p, const vision::Pose& q) {
                         return std::abs(static_cast<double>(p.frame) - frame) <
                                std::abs(static_cast<double>(q.frame) - frame);
                       });
  const double focal_px = a.calibration && a.calibration->lens
                              ? a.calibration->lens->lens.fx_px
                              : a.clip.width_px;
  out.lever = std::hypot(at->centre.x_px - 0.5 * a.clip.width_px,
                         at->centre.y_px - 0.5 * a.clip.height_px) /
              focal_px;
  // What flies is not what a hand still holds.
  const auto& evidence = a.contacts.evidence;
  const std::int64_t from = !evidence.empty() && evidence.front().before
                                ? evidence.front().before->first_frame
                                : poses.front().frame;
  out.flight_s = (frame - static_cast<double>(from)) / a.clip.time_base.fps;
  return out;
}

// "0.12 deg of the approach angle, 3 u".
std::string Size(double error_rad, double u_rad) {
  return fmt::format("{:.2g} deg of the approach angle, {:.2g} u",
                     error_rad / kDegree, u_rad > 0 ? error_rad / u_rad : 0.0);
}

// A correction judges again: nothing is said twice.
void Warn(const std::string& warning, Analysis& analysis) {
  std::vector<std::string>& warnings = analysis.warnings;
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) {
    warnings.push_back(warning);
  }
}

// A path that leaves the plane by psi: nearer to the camera it grows away from
// the picture's middle (lever), and its horizontal part looks shorter.
LeftOutEffect OutOfPlane(const ApproachFacts& s, const LeftOutSizes& sizes) {
  LeftOutEffect out{"path out of the plane"};
  const double psi = sizes.out_of_plane_rad;
  out.error_rad = s.lever * std::sin(psi) + (1.0 / std::cos(psi) - 1.0) *
                                                std::sin(s.angle_rad) *
                                                std::cos(s.angle_rad);
  out.text = fmt::format("{:g} deg of it would be up to {}", psi / kDegree,
                         Size(out.error_rad, s.u_rad));
  if (s.lever > 0.0 && s.u_rad < s.lever) {
    out.text += fmt::format("; below {:.2g} deg it stays within u",
                            std::asin(s.u_rad / s.lever) / kDegree);
  }
  return out;
}

// Rows that are read one after the other shift a falling body's picture by its
// own speed: relative to the picture's height.
LeftOutEffect Rolling(const Analysis& a, const ApproachFacts& s,
                      const LeftOutSizes& sizes) {
  LeftOutEffect out{"rolling shutter"};
  const double rows = s.down_mps * s.px_per_m / a.clip.time_base.fps;
  out.error_rad = rows / a.clip.height_px * sizes.readout *
                  std::sin(s.angle_rad) * std::cos(s.angle_rad);
  out.text = fmt::format(
      "a camera that reads its rows one after the other for a whole frame "
      "interval would be up to {}",
      Size(out.error_rad, s.u_rad));
  out.warns = out.error_rad > sizes.warn_rad;
  return out;
}

// On a ground that slopes by s, g sin(s) along it changes the speed by g sin(s)
// T over the flight; a straight line fitted to the path is off by half of that
// at its end.
LeftOutEffect Slope(const ApproachFacts& s, const LeftOutSizes& sizes) {
  LeftOutEffect out{"gravity along the ground"};
  out.error_rad = core::kStandardGravity_mps2 * std::sin(sizes.slope_rad) *
                  s.flight_s / (2.0 * s.speed_mps.value) *
                  std::sin(s.angle_rad);
  out.text = fmt::format(
      "no level: a ground that slopes by {:g} deg would be up to {}",
      sizes.slope_rad / kDegree, Size(out.error_rad, s.u_rad));
  return out;
}

// A common offset of all outlines moves the whole path, which no angle feels;
// the instant of contact and the gaps do.
LeftOutEffect Outline(const Analysis& a, const ApproachFacts& s,
                      const LeftOutSizes& sizes) {
  LeftOutEffect out{"light and gamma"};
  const double rows = s.down_mps * s.px_per_m / a.clip.time_base.fps;
  out.text = fmt::format(
      "outlines {:g} px too far out or in would move the contact by {:.2g} "
      "frame and gaps by nothing but the body's own size, {:.2g} mm; angles "
      "hardly",
      sizes.outline_px, rows > 0.0 ? sizes.outline_px / rows : 0.0,
      sizes.outline_px / s.px_per_m / core::kMillimetre);
  return out;
}

// How few bits the recording spends on a pixel; nothing where it is no file.
std::optional<LeftOutEffect> Compression(const Analysis& a) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(a.clip.path, none);
  if (none || !a.clip.is_predicted || a.clip.frames <= 0) return std::nullopt;
  LeftOutEffect out{"compression"};
  constexpr double kBits = 8.0;
  out.text = fmt::format(
      "{:.2g} bits a pixel; what it blurs is in the scatter of the poses, and "
      "the lag of predicted frames in u of the contact's time; ghosts of "
      "earlier frames are in neither",
      kBits * static_cast<double>(bytes) /
          (static_cast<double>(a.clip.frames) * a.clip.width_px *
           a.clip.height_px));
  return out;
}

// A straight line fitted to a path s on which drag takes the share k s of the
// speed is off by half of that at its end; so is a parabola of known gravity.
std::string DragOnALightBody(const Analysis& a, const ApproachFacts& s,
                             const LeftOutSizes& sizes) {
  // Of a sphere between Reynolds numbers of 1e3 and 2e5; of air at 20 degrees.
  constexpr double kDragCoefficient = 0.47;
  constexpr double kAir_kg_per_m3 = 1.2;
  const vision::BodyImage& body = a.track->body;
  const double size_px =
      2.0 * (body.kind == core::BodyKind::kSphere ? body.radius_px.value
                                                  : body.half_short_px.value);
  const double k = 0.75 * kDragCoefficient * kAir_kg_per_m3 * s.px_per_m /
                   (sizes.density_kg_per_m3 * size_px);
  const double error_mps =
      0.5 * k * s.speed_mps.value * s.flight_s * s.speed_mps.value;
  return fmt::format(
      "of a body as dense as water it would be {:.2g} % of the speed at "
      "touchdown, {:.2g} u",
      100.0 * error_mps / s.speed_mps.value,
      s.speed_mps.u > 0.0 ? error_mps / s.speed_mps.u : 0.0);
}

}  // namespace

double ProbabilityOfDrag(const vision::ContactResult& contacts) {
  constexpr double kAgainst = 1000.0;
  const auto& seen = contacts.drag_per_px;
  if (!seen || !(seen->value > 0.0)) return 0.0;
  const double z = seen->value / seen->u;
  return 1.0 / (1.0 + kAgainst * std::exp(-0.5 * z * z));
}

void DescribeDrag(Analysis& analysis, const LeftOutSizes& sizes) {
  const auto& seen = analysis.contacts.drag_per_px;
  std::string text = "too few frames of flight to tell it";
  if (seen) {
    const double per_m = analysis.scale ? analysis.scale->px_per_m.value : 1.0;
    text = fmt::format("{} of the speed lost on a {}",
                       report::InAscii(report::WithU(*seen, 1.0 / per_m)),
                       analysis.scale ? "metre" : "px");
    if (ProbabilityOfDrag(analysis.contacts) > 0.5) {
      Warn("the flights bend as air bends them, " + text +
               ": u contains what taking that out would change, by its "
               "probability; a camera that "
               "moves, perspective, and frames of uneven time bend them, too",
           analysis);
    }
    text = "the flights show " + text;
  }
  if (const auto facts = SeenAtContact(analysis)) {
    text += "; " + DragOnALightBody(analysis, *facts, sizes);
  }
  analysis.scene_model.left_out["drag"] = text;
}

std::vector<LeftOutEffect> LeftOutEffects(const Analysis& analysis,
                                          const LeftOutSizes& sizes) {
  const auto seen = SeenAtContact(analysis);
  if (!seen) return {};
  std::vector<LeftOutEffect> out{OutOfPlane(*seen, sizes)};
  // Both formats are of high-speed cameras, whose shutters are global; of other
  // files nobody knows.
  const bool raw =
      analysis.clip.format == "mraw" || analysis.clip.format == "cine";
  if (!raw) out.push_back(Rolling(analysis, *seen, sizes));
  const bool level = analysis.calibration && analysis.calibration->ground &&
                     analysis.calibration->ground->slope_rad;
  if (!level) out.push_back(Slope(*seen, sizes));
  if (!analysis.options.gamma && !analysis.track->body.gamma) {
    out.push_back(Outline(analysis, *seen, sizes));
  }
  if (auto compression = Compression(analysis)) {
    out.push_back(std::move(*compression));
  }
  return out;
}

void DescribeLeftOut(Analysis& analysis, const LeftOutSizes& sizes) {
  auto& left_out = analysis.scene_model.left_out;
  // Called again after a correction: nothing may be said twice.
  for (const LeftOutEffect& effect : LeftOutEffects(analysis, sizes)) {
    left_out[effect.name] = effect.text;
    // A camera's yaw does to a path in the plane what the path's own would.
    const auto yaw = left_out.find("yaw");
    if (effect.name == "path out of the plane" && yaw != left_out.end() &&
        yaw->second.find(effect.text) == std::string::npos) {
      yaw->second += "; " + effect.text;
    }
    if (!effect.warns) continue;
    Warn(effect.name + ": " + effect.text, analysis);
  }
}

}  // namespace touchdown::pipeline
