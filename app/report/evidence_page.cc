// The page of one trial, from what happened to who states it. All tables are
// made of the stored trial; nothing is measured again. Contacts after the first
// have the same tables under a heading each.
#include "app/report/evidence_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "app/facts/analysis_facts.h"
#include "app/report/content.h"
#include "app/report/group.h"
#include "app/report/set_points.h"
#include "app/text/format.h"
#include "app/text/text.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// A table of names and values; rows without a value are left out. A measured
// number that is absent is a row all the same: its reason is a fact.
class Facts {
 public:
  explicit Facts(std::string caption)
      : table_{std::move(caption), {{""}, {""}}, {}} {}
  void Add(std::string name, const std::string& value) {
    if (!value.empty()) table_.rows.push_back({{std::move(name)}, {value}});
  }
  // `m` in multiples of `unit`, with the name of that unit behind it.
  void Add(std::string name, const core::Measured& m, double unit,
           const char* symbol) {
    std::string text = WithUOrReason(m, unit);
    if (m && *symbol != '\0') text += std::string(" ") + symbol;
    Add(std::move(name), text);
  }
  void AppendTable(std::vector<Block>& out) const {
    if (!table_.rows.empty()) out.push_back(table_);
  }

 private:
  Table table_;
};

// Time, angles, corner and duration of one contact. The angle of `kind`, which
// the protocol names, is marked as the contact angle. A face angle is shown
// with its sign; the contact angle is its magnitude.
void AddContact(const core::ContactRecord& record, core::AngleKind kind,
                const std::string& caption, std::vector<Block>& out) {
  const core::Contact& contact = record.contact;
  Facts facts(caption);
  if (!contact.found) facts.Add("contact", "not found: " + contact.reason);
  const auto angle = [&](core::AngleKind which, const core::Measured& value) {
    const char* const names = which == core::AngleKind::kFace
                                  ? " (its magnitude is the contact angle)"
                                  : " (the contact angle)";
    facts.Add(fmt::format("{} angle{}", core::Name(which),
                          which == kind ? names : ""),
              value, kDegree, "deg");
  };
  angle(core::AngleKind::kApproach, contact.approach_angle_rad);
  angle(core::AngleKind::kRadius, contact.radius_angle_rad);
  angle(core::AngleKind::kFace, contact.face_angle_rad);
  if (contact.corner) {
    facts.Add("corner", std::string(core::Name(*contact.corner)));
  }
  facts.Add("time", contact.time_s, 1.0, "s");
  facts.Add("frame", contact.frame, 1.0, "(from 0 in the file)");
  facts.Add("duration, touchdown to release", contact.duration_s, 1e-3, "ms");
  facts.AppendTable(out);
}

// What was seen between release and the end of the film, against the bounce
// height, and why it is called what it is called.
void AddState(const core::StateDecision& state, const std::string& caption,
              std::vector<Block>& out) {
  Facts facts(caption);
  facts.Add("motion state",
            fmt::format("{} (in the paper's two words: {})",
                        core::Name(state.label), PaperWord(state.label)));
  facts.Add("because", state.reason);
  facts.Add("P(bounce)", state.p_bounce ? Probability(*state.p_bounce)
                                        : "absent: " + state.reason);
  facts.Add("greatest gap", state.max_gap_m, kMillimetre, "mm");
  facts.Add("greatest gap that the flight would reach",
            state.extrapolated_gap_m, kMillimetre, "mm");
  facts.Add("bounce height", state.bounce_height_m, kMillimetre, "mm");
  facts.Add("detectable gap", state.detectable_gap_m, kMillimetre, "mm");
  if (state.micro_bounce) facts.Add("micro-bounce", "yes");
  facts.AppendTable(out);
}

