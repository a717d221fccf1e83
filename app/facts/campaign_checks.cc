// How the checks work together: ReadRatios() takes from each trial two ratios
// of measured over expected, gravity and the body's size. CheckCampaign() pools
// them and the restitution over the trials of a campaign, and Explain() looks
// for the one mistake (scale, frame rate, stated size, ground line) that
// accounts for all that failed. Measured lengths go with 1 / scale and times
// with 1 / frame rate:
//
//   gravity  ~ (frame rate)^2 / (px per m)
//   size     ~ size in px / (px per m)
#include "app/facts/campaign_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/facts/stored_document.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

// Gravity is known to this share without a survey of the site: 9.780 at the
// equator, 9.832 at the poles.
constexpr double kLocalGravity = 0.002;
// Where an outline is seen is uncertain by light, gamma and lens in common to
// the clips of a set-up, px: outlines of rendered clips are off by 0.02 px, of
// recorded ones by up to this. Smaller finds a body of 20 px that is 3 % too
// small, and blames light for it.
constexpr double kOutline_px = 0.1;

// The {"value", "u"} at `path` of the document, in the unit of the field's
// name. Nothing where either is missing or the value is not positive: all that
// is read here is a length or a scale, of which 0 says nothing.
std::optional<core::Estimate> FindEstimate(
    const nlohmann::json& json, std::initializer_list<const char*> path) {
  const nlohmann::json& at = FindValue(json, path);
  const nlohmann::json& value = FindValue(at, {"value"});
  const nlohmann::json& u = FindValue(at, {"u"});
  if (!value.is_number() || !u.is_number() || !(value.get<double>() > 0.0)) {
    return std::nullopt;
  }
  return core::Estimate{value.get<double>(), u.get<double>(), {}};
}

// The body's size in the picture over its stated size at this scale, with the
// own u of this trial. `common_u` is set to the relative u that the trials of a
// set-up share (scale, statement, light on the outline). Absent with the reason
// where the two sizes are not independent.
core::Measured SizeRatio(const nlohmann::json& json,
                         const core::Estimate& scale, bool scale_of_body,
                         double& common_u) {
  if (scale_of_body) {
    return core::AbsentBecause("the scale is from the body's own size");
  }
  // The size in the document is that of the picture with the lens still in it,
  // and the scale is that without.
  if (!FindValue(json, {"calibration", "lens_rms_px"}).is_null()) {
    return core::AbsentBecause(
        "the size in the picture is not free of the lens");
  }
  // A sphere has a radius in the document; a rectangle is compared by its long
  // side, of which the same error in px is the smaller share.
  const auto radius = FindEstimate(json, {"body", "radius_px"});
  auto seen = radius ? std::optional(core::Scaled(*radius, 2.0))
                     : FindEstimate(json, {"body", "long_px"});
  const auto stated =
      FindEstimate(json, {"body", radius ? "diameter_mm" : "long_mm"});
  if (!seen || !stated) return core::AbsentBecause("no size was seen");
  // px over (m times px/m).
  const double ratio =
      seen->value / (stated->value * core::kMillimetre * scale.value);
  // A size that was not stated is the picture's own.
  constexpr double kOwn = 1e-9;
  if (std::abs(ratio - 1.0) < kOwn) {
    return core::AbsentBecause("the body's size was not stated");
  }
  // An outline that is off on both sides of the body changes its size twice.
  common_u = std::hypot(scale.u / scale.value, stated->u / stated->value,
                        2.0 * kOutline_px / seen->value);
  // A fit without scatter is no measurement without error.
  constexpr double kLeastU = 1e-5;
  return core::Estimate{
      ratio, std::max(kLeastU, ratio * seen->u / seen->value), {}};
}

// "1.1 %" of a share of 1.
std::string Percent(double share) {
  return fmt::format("{:.2g} %", 100.0 * share);
}

// "Gravity from the flights is 103.1 ± 0.4 % of what it should be (+7.1 u, 20
// trials)".
std::string Off(const char* what, const analysis::PooledCheck& check) {
  return fmt::format("{} is {} of what it should be ({:+.1f} u, {} trials)",
                     what, WithU(check.ratio, 0.01) + " %", check.z,
                     check.trials);
}

