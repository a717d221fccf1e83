// The JSON documents of a group of trials. BoundaryJson() makes the object of
// one group; `touchdown boundary` prints it alone, and the report's table1.json
// puts the trials and the checks of the group beside it. Angles are in degrees,
// lengths in millimetres; the names are a contract with scripts.
#include "app/report/boundary_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/facts/campaign_checks.h"
#include "app/report/check_shots.h"
#include "app/report/document.h"
#include "app/report/sentences.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// Degrees; null where there is no such angle.
Json DegreesJson(const std::optional<double>& angle_rad) {
  return angle_rad ? Json(*angle_rad / kDegree) : Json(nullptr);
}

// [low, high] of the angles that can be thrown; null without a rig.
Json DegreesJson(const core::Expected<Reach>& reach) {
  if (!reach) return nullptr;
  return {reach->angle_rad.low / kDegree, reach->angle_rad.high / kDegree};
}

// A number without unit or uncertainty; null where it is absent.
Json Optional(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

// [low, high] of an interval of a proportion, from 0 to 1; null where there is
// none.
Json Pair(const std::optional<core::Interval>& interval) {
  if (!interval) return nullptr;
  return Json::array({interval->low, interval->high});
}

// {"value", "u"} in the unit of the edge, of which `unit` is the size in SI;
// null, without the reason, where the quantity is absent.
Json Quantity(const core::Measured& m, double unit) {
  if (!m) return nullptr;
  return {{"value", m->value / unit}, {"u", m->u / unit}};
}

// The numbers that a verdict rests on: log likelihood ratios with the scatter
// free, and the posterior's tails beyond the margin (and beyond margin and U of
// the theory). Null for a theory that was not declared, as it gets no verdict.
Json EvidenceJson(const analysis::TheoryComparison& t) {
  if (!t.declared || t.basis.counts.decided() == 0) return nullptr;
  const analysis::VerdictBasis& b = t.basis;
  const analysis::Evidence& e = b.evidence;
  // A claim that no boundary supports has a log likelihood of minus infinity,
  // which JSON does not hold.
  const auto finite = [](double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
  };
  return {{"log_ratio_for",
           finite(e.log_within - std::max(e.log_below, e.log_above))},
          {"log_ratio_against",
           finite(std::max(e.log_far_below, e.log_far_above) - e.log_near)},
          {"p_below_margin", b.p_below},
          {"p_above_margin", b.p_above},
          {"p_far_below", b.p_far_below},
          {"p_far_above", b.p_far_above},
          {"angles_span_deg", b.span_rad / kDegree}};
}

// A theory's boundary beside the trials. In `agreement`, `right` and `decided`
// count all decided trials; every other count and statistic leaves out those
// within 2 u of the boundary. slide_bounce: slide was predicted, bounce seen.
Json TheoryJson(const analysis::TheoryComparison& t, const std::string& note) {
  const auto& a = t.agreement;
  const auto& verdict = t.judgement.verdict;
  return {{"name", t.theory.name},
          {"boundary_deg", t.theory.boundary_rad / kDegree},
          {"u_deg", t.theory.u_rad / kDegree},
          {"declared", t.declared},
          {"note", note},
          {"difference_deg", t.difference_rad / kDegree},
          {"p_below", t.p_below},
          {"p_within_margin", t.p_within},
          {"p_too_low", t.p_too_low},
          {"p_too_high", t.p_too_high},
          {"e_n", t.e_n},
          {"smallest_margin_deg", t.smallest_margin_rad / kDegree},
          {"verdict",
           verdict ? Json(std::string(core::Name(*verdict))) : Json(nullptr)},
          {"verdict_reason", t.judgement.reason},
          {"trials_to_decide",
           t.trials_to_decide ? Json(*t.trials_to_decide) : Json(nullptr)},
          {"deciding_angle_deg",
           t.deciding ? Json(t.deciding->angle_rad / kDegree) : Json(nullptr)},
          {"evidence", EvidenceJson(t)},
          {"agreement_sentence", AgreementSentence(t)},
          {"agreement",
           {{"right", a.all.right()},
            {"decided", a.all.total()},
            {"right_deciding", a.deciding.right()},
            {"deciding", a.deciding.total()},
            {"decides_nothing", a.decides_nothing},
            {"slide_slide", a.deciding.slide_slide},
            {"slide_bounce", a.deciding.slide_bounce},
            {"bounce_slide", a.deciding.bounce_slide},
            {"bounce_bounce", a.deciding.bounce_bounce},
            {"same_low_deg", DegreesJson(a.same_low_rad)},
            {"same_high_deg", DegreesJson(a.same_high_rad)},
            {"wilson95", Pair(t.wilson95)},
            {"clopper_pearson95", Pair(t.clopper_pearson95)},
            {"kappa", t.kappa ? Json(t.kappa->kappa) : Json(nullptr)},
            {"kappa_ase", t.kappa ? Json(t.kappa->ase) : Json(nullptr)},
            {"kappa_ase0", t.kappa ? Json(t.kappa->ase0) : Json(nullptr)},
            {"mcc", Optional(t.matthews)}}}};
}

// The prior on the scatter of the boundary from trial to trial. The log-normal
// has a standard deviation of the logarithm; the half-Cauchy has none, which is
// null.
Json PriorJson(const analysis::ScatterPrior& prior) {
  return {{"scatter_family", prior.log_sd ? "log-normal" : "half-Cauchy"},
          {"scatter_median_deg", prior.median_rad / kDegree},
          {"scatter_log_sd", Optional(prior.log_sd)}};
}

// The posterior of the boundary angle and of its scatter, with the priors it
// was made with. low95_deg and high95_deg hold under every prior that was used;
// the two fields with one_prior do not.
Json PosteriorJson(const Group& group) {
  const auto& p = group.study.posterior;
  Json out = {{"median_deg", p.median_rad / kDegree},
              {"low95_deg", p.interval95_rad.low / kDegree},
              {"high95_deg", p.interval95_rad.high / kDegree},
              {"open_low", p.status == analysis::DataStatus::kOnlyBounces},
              {"open_high", p.status == analysis::DataStatus::kOnlySlides},
              {"low90_deg", p.interval90_rad.low / kDegree},
              {"high90_deg", p.interval90_rad.high / kDegree},
              {"mean_deg", p.mean_rad / kDegree},
              {"sd_deg", p.sd_rad / kDegree},
              {"scatter_median_deg", p.scatter_median_rad / kDegree},
              {"scatter_low95_deg", p.scatter95_rad.low / kDegree},
              {"scatter_high95_deg", p.scatter95_rad.high / kDegree},
              {"lapse", p.lapse},
              {"binned", p.binned},
              {"method", "grid posterior, probit link, errors in the angle"},
              {"prior", PriorJson(group.prior)},
              {"cautious_prior",
               p.cautious_prior ? PriorJson(*p.cautious_prior) : Json(nullptr)},
              {"sharp_prior",
               p.sharp_prior ? PriorJson(*p.sharp_prior) : Json(nullptr)},
              {"low95_one_prior_deg", analysis::Quantile(p, 0.025) / kDegree},
              {"high95_one_prior_deg", analysis::Quantile(p, 0.975) / kDegree}};
  // The same trials under other priors: how much of the answer is the prior's.
  Json sensitivity = Json::array();
  for (const auto& line : p.sensitivity) {
    Json row = PriorJson(line.prior);
    row["median_deg"] = line.median_rad / kDegree;
    row["low95_deg"] = line.interval95_rad.low / kDegree;
    row["high95_deg"] = line.interval95_rad.high / kDegree;
    sensitivity.push_back(std::move(row));
  }
  out["sensitivity"] = std::move(sensitivity);
  return out;
}

// Why the campaign may end, in the word of the document; "go-on" where it may
// not.
std::string StopWord(analysis::StopReason stop) {
  switch (stop) {
    case analysis::StopReason::kTargetReached:
      return "target-reached";
    case analysis::StopReason::kMaxTrials:
      return "max-trials";
    case analysis::StopReason::kNone:
      break;
  }
  return "go-on";
}

// One trial as a row of the report: what the statistics take of it, and why
// they leave it out (`left_out`, null where they do not).
Json TrialJson(const core::Trial& trial, const std::string* left_out) {
  const core::StateDecision& state = trial.first.state;
  return {
      {"id", trial.id},
      {"revision", trial.revision},
      {"clip", trial.clip.path},
      {"set_angle_deg", DegreesJson(trial.set_angle_rad)},
      {"angle_deg", Quantity(core::ContactAngle(trial), kDegree)},
      {"state", std::string(core::Name(state.label))},
      {"paper_word", PaperWord(state.label)},
      {"p_bounce", Optional(state.p_bounce)},
      {"max_gap_mm", Quantity(state.max_gap_m, kMillimetre)},
      {"extrapolated_gap_mm", Quantity(state.extrapolated_gap_m, kMillimetre)},
      {"state_because", state.reason},
      {"bounce_height_mm", Quantity(state.bounce_height_m, kMillimetre)},
      {"micro_bounce", state.micro_bounce},
      {"left_out", left_out != nullptr ? Json(*left_out) : Json(nullptr)}};
}

// One quantity of the check shots, each value with the id of its trial, and the
// control chart; `chart` is null below two values. Limits and centre have the
// unit of the quantity; `beyond` are indices into `values`.
Json CheckSeriesJson(const CheckSeries& series, const CheckShots& checks,
                     std::span<const core::Trial> trials) {
  Json out = {{"quantity", series.quantity},
              {"sentence", CheckSentence(series)},
              {"values", Json::array()},
              {"chart", nullptr}};
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    out["values"].push_back(
        {{"trial", trials[checks.shots[series.shots[i]]].id},
         {"value", series.values[i].value},
         {"u", series.values[i].u}});
  }
  if (series.chart) {
    out["chart"] = {{"centre", series.chart->centre},
                    {"sigma", series.chart->sigma},
                    {"lower", series.chart->lower},
                    {"upper", series.chart->upper},
                    {"beyond", series.chart->beyond},
                    {"provisional", series.chart->provisional}};
  }
  return out;
}

