// One group of trials: facts, comparison, every trial.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/report/boundary_plot.h"
#include "app/report/content.h"
#include "app/report/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

std::string SizeText(const core::Body& body) {
  if (body.kind == core::BodyKind::kSphere) {
    return "diameter " + WithUOrReason(body.diameter_m, kMillimetre) +
           (body.diameter_m ? " mm" : "");
  }
  return "sides " + WithUOrReason(body.long_m, kMillimetre) +
         (body.long_m ? " mm" : "") + " and " +
         WithUOrReason(body.short_m, kMillimetre) + (body.short_m ? " mm" : "");
}

// The one bounce height of the trials, or that they differ.
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
  if (high - low < 1e-9) return Plain(low / kMillimetre, 3) + " mm";
  return fmt::format(
      "{} to {} mm: NOT the same for all trials, so they are not strictly "
      "comparable",
      Plain(low / kMillimetre, 3), Plain(high / kMillimetre, 3));
}

Table MakeFacts(const Group& group, std::span<const core::Trial> trials) {
  const core::Campaign& c = group.campaign;
  Table table{"", {{"campaign"}, {c.name.empty() ? "(none)" : c.name}}, {}};
  const auto row = [&](std::string name, std::string value) {
    table.rows.push_back({{std::move(name)}, {std::move(value)}});
  };
  row("origin of the trials", std::string(core::Name(group.trials.origin)));
  row("body",
      fmt::format("{}, {}", core::Name(group.trials.body), SizeText(c.body)));
  row("surface", c.surface.empty() ? "not recorded" : c.surface);
  row("contact angle", AngleName(group) + " at touchdown");
  row("bounce height", BounceHeightText(group, trials));
  if (c.speed_max_mps > 0.0) {
    row("speed band at touchdown",
        fmt::format("{} to {} m/s", Plain(c.speed_min_mps),
                    Plain(c.speed_max_mps)));
  }
  row("declared theory",
      group.judgement
          ? fmt::format(
                "{}: {} deg, margin {} deg", c.theory_name,
                WithU({*c.theory_boundary_rad, c.theory_u_rad}, kDegree),
                Plain(c.margin_rad / kDegree))
          : "none declared before the first trial");
  row("trials",
      fmt::format("{} slide, {} bounce, {} undecided; {} left out",
                  group.counts.not_bounce, group.counts.bounce,
                  group.counts.undecided, group.trials.left_out.size()));
  row("what the trials alone say", BracketText(group.bracket));
  return table;
}

// Mean and root mean square of measured minus set angle.
std::string SetPointText(const Group& group) {
  double sum = 0.0;
  double squares = 0.0;
  int n = 0;
  for (const auto& o : group.trials.observations) {
    if (!o.set_angle_rad) continue;
    const double error_deg = (o.angle_rad - *o.set_angle_rad) / kDegree;
    sum += error_deg;
    squares += error_deg * error_deg;
    ++n;
  }
  if (n == 0) return "";
  return fmt::format(
      "Measured minus set angle over {} trials: mean {:+.3f} deg, root mean "
      "square {:.3f} deg.",
      n, sum / n, std::sqrt(squares / n));
}

// theory.md E6.
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

Cell StateCell(const core::StateDecision& state) {
  const std::string word = PaperWord(state.label);
  const Tone tone = word == "slide"    ? Tone::kSlide
                    : word == "bounce" ? Tone::kBounce
                                       : Tone::kUndecided;
  std::string text(core::Name(state.label));
  if (state.micro_bounce) text += " (micro-bounce)";
  return {text, tone};
}

Cell AgreesCell(const core::Trial& trial, const analysis::Observation* o,
                const Compared& compared) {
  if (o == nullptr) return {"left out", Tone::kMuted};
  if (o->outcome == analysis::Outcome::kUndecided) {
    return {"undecided", Tone::kUndecided};
  }
  const double boundary = compared.theory.boundary.boundary_rad;
  if (analysis::DecidesNothing(*o, boundary)) {
    return {"decides nothing", Tone::kMuted};
  }
  const bool bounced = trial.first.state.label == core::MotionState::kBounce;
  return (o->angle_rad > boundary) == bounced ? Cell{"yes", Tone::kGood}
                                              : Cell{"no", Tone::kBad};
}

