// From trials to groups. GroupTrials() splits them by what may be pooled; each
// group then gets
//
//   ShareErrors()            which part of u its trials have in common
//   its campaign             the registered one, or one made of the trials
//   Study()                  boundary, theories, verdict, next angle
//   WithholdWhereItDrifts()  no confirmation where there is no one boundary
#include "app/report/group.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "app/report/content.h"
#include "app/report/set_points.h"
#include "app/report/shared_errors.h"

namespace touchdown::report {
namespace {

// Keys of the sort, in radians. Infinity where there is no set-point, or no
// angle: such a trial comes last.
double OrLast(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::infinity());
}

double AngleOrLast(const core::Trial& trial) {
  const core::Measured angle = core::ContactAngle(trial);
  return angle ? angle->value : std::numeric_limits<double>::infinity();
}

// The campaigns by their name, as pointers into `campaigns`. Throws
// std::invalid_argument where two have one name: the trials could not be given
// to one of them.
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

// The options of a study, with the angles that can be thrown in the group. Asks
// the rig for them and keeps the answer in group.reach.
analysis::StudyOptions BoundedStudy(const ReportInput& input, Group& group) {
  analysis::StudyOptions options = input.study;
  if (input.reach_of) group.reach = input.reach_of(group.campaign);
  if (group.reach) {
    options.next.feasible_rad = group.reach->angle_rad;
    // Only where it was asked for: a boundary beyond the reach would else be
    // pressed into it.
    if (input.support_is_reach &&
        group.reach->angle_rad.high > group.reach->angle_rad.low) {
      options.fit.low_rad = group.reach->angle_rad.low;
      options.fit.high_rad = group.reach->angle_rad.high;
    }
  }
  return options;
}

// Makes the study of a group, with the theories that speak of it, and the notes
// that run beside study.theories.
void Study(const ReportInput& input, Group& group) {
  analysis::StudyOptions options = BoundedStudy(input, group);
  const core::Campaign& campaign = group.campaign;
  options.origin = group.trials.origin;
  options.margin_rad = campaign.margin_rad;
  // The input's options are those of all groups; the theories are this one's.
  options.declared.reset();
  options.others.clear();
  // A theory declared for another body or another kind of angle says nothing
  // here.
  const bool speaks_of_these = campaign.body.kind == group.trials.body &&
                               campaign.angle_kind == group.trials.angle_kind;
  if (campaign.theory_boundary_rad && speaks_of_these) {
    options.declared = analysis::TheoryBoundary{campaign.theory_name,
                                                *campaign.theory_boundary_rad,
                                                campaign.theory_u_rad};
    group.notes.emplace_back("declared before the first trial");
  }
  for (const ReportTheory& theory : input.theories) {
    if (theory.body != group.trials.body) continue;
    // A published value that the campaign declares is one line and not two:
    // equal name and number, with both notes.
    if (options.declared && options.declared->name == theory.boundary.name &&
        options.declared->boundary_rad == theory.boundary.boundary_rad) {
      group.notes.front() += "; " + theory.note;
    } else {
      options.others.push_back(theory.boundary);
      group.notes.push_back(theory.note);
    }
  }
  group.prior = options.fit.scatter;
  group.study = analysis::StudyBoundary(group.trials.observations, options);
}

// A verdict of confirmed says that the boundary lies within the margin in all
// trials. Where it drifts, or depends on more than the angle, only its average
// may: the verdict becomes inconclusive. A contradiction stands: no one
// boundary within the margin explains the trials, drifting or not. A verdict
// that was inconclusive before names the dependence as well, because more of
// the same trials would not mend it.
void WithholdWhereItDrifts(Group& group, std::span<const core::Trial> trials) {
  if (group.declared() == nullptr) return;
  analysis::TheoryComparison& theory = group.study.theories.front();
  analysis::Judgement& judgement = theory.judgement;
  if (!judgement.verdict ||
      *judgement.verdict == core::Verdict::kContradicted) {
    return;
  }
  group.dependence = TellingDependence(group, trials);
  if (group.dependence.empty()) return;
  judgement.reason = fmt::format(
      "the boundary drifts or depends on more than the angle ({}), so that {}",
      group.dependence,
      *judgement.verdict == core::Verdict::kConfirmed
          ? "only its average lies within the margin"
          : "these trials have no one boundary; besides, " + judgement.reason);
  judgement.verdict = core::Verdict::kInconclusive;
  // The forecast simulates further trials with one boundary, which these do not
  // have.
  theory.trials_to_decide.reset();
}

}  // namespace

