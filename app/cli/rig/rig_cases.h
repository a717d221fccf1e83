// `touchdown rig spring --cases IN.csv`: the numbers of many rigs at once,
// under the names of the reference cases, so that anyone can judge the program
// on others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace touchdown::cli {

struct RigCasesOptions {
  // Of the MC_ columns. 2e6: their u to 0.05 %, MC_se_of_u being u/sqrt(2
  // draws).
  std::size_t draws = 2'000'000;
  // Every row starts a generator of its own with it: no row depends on another.
  std::uint64_t seed = 12345;
};

// Reads id, G, d, n_active, n_total, D_outer, X, preload_X0, m, theta_deg, h0,
// rho_spring, eta, mu_barrel, g, n_springs, urel_G, urel_d, urel_n, urel_D,
// urel_X, urel_m (SI; column_hex wins over column) and, where it is there,
// L0_m; returns the CSV. A number that does not exist (the body does not leave
// the muzzle) is nan; the coil clearance without L0_m is empty. Throws
// core::InputError naming file, line and id.
std::string RigCases(const std::string& path, const RigCasesOptions& options);

}  // namespace touchdown::cli