// Names what failed, and the mistake that would explain all of it, as one
// paragraph; empty where nothing failed. `px_per_m` and `fps` are those that
// the analyses took; what they ought to be follows from the ratios.
std::string Explain(const CampaignChecks& checks, double px_per_m, double fps,
                    bool scale_of_body) {
  std::string what;
  std::string why;
  // g: gravity failed; s: the size failed. A check that could not be made is
  // false.
  const bool g = checks.gravity && checks.gravity->failed;
  const bool s = checks.size && checks.size->failed;
  if (g) what = Off("Gravity from the flights", *checks.gravity);
  if (s) {
    what += (what.empty() ? "" : "; ") +
            Off("The size that was seen", *checks.size);
  }
  // Frame rate and scale that would make a gravity of `ratio` times the true
  // one right. A scale explains a size of `ratio` times the stated one in the
  // same way.
  const auto rate = [&](double ratio) {
    return fmt::format("a frame rate of {:.1f}/s instead of {:.1f}",
                       fps / std::sqrt(ratio), fps);
  };
  const auto scale = [&](double ratio) {
    return fmt::format("a scale of {:.1f} px/m instead of {:.1f}",
                       px_per_m * ratio, px_per_m);
  };
  if (g) {
    const double ratio = checks.gravity->ratio.value;
    // The scale was made from the stated size: a wrong statement is a wrong
    // scale, and the size itself cannot be checked.
    if (scale_of_body) {
      why = fmt::format(
          "a body of {:.4g} times the stated size (the scale is its own), or "
          "{}, would explain it",
          1.0 / ratio, rate(ratio));
    } else if (s && std::abs(ratio - checks.size->ratio.value) <
                        2.0 * std::hypot(checks.gravity->ratio.u,
                                         checks.size->ratio.u)) {
      // Gravity and size are off by the same factor within twice their u: a
      // wrong scale does that, a wrong frame rate leaves the size alone.
      why = scale(ratio) + " would explain both";
    } else if (s) {
      why = "no one cause explains both: check scale, frame rate and size";
    } else if (checks.size && !checks.size->failed &&
               checks.size->shows < std::abs(ratio - 1.0)) {
      // The size check would have seen a scale that is so far off, and it
      // agrees.
      why = rate(ratio) + " would explain it; the size agrees with the scale";
    } else {
      // The size says nothing, or not enough: both causes stay possible.
      why = scale(ratio) + ", or " + rate(ratio) + ", would explain it";
    }
  } else if (s) {
    // Gravity does not know the body's size. Where it is sharp enough to have
    // seen such a scale, only the stated size is left to blame.
    const double ratio = checks.size->ratio.value;
    const bool scale_agrees =
        checks.gravity && checks.gravity->shows < std::abs(ratio - 1.0);
    why = fmt::format(
        "a body of {:.4g} times the stated size{} would explain "
        "it",
        ratio,
        scale_agrees ? " (gravity agrees with the scale)"
                     : ", or " + scale(ratio) + ",");
  }
  // No rebound gains speed. A scale changes both speeds alike, so that it is
  // not the cause; a ground line above or below the ground moves the instants
  // at which the two speeds are taken.
  if (checks.restitution && checks.restitution->failed) {
    what += (what.empty() ? "" : "; ") +
            fmt::format("the mean restitution is {}, above 1",
                        WithU(checks.restitution->ratio, 1.0));
    if (why.empty()) why = "a ground line that is not the ground explains it";
  }
  if (what.empty()) return {};
  // An angle is a ratio of two lengths: a wrong scale or frame rate cancels in
  // it.
  return what + ": " + why +
         ". Speeds, heights and what they decide are wrong "
         "with it; approach angles are not.";
}

}  // namespace

TrialRatios ReadRatios(const core::Trial& trial) {
  const nlohmann::json json = StoredDocument(trial);
  TrialRatios out{
      core::AbsentBecause("no document"),
      core::AbsentBecause(json.is_object() ? "the document holds no scale"
                                           : "no document")};
  const auto scale = FindEstimate(json, {"scale", "px_per_m"});
  out.scale_of_body = FindValue(json, {"scale", "source"}) == "body_size";
  if (const nlohmann::json& fps = FindValue(json, {"clip", "time_base", "fps"});
      fps.is_number()) {
    out.fps = fps.get<double>();
  }
  // Relative u; 0 where the document has no scale.
  const double scale_u = scale ? scale->u / scale->value : 0.0;
  out.common_gravity_u = std::hypot(kLocalGravity, scale_u);
  const core::Measured& g = trial.first.motion.gravity_check_mps2;
  out.gravity =
      g ? core::Measured(core::Scaled(*g, 1.0 / core::kStandardGravity_mps2))
        : g;
  if (scale) {
    out.px_per_m = scale->value;
    out.size = SizeRatio(json, *scale, out.scale_of_body, out.common_size_u);
  }
  return out;
}

