#include <fmt/format.h>

#include <map>
#include <tuple>
#include <utility>

#include "register_rows.h"
#include "schema_parts.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"
#include "touchdown/db/views.h"

namespace touchdown::db {
namespace {

// A view, and the SQL of each of its columns.
class Maker {
 public:
  Maker(std::string name, std::string one_row)
      : view_{std::move(name), std::move(one_row), {}} {}

  void Text(std::string name, const std::string& sql, std::string meaning) {
    Add(std::move(name), ColumnType::kText, sql, std::move(meaning));
  }
  void Integer(std::string name, const std::string& sql, std::string meaning) {
    Add(std::move(name), ColumnType::kInteger, sql, std::move(meaning));
  }
  void Plain(std::string name, const std::string& sql, std::string meaning) {
    Add(std::move(name), ColumnType::kReal, sql, std::move(meaning));
  }
  // Of the first contact f, in deg: the angle that the statement names.
  // core::ContactAngle: of kind face the magnitude, so that below 0 the ends of
  // an interval change places.
  void Angle(std::string name, std::string_view part, std::string meaning) {
    std::string face = fmt::format("f.face_angle_rad{}", part);
    if (part.empty()) {
      face = fmt::format("abs({})", face);
    } else if (part != "_u") {
      face = fmt::format(
          "CASE WHEN f.face_angle_rad < 0 THEN -f.face_angle_rad{} ELSE {} END",
          part == "_low" ? "_high" : "_low", face);
    }
    Add(std::move(name), ColumnType::kReal,
        fmt::format(
            "CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad{0} "
            "WHEN 'face' THEN {1} "
            "ELSE f.approach_angle_rad{0} END / {2}",
            part, face, core::kDegree),
        std::move(meaning));
  }
  // In the unit of the edge; `inner` names column `column` of table `table`.
  void Real(std::string_view inner, std::string_view table,
            const std::string& meaning) {
    const core::EdgeUnit unit = core::AtTheEdge(inner);
    Add(unit.stem + unit.suffix, ColumnType::kReal,
        AtTheEdge(unit, fmt::format("{}.{}", table, inner), unit.offset),
        meaning);
  }
  // Five columns, as the store has them.
  void Measured(std::string_view inner, std::string_view table,
                const std::string& meaning) {
    const core::EdgeUnit unit = core::AtTheEdge(inner);
    const auto at = [&](std::string_view part) {
      return fmt::format("{}.{}{}", table, inner, part);
    };
    const std::string name = unit.stem + unit.suffix;
    Add(name, ColumnType::kReal, AtTheEdge(unit, at(""), unit.offset), meaning);
    Add(unit.stem + "_u" + unit.suffix, ColumnType::kReal,
        AtTheEdge(unit, at("_u"), 0.0),
        fmt::format("standard uncertainty of {}", name));
    Add(unit.stem + "_low" + unit.suffix, ColumnType::kReal,
        AtTheEdge(unit, at("_low"), unit.offset),
        fmt::format(
            "lower end of the 95 % interval of {}, where it has its own",
            name));
    Add(unit.stem + "_high" + unit.suffix, ColumnType::kReal,
        AtTheEdge(unit, at("_high"), unit.offset),
        fmt::format("upper end of the same of {}", name));
    Add(name + "_absent", ColumnType::kText, at("_absent"),
        fmt::format("why {} has no value", name));
  }
  void Body(std::string_view table) {
    Text("body_kind", fmt::format("{}.body_kind", table),
         "sphere or rectangle");
    for (const auto& quantity : core::kBodyQuantities) {
      Measured(quantity.name, table, std::string(quantity.meaning));
    }
  }

  std::pair<View, std::string> Done(const std::string& from) {
    return {std::move(view_), fmt::format("SELECT\n{}\n{}", columns_, from)};
  }