// The check shots of one campaign and origin: touchdown speed and approach
// angle.
Json CheckShotsJson(const CheckShots& checks,
                    std::span<const core::Trial> trials) {
  return {
      {"campaign", checks.campaign.name},
      {"origin", std::string(core::Name(checks.origin))},
      {"shots", checks.shots.size()},
      {"speed_mps", CheckSeriesJson(checks.speed, checks, trials)},
      {"approach_angle_deg", CheckSeriesJson(checks.angle, checks, trials)}};
}

}  // namespace

Json BoundaryJson(const Group& group) {
  const auto& study = group.study;
  const auto& l = study.likelihood;
  const auto& bracket = study.bracket;
  Json out = {{"campaign", group.trials.campaign},
              {"body", std::string(core::Name(group.trials.body))},
              {"angle_kind", std::string(core::Name(group.trials.angle_kind))},
              {"origin", std::string(core::Name(group.trials.origin))},
              {"simulated", group.simulated()},
              {"counts",
               {{"slide", study.counts.not_bounce},
                {"bounce", study.counts.bounce},
                {"undecided", study.counts.undecided},
                {"left_out", group.trials.left_out.size()}}},
              {"status", std::string(analysis::Name(study.posterior.status))},
              {"status_text", StatusSentence(study)},
              {"few_trials", study.posterior.few_trials},
              {"bracket",
               {{"low_deg", DegreesJson(bracket.low_rad)},
                {"high_deg", DegreesJson(bracket.high_rad)},
                {"separated", bracket.closed()}}},
              {"posterior", PosteriorJson(group)},
              {"likelihood",
               {{"estimate_deg", l.has_estimate ? Json(l.estimate_rad / kDegree)
                                                : Json(nullptr)},
                {"low95_deg", l.interval95_rad.low / kDegree},
                {"high95_deg", l.interval95_rad.high / kDegree},
                {"open_low", l.open_low},
                {"open_high", l.open_high},
                {"scatter_deg", l.has_estimate ? Json(l.scatter_rad / kDegree)
                                               : Json(nullptr)}}},
              {"margin_deg", study.margin_rad / kDegree}};
  // `notes` runs beside `theories`: where each comes from.
  Json theories = Json::array();
  for (std::size_t i = 0; i < study.theories.size(); ++i) {
    theories.push_back(TheoryJson(study.theories[i], group.notes[i]));
  }
  out["theory"] = std::move(theories);
  out["next"] = {{"angle_deg", study.next.angle_rad / kDegree},
                 {"expected_sd_deg", study.next.expected_sd_rad / kDegree},
                 {"trials_to_target", study.next.trials_to_target},
                 {"half_width_deg", study.next.half_width_rad / kDegree},
                 {"clipped", study.next.clipped},
                 {"stop", StopWord(study.next.stop)},
                 {"within_deg", DegreesJson(group.reach)}};
  // The sentences of the page, so that what a script prints says the same.
  out["sentences"] = {{"boundary", BoundarySentence(study)},
                      {"bracket", BracketSentence(bracket)},
                      {"status", StatusSentence(study)},
                      {"verdict", VerdictWord(group)},
                      {"verdict_reason", VerdictSentence(group)},
                      {"outlook", OutlookSentence(group)},
                      {"next", NextSentence(group)}};
  out["left_out"] = Json::array();
  for (const NamedLeftOut& left : group.left_out) {
    out["left_out"].push_back(
        {{"trial", left.trial}, {"name", left.name}, {"reason", left.reason}});
  }
  return out;
}

