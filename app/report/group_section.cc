// The pages of one group of trials in the order of reading: what was tested,
// the plan on record, the checks over all trials, every trial, the pictures,
// and the evidence for the numbers. The statistics are an annex
// (group_statistics.cc).
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/report/content.h"
#include "app/report/sentences.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// The one bounce height of the trials in mm, or that they differ: it is a
// convention, and trials with another one mean another thing by "bounce".
std::string BounceHeightText(const Group& group,
                             std::span<const core::Trial> trials) {
  double low = 1e300;
  double high = -1e300;
  for (const std::size_t t : group.members) {
    const auto& height = trials[t].first.state.bounce_height_m;
    if (!height) continue;
    low = std::min(low, height->value);
    high = std::max(high, height->value);
  }
  if (low > high) return "not recorded";
  // A nanometre: what is left of a conversion between units.
  if (high - low < 1e-9) return Plain(low / kMillimetre, 3) + " mm";
  return fmt::format(
      "{} to {} mm: NOT the same for all trials, so they are not strictly "
      "comparable",
      Plain(low / kMillimetre, 3), Plain(high / kMillimetre, 3));
}

// The part of u that does not become less with more trials: the greatest of the
// group, in degrees, and how many set-ups there are.
std::string SharedErrorText(const Group& group) {
  double most = 0.0;
  std::set<int> setups;
  for (const analysis::Observation& o : group.trials.observations) {
    if (o.common_u_rad <= 0.0) continue;
    most = std::max(most, o.common_u_rad);
    setups.insert(o.setup);
  }
  if (setups.empty()) {
    return "nothing is known: the trials count as independent";
  }
  return fmt::format(
      "up to {} deg (level, lens, yaw, scale) in {} set-up{}: one error moves "
      "all trials of a set-up, and stays however many there are",
      Plain(most / kDegree, 3), setups.size(), setups.size() == 1 ? "" : "s");
}

// The head of a group as two columns, name and value.
Table MakeFacts(const Group& group, std::span<const core::Trial> trials) {
  const core::Campaign& c = group.campaign;
  const analysis::BoundaryStudy& study = group.study;
  Table table{"", {{"campaign"}, {c.name.empty() ? "(none)" : c.name}}, {}};
  const auto row = [&](std::string name, std::string value) {
    table.rows.push_back({{std::move(name)}, {std::move(value)}});
  };
  row("origin of the trials", std::string(core::Name(group.trials.origin)));
  // A campaign may have been registered for another kind of body than the
  // trials have; the body of the first trial stands for them then.
  const core::Body& body = c.body.kind == group.trials.body
                               ? c.body
                               : trials[group.members.front()].body;
  row("body", fmt::format("{}, {}", core::Name(body.kind), SizeText(body)));
  row("surface", c.surface.empty() ? "not recorded" : c.surface);
  row("contact angle", AngleName(group) + " at touchdown");
  row("bounce height", BounceHeightText(group, trials));
  if (c.speed_max_mps > 0.0) {
    row("speed band at touchdown",
        fmt::format("{} to {} m/s", Plain(c.speed_min_mps),
                    Plain(c.speed_max_mps)));
  }
  row("declared theory",
      group.declared() != nullptr
          ? fmt::format(
                "{}: {} deg, margin {} deg", c.theory_name,
                WithU({*c.theory_boundary_rad, c.theory_u_rad, {}}, kDegree),
                Plain(c.margin_rad / kDegree))
          : "none declared before the first trial");
  // Own and common part together, from the least to the greatest.
  row("u of the angles",
      fmt::format("{} to {} deg", Plain(study.least_u_rad / kDegree, 3),
                  Plain(study.greatest_u_rad / kDegree, 3)));
  row("of which a set-up's trials share", SharedErrorText(group));
  if (study.used_set_angles > 0) {
    row("set angles",
        fmt::format("of {} trials, used beside the measured angles; the "
                    "ejector repeats to {} deg and differs from one set angle "
                    "to another by {} deg",
                    study.used_set_angles,
                    Plain(study.set_within_rad.value_or(0.0) / kDegree, 2),
                    Plain(study.set_between_rad.value_or(0.0) / kDegree, 2)));
  }
  row("next angle", NextSentence(group));
  return table;
}

// Why the paper's angles cannot be set with a body of finite thickness
// (theory.md, E6). Needed where a rectangle is thrown at face angles and
// compared with the paper's radius angle.
std::string FaceAngleText(const Group& group) {
  std::string least = "atan(b/a) of its sides";
  const core::Body& body = group.campaign.body;
  if (body.long_m && body.short_m && body.long_m->value > 0.0) {
    least += fmt::format(
        ", here {} deg",
        Plain(std::atan2(body.short_m->value, body.long_m->value) / kDegree,
              1));
  }
  return fmt::format(
      "The varied angle of this rectangle is its face angle, the inclination "
      "of the long side to the ground. The paper's own angle (its Fig. 1, the "
      "radius angle from the centre to the contact corner) cannot be less than "
      "{}, so a body of finite thickness cannot be thrown at the radius angles "
      "0, 3.9, ... of the paper's Table 1. The published boundary is shown for "
      "orientation; it speaks of another angle.",
      least);
}

}  // namespace

std::string SizeText(const core::Body& body) {
  const auto with_unit = [](const core::Measured& size) {
    return WithU(*size, kMillimetre) + " mm";
  };
  if (body.kind == core::BodyKind::kSphere) {
    return body.diameter_m
               ? "diameter " + with_unit(body.diameter_m)
               : "diameter absent: " + body.diameter_m.error().reason;
  }
  if (!body.long_m) return "sides absent: " + body.long_m.error().reason;
  if (!body.short_m) return "short side absent: " + body.short_m.error().reason;
  return "sides " + with_unit(body.long_m) + " and " + with_unit(body.short_m);
}

Section MakeGroupSection(const Group& group,
                         std::span<const core::Trial> trials,
                         const ReportInput& input, std::size_t& figures) {
  Section section{group.simulated(), {}};
  auto& out = section.blocks;
  out.push_back(PageBreak{});
  out.push_back(Heading{2, FullName(group)});
  out.push_back(MakeFacts(group, trials));
  if (group.trials.angle_kind == core::AngleKind::kFace) {
    out.push_back(Callout{"Which angle.", FaceAngleText(group)});
  }
  for (Block& block : MakePlan(group, trials, input)) {
    out.push_back(std::move(block));
  }
  for (Block& block : MakeChecks(group, trials)) {
    out.push_back(std::move(block));
  }
  for (Block& block : MakeTrialTables(group, trials, input)) {
    out.push_back(std::move(block));
  }
  for (Block& block : MakePictures(group, trials, input, figures)) {
    out.push_back(std::move(block));
  }
  for (Block& block : MakeEvidence(group, trials, input)) {
    out.push_back(std::move(block));
  }
  return section;
}

}  // namespace touchdown::report
