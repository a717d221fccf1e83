// Turns the typed flags of boundary, next and report into options of the
// modules below: MakeSelection() says which trials, MakeStudy() how the
// boundary is estimated, and MakeInput() puts both together with what the
// trials are compared with. Typed angles are degrees; all that leaves this file
// is radians.
#include "app/cli/store/boundary_flags.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "app/cli/messages.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/report_input/report_input.h"
#include "app/shots/thrower.h"
#include "app/text/parse_number.h"
#include "app/trials/looks.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

// The word of --support-deg for the angles that can be thrown.
constexpr std::string_view kOfTheRig = "rig";

// Returns the number that the whole of `text` is. Throws std::invalid_argument
// with the flag, the text and the expected form.
double ReadFlagNumber(const char* flag, std::string_view text,
                      const char* form) {
  const auto value = report::ParseNumber<double>(text);
  if (!value) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, form));
  }
  return *value;
}

// Returns the value of a word such as "sphere", and nothing where the flag was
// not given. A word that `parse` does not know is the user's error.
template <class Parse>
auto OptionalWord(const char* flag, const std::string& text, Parse parse,
                  const char* words) -> decltype(parse(text)) {
  if (text.empty()) return std::nullopt;
  auto parsed = parse(text);
  if (!parsed) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, words));
  }
  return parsed;
}

// Throws std::invalid_argument where the flag's value is not above 0, or more
// than any angle.
void RequirePositiveDegrees(const char* flag, double value_deg) {
  if (value_deg > 0.0 && value_deg <= 90.0) return;
  throw std::invalid_argument(
      fmt::format("{}: {}; expected more than 0, at most 90", flag, value_deg));
}

// An empty text means that the flag was not given: the filter lets all pass.
std::optional<std::string> Given(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return text;
}

}  // namespace

core::Estimate ParseTheory(const std::string& text) {
  // The message shows one form that works, since "11.8 +- 0.5" with blanks does
  // not.
  constexpr const char* kForm = "degrees from 0 to 90, e.g. 11.8 or 11.8+-0.5";
  const std::size_t sign = text.find("+-");
  const double value = ReadFlagNumber(
      "--theory-deg", std::string_view(text).substr(0, sign), kForm);
  const double u =
      sign == std::string::npos
          ? 0.0
          : ReadFlagNumber("--theory-deg",
                           std::string_view(text).substr(sign + 2), kForm);
  if (!(value >= 0.0 && value <= 90.0) || !(u >= 0.0 && u <= 90.0)) {
    throw std::invalid_argument(
        fmt::format("--theory-deg: '{}'; expected {}", text, kForm));
  }
  return {value * kDegree, u * kDegree, {}};
}

core::Estimate ReadTheory(const BoundaryFlags& flags) {
  core::Estimate theory = ParseTheory(flags.theory);
  if (!flags.theory_u_deg) return theory;
  const double u_deg = *flags.theory_u_deg;
  RequireDegrees("--theory-u-deg", u_deg);
  // Two different u's must not be resolved silently in favour of one.
  if (theory.u > 0.0) {
    throw std::invalid_argument(fmt::format(
        "--theory-u-deg: {} beside --theory-deg {}; give the theory's u once",
        u_deg, flags.theory));
  }
  theory.u = u_deg * kDegree;
  return theory;
}

void RequireDegrees(const char* flag, double value_deg) {
  if (value_deg >= 0.0 && value_deg <= 90.0) return;
  throw std::invalid_argument(
      fmt::format("{}: {}; expected 0 to 90", flag, value_deg));
}

core::Interval ParseRange(const char* flag, const std::string& text) {
  constexpr const char* kForm = "LOW:HIGH in degrees within 0:90, e.g. 5:40";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, kForm));
  }
  const std::string_view view(text);
  const core::Interval range{
      ReadFlagNumber(flag, view.substr(0, colon), kForm) * kDegree,
      ReadFlagNumber(flag, view.substr(colon + 1), kForm) * kDegree};
  if (!(range.low < range.high)) {
    throw std::invalid_argument(fmt::format(
        "{}: '{}'; expected {}, low below high", flag, text, kForm));
  }
  if (range.low < 0.0 || range.high > 90.0 * kDegree) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, kForm));
  }
  return range;
}

// Check shots are drops from a known height at one angle: no boundary lies
// among them.
void RefuseCheckShots(const BoundaryFlags& flags,
                      const report::ReportInput& input) {
  for (const core::Campaign& campaign : input.campaigns) {
    if (campaign.name == flags.campaign && core::HasCheckShots(campaign)) {
      throw std::invalid_argument(fmt::format(
          "--campaign: '{}' is of check shots, which have no boundary and no "
          "next angle; `touchdown report` draws their control chart",
          campaign.name));
    }
  }
}

