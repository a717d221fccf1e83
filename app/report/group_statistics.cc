// The numbers of a group, in the order in which they should be read: estimate,
// distance to theory, equivalence, agreement of labels.
#include <fmt/core.h>

#include <cmath>

#include "app/report/content.h"
#include "app/report/sentences.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

// "11.6 to 13.1" in degrees.
std::string IntervalText(const core::Interval& interval, int decimals) {
  return fmt::format("{:.{}f} to {:.{}f}", interval.low / kDegree, decimals,
                     interval.high / kDegree, decimals);
}

// An angle in degrees, without its unit, which stands in the heading.
std::string AngleText(double angle_rad, int decimals) {
  return fmt::format("{:.{}f}", angle_rad / kDegree, decimals);
}

// "0.664 to 1.000": an interval of a proportion.
std::string Share(const core::Interval& interval) {
  return fmt::format("{:.3f} to {:.3f}", interval.low, interval.high);
}

// A prior on the scatter in words, with its median in degrees.
std::string PriorName(const analysis::ScatterPrior& prior) {
  if (!prior.log_sd) {
    return fmt::format("scatter half-Cauchy, half of it below {} deg",
                       Plain(prior.median_rad / kDegree));
  }
  // One standard deviation of the logarithm is a factor up or down.
  return fmt::format("scatter about {} deg, a factor {} either way",
                     Plain(prior.median_rad / kDegree),
                     Plain(std::exp(*prior.log_sd), 1));
}

// The boundary by the posterior, by the same with other priors, and by the
// likelihood alone; then the scatter. Readers see at once whether the prior
// made the answer.
Table MakeEstimates(const Group& group, const analysis::ScatterPrior& prior) {
  const auto& p = group.study.posterior;
  const auto& l = group.study.likelihood;
  // All rows have the digits that the posterior's sd allows.
  const int decimals = Decimals(p.sd_rad / kDegree);
  Table table{"The boundary angle",
              {{"method"},
               {"boundary (deg)", true},
               {"95 % interval (deg)", true},
               {"remark"}},
              {}};
  std::string remark = PriorName(prior);
  // The interval in the table may hold under other priors, too; the remark has
  // the narrower one under the first alone.
  if (p.cautious_prior || p.sharp_prior) {
    remark +=
        fmt::format(", alone {}", IntervalText({analysis::Quantile(p, 0.025),
                                                analysis::Quantile(p, 0.975)},
                                               decimals));
  }
  if (p.cautious_prior) {
    remark += fmt::format(
        "; the 95 % interval holds under {}, too, as outcomes that do not "
        "overlap tell nothing of the scatter",
        PriorName(*p.cautious_prior));
  }
  if (p.sharp_prior) {
    remark += fmt::format(
        "; the 95 % interval holds under {}, too, as trials at few angles do "
        "not tell a small scatter",
        PriorName(*p.sharp_prior));
  }
  table.rows.push_back({{"posterior median"},
                        {AngleText(p.median_rad, decimals)},
                        {IntervalText(p.interval95_rad, decimals)},
                        {fmt::format("{}; 90 %: {} deg; sd {} deg", remark,
                                     IntervalText(p.interval90_rad, decimals),
                                     AngleText(p.sd_rad, decimals))}});
  for (const auto& line : p.sensitivity) {
    table.rows.push_back({{"the same, other prior"},
                          {AngleText(line.median_rad, decimals)},
                          {IntervalText(line.interval95_rad, decimals)},
                          {PriorName(line.prior)}});
  }
  // An open end: the likelihood falls too little on that side to bound the
  // angle.
  remark = l.has_estimate ? "no prior" : "no estimate, no prior";
  if (l.open_low) remark += "; open below";
  if (l.open_high) remark += "; open above";
  if (l.has_estimate && l.scatter_rad == 0.0) {
    remark += "; middle of the flat top, scatter not told from 0";
  }
  table.rows.push_back(
      {{"likelihood profile"},
       {l.has_estimate ? AngleText(l.estimate_rad, decimals) : ""},
       {IntervalText(l.interval95_rad, decimals)},
       {remark}});
  table.rows.push_back(
      {{"scatter of the boundary"},
       {AngleText(p.scatter_median_rad, decimals)},
       {IntervalText(p.scatter95_rad, decimals)},
       {"posterior; what a boundary varies from trial to trial"}});
  return table;
}

// Each theory of the group: its distance from the boundary, how probable it is
// that the two are equal within the margin, and the verdict on the declared
// one.
Table MakeTheories(const Group& group) {
  Table table{"Boundary angles of theory beside the trials",
              {{"theory"},
               {fmt::format("value {} u (deg)", kPlusMinus), true},
               {"median minus theory (deg)", true},
               {"E_n", true},
               {"P(boundary below it)", true},
               {fmt::format("P(within {} {} deg)", kPlusMinus,
                            Plain(group.study.margin_rad / kDegree)),
                true},
               {"margin that the 90 % interval fits (deg)", true},
               {"verdict"},
               {"where it comes from"}},
              {}};
  for (std::size_t i = 0; i < group.study.theories.size(); ++i) {
    const auto& t = group.study.theories[i];
    const auto& verdict = t.judgement.verdict;
    table.rows.push_back(
        {{t.theory.name + (t.declared ? " (declared)" : "")},
         {WithU({t.theory.boundary_rad, t.theory.u_rad, {}}, kDegree)},
         {Signed(t.difference_rad / kDegree,
                 Decimals(group.study.posterior.sd_rad / kDegree))},
         {Signed(t.e_n, 2)},
         {Probability(t.p_below)},
         {Probability(t.p_within)},
         {fmt::format("{:.1f}", t.smallest_margin_rad / kDegree)},
         {verdict      ? std::string(core::Name(*verdict))
          : t.declared ? "none"
                       : "for information"},
         {group.notes[i], Tone::kMuted}});
  }
  return table;
}

