// Speed against error of the contact problem, on the same problems in one run:
// closed form, full result, enumeration, projected Gauss-Seidel, and Siconos'
// Lemke and ENUM where it is installed.
//
// Sets:
//   slide  1024 random corners that slide: bodies and spins of the rig,
//   friction
//          to 2, both corners; one unknown
//   hard   sliding rows of the hard reference cases that are not within
//   rounding
//          of an edge and fit double; one unknown (only where ../shared is)
//   rest   1024 random corners at rest; three unknowns in general form
//
// An answer is right if it is a solution within 1e-6, or says that there is
// none where there is none. `wrong` counts all others, `false_success` those of
// them that claim a solution, `missed` problems whose second solution is not
// told. `error` is the largest relative error of F_n over 16 u times the
// condition number counted as 1: below 1 is as good as the data.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/theory/contact.h"
#include "touchdown/analysis/theory/impact.h"
#include "touchdown/analysis/theory/lcp.h"
#include "touchdown/analysis/theory/regime_map.h"

#ifdef TOUCHDOWN_HAS_SICONOS
extern "C" {
#include <LCP_Solvers.h>
#include <LinearComplementarityProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <lcp_cst.h>
}
#endif

namespace {

using namespace touchdown::analysis;  // NOLINT: a benchmark's main file

// One problem in the body's words and as an LCP, with its true solutions.
struct Problem {
  ContactProblem contact;
  std::vector<double> m;
  std::vector<double> q;
  std::vector<double> forces;  // F_n / m of every solution
  double condition = 1.0;
};

// What a method says.
struct Answer {
  bool found = false;
  double force = 0.0;
  int n = 0;  // solutions told
};

// Reference from long double; an error of 2^-64 times the condition, which is
// 1/2000 of what is measured.
Problem OfSlide(const ContactProblem& contact) {
  Problem p;
  p.contact = contact;
  using Wide = long double;
  const Wide s = contact.alpha.sin;
  const Wide c = contact.alpha.cos;
  const Wide slip_mu = static_cast<Wide>(Sign(contact.slip)) * contact.mu;
  const Wide kappa =
      contact.gyration_radius_m > 0
          ? std::pow(static_cast<Wide>(contact.radius_m) /
                         static_cast<Wide>(contact.gyration_radius_m),
                     2)
          : static_cast<Wide>(contact.kappa);
  const Wide a = 1 + kappa * c * (c - slip_mu * s);
  const Wide lift = static_cast<Wide>(contact.radius_m) *
                    contact.omega_rad_per_s * contact.omega_rad_per_s;
  const Wide b = lift * s - static_cast<Wide>(contact.gravity_mps2);
  p.m = {static_cast<double>(a)};
  p.q = {static_cast<double>(b)};
  if (b >= 0) p.forces.push_back(0.0);
  if (a * b < 0) p.forces.push_back(static_cast<double>(-b / a));
  const Wide size_a = 1 + kappa * c * c + kappa * std::abs(slip_mu * s * c);
  const Wide size_b =
      lift * std::abs(s) + static_cast<Wide>(contact.gravity_mps2);
  p.condition =
      static_cast<double>(std::max(size_a / std::abs(a), size_b / std::abs(b)));
  return p;
}

std::vector<Problem> Slides() {
  std::mt19937_64 engine(20240229);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Problem> out;
  for (int i = 0; i < 1024; ++i) {
    ContactProblem c;
    c.alpha = RoundedSinCosOfRadians(1.57 * unit(engine));
    c.mu = 2.0 * unit(engine);
    c.slip = unit(engine) < 0.5 ? Slip::kLeading : Slip::kTrailing;
    c.mass_kg = 0.01 + unit(engine);
    c.radius_m = 0.005 + 0.1 * unit(engine);
    c.kappa = unit(engine) < 0.5 ? 3.0 : 1.0;
    c.omega_rad_per_s = 60.0 * unit(engine);
    out.push_back(OfSlide(c));
  }
  return out;
}

std::vector<Problem> HardSlides() {
  std::vector<Problem> out;
  const auto path =
      touchdown::testing::Shared("reference/data/lcp_hard_cases.csv");
  if (!std::filesystem::exists(path)) return out;
  for (const auto& row : touchdown::testing::ReadCsv(path)) {
    const std::string& regime = row.Text("regime_exact");
    if (row.Text("slip_sign") == "0" ||
        regime != row.Text("regime_with_tolerance")) {
      continue;
    }
    ContactProblem c;
    c.alpha = SinCosOfRadians(row.Number("alpha_rad"));
    c.mu = row.Number("mu");
    c.slip = static_cast<Slip>(static_cast<int>(row.Number("slip_sign")));
    c.mass_kg = row.Number("m");
    c.radius_m = row.Number("R");
    if (row.Has("kappa_in")) c.kappa = row.Number("kappa_in");
    if (row.Has("k_in")) c.gyration_radius_m = row.Number("k_in");
    c.omega_rad_per_s = row.Number("omega");
    c.gravity_mps2 = row.Number("g");
    Problem p;
    p.contact = c;
    p.m = {static_cast<double>(row.Long("A_hat"))};
    p.q = {static_cast<double>(row.Long("B"))};
    if (!std::isfinite(p.m[0]) || !std::isfinite(p.q[0])) continue;
    const int n = static_cast<int>(row.Number("n_solutions"));
    // F_n of a subnormal or huge mass is not a matter of the method.
    if (c.mass_kg < 1e-300 || c.mass_kg > 1e300) continue;
    const auto mass = static_cast<long double>(c.mass_kg);
    for (int i = 1; i <= n; ++i) {
      const std::string column = "sol" + std::to_string(i) + "_Fn";
      p.forces.push_back(static_cast<double>(row.Long(column) / mass));
    }
    p.condition = std::max(row.Number("cond_A"), row.Number("cond_B"));
    out.push_back(p);
  }
  return out;
}

// The friction LCP in unknowns (f_N, f_T + mu f_N, g_T''-), units of g.
std::vector<Problem> Rests() {
  std::mt19937_64 engine(20240301);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Problem> out;
  while (out.size() < 1024) {
    Problem p;
    ContactProblem& c = p.contact;
    c.alpha = RoundedSinCosOfRadians(0.01 + 1.55 * unit(engine));
    c.mu = 1.2 * unit(engine);  // below every wedge: one solution
    c.slip = Slip::kNone;
    c.radius_m = 0.005 + 0.1 * unit(engine);
    c.omega_rad_per_s = 30.0 * unit(engine);
    c.gravity_mps2 = 1.0;
    const Delassus g = ComputeDelassus(c.alpha, c.kappa);
    const double lift = c.radius_m * c.omega_rad_per_s * c.omega_rad_per_s;
    p.m = {g.nn - c.mu * g.nt, g.nt, 0.0, g.nt - c.mu * g.tt, g.tt, 1.0,
           2 * c.mu,           -1.0, 0.0};
    p.q = {lift * c.alpha.sin - 1.0, -lift * c.alpha.cos, 0.0};
    const ContactResult r = SolveContact(c);
    if (r.n_solutions != 1 || r.within_tolerance) continue;
    p.forces = {r.solution[0].normal_n};
    p.condition = r.b_condition;
    out.push_back(p);
  }
  return out;
}

// --- methods -----------------------------------------------------------------

using Method = std::function<Answer(const Problem&)>;

Answer Quick(const Problem& p) {
  const QuickContact r = SolveSlidingContact(p.contact);
  switch (r.regime) {
    case Regime::kSlide:
    case Regime::kDetach:
    case Regime::kGraze:
    case Regime::kAZeroDetach:
      return {true, r.normal_per_mass_mps2, 1};
    case Regime::kIndeterminate:
      return {true, r.normal_per_mass_mps2, 2};
    default:
      return {};
  }
}

Answer Full(const Problem& p) {
  const ContactResult r = SolveContact(p.contact);
  if (r.n_solutions == 0) return {};
  return {true,
          r.solution[static_cast<std::size_t>(r.n_solutions - 1)].normal_n /
              p.contact.mass_kg,
          r.n_solutions};
}

Answer Enumerate(const Problem& p) {
  const LcpResult r = SolveLcp(p.m, p.q);
  if (r.solutions.empty()) return {};
  return {true, r.solutions.back().z[0], static_cast<int>(r.solutions.size())};
}

// Sweeps z_i = max(0, z_i - (M z + q)_i / M_ii) until they rest.
Answer GaussSeidel(const Problem& p) {
  constexpr int kMaxSweeps = 1000;
  constexpr double kRest = 1e-14;
  const std::size_t n = p.q.size();
  std::array<double, 3> z{};
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double change = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double pivot = p.m[i * n + i];
      double w = p.q[i];
      for (std::size_t j = 0; j < n; ++j) w += p.m[i * n + j] * z[j];
      if (pivot == 0.0) continue;
      const double next = std::max(0.0, z[i] - w / pivot);
      change = std::max(change, std::abs(next - z[i]));
      size = std::max(size, std::abs(next));
      z[i] = next;
    }
    if (change <= kRest * size) return {true, z[0], 1};
  }
  return {};
}