Table MakeTrialTable(const Group& group, std::span<const core::Trial> trials) {
  Table table;
  table.caption = "Every trial";
  table.columns = {
      {"set (deg)", true},
      {fmt::format("{} {} u (deg)", AngleName(group), kPlusMinus), true},
      {"motion state"},
      {"paper's word"},
      {"P(bounce)", true},
      {fmt::format("greatest gap {} u (mm)", kPlusMinus), true}};
  const Compared* theory =
      group.compared.empty() ? nullptr : &group.compared.front();
  if (theory != nullptr) {
    table.columns.push_back(
        {fmt::format("agrees with {} {} deg?", theory->theory.boundary.name,
                     Plain(theory->theory.boundary.boundary_rad / kDegree))});
  }
  table.columns.push_back({"clip or trial"});
  for (const std::size_t t : group.members) {
    const core::Trial& trial = trials[t];
    const core::StateDecision& state = trial.first.state;
    const auto found = std::find_if(
        group.trials.observations.begin(), group.trials.observations.end(),
        [t](const analysis::Observation& o) { return o.trial == t; });
    const analysis::Observation* o =
        found == group.trials.observations.end() ? nullptr : &*found;
    std::vector<Cell> row;
    row.push_back({trial.set_angle_rad ? Plain(*trial.set_angle_rad / kDegree)
                                       : std::string()});
    row.push_back({WithUOrReason(core::ContactAngle(trial), kDegree)});
    row.push_back(StateCell(state));
    row.push_back({PaperWord(state.label)});
    row.push_back({state.p_bounce ? fmt::format("{:.4f}", *state.p_bounce)
                                  : std::string("not filmed")});
    row.push_back({WithUOrReason(state.max_gap_m, kMillimetre)});
    if (theory != nullptr) row.push_back(AgreesCell(trial, o, *theory));
    row.push_back(
        {trial.clip.path.empty()
             ? trial.id
             : std::filesystem::path(trial.clip.path).filename().string(),
         Tone::kMuted});
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table MakeLeftOut(const Group& group, std::span<const core::Trial> trials) {
  Table table{"Left out of the statistics", {{"trial"}, {"reason"}}, {}};
  for (const auto& left : group.trials.left_out) {
    const core::Trial& trial = trials[left.trial];
    table.rows.push_back(
        {{trial.clip.path.empty() ? trial.id : trial.clip.path},
         {left.reason}});
  }
  return table;
}

Table MakeComparison(const Group& group) {
  Table table{"Boundary angles beside the trials",
              {{"theory"},
               {"boundary (deg)", true},
               {"agree", true},
               {"agree, without those within 2 u", true},
               {"decide nothing", true},
               {"same agreement for boundaries (deg)"},
               {"where it comes from"}},
              {}};
  for (const Compared& c : group.compared) {
    const analysis::Agreement& a = c.agreement;
    table.rows.push_back(
        {{c.theory.boundary.name + (c.declared ? " (declared)" : "")},
         {WithU({c.theory.boundary.boundary_rad, c.theory.boundary.u_rad},
                kDegree)},
         {fmt::format("{} of {}", a.all.right(), a.all.total())},
         {fmt::format("{} of {}", a.deciding.right(), a.deciding.total())},
         {fmt::format("{}", a.decides_nothing)},
         {HalfOpen(a.same_low_rad, a.same_high_rad, kDegree)},
         {c.theory.note}});
  }
  return table;
}

}  // namespace

Figure MakeFigure(const Group& group, std::size_t index) {
  BoundaryPlot plot;
  plot.angle_name = AngleName(group) + " at touchdown";
  plot.observations = group.trials.observations;
  plot.bracket = group.bracket;
  plot.simulated = group.simulated();
  plot.id = fmt::format("p{}", index);
  for (const Compared& c : group.compared) {
    plot.lines.push_back(
        {fmt::format("{} {} deg", c.theory.boundary.name,
                     Plain(c.theory.boundary.boundary_rad / kDegree)),
         c.theory.boundary.boundary_rad, c.theory.boundary.u_rad});
  }
  Figure figure;
  figure.svg = DrawBoundaryPlot(plot);
  figure.caption = fmt::format(
      "{}{}, {}: what was seen at each {}. Bars are {} 2 u (95 %). Shaded: the "
      "bracket, within which these trials prefer no boundary.",
      group.simulated() ? "Simulated. " : "", core::Name(group.trials.body),
      group.trials.campaign.empty() ? "no campaign" : group.trials.campaign,
      AngleName(group), kPlusMinus);
  figure.alt = fmt::format(
      "{}Plot of {} trials of a {} over the {} in degrees: {} slide, {} "
      "bounce, {} undecided; {}.",
      group.simulated() ? "Simulated trials. " : "",
      group.trials.observations.size(), core::Name(group.trials.body),
      AngleName(group), group.counts.not_bounce, group.counts.bounce,
      group.counts.undecided, BracketText(group.bracket));
  for (const Compared& c : group.compared) {
    figure.alt +=
        fmt::format(" Line: {} boundary at {} deg.", c.theory.boundary.name,
                    Plain(c.theory.boundary.boundary_rad / kDegree));
  }
  figure.data = {"",
                 {{AngleName(group) + " (deg)", true},
                  {"2 u (deg)", true},
                  {"P(bounce)", true}},
                 {}};
  for (const auto& o : group.trials.observations) {
    figure.data.rows.push_back({{Plain(o.angle_rad / kDegree, 3)},
                                {Plain(2 * o.u_rad / kDegree, 3)},
                                {Plain(o.p_bounce, 4)}});
  }
  return figure;
}

Callout MakeVerdict(const Group& group, std::span<const Group> groups) {
  Callout callout;
  const std::string name = ShortName(group, groups);
  std::string verdict = "no verdict: no theory was declared";
  if (group.judgement) {
    const auto& judged = group.judgement->verdict;
    if (judged) {
      verdict = std::string(core::Name(*judged));
      callout.tone = *judged == core::Verdict::kConfirmed      ? Tone::kGood
                     : *judged == core::Verdict::kContradicted ? Tone::kBad
                                                               : Tone::kPlain;
      callout.text = fmt::format("{}: {}. ", group.campaign.theory_name,
                                 group.judgement->reason);
    } else {
      verdict = "no verdict";
      callout.text = judged.error().reason + ". ";
      callout.text[0] = 'S';  // "Simulated trials ..."
    }
  } else if (group.simulated()) {
    verdict = "no verdict";
    callout.text =
        "Simulated trials yield no verdict on a theory: they test the "
        "software. ";
  }
  callout.title = fmt::format("{}: {}.", name, verdict);
  callout.text += fmt::format(
      "{} slide, {} bounce, {} undecided; {}. ", group.counts.not_bounce,
      group.counts.bounce, group.counts.undecided, BracketText(group.bracket));
  if (!group.compared.empty()) {
    callout.text += AgreementText(group.compared.front());
  }
  return callout;
}

Section MakeGroupSection(const Group& group, std::span<const Group> groups,
                         std::span<const core::Trial> trials) {
  Section section{group.simulated(), {}};
  auto& out = section.blocks;
  out.push_back(PageBreak{});
  out.push_back(Heading{
      2, fmt::format("{}: {}, {} trials",
                     group.trials.campaign.empty() ? "No campaign"
                                                   : group.trials.campaign,
                     AngleName(group), core::Name(group.trials.origin))});
  out.push_back(MakeFacts(group, trials));
  if (group.trials.angle_kind == core::AngleKind::kFace) {
    out.push_back(Callout{"Which angle.", FaceAngleText(group)});
  }
  out.push_back(MakeVerdict(group, groups));
  if (!group.compared.empty()) out.push_back(MakeComparison(group));
  const std::string set_point = SetPointText(group);
  if (!set_point.empty()) out.push_back(Paragraph{set_point});
  out.push_back(MakeTrialTable(group, trials));
  if (!group.trials.left_out.empty()) {
    out.push_back(MakeLeftOut(group, trials));
  }
  return section;
}

}  // namespace touchdown::report