// What the theory predicted against what was seen, in the paper's two words.
// Rows: prediction; trials too near to the boundary to decide are a row of
// their own.
Table MakeConfusion(const Group& group, const analysis::TheoryComparison& t) {
  const auto& a = t.agreement;
  Table table{fmt::format("Predicted by {} {} deg, and seen", t.theory.name,
                          Plain(t.theory.boundary_rad / kDegree)),
              {{"prediction"}, {"seen: slide", true}, {"seen: bounce", true}},
              {}};
  const auto number = [](int n) { return Cell{fmt::format("{}", n)}; };
  table.rows.push_back({{"slide"},
                        number(a.deciding.slide_slide),
                        number(a.deciding.slide_bounce)});
  table.rows.push_back({{"bounce"},
                        number(a.deciding.bounce_slide),
                        number(a.deciding.bounce_bounce)});
  table.rows.push_back(
      {{"too near to tell (within 2 u of the boundary)"},
       number(a.all.slide_slide + a.all.bounce_slide - a.deciding.slide_slide -
              a.deciding.bounce_slide),
       number(a.all.slide_bounce + a.all.bounce_bounce -
              a.deciding.slide_bounce - a.deciding.bounce_bounce)});
  if (group.study.counts.undecided > 0) {
    table.rows.push_back({{fmt::format("motion state undecided: {}",
                                       group.study.counts.undecided)},
                          {""},
                          {""}});
  }
  return table;
}

// The proportion of right predictions among the trials that decide, with two
// intervals: Wilson's, and the more cautious one of Clopper and Pearson. Kappa
// and Matthews' correlation take off what chance would get right.
std::string AgreementNumbers(const analysis::TheoryComparison& t) {
  const auto& m = t.agreement.deciding;
  if (m.total() == 0) return "No trial decides anything about this theory.";
  std::string text = fmt::format(
      "Of the {} trials that decide, {} agree: proportion {:.3f}, 95 % "
      "interval {} (Wilson), {} (Clopper and Pearson).",
      m.total(), m.right(), static_cast<double>(m.right()) / m.total(),
      Share(*t.wilson95), Share(*t.clopper_pearson95));
  if (t.kappa) {
    text += fmt::format(
        " Cohen's kappa {:.3f} (standard error {:.3f}; {:.3f} "
        "under chance)",
        t.kappa->kappa, t.kappa->ase, t.kappa->ase0);
    if (t.matthews) {
      text += fmt::format(", Matthews' correlation {:.3f}", *t.matthews);
    }
    text += ".";
  }
  return text;
}

// All about the theories; confusion and agreement for the first one only, which
// is the declared theory where there is one.
std::vector<Block> MakeComparison(const Group& group) {
  std::vector<Block> out;
  out.push_back(MakeTheories(group));
  const auto& first = group.study.theories.front();
  if (first.declared) {
    // Said only of a declared theory: no other gets a verdict.
    const double theory = first.theory.boundary_rad;
    const double margin = group.study.margin_rad;
    out.push_back(Paragraph{
        fmt::format(
            "Equivalence (two one-sided tests) at the margin of {} deg: "
            "P(boundary below {} deg): {}, P(above {} deg): {}; both under "
            "0.05 "
            "is one of the things that confirmed needs. |E_n| up to 1 is "
            "called "
            "compatible, which is not the same as confirmed.",
            Plain(margin / kDegree), Plain((theory - margin) / kDegree),
            Probability(first.p_too_low), Plain((theory + margin) / kDegree),
            Probability(first.p_too_high)),
        true});
  }
  out.push_back(MakeConfusion(group, first));
  out.push_back(Paragraph{AgreementSentence(first)});
  out.push_back(Paragraph{AgreementNumbers(first), true});
  return out;
}

}  // namespace

Section MakeStatistics(const Group& group,
                       std::span<const core::Trial> trials) {
  Section section{group.simulated(), {}};
  auto& out = section.blocks;
  out.push_back(Heading{2, "Annex: statistics of " + FullName(group)});
  out.push_back(MakeEstimates(group, group.prior));
  out.push_back(Paragraph{StatusSentence(group.study), true});
  if (!group.study.theories.empty()) {
    for (Block& block : MakeComparison(group)) out.push_back(std::move(block));
  }
  for (Block& block : MakeDependence(group, trials)) {
    out.push_back(std::move(block));
  }
  return section;
}

}  // namespace touchdown::report