// Velocities of the centre in the plane frame (m/s, upward and along the
// direction of travel positive) and spin (rad/s, counter-clockwise), then the
// ratios made of them.
void AddMotion(const core::Motion& m, const std::string& caption,
               std::vector<Block>& out) {
  Table table{caption,
              {{""},
               {fmt::format("at touchdown {} u", kPlusMinus), true},
               {fmt::format("at release {} u", kPlusMinus), true}},
              {}};
  const auto row = [&](const char* name, const core::Measured& before,
                       const core::Measured& after) {
    table.rows.push_back(
        {{name}, {WithUOrReason(before, 1.0)}, {WithUOrReason(after, 1.0)}});
  };
  // The speed at release is not a stored number; its cell stays empty.
  row("speed of the centre (m/s)", m.before_speed_mps,
      core::AbsentBecause("see its parts"));
  table.rows.back()[2].text.clear();
  row("along the normal (m/s)", m.before_normal_mps, m.after_normal_mps);
  row("along the ground (m/s)", m.before_tangential_mps,
      m.after_tangential_mps);
  row("spin (rad/s)", m.before_omega_rad_per_s, m.after_omega_rad_per_s);
  out.push_back(std::move(table));
  Facts facts("");
  facts.Add("restitution of the contact point", m.restitution, 1.0, "");
  facts.Add("centre's rebound ratio", m.centre_rebound_ratio, 1.0, "");
  facts.Add("impulse ratio", m.impulse_ratio, 1.0, "");
  facts.Add("gravity, fitted freely", m.gravity_check_mps2, 1.0, "m/s\u00b2");
  facts.AppendTable(out);
}

// The budget of the contact angle, the largest source first, with each share of
// the variance. Shares are of the sum of the squares in the table, so that they
// add up to the whole.
void AddBudget(const core::Trial& trial, std::vector<Block>& out) {
  const core::Budget& budget = AngleBudget(trial);
  if (budget.empty()) {
    out.push_back(Paragraph{
        "No uncertainty budget of the contact angle was recorded.", true});
    return;
  }
  double squares = 0.0;
  for (const auto& line : budget) squares += line.u * line.u;
  // Stable, so that equal lines keep the order of the budget.
  core::Budget sorted = budget;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.u > b.u; });
  Table table{
      fmt::format("Uncertainty budget of the {} angle",
                  core::Name(trial.angle_kind)),
      {{"source"}, {"u (deg)", true}, {"share of the variance (%)", true}},
      {}};
  for (const auto& line : sorted) {
    table.rows.push_back(
        {{line.source},
         {fmt::format("{:.3g}", line.u / kDegree)},
         {fmt::format("{:.1f}",
                      squares > 0.0 ? 100 * line.u * line.u / squares : 0.0)}});
  }
  table.rows.push_back({{"root of the sum of squares"},
                        {fmt::format("{:.3g}", std::sqrt(squares) / kDegree)},
                        {""}});
  out.push_back(std::move(table));
}

// Who states this revision and why, from which recording, by which version with
// which options.
void AddRecord(const core::Trial& trial, std::vector<Block>& out) {
  Facts facts("The record");
  facts.Add("trial", trial.id);
  facts.Add("campaign", trial.campaign.empty() ? "(none)" : trial.campaign);
  facts.Add("origin", std::string(core::Name(trial.origin)));
  facts.Add("revision", fmt::format("{}", trial.revision));
  facts.Add("stated by", trial.author);
  facts.Add("because", trial.reason);
  facts.Add("at (UTC)", trial.recorded_at_utc);
  if (trial.excluded) facts.Add("excluded", trial.exclusion_reason);
  facts.Add("recording", trial.clip.path);
  facts.Add("its digest", trial.clip.id);
  facts.Add("its SHA-256", trial.clip.sha256);
  facts.Add("analysed by version", trial.software_version);
  facts.Add("options of the analysis (digest)", trial.options_hash);
  facts.AppendTable(out);
}

// The bytes of a picture that analyze or batch wrote. Throws core::InputError
// where it cannot be read.
std::string ReadPicture(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file || bytes.empty()) {
    throw core::InputError(fmt::format(
        "{}: cannot be read; analyse the recording again with --out",
        path.string()));
  }
  return bytes;
}