CampaignChecks CheckCampaign(std::span<const std::size_t> members,
                             std::span<const core::Trial> trials) {
  // One entry for each trial that tells something. `no_gravity` and `no_size`
  // keep the reason of the last trial that does not, as an example for the
  // reader.
  std::vector<core::Estimate> gravity;
  std::vector<core::Estimate> size;
  std::vector<core::Estimate> restitution;
  std::string no_gravity;
  std::string no_size;
  double gravity_u = 0.0;
  double size_u = 0.0;
  double px_per_m = 0.0;
  double fps = 0.0;
  bool of_body = false;
  for (const std::size_t i : members) {
    const core::Trial& trial = trials[i];
    // Numbers that were typed were not measured with this scale or frame rate.
    if (trial.excluded || trial.origin == core::Origin::kManual) continue;
    const TrialRatios r = ReadRatios(trial);
    // Scale and frame rate of the last trial stand in the explanation for all:
    // they are those of one set-up as a rule.
    of_body = of_body || r.scale_of_body;
    if (r.px_per_m) px_per_m = *r.px_per_m;
    if (r.fps) fps = *r.fps;
    // The mean is weighted by 1/u^2: a u of 0 would outweigh all other trials,
    // and PoolChecks() refuses it.
    if (r.gravity && r.gravity->u > 0.0) {
      gravity.push_back(*r.gravity);
      gravity_u += r.common_gravity_u;
    } else if (!r.gravity) {
      no_gravity = r.gravity.error().reason;
    }
    if (r.size && r.size->u > 0.0) {
      size.push_back(*r.size);
      size_u += r.common_size_u;
    } else if (!r.size) {
      no_size = r.size.error().reason;
    }
    const core::Measured& e = trial.first.motion.restitution;
    if (e && e->u > 0.0) restitution.push_back(*e);
  }
  CampaignChecks out;
  // Pools the ratios; where there are too few, adds why trials gave none.
  const auto pooled = [](const std::vector<core::Estimate>& ratios, double u,
                         const std::string& why) {
    auto check = analysis::PoolChecks(ratios, u);
    if (!check && !why.empty()) {
      return core::Expected<analysis::PooledCheck>(
          core::AbsentBecause(check.error().reason + ": " + why));
    }
    return check;
  };
  // One error in common moves each trial by its own share, and their mean by
  // the mean share.
  const auto mean = [](double sum, std::size_t n) {
    return n > 0 ? sum / static_cast<double>(n) : 0.0;
  };
  out.gravity = pooled(gravity, mean(gravity_u, gravity.size()), no_gravity);
  out.size = pooled(size, mean(size_u, size.size()), no_size);
  // No error of scale or site enters a ratio of two speeds.
  out.restitution = pooled(restitution, 0.0, "");
  // Below 1 is what bodies do; only above it is a mistake.
  if (out.restitution) {
    out.restitution->failed =
        out.restitution->failed && out.restitution->z > 0.0;
  }
  out.explanation = Explain(out, px_per_m, fps, of_body);
  return out;
}

std::string CampaignChecks::Suspects() const {
  const auto failed = [](const core::Expected<analysis::PooledCheck>& check) {
    return check && check->failed;
  };
  std::string out;
  if (failed(gravity) || failed(size)) out = "scale, frame rate or size";
  // Neither of these makes a rebound faster than the approach.
  if (failed(restitution))
    out += out.empty() ? "the ground line" : ", and the ground line";
  return out;
}

// `shows` is the relative error that 95 of 100 such campaigns would have failed
// for. Gravity goes with the square of the frame rate, so that half of the
// error in the rate already shows.
std::string WhatChecksShow(const CampaignChecks& checks) {
  if (!checks.gravity && !checks.size) {
    return fmt::format(
        "Nothing in these trials can show a wrong scale, frame rate or size of "
        "the body (gravity: {}; size: {})",
        checks.gravity.error().reason, checks.size.error().reason);
  }
  std::string out = "What is wrong in all trials alike would show from";
  if (checks.gravity) {
    out += fmt::format(" {} in the scale or {} in the frame rate (gravity)",
                       Percent(checks.gravity->shows),
                       Percent(0.5 * checks.gravity->shows));
  }
  if (checks.size) {
    out += fmt::format("{} {} in the body's size or the scale (its picture)",
                       checks.gravity ? " and from" : "",
                       Percent(checks.size->shows));
  }
  if (!checks.gravity) {
    out += "; nothing can show a wrong frame rate (gravity: " +
           checks.gravity.error().reason + ")";
  }
  if (!checks.size) {
    out += "; nothing can show a wrong size of the body beside it (" +
           checks.size.error().reason + ")";
  }
  return out;
}

}  // namespace touchdown::report
