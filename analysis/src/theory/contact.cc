#include "touchdown/analysis/theory/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "theory/contact_core.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Within this range of inputs no product of the evaluation leaves double: the
// longest, kappa mu R omega^2 / A_hat with A_hat >= u, has five such factors.
constexpr double kComfortableLow = 1e-50;
constexpr double kComfortableHigh = 1e50;

bool IsComfortable(double x) {
  const double size = std::abs(x);
  return size == 0.0 || (size >= kComfortableLow && size <= kComfortableHigh);
}

bool FitsDouble(const ContactProblem& p) {
  return IsComfortable(p.mu) && IsComfortable(p.mass_kg) &&
         IsComfortable(p.radius_m) && IsComfortable(p.kappa) &&
         IsComfortable(p.gyration_radius_m) &&
         IsComfortable(p.omega_rad_per_s) && IsComfortable(p.gravity_mps2) &&
         IsComfortable(p.alpha.sin) && IsComfortable(p.alpha.cos) &&
         (p.gyration_radius_m == 0.0 ||
          IsComfortable(p.radius_m / p.gyration_radius_m));
}

void CheckContactProblem(const ContactProblem& p) {
  core::RequireFinite("sin alpha", p.alpha.sin);
  core::RequireFinite("cos alpha", p.alpha.cos);
  core::RequireNotNegative("mu", p.mu);
  core::RequirePositive("mass", p.mass_kg, "kg");
  core::RequirePositive("radius", p.radius_m, "m");
  core::RequireNotNegative("kappa", p.kappa);
  core::RequireNotNegative("radius of gyration", p.gyration_radius_m, "m");
  core::RequireFinite("omega", p.omega_rad_per_s, "rad/s");
  core::RequireNotNegative("gravity", p.gravity_mps2, "m/s^2");
}

// Unit roundoffs of double and of the mantissa that long double has at least.
constexpr double kUlp = 0x1p-53;
constexpr long double kWideUlp = 0x1p-64L;

template <class T>
ContactCore<T> Solved(const ContactProblem& p, T ulp) {
  ContactCore<T> core(p, ulp);
  if (p.slip == Slip::kNone) {
    core.Rest();
  } else {
    core.Slide();
  }
  return core;
}

template <class T>
void CopySolutions(const ContactCore<T>& core, double mass_kg,
                   ContactResult& out) {
  const T mass = static_cast<T>(mass_kg);
  out.n_solutions = core.n_;
  for (int i = 0; i < core.n_; ++i) {
    const CoreSolution<T>& from = core.solution_[static_cast<std::size_t>(i)];
    out.solution[static_cast<std::size_t>(i)] = {
        from.kind,
        static_cast<double>(mass * from.normal),
        static_cast<double>(mass * from.tangential),
        static_cast<double>(from.normal_acc),
        static_cast<double>(from.tangential_acc),
        static_cast<double>(from.residual)};
  }
}

// Change of the input that brings `value` to 0, to first order.
template <class T>
double Margin(T value, T slope) {
  if (slope == 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(-value / slope);
}

template <class T>
ContactMargins ComputeMargins(const ContactCore<T>& k,
                              const ContactProblem& p) {
  ContactMargins out;
  const T s = k.s_;
  const T c = k.c_;
  if (p.slip != Slip::kNone) {
    const T slip_mu = static_cast<T>(k.sign_) * k.mu_;
    out.a_hat_alpha_rad =
        Margin(k.a_, -k.kappa_ * (2 * s * c + slip_mu * (c - s) * (c + s)));
    out.a_hat_mu = Margin(k.a_, static_cast<T>(-k.sign_) * k.g_nt_);
    out.a_hat_kappa = Margin(k.a_, c * (c - slip_mu * s));
  } else if (k.stick_n_ > 0) {
    out.cone_mu =
        static_cast<double>(k.mu_ - std::abs(k.stick_t_) / k.stick_n_);
  }
  const T omega = static_cast<T>(p.omega_rad_per_s);
  const T radius = static_cast<T>(p.radius_m);
  out.b_alpha_rad = Margin(k.b_, k.centripetal_ * c);
  out.b_omega_rad_per_s = Margin(k.b_, 2 * radius * omega * s);
  out.b_radius_m = Margin(k.b_, omega * omega * s);
  out.b_gravity_mps2 = static_cast<double>(k.b_);
  return out;
}

template <class T>
ContactResult Report(const ContactCore<T>& core, const ContactProblem& p) {
  ContactResult out;
  out.regime = core.regime_;
  out.tolerant_regime = core.regime_;
  out.within_tolerance = core.within_;
  CopySolutions(core, p.mass_kg, out);
  // Tolerances are those of double whatever the arithmetic: they say what the
  // rounding of the inputs leaves open.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  out.b_mps2 = static_cast<double>(core.b_);
  out.b_tolerance_mps2 = static_cast<double>(8 * kUlp * core.b_size_);
  out.b_condition = core.b_ == 0
                        ? (core.b_size_ == 0 ? 1.0 : kInfinity)
                        : static_cast<double>(core.b_size_ / std::abs(core.b_));
  if (p.slip != Slip::kNone) {
    out.a_hat = static_cast<double>(core.a_);
    out.a_hat_tolerance = static_cast<double>(8 * kUlp * core.a_size_);
    out.a_hat_condition =
        core.a_ == 0 ? kInfinity
                     : static_cast<double>(core.a_size_ / std::abs(core.a_));
  }
  out.margins = ComputeMargins(core, p);
  return out;
}

}  // namespace