const analysis::TheoryComparison* Group::declared() const {
  // StudyBoundary() puts the declared theory first.
  return !study.theories.empty() && study.theories.front().declared
             ? &study.theories.front()
             : nullptr;
}

void SortTrials(std::vector<core::Trial>& trials) {
  // The angle decides before clip and id, so that a table reads from flat to
  // steep.
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
  // Trials that bear the program's and a person's label.
  std::map<std::string, const LabelPair*> labels;
  for (const LabelPair& pair : input.labels) labels[pair.trial] = &pair;
  std::vector<Group> out;
  for (analysis::TrialGroup& trial_group : analysis::GroupTrials(trials)) {
    const auto known = campaigns.find(trial_group.campaign);
    // They have no boundary: check_shots.cc makes what is said of them.
    if (known != campaigns.end() && core::HasCheckShots(*known->second)) {
      continue;
    }
    Group group;
    ShareErrors(trials, trial_group.observations);
    // Members are all trials of the group, those left out too, in the order of
    // `trials`: SortTrials() has put that right for the tables.
    for (const auto& o : trial_group.observations) {
      group.members.push_back(o.trial);
    }
    for (const auto& left : trial_group.left_out) {
      group.members.push_back(left.trial);
      const core::Trial& trial = trials[left.trial];
      group.left_out.push_back({trial.id, TrialName(trial), left.reason});
    }
    std::sort(group.members.begin(), group.members.end());
    for (const std::size_t t : group.members) {
      const auto pair = labels.find(trials[t].id);
      if (pair != labels.end()) group.labels.push_back(*pair->second);
    }
    // A group without a registered campaign (a CSV file) gets one with the
    // first trial's body, no theory and the default margin.
    group.registered = known != campaigns.end();
    if (group.registered) {
      group.campaign = *known->second;
    } else {
      group.campaign.name = trial_group.campaign;
      group.campaign.body = trials[group.members.front()].body;
      group.campaign.angle_kind = trial_group.angle_kind;
    }
    group.trials = std::move(trial_group);
    Study(input, group);
    WithholdWhereItDrifts(group, trials);
    out.push_back(std::move(group));
  }
  // As in the paper: the sphere first.
  std::stable_sort(out.begin(), out.end(), [](const Group& a, const Group& b) {
    return a.trials.body < b.trials.body;
  });
  return out;
}

Group EmptyGroup(const ReportInput& input, const core::Campaign& campaign) {
  Group group;
  group.campaign = campaign;
  group.trials.campaign = campaign.name;
  group.trials.body = campaign.body.kind;
  group.trials.angle_kind = campaign.angle_kind;
  group.prior = input.study.fit.scatter;
  group.study = analysis::StudyBoundary({}, BoundedStudy(input, group));
  return group;
}

std::map<std::size_t, std::string> ReasonsLeftOut(const Group& group) {
  std::map<std::size_t, std::string> out;
  for (const auto& left : group.trials.left_out) {
    out[left.trial] = left.reason;
  }
  return out;
}

std::string FullName(const Group& group) {
  return fmt::format(
      "{}: {}, {}, {}",
      group.trials.campaign.empty() ? "no campaign" : group.trials.campaign,
      core::Name(group.trials.body), AngleName(group),
      core::Name(group.trials.origin));
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

}  // namespace touchdown::report