#ifdef TOUCHDOWN_HAS_SICONOS
class Siconos {
 public:
  Siconos(int solver, int size, bool skip_trivial) : z_(), w_(), m_(), q_() {
    options_ = solver_options_create(solver);
    if (skip_trivial) {
      options_->iparam[SICONOS_LCP_IPARAM_SKIP_TRIVIAL] =
          SICONOS_LCP_SKIP_TRIVIAL_YES;
    }
    matrix_ = NM_create_from_data(NM_DENSE, size, size, m_.data());
    problem_.size = size;
    problem_.M = matrix_;
    problem_.q = q_.data();
  }
  // The matrix is ours; Siconos would free it.
  ~Siconos() { solver_options_delete(options_); }
  Siconos(const Siconos&) = delete;
  Siconos& operator=(const Siconos&) = delete;

  Answer Solve(const Problem& p) {
    const std::size_t n = p.q.size();
    for (std::size_t i = 0; i < n; ++i) {
      q_[i] = p.q[i];
      z_[i] = 0.0;
      w_[i] = 0.0;
      // Column by column.
      for (std::size_t j = 0; j < n; ++j) m_[j * n + i] = p.m[i * n + j];
    }
    const int info =
        linearComplementarity_driver(&problem_, z_.data(), w_.data(), options_);
    return {info == 0, z_[0], info == 0 ? 1 : 0};
  }

