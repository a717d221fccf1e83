#include "app/trials/paper_trials.h"

#include <fmt/core.h>

#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/body.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {

PaperTrials PaperTable1Trials(double u_rad) {
  PaperTrials out;
  // Each body has one campaign of nine trials.
  for (const auto kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    core::Campaign campaign;
    campaign.name = fmt::format("paper-table1-{}", core::Name(kind));
    campaign.body = core::UnmeasuredBody(kind, "not in the paper");
    campaign.surface = "not in the paper";
    campaign.angle_kind = core::DefaultAngleKind(kind);
    // A campaign must have one; the paper gives none, and its trials say so.
    campaign.bounce_height_m = 0.5 * core::kMillimetre;
    const auto theory = analysis::PaperTable1Boundary(kind);
    campaign.theory_name = theory.name;
    campaign.theory_boundary_rad = theory.boundary_rad;
    for (const auto& o : analysis::PaperTable1(kind, u_rad)) {
      core::Trial trial;
      // A readable id, "paper-table1-sphere-11.8", unique because the paper has
      // each angle of a body once. A store gives an id of its own.
      trial.id =
          fmt::format("{}-{:.1f}", campaign.name, o.angle_rad / core::kDegree);
      trial.campaign = campaign.name;
      trial.origin = core::Origin::kManual;
      trial.body = campaign.body;
      trial.angle_kind = campaign.angle_kind;
      trial.set_angle_rad = o.angle_rad;
      core::Contact& contact = trial.first.contact;
      contact.found = true;
      const core::Estimate angle{o.angle_rad, o.u_rad};
      // The other two angles stay absent: the paper prints one angle a trial.
      (kind == core::BodyKind::kSphere ? contact.approach_angle_rad
                                       : contact.radius_angle_rad) = angle;
      core::StateDecision& state = trial.first.state;
      // The paper's two words; its "slide" is taken at its word here.
      state.label = o.outcome == analysis::Outcome::kBounce
                        ? core::MotionState::kBounce
                        : core::MotionState::kSlide;
      state.p_bounce = o.p_bounce;
      state.reason = "the paper's Table 1";
      const auto unknown = core::AbsentBecause("not in the paper");
      // The gaps were not printed, so the label rests on the paper's word
      // alone.
      state.max_gap_m = unknown;
      state.bounce_height_m = unknown;
      state.detectable_gap_m = unknown;
      state.extrapolated_gap_m = unknown;
      trial.author = "the paper's Table 1";
      out.trials.push_back(std::move(trial));
    }
    out.campaigns.push_back(std::move(campaign));
  }
  return out;
}

}  // namespace touchdown::pipeline