Json BoundaryDocument(std::span<const Group> groups) {
  Json out = {{"schema", "touchdown.boundary/1"}};
  // A script for one campaign reads the fields without a step into an array.
  if (groups.size() == 1) {
    out.update(BoundaryJson(groups.front()));
    return out;
  }
  out["groups"] = Json::array();
  for (const Group& group : groups)
    out["groups"].push_back(BoundaryJson(group));
  return out;
}

namespace {

// A check pooled over the trials, or {"absent": reason}.
Json CheckJson(const core::Expected<analysis::PooledCheck>& check) {
  if (!check) return {{"absent", check.error().reason}};
  return {{"trials", check->trials},
          {"ratio", {{"value", check->ratio.value}, {"u", check->ratio.u}}},
          {"z", check->z},
          {"failed", check->failed},
          {"shows", check->shows}};
}

// Gravity, size and restitution over all trials of the group.
Json ChecksJson(const Group& group, std::span<const core::Trial> trials) {
  const CampaignChecks checks = CheckCampaign(group.members, trials);
  return {{"gravity", CheckJson(checks.gravity)},
          {"size", CheckJson(checks.size)},
          {"restitution", CheckJson(checks.restitution)},
          {"failed", checks.Failed()},
          {"explanation",
           checks.Failed() ? checks.explanation : WhatChecksShow(checks)}};
}

}  // namespace

Json ReportDocument(const ReportInput& input, std::span<const Group> groups,
                    std::span<const core::Trial> trials) {
  Json out = {{"schema", "touchdown.report/1"},
              {"software", {{"version", input.software_version}}},
              {"source", input.source},
              {"options", input.options},
              {"groups", Json::array()}};
  for (const Group& group : groups) {
    Json entry = BoundaryJson(group);
    if (group.simulated()) entry["watermark"] = kWatermark;
    const auto left_out = ReasonsLeftOut(group);
    entry["campaign_checks"] = ChecksJson(group, trials);
    entry["trials"] = Json::array();
    for (const std::size_t t : group.members) {
      const auto why = left_out.find(t);
      entry["trials"].push_back(
          TrialJson(trials[t], why == left_out.end() ? nullptr : &why->second));
    }
    out["groups"].push_back(std::move(entry));
  }
  out["check_shots"] = Json::array();
  for (const CheckShots& checks : CollectCheckShots(input, trials)) {
    out["check_shots"].push_back(CheckShotsJson(checks, trials));
  }
  return out;
}

}  // namespace touchdown::report
