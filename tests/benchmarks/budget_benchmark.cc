// First-order uncertainties against Monte Carlo (JCGM 101), trial by trial: a
// table in Markdown. Argument: most draws of a trial (default 100000).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/accuracy/monte_carlo.h"
#include "touchdown/core/estimate.h"

int main(int argc, char** argv) {
  using touchdown::accuracy::DrawOptions;
  const unsigned long most =
      argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100000;
  DrawOptions options;
  options.most = std::max<std::size_t>(options.least, most / options.batch);
  fmt::print(
      "| trial | quantity | draws | absent | value | u, first order | u, drawn "
      "| ratio - 1, % | ends apart, u | tolerance (1 digit), u | agrees |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|\n");
  unsigned seed = 0;
  for (const auto& trial : touchdown::accuracy::BudgetTrials()) {
    std::mt19937_64 engine(++seed);
    for (const auto& s :
         touchdown::accuracy::DrawnSpreads(trial, options, engine)) {
      const double tolerance = s.Tolerance(1);
      fmt::print(
          "| {} | {} | {} | {} | {:.5f} | {:.3g} | {:.3g} | {:.1f} | "
          "{:.2f} | {:.2f} | {} |\n",
          trial.name, s.quantity, s.draws, s.absent, s.first_order.value,
          s.first_order.u, s.u, 100.0 * (s.first_order.u / s.u - 1.0),
          s.FarthestEnd() / s.u, tolerance / s.u,
          s.FarthestEnd() < tolerance ? "yes" : "no");
    }
  }
}