 private:
  SolverOptions* options_ = nullptr;
  NumericsMatrix* matrix_ = nullptr;
  LinearComplementarityProblem problem_{};
  std::array<double, 3> z_, w_;
  std::array<double, 9> m_;
  std::array<double, 3> q_;
};
#endif

// --- measurement -------------------------------------------------------------

void Judge(const std::vector<Problem>& problems, const Method& method,
           benchmark::State& state) {
  constexpr double kSame = 1e-6;
  constexpr double kUlp = 0x1p-53;
  double wrong = 0;
  double false_success = 0;
  double missed = 0;
  double error = 0.0;
  for (const Problem& p : problems) {
    const Answer a = method(p);
    if (!a.found) {
      wrong += !p.forces.empty();
      continue;
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (const double force : p.forces) {
      const double off = std::abs(a.force - force);
      nearest = std::min(nearest, force == 0.0 ? off : off / force);
    }
    if (!(nearest <= std::max(kSame, 16 * kUlp * p.condition))) {
      ++wrong;
      ++false_success;
      continue;
    }
    missed += static_cast<std::size_t>(a.n) < p.forces.size();
    error = std::max(error, nearest / (16 * kUlp * p.condition));
  }
  state.counters["error"] = error;
  state.counters["wrong"] = wrong;
  state.counters["false_success"] = false_success;
  state.counters["missed"] = missed;
  state.counters["problems"] = static_cast<double>(problems.size());
}

// The CSV reporter wants the same counters of every benchmark.
void DoNotJudge(double problems, benchmark::State& state) {
  for (const char* name : {"error", "wrong", "false_success", "missed"}) {
    state.counters[name] = std::numeric_limits<double>::quiet_NaN();
  }
  state.counters["problems"] = problems;
}

template <class F>
void Add(const std::string& name, const std::vector<Problem>& problems,
         F method) {
  if (problems.empty()) return;
  // The method is called directly, so that its time has no indirection in it.
  benchmark::RegisterBenchmark(
      name.c_str(), [&problems, method](benchmark::State& state) mutable {
        for (auto unused : state) {
          static_cast<void>(unused);
          for (const Problem& p : problems) {
            Answer a = method(p);
            benchmark::DoNotOptimize(a);
          }
        }
        state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                                static_cast<std::int64_t>(problems.size()));
        Judge(problems, method, state);
      });
}

