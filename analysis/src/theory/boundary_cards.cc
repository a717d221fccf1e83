#include <array>

#include "touchdown/analysis/theory/boundary_models.h"

namespace touchdown::analysis {
namespace {

// What each theory assumes, where it holds and where it is from.
constexpr std::array<BoundaryModelCard, 5> kCards = {{
    {BoundaryModel::kPublished, "published", "Published boundary angles",
     "none: the numbers are quoted as printed, 11.8 deg for the sphere and 7.8 "
     "deg for the rectangle",
     "the paper's own tests, without spin; these support only 11.8 to 27.4 deg "
     "(sphere) and 7.8 to 11.8 deg (rectangle)",
     "the paper, abstract and Table 1; its Sec. 4.2 swaps the upper limits "
     "(errata E17, E19)",
     false},
    {BoundaryModel::kPrintedEquations, "printed-equations",
     "The paper's equations as printed",
     "sustained contact (v_N = 0) of a point fixed to the body; friction F_t = "
     "+mu F_n; A = 0 never happens, so only b = R omega^2 sin(alpha) - g "
     "decides",
     "a trailing corner with known spin after the impact; without spin it says "
     "slide at every angle",
     "the paper, Eqs. (1)-(9) and Sec. 3.3 (errata E2, E7, E15, E16)", false},
    {BoundaryModel::kCorrectedLcp, "corrected-lcp", "Corrected contact problem",
     "sustained contact of a rigid corner, Coulomb friction against the slip, "
     "A_hat = 1 + kappa cos(alpha)(cos(alpha) - slip mu sin(alpha))",
     "rigid bodies sliding on one corner; says when contact is lost, not "
     "whether an impact rebounds",
     "Genot and Brogliato 1999; Champneys and Varkonyi 2016; errata E1, E2, "
     "E8, "
     "E10-E14",
     true},
    {BoundaryModel::kPaperReplication, "paper-replication",
     "Replication of the paper's digits (not physics)",
     "A_hat = 0 with F_t = -mu F_n and mu = 9.8, the value of g in the place "
     "of "
     "friction; kappa = 1 for the paper's sphere, 3 for the rectangle",
     "reproducing 11.8 and 7.8 deg; mu = 9.8 is no friction coefficient, the "
     "sign contradicts Eq. (5), and above 84.0 (88.0) deg it says slide again",
     "found by search: of 35 readings of the theory the only one that gives "
     "both "
     "digits (docs/theory.md)",
     false},
    {BoundaryModel::kDetectableBounce, "detectable-bounce",
     "Impact and detectable bounce",
     "one impact with Poisson restitution e and Coulomb friction; radius angle "
     "and approach angle are equal; no spin before; a bounce is a rise of the "
     "contact point above h_c under gravity less the spin's lift",
     "single impact of a stiff body; a second corner that slaps down shortly "
     "after is left out, which matters for thin plates",
     "Routh 1905; sphere: sin(angle) = sqrt(2 g h_c)/(e V)", true},
}};

}  // namespace

std::span<const BoundaryModelCard> BoundaryModelCards() { return kCards; }

}  // namespace touchdown::analysis
