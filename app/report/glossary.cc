// The words of the report, for who meets them for the first time: term and
// meaning, in the order in which a reader comes to need them. The program's own
// definitions are those of core/words.h and core/trial.h; these are the same in
// plain words.
#include "app/report/content.h"

namespace touchdown::report {

Section MakeGlossary() {
  Section section;
  section.blocks.push_back(Heading{2, "Annex: glossary"});
  // First the angles and the touchdown, then what is decided of a trial, then
  // the statistics, then the words of the laboratory.
  section.blocks.push_back(Terms{
      {{"approach angle",
        "between the ground and the velocity of the body's centre at "
        "touchdown, 0 to 90 deg"},
       {"radius angle",
        "acute angle between the ground and the line from the centre to the "
        "contact point: the paper's alpha"},
       {"face angle",
        "of a rectangle's long side to the ground at touchdown, positive with "
        "the leading end up"},
       {"contact angle",
        "the one of these that the campaign varies; kinds are never pooled"},
       {"touchdown, contact",
        "the first instant at which the gap is zero; it lies between frames"},
       {"gap", "height of the body's lowest point above the ground line"},
       {"bounce height",
        "rising above it is what bounce means; fixed before the first trial"},
       {"slide",
        "in the paper's two words every motion that is not a bounce: slide, "
        "roll-slide, roll, stick, stays-down"},
       {"undecided",
        "the trial could be either; P(bounce) is its probability of a bounce"},
       {"boundary angle",
        "the contact angle below which a body stays down and above which it "
        "bounces"},
       {"scatter", "how much the boundary angle varies from trial to trial"},
       {"u",
        "standard uncertainty (JCGM 100): two thirds of such values are off by "
        "less, 95 % by less than 2 u"},
       {"95 % interval",
        "holds the true value with a probability of 95 %, as far as its model "
        "is right"},
       {"bracket",
        "from the greatest angle that stayed down to the least that bounced"},
       {"posterior, prior",
        "what is known of a number with the trials, and before them"},
       {"likelihood profile",
        "the same from the trials alone, without a prior"},
       {"margin",
        "how far boundary and theory may differ and still count as equal; "
        "declared before the first trial"},
       {"E_n",
        "difference of two numbers over their joint expanded uncertainty "
        "(k = 2), of both of them; up to 1 they are compatible"},
       {"equivalence test",
        "two one-sided tests: are both a boundary below the margin and one "
        "above it improbable?"},
       {"restitution",
        "normal velocity of the contact point at release over that at "
        "touchdown, reversed"},
       {"campaign",
        "trials of one body on one surface in one speed band with one theory "
        "declared before the first"},
       {"origin",
        "recorded, simulated or manual (typed); never pooled, and only "
        "recorded and manual trials yield a verdict"}},
      false});
  return section;
}

}  // namespace touchdown::report