void AddMap(const std::string& name, MapAxis axis) {
  benchmark::RegisterBenchmark(name.c_str(), [axis](benchmark::State& state) {
    RegimeMapOptions options;
    options.axis = axis;
    options.alpha_points = 1000;
    options.axis_points = 1000;
    options.axis_max = axis == MapAxis::kMu ? 6.0 : 60.0;
    options.problem.mu = 1.6;
    options.problem.slip = Slip::kLeading;
    options.problem.radius_m = 0.05;
    options.problem.omega_rad_per_s = 20.0;
    for (auto unused : state) {
      static_cast<void>(unused);
      auto map = ComputeRegimeMap(options);
      benchmark::DoNotOptimize(map);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                            1'000'000);
    DoNotJudge(1e6, state);
  });
}

void AddImpact() {
  benchmark::RegisterBenchmark("impact", [](benchmark::State& state) {
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<ImpactProblem> problems(1024);
    for (ImpactProblem& p : problems) {
      p.alpha = RoundedSinCosOfRadians(1.57 * unit(engine));
      p.radius_m = 0.01 + 0.1 * unit(engine);
      p.mu = unit(engine);
      p.restitution = unit(engine);
      p.tangential_mps = 10.0 * (unit(engine) - 0.5);
      p.normal_mps = -5.0 * unit(engine);
    }
    for (auto unused : state) {
      static_cast<void>(unused);
      for (const ImpactProblem& p : problems) {
        auto r = Impact(p);
        benchmark::DoNotOptimize(r);
      }
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(problems.size()));
    DoNotJudge(static_cast<double>(problems.size()), state);
  });
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Problem> slides = Slides();
  const std::vector<Problem> hard = HardSlides();
  const std::vector<Problem> rests = Rests();
  struct Set {
    const char* name;
    const std::vector<Problem>* problems;
  };
  for (const Set& set : {Set{"slide", &slides}, Set{"hard", &hard}}) {
    const std::string prefix = std::string(set.name) + "/";
    Add(prefix + "closed_form", *set.problems, Quick);
    Add(prefix + "full_result", *set.problems, Full);
    Add(prefix + "enumeration", *set.problems, Enumerate);
    Add(prefix + "gauss_seidel", *set.problems, GaussSeidel);
#ifdef TOUCHDOWN_HAS_SICONOS
    const auto siconos = [&](const char* name, int solver, bool skip) {
      const auto peer = std::make_shared<Siconos>(solver, 1, skip);
      Add(prefix + name, *set.problems,
          [peer](const Problem& p) { return peer->Solve(p); });
    };
    siconos("siconos_default", SICONOS_LCP_LEMKE, false);
    siconos("siconos_lemke", SICONOS_LCP_LEMKE, true);
    siconos("siconos_enum", SICONOS_LCP_ENUM, true);
#endif
  }
  Add("rest/full_result", rests, Full);
  Add("rest/enumeration", rests, Enumerate);
  Add("rest/gauss_seidel", rests, GaussSeidel);
#ifdef TOUCHDOWN_HAS_SICONOS
  for (const auto& [name, solver] :
       {std::pair{"rest/siconos_lemke", int{SICONOS_LCP_LEMKE}},
        std::pair{"rest/siconos_enum", int{SICONOS_LCP_ENUM}}}) {
    const auto peer = std::make_shared<Siconos>(solver, 3, true);
    Add(name, rests, [peer](const Problem& p) { return peer->Solve(p); });
  }
#endif
  AddMap("map/mu", MapAxis::kMu);
  AddMap("map/omega", MapAxis::kOmega);
  AddImpact();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
