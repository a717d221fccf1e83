// touchdown rig plan gives for each wanted contact angle the settings that give
// it at the wanted speed, or why there are none.
#include <fmt/core.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/options.h"
#include "app/cli/rig/rig_commands.h"
#include "app/cli/rig/rig_flags.h"
#include "app/cli/rig/rig_print.h"
#include "app/cli/store/store_flags.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. `height_mm` holds the muzzle height; without it the
// plan chooses one.
struct PlanFlags {
  RigFlags rig;
  DrawFlags draw;
  std::string angle_kind, corner;
  std::vector<double> angles_deg;
  double speed_mps = 0.0;
  std::optional<double> height_mm;
  bool all = false;
  bool json = false;
};

// Returns what is wanted of every contact, but for the angle, which is set for
// each in turn. Throws std::invalid_argument for an unknown word.
rig::ContactWish MakeWish(const PlanFlags& flags, const rig::Description& rig) {
  rig::ContactWish wish;
  // A rig without a body throws a point, which lands as a sphere does.
  wish.kind = core::DefaultAngleKind(rig.body ? rig.body->kind
                                              : core::BodyKind::kSphere);
  if (!flags.angle_kind.empty()) {
    const auto kind = core::ParseAngleKind(flags.angle_kind);
    if (!kind) {
      throw std::invalid_argument(
          fmt::format("--angle-kind is \"{}\", must be approach, radius or "
                      "face",
                      flags.angle_kind));
    }
    wish.kind = *kind;
  }
  wish.corner = ReadCorner(flags.corner);
  wish.speed_mps = flags.speed_mps;
  if (flags.height_mm) {
    wish.muzzle_height_m = *flags.height_mm * core::kMillimetre;
  }
  return wish;
}

// Returns one line with the settings and where the body lands, "20 deg:
// elevation ..., lands at 20.0 +- 0.4 deg", and one for each finding. `all`
// adds everything that was predicted.
std::string PlanText(double angle_deg, core::AngleKind kind,
                     const rig::SetPoint& point, bool all) {
  const rig::ContactPrediction& contact = point.contact;
  // This is the predicted angle of the kind that was asked for.
  const rig::Predicted& angle =
      kind == core::AngleKind::kApproach ? contact.approach_angle_rad
      : kind == core::AngleKind::kRadius ? contact.radius_angle_rad
                                         : contact.face_angle_rad;
  std::string out = fmt::format(
      "{:g} deg: elevation {:.2f} deg, compression {:.2f} mm, muzzle height "
      "{:.1f} mm",
      angle_deg, point.setting.elevation_rad / core::kDegree,
      point.setting.compression_m / core::kMillimetre,
      point.setting.muzzle_height_m / core::kMillimetre);
  if (angle.first_order) {
    out += fmt::format(
        "; lands at {} deg",
        Rounded(core::Scaled(*angle.first_order, 1.0 / core::kDegree)));
  }
  return out + '\n' + (all ? PredictionText(contact, true) : "") +
         FindingsText(contact.findings);
}

// Plans each angle in the order given. Returns 0: an angle that the rig cannot
// throw is refused in its own line and stops nothing.
int RunPlan(const PlanFlags& flags) {
  RequireDraws(flags.draw.draws);
  const rig::Description rig = MakeDescription(flags.rig);
  rig::ContactWish wish = MakeWish(flags, rig);
  const std::string kind(core::Name(wish.kind));
  // One generator serves all angles: the same line repeated gives the same
  // bytes, while an angle alone may draw other numbers than among others.
  std::mt19937_64 engine(flags.draw.seed);
  Json out{{"schema", "touchdown.rig.plan/1"},
           {"rig", rig.name},
           {"angle_kind", kind},
           {"speed_mps", wish.speed_mps},
           {"set_points", Json::array()}};
  if (!flags.json) {
    fmt::print("plan for {}: {} angle, {:g} m/s at touchdown\n",
               rig.name.empty() ? "the rig" : rig.name, kind, wish.speed_mps);
  }
  for (const double angle_deg : flags.angles_deg) {
    wish.angle_rad = angle_deg * core::kDegree;
    const auto point = rig::PlanContact(rig, wish, {flags.draw.draws}, engine);
    if (flags.json) {
      Json one{{"angle_deg", angle_deg}, {"possible", !!point}};
      one["reason"] = point ? Json(nullptr) : Json(point.error().reason);
      if (point) {
        one["elevation_deg"] = point->setting.elevation_rad / core::kDegree;
        one["compression_mm"] =
            point->setting.compression_m / core::kMillimetre;
        one["muzzle_height_mm"] =
            point->setting.muzzle_height_m / core::kMillimetre;
        one["contact"] = PredictionJson(point->contact);
      }
      out["set_points"].push_back(std::move(one));
      continue;
    }
    if (!point) {
      fmt::print("{:g} deg: REFUSED: {}\n", angle_deg, point.error().reason);
      continue;
    }
    fmt::print("{}", PlanText(angle_deg, wish.kind, *point, flags.all));
  }
  if (flags.json) Print(out);
  return 0;
}

}  // namespace

void AddRigPlan(CLI::App& rig, Action& action) {
  auto plan = std::make_shared<PlanFlags>();
  CLI::App* one = AddCommand(
      rig, "plan", "settings for wanted contact angles and speed at touchdown");
  AddSpringFlags(*one, plan->rig).Require();
  AddLaunchFlags(*one, plan->rig);
  AddOption(*one, "--angle-kind", plan->angle_kind,
            "approach, radius or face [sphere approach, rectangle radius]");
  AddOption(*one, "--angle-deg", plan->angles_deg, "one or more, A,B,C")
      .Require()
      .SplitAtCommas();
  AddOption(*one, "--speed-mps", plan->speed_mps, "at touchdown").Require();
  AddOption(*one, "--corner", plan->corner,
            "that lands first: leading, trailing or flush");
  AddOption(*one, "--height-mm", plan->height_mm, "muzzle height to keep");
  AddDrawFlags(*one, plan->draw);
  AddFlag(*one, "--all", plan->all,
          "speeds, angles, flight time and range of each, with their u");
  AddFlag(*one, "--json", plan->json, "one JSON document");
  SetAction(*one, action, [plan] { return RunPlan(*plan); });
}

}  // namespace touchdown::cli