void PrintLeftOut(const report::Group& group, std::string_view heading) {
  // Five are enough to see a pattern; a campaign may have hundreds.
  constexpr std::size_t kShown = 5;
  const std::size_t shown = std::min(group.left_out.size(), kShown);
  for (std::size_t i = 0; i < shown; ++i) {
    fmt::print("{:<{}}{}: {}\n", i == 0 ? heading : "", heading.size(),
               Printable(group.left_out[i].name),
               Printable(group.left_out[i].reason));
  }
  if (group.left_out.size() > shown) {
    fmt::print("{:<{}}and {} more (--json lists them)\n", "", heading.size(),
               group.left_out.size() - shown);
  }
}

// Checks the ranges of the flags. Whether there is exactly one source (--db,
// --trials, --paper-table1) is checked by SelectTrials().
pipeline::SelectionOptions MakeSelection(const BoundaryFlags& flags) {
  // Left alone, the u would be dropped and the verdict would look sharper than
  // the user asked for.
  if (flags.theory_u_deg && flags.theory.empty()) {
    throw std::invalid_argument(
        "--theory-u-deg: there is no --theory-deg that it could be of; a "
        "campaign's own theory has its u from `campaign --theory-u-deg`");
  }
  pipeline::SelectionOptions out;
  out.store = flags.store;
  out.csv = flags.csv;
  out.paper_table1 = flags.paper_table1;
  RequireDegrees("--paper-u-deg", flags.paper_u_deg);
  out.paper_u_rad = flags.paper_u_deg * kDegree;
  out.campaign = Given(flags.campaign);
  out.surface = Given(flags.surface);
  out.body = OptionalWord("--body", flags.body, core::ParseBodyKind,
                          "sphere or rectangle");
  out.angle_kind =
      OptionalWord("--angle-kind", flags.angle_kind, core::ParseAngleKind,
                   "approach, radius or face");
  out.origin = OptionalWord("--origin", flags.origin, core::ParseOrigin,
                            "recorded, simulated or manual");
  out.from_utc = Given(flags.from);
  out.until_utc = Given(flags.until);
  out.reviewed_only = flags.reviewed;
  if (flags.margin_deg) {
    RequirePositiveDegrees("--margin-deg", *flags.margin_deg);
    out.margin_rad = *flags.margin_deg * kDegree;
  }
  // A file has no campaign that could declare a theory, so --theory-deg
  // declares it. Of a store the flag is for information only (MakeInput).
  if (!flags.csv.empty() && !flags.theory.empty()) {
    const core::Estimate theory = ReadTheory(flags);
    out.theory_name = flags.theory_name;
    out.theory_rad = theory.value;
    out.theory_u_rad = theory.u;
  }
  return out;
}

// The ranges are those of the module, which would name its own fields, and only
// after the look has been recorded.
analysis::StudyOptions MakeStudy(const BoundaryFlags& flags) {
  RequirePositiveDegrees("--target-deg", flags.target_deg);
  RequireDegrees("--set-u-deg", flags.set_u_deg);
  analysis::StudyOptions out;
  out.next.target_half_width_rad = flags.target_deg * kDegree;
  out.next.set_u_rad = flags.set_u_deg * kDegree;
  out.next.max_trials = flags.max_trials;
  // "rig" is resolved in MakeInput(), where the reach is known for each
  // campaign.
  if (!flags.support.empty() && flags.support != kOfTheRig) {
    const core::Interval support = ParseRange("--support-deg", flags.support);
    out.fit.low_rad = support.low;
    out.fit.high_rad = support.high;
  }
  return out;
}

// Somebody who looks after every trial and stops when the answer pleases can
// reach any verdict; therefore each look is on record beside the campaign's
// plan.
void KeepLook(const BoundaryFlags& flags, std::string_view command,
              std::span<const core::Trial> trials) {
  if (flags.store.empty() || trials.empty()) return;
  // Each campaign that has a trial here gets one look.
  std::set<std::string> names;
  for (const core::Trial& trial : trials) names.insert(trial.campaign);
  const std::string trouble = pipeline::KeepLooks(flags.store, names, command);
  // A read-only store must not keep anybody from reading the answer.
  if (!trouble.empty()) {
    Tell(fmt::format("this look is not on record: {}", trouble));
  }
}

