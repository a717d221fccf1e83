// Boundary angles by named models: below it a body stays down, above it bounces
// (or loses contact). Each model states what it assumes, where it holds and
// where it comes from, so that a user chooses one and a report prints which.
//
//   published            the paper's 11.8 and 7.8 deg
//   printed-equations    the paper's equations as printed: no boundary without
//                        spin, arcsin(g/(R omega^2)) with it
//   corrected-lcp        the corrected contact problem, both slip directions,
//                        Painleve's wedge (contact.h)
//   paper-replication    A = 0 with F_t = -mu F_n and mu = 9.8: gives 11.778
//   and
//                        7.784 deg. Reproduces the paper's digits; not physics
//   detectable-bounce    impact with restitution and friction, and the smallest
//                        rise that counts as a bounce
//
// Angles are the kind that `ModelAngleKind` names: a sphere's radius angle is
// always 90 deg, so its boundary can only be one of the approach angle.
#pragma once

#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/analysis/theory/corner.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/units.h"
#include "touchdown/core/words.h"

namespace touchdown::analysis {

enum class BoundaryModel {
  kPublished,
  kPrintedEquations,
  kCorrectedLcp,
  kPaperReplication,
  kDetectableBounce
};

// What a report prints beside a model's number.
struct BoundaryModelCard {
  BoundaryModel model;
  std::string_view name;         // the word on the command line
  std::string_view label;        // a heading
  std::string_view assumptions;  //
  std::string_view range;        // where it may be used
  std::string_view source;       //
  bool is_physics;               // false: a quotation or a replication
};
std::span<const BoundaryModelCard> BoundaryModelCards();

// Every model takes what it needs of these. Where u > 0 it is propagated.
struct BoundaryInputs {
  core::BodyKind body = core::BodyKind::kRectangle;
  Slip slip = Slip::kTrailing;  // the corner that lands; of rectangles
  core::Estimate kappa{3.0, 0.0};
  core::Estimate radius_m{0.05, 0.0};  // R
  core::Estimate mu{0.5, 0.0};
  core::Estimate omega_rad_per_s{0.0, 0.0};  // at the contact, after the impact
  core::Estimate gravity_mps2{core::kStandardGravity_mps2, 0.0};
  // Of detectable-bounce alone: no defaults that anyone should rely on.
  core::Estimate restitution{0.5, 0.0};
  core::Estimate speed_mps{5.0, 0.0};         // of the centre at touchdown
  core::Estimate bounce_height_m{1e-3, 0.0};  // the campaign's h_c
  // Of a rectangle: the angle that the campaign does not vary. With the radius
  // angle held the boundary is one of the approach angle, and the other way
  // round. With none held the two are taken as equal, as the paper has them,
  // which no throw makes them.
  std::optional<core::AngleKind> held_kind;  // approach or radius
  core::Estimate held_angle_rad;
};

// The boundary itself, or why there is none. Throws std::invalid_argument for
// an impossible input.
core::Expected<double> BoundaryAngle(BoundaryModel model,
                                     const BoundaryInputs& inputs);

// What the model says of every angle: stretches of the contact angle, from 0 to
// 90 deg, in order.
struct AngleRange {
  double from_rad = 0.0;
  double to_rad = 0.0;
  std::string state;  // e.g. "slide", "detach", "no solution", "bounce"
};

struct Sensitivity {
  std::string input;
  double slope = 0.0;  // d alpha_b / d input, rad per unit
  double u_rad = 0.0;  // |slope| u(input)
};

struct BoundaryUncertainty {
  // First order (@cite JCGM100), and whether it may be used: alpha_b exists,
  // and still exists with each input moved by 3 u towards losing it, without
  // departing from the straight line by more than a half; for a boundary of
  // spin also R omega^2/g - 1 > 10 u of it.
  double first_order_u_rad = 0.0;
  bool first_order_is_valid = false;
  // Monte Carlo (@cite JCGM101); nothing where no input has u > 0.
  int n_draws = 0;
  double p_none = 0.0;             // share of draws without a boundary
  std::optional<double> mean_rad;  // of the draws with one
  std::optional<double> u_rad;
  std::optional<double> low_rad;   // 2.5 %
  std::optional<double> high_rad;  // 97.5 %
};

struct BoundaryAnswer {
  core::AngleKind angle_kind = core::AngleKind::kRadius;
  core::Expected<double> boundary_rad = core::AbsentBecause("not evaluated");
  std::vector<AngleRange> ranges;
  std::vector<Sensitivity> sensitivities;  // of what has u > 0 and matters
  BoundaryUncertainty uncertainty;
  std::vector<std::string> notes;  // what a reader must know of this answer
};

struct BoundaryOptions {
  // Draws of the Monte Carlo. 20 000 give u to 0.5 % and P(none) to 0.004;
  // detectable-bounce takes about 20 us a draw.
  int n_draws = 20'000;
};

BoundaryAnswer EvaluateBoundary(BoundaryModel model,
                                const BoundaryInputs& inputs,
                                std::mt19937_64& engine,
                                const BoundaryOptions& options = {});

// The kind of contact angle that a model speaks of for a body.
core::AngleKind ModelAngleKind(BoundaryModel model,
                               const BoundaryInputs& inputs);

// Rise of the contact point after an impact at the campaign's angle, over the
// bounce height: >= 1 is a bounce; infinite where spin keeps it off the ground.
// With b the approach and a the radius angle (one of them held, or both the
// given one), the rule of detectable-bounce:
//   sphere:     (e V sin b)^2 / (2 g h_c)
//   rectangle:  v_N+^2 / (2 (g - R omega+^2 sin a) h_c), v_N+ and omega+ from
//               Impact() at V (cos b, -sin b) without spin before
double BounceRatio(const BoundaryInputs& inputs, double angle_rad);

}  // namespace touchdown::analysis
