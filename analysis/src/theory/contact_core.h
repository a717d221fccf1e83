// The contact problem evaluated in one arithmetic: double, or long double where
// double has not the range or the digits.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "touchdown/analysis/theory/contact.h"

namespace touchdown::analysis {

static_assert(std::numeric_limits<long double>::max_exponent >= 16384,
              "the contact theory needs a long double of wider range than "
              "double, as on x86-64, AArch64 and RISC-V");

template <class T>
struct CoreSolution {
  SolutionKind kind = SolutionKind::kDetach;
  T normal = 0;          // F_n / m
  T tangential = 0;      // F_t / m
  T normal_acc = 0;      // g_N''
  T tangential_acc = 0;  // g_T''
  T residual = 0;
};

// By the signs of A_hat (rows) and b, each -1, 0, 1.
inline constexpr std::array<Regime, 9> kSignTable = {
    Regime::kInconsistent, Regime::kGraze,      Regime::kIndeterminate,
    Regime::kAZeroNone,    Regime::kDegenerate, Regime::kAZeroDetach,
    Regime::kSlide,        Regime::kGraze,      Regime::kDetach};

template <class T>
class ContactCore {
 public:
  // `ulp`: the unit roundoff that the tolerances are made of.
  ContactCore(const ContactProblem& p, T ulp)
      : tolerance_(8 * ulp),
        mu_(static_cast<T>(p.mu)),
        kappa_(ComputeKappa(p)),
        g_(static_cast<T>(p.gravity_mps2)),
        sign_(Sign(p.slip)) {
    s_ = static_cast<T>(p.alpha.sin);
    c_ = static_cast<T>(p.alpha.cos);
    if constexpr (!std::is_same_v<T, double>) {
      s_ += static_cast<T>(p.alpha.sin_low);
      c_ += static_cast<T>(p.alpha.cos_low);
    }
    const T omega = static_cast<T>(p.omega_rad_per_s);
    centripetal_ = static_cast<T>(p.radius_m) * omega * omega;
    b_ = Fma(centripetal_, s_, -g_);
    b_size_ = centripetal_ * std::abs(s_) + g_;
    g_nn_ = Fma(kappa_ * c_, c_, T(1));
    g_nt_ = kappa_ * s_ * c_;
    g_tt_ = Fma(kappa_ * s_, s_, T(1));
    a_size_ = g_nn_ + mu_ * std::abs(g_nt_);
  }

  static bool IsWithin(T value, T tolerance) {
    // A tolerance of 0 says that the value is exact.
    return std::abs(value) <= tolerance && tolerance > 0;
  }

  void Slide() {
    a_ = AHat(sign_);
    const T a_tolerance = tolerance_ * a_size_;
    const T b_tolerance = tolerance_ * b_size_;
    within_ = IsWithin(a_, a_tolerance) || IsWithin(b_, b_tolerance);
    const int a_sign = SignBeyondTolerance(a_, a_tolerance);
    const int b_sign = SignBeyondTolerance(b_, b_tolerance);
    regime_ = ClassifyRegime(a_sign, b_sign);
    if (a_sign == 0 && b_sign < 0) return;
    if (b_sign >= 0) AddDetach(b_sign == 0 ? T(0) : b_);
    if (a_sign * b_sign < 0) AddSlip(SolutionKind::kSlide, sign_, a_);
  }

  void Rest() {
    const T b_tolerance = tolerance_ * b_size_;
    const int b_sign = SignBeyondTolerance(b_, b_tolerance);
    if (b_sign == 0) {
      within_ = b_tolerance > 0;
      regime_ = Regime::kGraze;
      AddDetach(T(0));
      return;
    }
    // The sticking force, f = -G^-1 b.
    const T share = g_ / (1 + kappa_);
    stick_n_ = Fma(share, g_tt_, -centripetal_ * s_);
    stick_t_ = c_ * Fma(-kappa_ * s_, share, centripetal_);
    const T h_tolerance =
        tolerance_ *
        (mu_ * (share * g_tt_ + centripetal_ * std::abs(s_)) +
         std::abs(c_) * (centripetal_ + kappa_ * std::abs(s_) * share));
    bool cone_holds = stick_n_ >= 0;
    if (b_sign > 0) AddDetach(b_);
    bool edge = false;
    for (const int sign : {1, -1}) {
      // h >= 0: the force lies in the cone on the side of this slip. Slipping
      // gives sign g_T'' = -(1 + kappa) h / A_hat, which has to be positive.
      const T h = mu_ * stick_n_ + static_cast<T>(sign) * stick_t_;
      const T a = AHat(sign);
      const bool on_edge = IsWithin(h, h_tolerance);
      edge = edge || (b_sign < 0 && on_edge);
      if (h < 0) cone_holds = false;
      if (on_edge) continue;
      within_ = within_ || (h * b_ > 0 && IsWithin(a, tolerance_ * a_size_));
      if (a * b_ < 0 && a * h < 0) {
        AddSlip(
            sign > 0 ? SolutionKind::kSlipLeading : SolutionKind::kSlipTrailing,
            sign, a);
        Last().tangential_acc = static_cast<T>(-sign) * (1 + kappa_) * h / a;
      }
    }
    if (cone_holds || (edge && stick_n_ >= 0 && n_ == 0)) AddStick();
    within_ = within_ || edge;
    regime_ = edge ? Regime::kStickOrSlip : RegimeOfSolutions();
  }