// Selects trials and sets what they are compared with and what can be thrown.
// `with_evidence` also loads analysis documents and earlier labels, which only
// `report` shows: they are most of a store's bytes.
report::ReportInput MakeInput(const BoundaryFlags& flags, bool with_evidence) {
  pipeline::SelectionOptions options = MakeSelection(flags);
  options.with_evidence = with_evidence;
  report::ReportInput input =
      pipeline::MakeReportInput(pipeline::SelectTrials(options));
  input.study = MakeStudy(flags);
  if (!flags.feasible.empty()) {  // as the user says, whatever the rig can do
    const core::Interval asked = ParseRange("--feasible-deg", flags.feasible);
    input.reach_of = [asked](const core::Campaign&) {
      return report::Reach{asked, "as --feasible-deg says"};
    };
  } else if (!flags.rig.empty()) {
    // Each campaign's reach is found by searching the rig's settings when it is
    // asked for, at the speed of --speed-mps or of that campaign's band.
    input.reach_of = pipeline::ReachOfRig(
        flags.rig, flags.speed_mps, ReadCorner(flags.corner), flags.store);
  }
  // The prior on the boundary is then confined to the angles that can be
  // thrown.
  if (flags.support == kOfTheRig) {
    if (!input.reach_of) {
      throw std::invalid_argument(
          "--support-deg is rig, and no rig says what can be thrown: give "
          "--rig or --feasible-deg");
    }
    input.support_is_reach = true;
  }
  // A file of bare angles is compared with the published boundary of the body
  // that it is said to be of.
  if (!flags.csv.empty() && flags.body.empty()) input.theories.clear();
  if (flags.csv.empty() && !flags.theory.empty()) {
    const core::Estimate theory = ReadTheory(flags);
    // The flag does not say which body it is of, so trials of either are
    // compared with it.
    for (const auto body :
         {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
      input.theories.push_back(
          {body,
           {flags.theory_name.empty() ? "theory" : flags.theory_name,
            theory.value, theory.u},
           "given for information"});
    }
  }
  return input;
}

// --help shows them in this order: the source of trials, filters, theory, what
// can be thrown, when to stop, the rig.
void AddBoundaryFlags(CLI::App& command, BoundaryFlags& flags) {
  AddOption(command, "--db", flags.store, "trial store");
  AddOption(
      command, "--trials", flags.csv,
      "CSV file with angle_deg, u_deg, p_bounce and, where there were "
      "set-points, set_angle_deg; where trials share an error, its "
      "common_u_deg, and the calibration that tells one set-up from another");
  AddFlag(command, "--paper-table1", flags.paper_table1,
          "the paper's own Table 1");
  AddOption(command, "--paper-u-deg", flags.paper_u_deg,
            "assumed u of the paper's angles")
      .ShowDefault();
  AddOption(command, "--campaign", flags.campaign, "only this campaign");
  AddOption(command, "--surface", flags.surface, "only this surface");
  AddOption(command, "--body", flags.body, "sphere or rectangle");
  AddOption(command, "--angle-kind", flags.angle_kind,
            "approach, radius or face");
  AddOption(command, "--origin", flags.origin, "recorded, simulated or manual");
  AddOption(command, "--from", flags.from, "logged at this UTC time or later");
  AddOption(command, "--until", flags.until, "logged before this UTC time");
  AddFlag(command, "--reviewed", flags.reviewed,
          "only trials that a person has corrected");
  AddOption(command, "--theory-deg", flags.theory,
            "a theory's boundary, D or D+-u: of --trials the declared one, "
            "else for information");
  AddOption(command, "--theory-u-deg", flags.theory_u_deg,
            "its standard uncertainty: enters E_n and the verdict, with U = 2 "
            "u (default 0, the value is exact)");
  AddOption(command, "--theory-name", flags.theory_name, "its name");
  AddOption(command, "--margin-deg", flags.margin_deg,
            "equivalence margin, of --trials (default 1)");
  AddOption(command, "--feasible-deg", flags.feasible,
            "angles the rig can throw, LOW:HIGH");
  AddOption(command, "--support-deg", flags.support,
            "angles at which the boundary can be, LOW:HIGH, or rig: those it "
            "can throw; the support of the prior (default 0:90)");
  AddOption(command, "--set-u-deg", flags.set_u_deg,
            "repeatability of the ejector")
      .ShowDefault();
  AddOption(command, "--target-deg", flags.target_deg,
            "half-width of the 95 % interval to reach")
      .ShowDefault();
  AddOption(command, "--max-trials", flags.max_trials, "stop there")
      .ShowDefault();
  AddOption(command, "--rig", flags.rig,
            "rig.toml: the next angle stays within its reach; `next` prints "
            "its set-points, `report` its predictions");
  AddOption(command, "--speed-mps", flags.speed_mps,
            "with --rig: speed at touchdown (default: the middle of the "
            "campaign's band)");
  AddOption(command, "--corner", flags.corner,
            "with --rig: corner that lands first, leading, trailing or flush");
  AddFlag(command, "--json", flags.json, "one JSON document");
}

// Two decimals are enough: the angle of a good clip is known to some
// hundredths.
std::string DegreesText(double angle_rad) {
  return fmt::format("{:.2f}", angle_rad / kDegree);
}

}  // namespace touchdown::cli
