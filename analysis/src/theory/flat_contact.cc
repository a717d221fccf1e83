#include "touchdown/analysis/theory/flat_contact.h"

#include <cmath>

#include "theory/wide.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Wide: a/b squared may leave the range of double, and nobody solves a million
// of these.
constexpr Wide kWithinRounding = 8 * 0x1p-53L;

// Each foot's share per unit of g.
struct Shares {
  Feet feet = Feet::kBoth;
  Wide rear = 0, front = 0;            // normal reaction / m
  Wide rear_rise = 0, front_rise = 0;  // response beyond the constraint
};

struct Flush {
  explicit Flush(const FlatProblem& p) {
    const Wide eta = static_cast<Wide>(p.height_m) / p.length_m;
    tau = Sign(p.slip) * (static_cast<Wide>(p.mu) * p.height_m) / p.length_m;
    const Wide spread = 1 + eta * eta;
    lean_rear = 3 * (1 + tau) / spread;
    lean_front = 3 * (1 - tau) / spread;
    m_rr = 1 + lean_rear;
    m_rf = 1 - lean_front;
    m_fr = 1 - lean_rear;
    m_ff = 1 + lean_front;
    determinant = 12 / spread;
  }

  std::optional<Shares> Solve() const {
    Shares out;
    if (std::abs(tau) <= 1) {
      out.rear = (1 - tau) / 2;
      out.front = (1 + tau) / 2;
      return out;
    }
    // M_rf - M_ff = -2 lean_front: exact, whereas the difference is not.
    if (tau > 1 && m_ff > 0) {
      out.feet = Feet::kFront;
      out.front = 1 / m_ff;
      out.rear_rise = -2 * lean_front / m_ff;
      return out;
    }
    if (tau < -1 && m_rr > 0) {
      out.feet = Feet::kRear;
      out.rear = 1 / m_rr;
      out.front_rise = -2 * lean_rear / m_rr;
      return out;
    }
    return std::nullopt;
  }

  bool IsWithinTolerance() const {
    return std::abs(std::abs(tau) - 1) <= kWithinRounding * std::abs(tau) ||
           std::abs(m_ff) <= kWithinRounding * (1 + std::abs(lean_front)) ||
           std::abs(m_rr) <= kWithinRounding * (1 + std::abs(lean_rear));
  }

  Wide tau = 0, lean_rear = 0, lean_front = 0;
  Wide m_rr = 0, m_rf = 0, m_fr = 0, m_ff = 0, determinant = 0;
};

void CheckFlatProblem(const FlatProblem& p) {
  core::RequirePositive("length", p.length_m, "m");
  core::RequirePositive("height", p.height_m, "m");
  core::RequireNotNegative("mu", p.mu);
  core::RequirePositive("mass", p.mass_kg, "kg");
  core::RequirePositive("gravity", p.gravity_mps2, "m/s^2");
}

}  // namespace

FlatResult SolveFlatContact(const FlatProblem& problem) {
  CheckFlatProblem(problem);
  const Flush flush(problem);
  FlatResult out;
  out.m_rr = Narrow(flush.m_rr);
  out.m_rf = Narrow(flush.m_rf);
  out.m_fr = Narrow(flush.m_fr);
  out.m_ff = Narrow(flush.m_ff);
  out.determinant = Narrow(flush.determinant);
  out.tipping = Narrow(flush.tau);
  out.within_tolerance = flush.IsWithinTolerance();
  if (const auto shares = flush.Solve()) {
    const Wide weight =
        static_cast<Wide>(problem.mass_kg) * problem.gravity_mps2;
    out.solution = FlatSolution{
        shares->feet,
        Narrow(weight * shares->rear),
        Narrow(weight * shares->front),
        Narrow(-Sign(problem.slip) * static_cast<Wide>(problem.mu) * weight *
               (shares->rear + shares->front)),
        Narrow(problem.gravity_mps2 * shares->rear_rise),
        Narrow(problem.gravity_mps2 * shares->front_rise)};
  }
  return out;
}

std::string_view Name(Feet feet) {
  switch (feet) {
    case Feet::kBoth:
      return "both";
    case Feet::kFront:
      return "front";
    case Feet::kRear:
      return "rear";
  }
  return "";
}

}  // namespace touchdown::analysis