  Regime RegimeOfSolutions() const {
    if (n_ == 0) return Regime::kInconsistent;
    if (n_ > 1) return Regime::kIndeterminate;
    switch (solution_[0].kind) {
      case SolutionKind::kDetach:
        return Regime::kDetach;
      case SolutionKind::kStick:
        return Regime::kStick;
      case SolutionKind::kSlipLeading:
        return Regime::kSlipLeading;
      case SolutionKind::kSlipTrailing:
        return Regime::kSlipTrailing;
      case SolutionKind::kSlide:
        break;
    }
    return Regime::kSlide;
  }

  static constexpr Regime ClassifyRegime(int a_sign, int b_sign) {
    const int row = 3 * (a_sign + 1);
    return kSignTable[static_cast<std::size_t>(row) +
                      static_cast<std::size_t>(b_sign + 1)];
  }

  static constexpr int SignBeyondTolerance(T value, T tolerance) {
    return static_cast<int>(value > tolerance) -
           static_cast<int>(value < -tolerance);
  }

  // Results, read by contact.cc.
  T tolerance_;
  T s_ = 0, c_ = 1;
  T mu_ = 0, kappa_ = 0, g_ = 0;
  T centripetal_ = 0;
  T g_nn_ = 1, g_nt_ = 0, g_tt_ = 1;
  T a_ = 0, a_size_ = 0;
  T b_ = 0, b_size_ = 0;
  T stick_n_ = 0, stick_t_ = 0;
  std::array<CoreSolution<T>, 4> solution_{};
  int sign_;
  int n_ = 0;
  Regime regime_ = Regime::kSlide;
  bool within_ = false;

 private:
  static T ComputeKappa(const ContactProblem& p) {
    if (p.gyration_radius_m <= 0.0) return static_cast<T>(p.kappa);
    const T quotient =
        static_cast<T>(p.radius_m) / static_cast<T>(p.gyration_radius_m);
    return quotient * quotient;
  }

  // Long double gains nothing from a fused multiply-add that is a function
  // call.
  static T Fma(T x, T y, T z) {
    if constexpr (std::is_same_v<T, double>) {
      return std::fma(x, y, z);
    } else {
      return x * y + z;
    }
  }

  T AHat(int sign) const {
    if constexpr (std::is_same_v<T, double>) {
      const SinCos alpha{.sin = s_, .cos = c_};
      return SlidingResponse(alpha, kappa_, mu_, static_cast<Slip>(sign));
    } else {
      return 1 + kappa_ * c_ * (c_ - static_cast<T>(sign) * mu_ * s_);
    }
  }

  CoreSolution<T>& Add(SolutionKind kind) {
    CoreSolution<T>& out = solution_[static_cast<std::size_t>(n_++)];
    out.kind = kind;
    return out;
  }
  CoreSolution<T>& Last() {
    return solution_[static_cast<std::size_t>(n_ - 1)];
  }

  void AddDetach(T acceleration) {
    CoreSolution<T>& out = Add(SolutionKind::kDetach);
    out.normal_acc = acceleration;
    out.tangential_acc = -centripetal_ * c_;
  }

  void AddSlip(SolutionKind kind, int sign, T a) {
    CoreSolution<T>& out = Add(kind);
    out.normal = -b_ / a;
    const T ratio = static_cast<T>(-sign) * mu_;
    out.tangential = ratio * out.normal;
    out.tangential_acc =
        Fma(Fma(g_tt_, ratio, g_nt_), out.normal, -centripetal_ * c_);
    SetResidual(out);
  }

  void AddStick() {
    CoreSolution<T>& out = Add(SolutionKind::kStick);
    out.normal = stick_n_;
    out.tangential = stick_t_;
    SetResidual(out);
  }

  // From G, not from A_hat, so that it tests the solution.
  void SetResidual(CoreSolution<T>& out) const {
    const T size =
        g_nn_ * out.normal + std::abs(g_nt_ * out.tangential) + b_size_;
    const T sum =
        Fma(g_nn_, out.normal, Fma(g_nt_, out.tangential, b_ - out.normal_acc));
    out.residual = size > 0 ? std::abs(sum) / size : T(0);
  }
};

}  // namespace touchdown::analysis
