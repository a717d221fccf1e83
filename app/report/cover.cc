// The cover block: what a test report must hold beside its results (ISO/IEC
// 17025, 7.8.2). What the trials and the store know comes first (dates,
// operator, environment, equipment); report.toml fills in the rest. What
// neither says is listed as absent instead of being left out.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/facts/analysis_facts.h"
#include "app/report/content.h"
#include "app/report/tally.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"

namespace touchdown::report {
namespace {

// The day of a time in ISO 8601: "2026-08-01T..." gives "2026-08-01". Empty
// stays empty.
std::string Day(const std::string& utc) {
  constexpr std::size_t kDay = 10;
  return utc.substr(0, kDay);
}

// When the trial was first logged, in UTC. The time of a revision is that of
// the correction, not of the shot.
std::string FirstLogged(const core::Trial& trial, const ReportInput& input) {
  const auto found = input.first_logged_utc.find(trial.id);
  return found == input.first_logged_utc.end() ? trial.recorded_at_utc
                                               : found->second;
}

// The first and the last day on which trials were logged; empty where none has
// a time.
struct Days {
  std::string first;
  std::string last;
};

Days FindDays(const ReportInput& input) {
  Days out;
  for (const core::Trial& trial : input.trials) {
    const std::string day = Day(FirstLogged(trial, input));
    if (day.empty()) continue;
    // Days in ISO 8601 sort as texts.
    if (out.first.empty() || day < out.first) out.first = day;
    out.last = std::max(out.last, day);
  }
  return out;
}

// "2026-08-01 to 2026-08-03 (UTC, as logged)", or empty.
std::string DatesText(const ReportInput& input) {
  const Days days = FindDays(input);
  if (days.first.empty()) return "";
  return days.first == days.last
             ? days.first + " (UTC, as logged)"
             : fmt::format("{} to {} (UTC, as logged)", days.first, days.last);
}

// "M. Weber (9 trials); J. Ono (3 trials)"; trials that name nobody do not
// count.
std::string OperatorText(const ReportInput& input) {
  Tally people;
  for (const core::Trial& trial : input.trials) {
    if (trial.conditions) people.Add(trial.conditions->person.name);
  }
  return people.Text();
}

// "21.3 to 22.8 degC in 14 of 18 trials" of one of the conditions: (SI value -
// offset) / unit. Empty where no trial has it.
std::string RangeText(const ReportInput& input,
                      core::Measured core::Conditions::*member, double offset,
                      double unit, const char* symbol) {
  double low = 1e300;
  double high = -1e300;
  double u = 0.0;
  std::size_t n = 0;
  for (const core::Trial& trial : input.trials) {
    if (!trial.conditions || !((*trial.conditions).*member)) continue;
    const core::Estimate& value = *((*trial.conditions).*member);
    low = std::min(low, value.value);
    high = std::max(high, value.value);
    // The least certain value decides on the digits.
    u = std::max(u, value.u);
    ++n;
  }
  if (n == 0) return "";
  const int decimals = std::min(Decimals(u / unit), 2);
  const std::string from = Plain((low - offset) / unit, decimals);
  const std::string to = Plain((high - offset) / unit, decimals);
  return fmt::format("{} {} in {} of {} trials",
                     from == to ? from : from + " to " + to, symbol, n,
                     input.trials.size());
}

// Air temperature and humidity as the trials have them, then what report.toml
// says of the environment.
std::string EnvironmentText(const ReportInput& input) {
  std::string out;
  const auto add = [&out](const std::string& what, const std::string& text) {
    if (!text.empty()) out += (out.empty() ? "" : "; ") + what + text;
  };
  add("air ", RangeText(input, &core::Conditions::temperature_k,
                        core::kIcePoint_k, 1.0, "degC"));
  add("relative humidity ",
      RangeText(input, &core::Conditions::relative_humidity, 0.0, 0.01, "%"));
  add("", input.details.environment);
  return out;
}

// What was not as planned: the statement of report.toml, the anomalies noted
// with trials, how many trials say nothing of anomalies, how many are excluded,
// and changes of the plan after the first trial.
std::string DeviationText(const ReportInput& input) {
  Tally noted;
  std::size_t silent = 0;
  std::size_t excluded = 0;
  for (const core::Trial& trial : input.trials) {
    excluded += trial.excluded ? 1 : 0;
    const core::Anomaly anomaly = trial.conditions
                                      ? trial.conditions->anomaly
                                      : core::Anomaly::kNotRecorded;
    // "Not recorded" is no "none": nobody said that all was well.
    if (anomaly == core::Anomaly::kNotRecorded) {
      ++silent;
    } else if (anomaly != core::Anomaly::kNone &&
               anomaly != core::Anomaly::kNotApplicable) {
      const std::string& note = trial.conditions->anomaly_note;
      noted.Add(std::string(core::Name(anomaly)) +
                (note.empty() ? "" : ": " + note));
    }
  }
  // A look at the answer is an event of the plan, but changes nothing.
  const auto changes = std::count_if(
      input.plan.begin(), input.plan.end(), [](const db::PlanEvent& event) {
        return event.kind != db::PlanEventKind::kLook && event.trials > 0;
      });
  std::string out = input.details.deviations.empty()
                        ? "absent: " + Where("trials.deviations", input)
                        : input.details.deviations;
  const std::string noticed = noted.Text();
  out += noticed.empty() ? "" : "; noted with trials: " + noticed;
  if (silent > 0) {
    out += fmt::format("; {} of {} trials say nothing of anomalies", silent,
                       input.trials.size());
  }
  out += fmt::format(
      "; {} trial{} excluded, {} of the plan after the first "
      "trial (listed with each campaign)",
      excluded, excluded == 1 ? "" : "s",
      changes == 1 ? "one change" : fmt::format("{} changes", changes));
  return out;
}

// The version that made the report and those that analysed the trials: they
// differ where trials are old.
std::string SoftwareText(const ReportInput& input) {
  Tally versions;
  Tally options;
  for (const core::Trial& trial : input.trials) {
    versions.Add(trial.software_version);
    options.Add(trial.options_hash);
  }
  std::string out = "touchdown " + input.software_version + " (report)";
  const std::string analysed = versions.Text();
  if (!analysed.empty()) out += "; trials analysed by " + analysed;
  const std::string digests = options.Text();
  if (!digests.empty()) out += "; options of the analysis: " + digests;
  if (!input.options.empty()) out += "; report made with " + input.options;
  return out;
}

// A text field of an entry of the register; empty where it is not recorded.
std::string EntryText(const db::Entry& entry, std::string_view field) {
  const auto found = entry.texts.find(field);
  if (found == entry.texts.end() || found->second == "not recorded") return "";
  return found->second;
}

// `kind` is the register's word ("camera"), empty for what report.toml alone
// names.
struct EquipmentRow {
  std::string kind;
  Equipment what;
};

// The equipment in the register, in the versions that the trials name.
std::vector<EquipmentRow> RegisteredEquipment(const ReportInput& input) {
  std::vector<EquipmentRow> out;
  for (const db::Entry& entry : input.register_entries) {
    // What was thrown, on what, and by whom, is no equipment.
    if (entry.kind == db::RegisterKind::kBody ||
        entry.kind == db::RegisterKind::kSurface ||
        entry.kind == db::RegisterKind::kOperator) {
      continue;
    }
    EquipmentRow row{std::string(db::Name(entry.kind)), {}};
    row.what.name = entry.name;
    // "Photron, SA-Z, no. 4711, 50 mm": whichever of these the entry has.
    for (const char* field : {"maker", "model", "serial", "lens"}) {
      const std::string text = EntryText(entry, field);
      if (text.empty()) continue;
      row.what.number +=
          (row.what.number.empty() ? "" : ", ") +
          std::string(field == std::string_view("serial") ? "no. " : "") + text;
    }
    row.what.calibrated_on = EntryText(entry, "made_on");
    out.push_back(std::move(row));
  }
  return out;
}

// The register's equipment with what report.toml adds: entries of one name are
// one piece, and what report.toml says of it replaces what the register says.
std::vector<EquipmentRow> AllEquipment(const ReportInput& input) {
  std::vector<EquipmentRow> out = RegisteredEquipment(input);
  for (const Equipment& given : input.details.equipment) {
    const auto same = std::find_if(
        out.begin(), out.end(),
        [&](const EquipmentRow& row) { return row.what.name == given.name; });
    if (same == out.end()) {
      out.push_back({"", given});
      continue;
    }
    const auto fill = [](std::string& to, const std::string& from) {
      if (!from.empty()) to = from;
    };
    fill(same->what.number, given.number);
    fill(same->what.calibrated_on, given.calibrated_on);
    fill(same->what.due_on, given.due_on);
    fill(same->what.certificate, given.certificate);
  }
  return out;
}

// The table of equipment, or a sentence that there is none and where it would
// come from.
std::vector<Block> MakeEquipment(const ReportInput& input) {
  const std::vector<EquipmentRow> rows = AllEquipment(input);
  if (rows.empty()) {
    return {
        Paragraph{"Equipment with calibration and due dates: absent (the "
                  "trials name none of the register, and " +
                  Where("[[equipment]]", input) + ")."}};
  }
  // A calibration that was due before the last trial is marked: the days are
  // compared as texts in ISO 8601.
  const std::string last = FindDays(input).last;
  Table table{"Equipment",
              {{"kind"},
               {"name"},
               {"number"},
               {"calibrated on"},
               {"due on"},
               {"certificate"}},
              {}};
  const auto cell = [](const std::string& text) {
    return text.empty() ? Cell{"absent", Tone::kMuted} : Cell{text};
  };
  for (const auto& [kind, what] : rows) {
    Cell due = cell(what.due_on);
    if (!what.due_on.empty() && what.due_on < last) {
      due = {what.due_on + ", overdue at the last trial", Tone::kBad};
    }
    table.rows.push_back({{kind},
                          {what.name},
                          cell(what.number),
                          cell(what.calibrated_on),
                          due,
                          cell(what.certificate)});
  }
  return {std::move(table)};
}

// ISO/IEC 17025 asks a report that states conformity for its decision rule and
// the risk that goes with it.
constexpr const char* kDecisionRule =
    "A trial is a bounce where the 95 % interval of its greatest gap lies "
    "above "
    "the campaign's bounce height, not a bounce where it lies below, else "
    "undecided. A declared theory is confirmed where the boundary's 90 % "
    "interval lies within its value \u00b1 margin, contradicted where the 95 % "
    "interval lies outside of value \u00b1 (margin + U of the theory), else "
    "inconclusive. Risk, by simulation: at most 5 of 100 campaigns see a false "
    "verdict.";

}  // namespace

std::string Where(std::string_view key, const ReportInput& input) {
  return input.details.file.empty()
             ? fmt::format("no report.toml was given, {} would say it", key)
             : fmt::format("{} does not say {}", input.details.file, key);
}

Section MakeCover(const ReportInput& input) {
  Section section;
  auto& out = section.blocks;
  out.push_back(Heading{2, "Order, laboratory, equipment"});
  // Lines of the cover that the trials themselves can fill. They replace what
  // report.toml says under the same key; environment and deviations contain it.
  const std::map<std::string_view, std::string> known{
      {"trials.dates", DatesText(input)},
      {"trials.operator", OperatorText(input)},
      {"trials.environment", EnvironmentText(input)},
      {"trials.deviations", DeviationText(input)}};
  Terms terms;
  std::vector<std::string> absent;
  for (const DetailField& field : DetailFields()) {
    const auto found = known.find(field.key);
    std::string text = found == known.end() ? "" : found->second;
    if (text.empty()) text = input.details.*field.member;
    if (text.empty()) {
      // The key stands beside the name, so that a reader knows what to write.
      absent.push_back(fmt::format("{} ({})", field.name, field.key));
      continue;
    }
    terms.items.emplace_back(field.name, std::move(text));
  }
  terms.items.emplace_back(
      "date of the report",
      input.made_on.empty() ? "absent: no clock was asked" : input.made_on);
  terms.items.emplace_back("software and options", SoftwareText(input));
  terms.items.emplace_back("decision rule and risk", kDecisionRule);
  if (!absent.empty()) {
    std::string names;
    for (const std::string& name : absent) {
      names += (names.empty() ? "" : ", ") + name;
    }
    terms.items.emplace_back(
        "absent",
        fmt::format("{}. {}", names,
                    input.details.file.empty()
                        ? "No report.toml was given; `touchdown report "
                          "--details-example` prints one."
                        : input.details.file + " does not say it."));
  }
  out.push_back(std::move(terms));
  for (Block& block : MakeEquipment(input)) out.push_back(std::move(block));
  Table signatures{
      "Signatures", {{"role"}, {"name"}, {"date and signature"}}, {}};
  // Without names there are still lines to sign on.
  std::vector<Signature> lines = input.details.signatures;
  if (lines.empty()) lines = {{"tested by", ""}, {"authorised by", ""}};
  for (const Signature& line : lines) {
    signatures.rows.push_back({{line.role},
                               {line.name.empty() ? "absent" : line.name},
                               {"____________________________________"}});
  }
  out.push_back(std::move(signatures));
  out.push_back(Paragraph{
      "The results speak of the items tested and of no others. u is a standard "
      "uncertainty; an interval is one of 95 % unless it says otherwise.",
      true});
  return section;
}

}  // namespace touchdown::report