 private:
  static std::string AtTheEdge(const core::EdgeUnit& unit, std::string sql,
                               double offset) {
    if (offset != 0.0) sql = fmt::format("({} - {})", sql, offset);
    return unit.factor == 1.0 ? sql : fmt::format("{} / {}", sql, unit.factor);
  }
  void Add(std::string name, ColumnType type, const std::string& sql,
           std::string meaning) {
    columns_ +=
        fmt::format("{}  {} AS {}", columns_.empty() ? "" : ",\n", sql, name);
    const std::string unit = type == ColumnType::kReal ? FindUnit(name) : "";
    view_.columns.push_back({std::move(name), type, unit, std::move(meaning)});
  }

  View view_;
  std::string columns_;
};

// The trials t with what is in force of them: campaign c, clip k, revision r,
// statement s, first contact f, exclusion x, conditions o. A proposal is never
// in force.
constexpr std::string_view kTrials =
    "FROM trials t\n"
    "JOIN revisions r ON r.trial_id = t.id AND r.number =\n"
    "  (SELECT max(number) FROM revisions\n"
    "   WHERE trial_id = t.id AND kind <> 'proposed')\n"
    "JOIN statements s ON s.revision_id = r.statement_id\n"
    "LEFT JOIN campaigns c ON c.id = t.campaign_id\n";

void Identity(Maker& view) {
  view.Text("trial", "t.uuid", "UUID of the trial");
  view.Text("campaign", "c.name", "name; NULL: in none");
}

std::pair<View, std::string> Campaigns() {
  Maker view("v_campaigns", "a campaign");
  view.Text("campaign", "c.name", "its name");
  view.Body("c");
  view.Text("surface", "f.name", "name in the register");
  view.Text("angle_kind", "c.angle_kind",
            "approach, radius or face: the angle that is varied");
  view.Real("bounce_height_m", "c", "rising above it is what bounce means");
  view.Real("speed_min_mps", "c", "lower end of the speed band");
  view.Real("speed_max_mps", "c", "upper end of the speed band");
  view.Text("theory_name", "nullif(c.theory_name, '')", "the theory declared");
  view.Real("theory_boundary_rad", "c", "boundary angle of that theory");
  view.Real("theory_u_rad", "c", "standard uncertainty of the theory");
  view.Real("margin_rad", "c", "equivalence margin");
  view.Text("created_at_utc", "c.created_at_utc", "when it was made");
  view.Integer("trials",
               "(SELECT count(*) FROM trials WHERE campaign_id = c.id)",
               "how many trials it has, excluded ones too");
  return view.Done(
      "FROM campaigns c LEFT JOIN surfaces f ON f.id = c.surface_id\n"
      "ORDER BY c.name");
}

std::pair<View, std::string> Trials() {
  Maker view("v_trials",
             "a trial, as the revision in force states it; its first contact");
  Identity(view);
  view.Text("origin", "t.origin",
            "recorded, simulated or manual: never pooled");
  view.Text("logged_at_utc", "t.logged_at_utc", "when it was first logged");
  view.Integer("revision", "r.number", "the one in force");
  view.Text("revised_at_utc", "r.recorded_at_utc", "when that was stated");
  view.Text("author", "r.author", "who stated it");
  view.Text("reason", "nullif(r.reason, '')", "why");
  view.Integer("excluded", "r.exclusion_id IS NOT NULL",
               "1: the trial does not count");
  view.Text("exclusion_reason", "x.reason", "why not");
  view.Body("s");
  view.Real("set_angle_rad", "s", "set-point of the varied angle");
  view.Real("set_speed_mps", "s", "set-point of the launch speed");
  view.Text("angle_kind", "s.angle_kind",
            "approach, radius or face: what contact_angle_deg is");
  for (const auto& [part, name, meaning] :
       {std::tuple("", "contact_angle_deg",
                   "the angle that angle_kind names; of kind face its "
                   "magnitude"),
        std::tuple("_u", "contact_angle_u_deg", "its standard uncertainty"),
        std::tuple("_low", "contact_angle_low_deg",
                   "lower end of its 95 % interval, where it has its own"),
        std::tuple("_high", "contact_angle_high_deg",
                   "upper end of the same")}) {
    view.Angle(name, part, meaning);
  }
  view.Text("contact_angle_deg_absent",
            "CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad_absent "
            "WHEN 'face' THEN f.face_angle_rad_absent "
            "ELSE f.approach_angle_rad_absent END",
            "why it has no value");
  view.Text("state", "f.state",
            "bounce, slide, roll-slide, roll, stick, stays-down or undecided");
  view.Plain("p_bounce", "f.p_bounce", "probability of a bounce");
  view.Text("state_because", "f.state_because", "evidence of the state");
  view.Integer("contacts", "s.contacts", "how many v_contacts has");
  for (const auto& entry : kConditionEntries) {
    view.Text(std::string(Name(entry.kind)),
              fmt::format("(SELECT name FROM {} WHERE id = o.{}_id)",
                          FindTable(entry.kind).table, Name(entry.kind)),
              "name in the register");
  }
  for (const auto& quantity : kConditionQuantities) {
    view.Measured(quantity.name, "o", std::string(quantity.meaning));
  }
  view.Text("anomaly", "o.anomaly", "what was not as it should be");
  view.Text("anomaly_note", "nullif(o.anomaly_note, '')", "what it was");
  view.Text("note", "nullif(o.note, '')", "the operator's");
  view.Text("clip_path", "nullif(s.clip_path, '')",
            "where the recording was when it was analysed");
  view.Text("clip_id", "k.clip_id", "clip.id of `touchdown analyze`");
  view.Text("clip_sha256", "k.sha256", "of the whole recording");
  view.Integer("clip_size_bytes", "k.size_bytes", "of the recording");
  view.Text("software_version", "nullif(s.software_version, '')",
            "of the analysis");
  view.Text("options_hash", "nullif(s.options_hash, '')",
            "digest of the options of the analysis");
  return view.Done(
      std::string(kTrials) +
      "JOIN contacts f ON f.revision_id = s.revision_id AND f.ordinal = 0\n"
      "LEFT JOIN clips k ON k.id = t.clip_id\n"
      "LEFT JOIN exclusions x ON x.revision_id = r.exclusion_id\n"
      "LEFT JOIN conditions o ON o.revision_id = r.conditions_id\n"
      "ORDER BY t.id");
}

std::pair<View, std::string> Contacts() {
  Maker view("v_contacts", "a contact of a trial, as it is in force");
  Identity(view);
  view.Integer("contact", "f.ordinal + 1", "1: the first");
  view.Integer("found", "f.found", "1: a touchdown was seen");
  view.Text("not_found_because", "nullif(f.not_found_because, '')", "why not");
  view.Integer("from_start", "f.from_start",
               "1: on the ground from the first frame");
  view.Text("corner", "f.corner",
            "of a rectangle, which came first: leading, trailing or flush");
  view.Text("state", "f.state",
            "bounce, slide, roll-slide, roll, stick, stays-down or undecided");
  view.Plain("p_bounce", "f.p_bounce", "probability of a bounce");
  view.Text("state_because", "f.state_because", "evidence of the state");
  view.Integer("micro_bounce", "f.micro_bounce",
               "1: it left the ground below the bounce height");
  for (const auto& quantity : core::kContactQuantities) {
    view.Measured(quantity.name, "f", std::string(quantity.meaning));
  }
  return view.Done(std::string(kTrials) +
                   "JOIN contacts f ON f.revision_id = s.revision_id\n"
                   "ORDER BY t.id, f.ordinal");
}

std::string NumberOfRow(int i) {
  return fmt::format(
      "json_extract('[' || replace(p.value, ' ', ',') || ']', '$[{}]')", i);
}

// Of a document's "path": rows of text, numbers in the order of these columns.
std::pair<View, std::string> Tracks() {
  Maker view("v_tracks",
             "a frame in which the body was measured; none of a trial without "
             "an analysis, or of one logged before version 8 of the store");
  Identity(view);
  view.Integer("frame", NumberOfRow(0), "from 0");
  int i = 0;
  for (const auto& [name, meaning] :
       {std::pair("time_s", "0 is the middle of frame 0"),
        std::pair("x_mm",
                  "of the centre, along the ground in the direction of "
                  "travel"),
        std::pair("y_mm", "of the centre above the ground line"),
        std::pair("gap_mm", "of the body's lowest point above the ground line"),
        std::pair(
            "face_angle_deg",
            "of a rectangle's long side to the ground, leading end up")}) {
    view.Plain(name, NumberOfRow(++i), meaning);
  }
  return view.Done(std::string(kTrials) +
                   "JOIN json_each(CASE WHEN json_valid(s.document_json)\n"
                   "  THEN s.document_json ELSE '{}' END, '$.path.rows') p\n"
                   "ORDER BY t.id, p.id");
}

std::pair<View, std::string> Revisions() {
  Maker view("v_revisions", "an act on a trial; nothing is ever removed");
  Identity(view);
  view.Integer("revision", "r.number", "1, 2, 3 ...");
  view.Text("kind", "r.kind",
            "logged, corrected, excluded, included, merged or proposed");
  view.Text("author", "r.author", "who");
  view.Text("reason", "nullif(r.reason, '')", "why");
  view.Text("recorded_at_utc", "r.recorded_at_utc", "when");
  view.Text("sha256",
            "(SELECT sha256 FROM chain WHERE subject = 'revision' AND key = "
            "r.uuid)",
            "of this revision and all that was recorded before it");
  return view.Done(
      "FROM revisions r JOIN trials t ON t.id = r.trial_id\n"
      "LEFT JOIN campaigns c ON c.id = t.campaign_id\n"
      "ORDER BY t.id, r.number");
}

struct Made {
  std::vector<View> views;
  std::map<std::string, std::string, std::less<>> queries;
  std::string sql;
};

std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    quoted += c;
    if (c == '\'') quoted += c;
  }
  return quoted + "'";
}

