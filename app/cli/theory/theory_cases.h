// `touchdown theory ... --cases IN.csv`: the columns of a case file in, the
// computed columns out, as CSV text.
#pragma once

#include <string>

namespace touchdown::cli {

// In: id, alpha_rad, mu, slip_sign (-1, 0 at rest, 1), m, R, omega, g, and
// kappa_in or k_in.
std::string RegimeCases(const std::string& path);

// In: id, a, b, mu, slip_sign, m, g.
std::string FlatCases(const std::string& path);

// In: id, alpha, mu, kappa, R, vT0, vN0, alphadot0, e.
std::string ImpactCases(const std::string& path);

// In: id, R, omega, g: the spin boundary with its derivatives. With u_omega:
// what that uncertainty makes of it.
std::string BoundaryCases(const std::string& path);

// In: name or id, M and q: lists like [["2", "1/3"], ["0", "4"]] of decimals or
// fractions.
std::string LcpCases(const std::string& path);

}  // namespace touchdown::cli