ContactProblem SphereContact(double mass_kg, double radius_m, double kappa,
                             double mu, Slip slip, double gravity_mps2) {
  ContactProblem p;
  p.alpha = SinCosOfDegrees(90.0);
  p.mu = mu;
  p.slip = slip;
  p.mass_kg = mass_kg;
  p.radius_m = radius_m;
  p.kappa = kappa;
  p.gravity_mps2 = gravity_mps2;
  return p;
}

ContactResult SolveContact(const ContactProblem& problem) {
  CheckContactProblem(problem);
  if (FitsDouble(problem)) {
    const auto core = Solved<double>(problem, kUlp);
    if (!core.within_) return Report(core, problem);
  }
  const auto wide = Solved<long double>(problem, kUlp);
  ContactResult out = Report(wide, problem);
  if (wide.within_ && problem.alpha.has_low) {
    const auto certified = Solved<long double>(problem, kWideUlp);
    if (!certified.within_) {
      out = Report(certified, problem);
      out.tolerant_regime = wide.regime_;
      out.within_tolerance = true;
    }
  }
  return out;
}

// Plain arithmetic: without hardware support in the baseline of x86-64 a fused
// multiply-add is a function call, and the rounding it saves is far below the
// tolerance that guards the signs.
QuickContact SolveSlidingContact(const ContactProblem& p) {
  const double s = p.alpha.sin;
  const double c = p.alpha.cos;
  const double kappa = p.gyration_radius_m > 0.0
                           ? (p.radius_m / p.gyration_radius_m) *
                                 (p.radius_m / p.gyration_radius_m)
                           : p.kappa;
  const double kappa_c = kappa * c;
  const double slip_mu_s = Sign(p.slip) * p.mu * s;
  const double centripetal_s =
      p.radius_m * p.omega_rad_per_s * p.omega_rad_per_s * s;
  const double a = 1.0 + kappa_c * (c - slip_mu_s);
  const double b = centripetal_s - p.gravity_mps2;
  // A few roundings of each term: what is nearer to zero than this may be zero.
  constexpr double kTolerance = 8 * kUlp;
  const double a_tolerance =
      kTolerance *
      (1.0 + std::abs(kappa_c) * (std::abs(c) + std::abs(slip_mu_s)));
  const double b_size = std::abs(centripetal_s) + p.gravity_mps2;
  const double b_tolerance = kTolerance * b_size;
  // Anything that overflowed or vanished shows here; NaN fails too.
  constexpr double kFloor = 1e-250;
  constexpr double kCeiling = 1e250;
  if (!(a_tolerance < kCeiling && b_size < kCeiling && b_size > kFloor))
      [[unlikely]] {
    const auto wide = Solved<long double>(p, kUlp);
    // The sliding solution comes last; where there is none, F_n is 0 in all.
    const auto& last = wide.solution_[wide.n_ > 1 ? 1 : 0];
    return {wide.regime_, static_cast<double>(last.normal)};
  }
  const int a_sign = ContactCore<double>::SignBeyondTolerance(a, a_tolerance);
  const int b_sign = ContactCore<double>::SignBeyondTolerance(b, b_tolerance);
  const Regime regime = ContactCore<double>::ClassifyRegime(a_sign, b_sign);
  if (a_sign == 0 || b_sign == 0) [[unlikely]]
    return {regime, 0.0};
  // Where the signs are equal nothing slides and -b/a is negative: a maximum
  // instead of a branch that nobody could predict.
  return {regime, std::max(0.0, -b / a)};
}

Wedge PainleveWedge(double kappa, double mu) {
  core::RequirePositive("kappa", kappa);
  core::RequireNotNegative("mu", mu);
  // (kappa mu)^2 - 4 (1 + kappa), as a product so that it keeps its digits near
  // the critical friction.
  const double half = 2.0 * std::sqrt(1.0 + kappa);
  const double discriminant = (kappa * mu - half) * (kappa * mu + half);
  if (!(discriminant >= 0.0)) return {};
  const double sum = kappa * mu + std::sqrt(discriminant);
  return {true, std::atan(2.0 * (1.0 + kappa) / sum), std::atan(sum / 2.0)};
}

std::string_view Name(Regime regime) {
  switch (regime) {
    case Regime::kSlide:
      return "SLIDE";
    case Regime::kDetach:
      return "DETACH";
    case Regime::kIndeterminate:
      return "INDETERMINATE";
    case Regime::kInconsistent:
      return "INCONSISTENT";
    case Regime::kGraze:
      return "GRAZE";
    case Regime::kAZeroDetach:
      return "A_ZERO_DETACH";
    case Regime::kAZeroNone:
      return "A_ZERO_NONE";
    case Regime::kDegenerate:
      return "DEGENERATE";
    case Regime::kStick:
      return "STICK";
    case Regime::kSlipLeading:
      return "SLIP+";
    case Regime::kSlipTrailing:
      return "SLIP-";
    case Regime::kStickOrSlip:
      return "STICK_OR_SLIP";
  }
  return "";
}

std::string_view Name(SolutionKind kind) {
  switch (kind) {
    case SolutionKind::kDetach:
      return "detach";
    case SolutionKind::kSlide:
      return "slide";
    case SolutionKind::kStick:
      return "stick";
    case SolutionKind::kSlipLeading:
      return "slip+";
    case SolutionKind::kSlipTrailing:
      return "slip-";
  }
  return "";
}

}  // namespace touchdown::analysis