const Made& AllViews() {
  static const Made made = [] {
    Made all;
    std::string rows;
    for (auto& [view, select] :
         {Campaigns(), Trials(), Contacts(), Tracks(), Revisions()}) {
      all.sql += fmt::format("CREATE VIEW {} AS {};\n", view.name, select);
      for (const ViewColumn& column : view.columns) {
        rows += fmt::format("{}\n  ({}, {}, {}, {}, {})",
                            rows.empty() ? "" : ",", Quoted(view.name),
                            Quoted(column.name), Quoted(Name(column.type)),
                            column.unit.empty() ? "NULL" : Quoted(column.unit),
                            Quoted(column.meaning));
      }
      all.queries[view.name] = select;
      all.views.push_back(view);
    }
    all.sql += fmt::format(
        "CREATE VIEW v_columns (view_name, column_name, type, unit, meaning) "
        "AS VALUES{};\n",
        rows);
    return all;
  }();
  return made;
}

}  // namespace

std::string_view Name(ColumnType type) {
  switch (type) {
    case ColumnType::kText:
      return "text";
    case ColumnType::kInteger:
      return "integer";
    case ColumnType::kReal:
      break;
  }
  return "real";
}

std::string FindUnit(std::string_view edge_name) {
  // Endings of names and their units; the longer of two endings stands first.
  static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_n_per_m", "N/m"}, {"_rad_per_s", "rad/s"},
      {"_mps2", "m/s2"},   {"_mps", "m/s"},
      {"_deg", "deg"},     {"_mm", "mm"},
      {"_gpa", "GPa"},     {"_g", "g"},
      {"_s", "s"},         {"_c", "degC"},
      {"frame", "frame"}};
  for (const auto& [suffix, unit] : kUnits) {
    if (edge_name.ends_with(suffix)) return std::string(unit);
  }
  return {};
}

const std::vector<View>& Views() { return AllViews().views; }

std::string ViewsSql() { return AllViews().sql; }

const std::string& ViewQuery(std::string_view view) {
  return AllViews().queries.find(view)->second;
}

}  // namespace touchdown::db
