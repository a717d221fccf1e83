#include "app/session/check_shot.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "app/text/format.h"

namespace touchdown::session {
namespace {

// Returns the size of the body that is dropped. Throws std::invalid_argument
// where it has none: the campaign's name and bounce height need it.
core::Estimate RequireSize(const CheckShot& check) {
  const auto size = core::Size(check.body);
  if (!size) {
    throw std::invalid_argument(
        "the body of the check shot has no size, must have one");
  }
  return *size;
}

}  // namespace

using core::kDegree;
using core::kMillimetre;

core::Estimate ExpectedSpeed(const CheckShot& check) {
  const core::Estimate& h = check.height_m;
  const core::Estimate& g = check.gravity_mps2;
  for (const auto& [field, value] :
       {std::pair{"height_m", h.value}, std::pair{"gravity_mps2", g.value}}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(
          fmt::format("{} is {:g}, must be positive and finite", field, value));
    }
  }
  // From v = sqrt(2 g h) follows that u(v)/v is half of the relative u of g and
  // h together.
  const double speed = std::sqrt(2.0 * g.value * h.value);
  return {speed, speed / 2.0 * std::hypot(h.u / h.value, g.u / g.value),
          std::nullopt};
}

std::string DroppedBody(const CheckShot& check) {
  return fmt::format("{} {} mm", core::Name(check.body.kind),
                     report::Plain(RequireSize(check).value / kMillimetre));
}

core::Campaign CheckCampaign(const CheckShot& check) {
  core::Campaign campaign;
  campaign.name =
      fmt::format("check: {} from {} mm", DroppedBody(check),
                  report::Plain(check.height_m.value / kMillimetre));
  campaign.body = check.body;
  campaign.surface = core::kCheckShotSurface;
  campaign.angle_kind = core::AngleKind::kApproach;
  // No speed band and no theory: a check shot gets no verdict.
  campaign.bounce_height_m =
      core::DefaultBounceHeight(RequireSize(check).value);
  return campaign;
}

CheckResult Compare(const CheckShot& check, const core::Trial& trial) {
  const core::Estimate known = ExpectedSpeed(check);
  const core::Measured& speed = trial.first.motion.before_speed_mps;
  const core::Measured& angle = trial.first.contact.approach_angle_rad;
  // E_n divides by the expanded uncertainty, U = 2 u, of the measured and the
  // known value together.
  const auto e_n = [](double difference, double u, double u_known) {
    return difference / (2.0 * std::hypot(u, u_known));
  };
  CheckResult out;
  if (speed) {
    out.speed_e_n = e_n(speed->value - known.value, speed->u, known.u);
  } else {
    out.speed_e_n = core::AbsentBecause(speed.error().reason);
  }
  // A dropped body meets the ground at 90 deg. A measured angle never exceeds
  // that, so this E_n is 0 or negative.
  constexpr double kUpright = std::numbers::pi / 2.0;
  if (angle) {
    out.angle_e_n = e_n(angle->value - kUpright, angle->u, check.upright_u_rad);
  } else {
    out.angle_e_n = core::AbsentBecause(angle.error().reason);
  }
  const auto good = [](const core::Expected<double>& value) {
    return value && std::abs(*value) <= 1.0;
  };
  // Scale and frame rate show in the speed, the camera's level in the angle.
  // One that is absent is no agreement.
  out.agrees = good(out.speed_e_n) && good(out.angle_e_n);
  const auto text = [](const core::Expected<double>& value) {
    return value ? fmt::format("E_n {:.2f}", *value)
                 : "absent: " + value.error().reason;
  };
  out.text = fmt::format(
      "check shot {}: speed {} m/s, known {} m/s ({}); approach angle {} deg, "
      "known 90 deg ({})",
      out.agrees ? "agrees" : "DOES NOT AGREE",
      report::WithUOrReason(speed, 1.0), report::WithU(known, 1.0),
      text(out.speed_e_n), report::WithUOrReason(angle, kDegree),
      text(out.angle_e_n));
  return out;
}

}  // namespace touchdown::session
