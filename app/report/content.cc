#include "app/report/content.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "app/report/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

double OrLast(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::infinity());
}

double AngleOrLast(const core::Trial& trial) {
  const core::Measured& angle = core::ContactAngle(trial);
  return angle ? angle->value : std::numeric_limits<double>::infinity();
}

std::map<std::string, const core::Campaign*> ByName(
    const std::vector<core::Campaign>& campaigns) {
  std::map<std::string, const core::Campaign*> out;
  for (const core::Campaign& campaign : campaigns) {
    if (!out.emplace(campaign.name, &campaign).second) {
      throw std::invalid_argument(fmt::format(
          "campaigns: the name '{}' is given twice; names must be unique",
          campaign.name));
    }
  }
  return out;
}

void Compare(const ReportInput& input, Group& group) {
  const auto add = [&](const ReportTheory& theory, bool declared) {
    group.compared.push_back({theory, declared,
                              analysis::CompareWithTheory(
                                  group.trials.observations, theory.boundary)});
  };
  const core::Campaign& campaign = group.campaign;
  const bool speaks_of_these = campaign.body.kind == group.trials.body &&
                               campaign.angle_kind == group.trials.angle_kind;
  if (campaign.theory_boundary_rad && speaks_of_these) {
    const analysis::TheoryBoundary declared{campaign.theory_name,
                                            *campaign.theory_boundary_rad,
                                            campaign.theory_u_rad};
    add({group.trials.body, declared, "declared before the first trial"}, true);
    analysis::BoundaryIntervals intervals;
    if (group.bracket.closed()) {
      intervals.interval90_rad =
          core::Interval{*group.bracket.low_rad, *group.bracket.high_rad};
    }
    group.judgement = analysis::Judge(intervals, declared, campaign.margin_rad,
                                      group.trials.origin);
  }
  for (const ReportTheory& theory : input.theories) {
    if (theory.body != group.trials.body) continue;
    const bool same =
        group.judgement && campaign.theory_name == theory.boundary.name &&
        *campaign.theory_boundary_rad == theory.boundary.boundary_rad;
    if (same) {
      group.compared.front().theory.note += "; " + theory.note;
    } else {
      add(theory, false);
    }
  }
}

}  // namespace

void SortTrials(std::vector<core::Trial>& trials) {
  const auto key = [](const core::Trial& t) {
    return std::tuple(t.campaign, t.body.kind, t.angle_kind, t.origin,
                      OrLast(t.set_angle_rad), AngleOrLast(t), t.clip.path,
                      t.id, t.revision);
  };
  std::stable_sort(trials.begin(), trials.end(),
                   [&](const core::Trial& a, const core::Trial& b) {
                     return key(a) < key(b);
                   });
}

std::vector<Group> MakeGroups(const ReportInput& input,
                              std::span<const core::Trial> trials) {
  const auto campaigns = ByName(input.campaigns);
  std::vector<Group> out;
  for (analysis::TrialGroup& trial_group : analysis::GroupTrials(trials)) {
    Group group;
    for (const auto& o : trial_group.observations) {
      group.members.push_back(o.trial);
    }
    for (const auto& left : trial_group.left_out) {
      group.members.push_back(left.trial);
    }
    std::sort(group.members.begin(), group.members.end());
    const auto known = campaigns.find(trial_group.campaign);
    group.registered = known != campaigns.end();
    if (group.registered) {
      group.campaign = *known->second;
    } else {
      group.campaign.name = trial_group.campaign;
      group.campaign.body = trials[group.members.front()].body;
      group.campaign.angle_kind = trial_group.angle_kind;
    }
    group.trials = std::move(trial_group);
    group.counts = analysis::Count(group.trials.observations);
    group.bracket = analysis::FindBracket(group.trials.observations);
    Compare(input, group);
    out.push_back(std::move(group));
  }
  return out;
}

std::string ShortName(const Group& group, std::span<const Group> groups) {
  const auto same =
      std::count_if(groups.begin(), groups.end(), [&](const Group& other) {
        return other.trials.body == group.trials.body;
      });
  std::string name(core::Name(group.trials.body));
  if (same > 1) {
    name += fmt::format(" ({})", group.trials.campaign.empty()
                                     ? "no campaign"
                                     : group.trials.campaign);
  }
  return name;
}

std::string AngleName(const Group& group) {
  return fmt::format("{} angle", core::Name(group.trials.angle_kind));
}

std::string PaperWord(core::MotionState state) {
  if (state == core::MotionState::kBounce) return "bounce";
  return core::IsNotBounce(state) ? "slide" : "undecided";
}

std::string BracketText(const analysis::Bracket& bracket) {
  if (bracket.overlap) {
    return fmt::format(
        "no bracket: a body stayed down at {} deg and another bounced at {} "
        "deg",
        Plain(*bracket.low_rad / kDegree), Plain(*bracket.high_rad / kDegree));
  }
  if (bracket.closed()) {
    return fmt::format("bracket {} deg, {} deg wide",
                       HalfOpen(bracket.low_rad, bracket.high_rad, kDegree),
                       Plain((*bracket.high_rad - *bracket.low_rad) / kDegree));
  }
  if (bracket.low_rad) {
    return fmt::format("boundary {} deg (no bounce was seen)",
                       HalfOpen(bracket.low_rad, {}, kDegree));
  }
  if (bracket.high_rad) {
    return fmt::format("boundary {} deg (every body bounced)",
                       HalfOpen({}, bracket.high_rad, kDegree));
  }
  return "no decided trial";
}

std::string AgreementText(const Compared& compared) {
  const analysis::Agreement& a = compared.agreement;
  std::string text =
      fmt::format("{} of {} agree with the {} boundary, {} deg", a.all.right(),
                  a.all.total(), compared.theory.boundary.name,
                  Plain(compared.theory.boundary.boundary_rad / kDegree));
  if (a.decides_nothing > 0) {
    text += fmt::format(", but {} of them decide{} nothing (within 2 u of it)",
                        a.decides_nothing, a.decides_nothing == 1 ? "s" : "");
  }
  if (a.all.total() > 0) {
    text += fmt::format(
        "; every boundary {} deg agrees as well",
        a.same_low_rad && a.same_high_rad
            ? "in " + HalfOpen(a.same_low_rad, a.same_high_rad, kDegree)
            : HalfOpen(a.same_low_rad, a.same_high_rad, kDegree));
  }
  return text + ".";
}

}  // namespace touchdown::report