// The picture that --out wrote where the user gave its folder, else the strip
// from the recording, else a sentence that says why there is neither.
void AddPicture(const core::Trial& trial, const ReportInput& input,
                std::vector<Block>& out) {
  const auto found = input.pictures.find(trial.id);
  const auto strip = input.strips.find(trial.id);
  if (found == input.pictures.end() && strip != input.strips.end()) {
    out.push_back(DrawStrip(strip->second, StripCaption(trial)));
    out.push_back(Paragraph{kStripLegend, true});
    return;
  }
  if (found == input.pictures.end()) {
    out.push_back(Paragraph{
        trial.clip.path.empty()
            ? "Logged by hand: there is no recording and no picture."
            : "No picture of this analysis was found: analyze and batch write "
              "one with --out FOLDER, and report takes it with --evidence "
              "FOLDER.",
        true});
    return;
  }
  out.push_back(Picture{
      Base64(ReadPicture(found->second)),
      "Frames around the contact, with the body's outline, the ground line and "
      "the fitted flights drawn in.",
      "The frames around the contact. Drawn in: outline, ground line, the "
      "flights before and after."});
}

}  // namespace

// The id of a trial is a UUID in a store, but any text in a file: "../x" must
// not become a path.
std::string EvidencePageName(const core::Trial& trial) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           (c >= '0' && c <= '9') || c == '-';
  };
  // A file name is limited to some 250 bytes.
  constexpr std::size_t kLongest = 80;
  if (!trial.id.empty() && trial.id.size() <= kLongest &&
      std::all_of(trial.id.begin(), trial.id.end(), plain)) {
    return trial.id + ".html";
  }
  std::string name = trial.id;
  std::replace_if(
      name.begin(), name.end(), [&](char c) { return !plain(c); }, '-');
  // What is cut off or replaced is in the digest, so that names differ where
  // ids do.
  return fmt::format("{}-{:016x}.html", name.substr(0, kLongest),
                     Digest(trial.id));
}

std::string EvidenceLink(const ReportInput& input, const core::Trial& trial) {
  return input.evidence_pages ? "evidence/" + EvidencePageName(trial) : "";
}

Document MakeEvidencePage(const core::Trial& trial, const ReportInput& input) {
  const core::Measured angle = core::ContactAngle(trial);
  const core::StateDecision& state = trial.first.state;
  Document document;
  // "shot7.mraw: approach angle 12.400 ± 0.050 deg, bounce".
  document.title = fmt::format(
      "{}: {} angle {}, {}", TrialName(trial), core::Name(trial.angle_kind),
      angle ? WithU(*angle, kDegree) + " deg" : "absent",
      core::Name(state.label));
  document.footer = fmt::format("Evidence of trial {}", trial.id);
  Section section{trial.origin == core::Origin::kSimulated, {}};
  auto& out = section.blocks;
  // The page lies in evidence/, one folder below the report.
  out.push_back(Link{"../table1.html", "The report"});
  if (trial.excluded) {
    out.push_back(Callout{"Excluded.", trial.exclusion_reason, Tone::kBad});
  }
  AddPicture(trial, input, out);
  AddState(state, "What happened", out);
  AddContact(trial.first, trial.angle_kind, "The contact", out);
  AddBudget(trial, out);
  AddMotion(trial.first.motion, "The motion", out);
  for (Block& block : MakeTrialSetPoints(trial, input)) {
    out.push_back(std::move(block));
  }
  // Contacts are counted from 1, and the first is above.
  for (std::size_t i = 0; i < trial.later.size(); ++i) {
    out.push_back(Heading{2, fmt::format("Contact {}", i + 2)});
    AddState(trial.later[i].state, "What happened", out);
    AddContact(trial.later[i], trial.angle_kind, "The contact", out);
    AddMotion(trial.later[i].motion, "The motion", out);
  }
  // What the stored analysis says of camera, scale and scene; empty for a trial
  // that was typed.
  Facts seen("How it was seen");
  for (const auto& [name, value] : AnalysisFacts(trial)) seen.Add(name, value);
  seen.AppendTable(out);
  AddRecord(trial, out);
  document.sections.push_back(std::move(section));
  return document;
}

void WriteEvidencePages(const ReportInput& input,
                        const std::filesystem::path& folder) {
  const std::filesystem::path pages = folder / "evidence";
  std::error_code trouble;
  std::filesystem::create_directories(pages, trouble);
  if (trouble) {
    throw core::OutputError(
        fmt::format("{}: cannot be made: {}; give a folder that can",
                    pages.string(), trouble.message()));
  }
  for (const core::Trial& trial : input.trials) {
    WriteTextFile(pages / EvidencePageName(trial),
                  ToHtml(MakeEvidencePage(trial, input)));
  }
}

}  // namespace touchdown::report
