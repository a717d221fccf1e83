// The table of all columns, made once by MakeColumns(). A column is its name,
// its meaning and two functions, so that reader and writer take them in any
// order and no column is described twice. Cells bear degrees and millimetres;
// the functions convert to and from SI and radians.
#include "app/exchange/trial_csv_columns.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>

#include "app/text/parse_number.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"

namespace touchdown::report {

using core::Trial;

namespace {

// The number in a cell, in the unit of its column. Throws std::invalid_argument
// saying what was expected for anything else: a decimal comma, a unit behind
// the number, inf or nan. A leading plus is taken, as people type it.
double ToNumber(const std::string& cell) {
  std::string_view unsigned_cell = cell;
  if (unsigned_cell.starts_with('+')) unsigned_cell.remove_prefix(1);
  const auto value = ParseNumber<double>(unsigned_cell);
  if (!value || !std::isfinite(*value)) {
    throw std::invalid_argument("a number with a decimal point was expected");
  }
  return *value;
}

// A count or size; a negative one is the user's mistake.
std::int64_t ToInteger(const std::string& cell) {
  const auto value = ParseNumber<std::int64_t>(cell);
  if (!value || *value < 0) {
    throw std::invalid_argument("a whole number >= 0 was expected");
  }
  return *value;
}

// Words, and not 1 and 0: a spreadsheet shows what is meant.
bool ToFlag(const std::string& cell) {
  if (cell == "yes") return true;
  if (cell == "no") return false;
  throw std::invalid_argument("yes or no was expected");
}

// The shortest digits that read as this double again.
std::string Shortest(double value) { return fmt::format("{}", value); }

// Collects the columns in the order of the file.
class Columns {
 public:
  // A column of free text. `at` gives the place of the text in a trial. It
  // takes a trial that can be changed; for writing, the const is cast away and
  // nothing is changed.
  void Text(std::string name, std::string meaning, std::string& (*at)(Trial&)) {
    columns_.push_back(
        {{std::move(name), std::move(meaning)},
         [at](const Trial& t) { return at(const_cast<Trial&>(t)); },
         [at](Trial& t, const std::string& cell) { at(t) = cell; }});
  }

  // A column of one of the words of an enumeration. `words` lists them for the
  // column's meaning and for the message about a cell that is none of them.
  template <class T>
  void Word(std::string name, std::string meaning, T& (*at)(Trial&),
            std::optional<T> (*parse)(std::string_view),
            const std::string& words) {
    columns_.push_back(
        {{std::move(name), std::move(meaning) + ": " + words},
         [at](const Trial& t) {
           return std::string(core::Name(at(const_cast<Trial&>(t))));
         },
         [at, parse, words](Trial& t, const std::string& cell) {
           const auto word = parse(cell);
           if (!word) {
             throw std::invalid_argument(words + " was expected");
           }
           at(t) = *word;
         }});
  }

  // Two columns, value and standard uncertainty, in the unit of the edge.
  // `inner` is the name in SI, as "diameter_m", which becomes diameter_mm and
  // diameter_u_mm; `select` gives the index-th quantity of a trial.
  void Measured(std::string_view inner, std::string_view meaning,
                core::Measured& (*select)(Trial&, std::size_t),
                std::size_t index) {
    Measured(
        inner, meaning,
        [select, index](const Trial& t) {
          return &select(const_cast<Trial&>(t), index);
        },
        [select, index](Trial& t) { return &select(t, index); });
  }

  // The same for a quantity that the trial may not have a place for: `get` may
  // give nothing, which is an empty cell; `set` never does.
  void Measured(std::string_view inner, std::string_view meaning,
                const std::function<const core::Measured*(const Trial&)>& get,
                const std::function<core::Measured*(Trial&)>& set) {
    const core::EdgeUnit unit = core::AtTheEdge(inner);
    const std::string u_name = unit.stem + "_u" + unit.suffix;
    columns_.push_back(
        {{unit.stem + unit.suffix, fmt::format("{}; empty: absent", meaning),
          true},
         [get, unit](const Trial& t) {
           const auto* m = get(t);
           if (m == nullptr || !*m) return std::string();
           const double value = (*m)->value;
           // A sum (degrees Celsius from kelvin) does not come back to its last
           // digit: 12 digits hide what it adds.
           return unit.offset == 0.0
                      ? Shortest(value / unit.factor)
                      : fmt::format("{:.12g}",
                                    (value - unit.offset) / unit.factor);
         },
         [set, unit](Trial& t, const std::string& cell) {
           const double value = ToNumber(cell) * unit.factor + unit.offset;
           auto& m = *set(t);
           // ReadTrialsCsv() refuses the row if no column replaces this -1.
           if (m) {
             m->value = value;
           } else {
             m = core::Estimate{value, -1.0, std::nullopt};  // u must follow
           }
         }});
    columns_.push_back(
        {{u_name, "its standard uncertainty", true},
         [get, unit](const Trial& t) {
           const auto* m = get(t);
           return m != nullptr && *m ? Shortest((*m)->u / unit.factor)
                                     : std::string();
         },
         [set, unit](Trial& t, const std::string& cell) {
           const double u = ToNumber(cell) * unit.factor;
           if (u < 0) throw std::invalid_argument("a number >= 0 was expected");
           auto& m = *set(t);
           // The values have been read: an uncertainty without a value is a
           // slip of columns.
           if (!m) {
             throw std::invalid_argument("u of an empty value");
           }
           m->u = u;
         },
         true});
  }

  void Add(TrialColumn column) { columns_.push_back(std::move(column)); }
  std::vector<TrialColumn> Done() { return std::move(columns_); }

 private:
  std::vector<TrialColumn> columns_;
};

// A number without uncertainty that may be absent (an empty cell), with
// `factor` inner units in a unit of the column: kDegree for "_deg".
TrialColumn OptionalNumber(std::string name, std::string meaning, double factor,
                           std::optional<double>& (*at)(Trial&)) {
  return {{std::move(name), std::move(meaning), true},
          [at, factor](const Trial& t) {
            const auto& value = at(const_cast<Trial&>(t));
            return value ? Shortest(*value / factor) : std::string();
          },
          [at, factor](Trial& t, const std::string& cell) {
            at(t) = ToNumber(cell) * factor;
          }};
}

// A column of yes and no.
TrialColumn Flag(std::string name, std::string meaning, bool& (*at)(Trial&)) {
  return {{std::move(name), std::move(meaning) + ": yes or no"},
          [at](const Trial& t) {
            return std::string(at(const_cast<Trial&>(t)) ? "yes" : "no");
          },
          [at](Trial& t, const std::string& cell) { at(t) = ToFlag(cell); }};
}

// The trial's conditions, made at the first cell that states one: a trial
// without any such cell has none, which is not the same as empty ones.
core::Conditions& Stated(Trial& t) {
  return t.conditions ? *t.conditions : t.conditions.emplace();
}

// The columns of the circumstances of a shot: entries of the register by their
// name, numbers in the unit of the edge, notes and the anomaly.
void AddConditions(Columns& c) {
  for (const auto& [kind, member] : db::kConditionEntries) {
    c.Add({{std::string(Name(kind)), "name in the register; empty: none"},
           [member = member](const Trial& t) {
             return t.conditions ? ((*t.conditions).*member).name
                                 : std::string();
           },
           [member = member](Trial& t, const std::string& cell) {
             Stated(t).*member = {cell, ""};
           }});
  }
  // Two columns each, as for the quantities of the trial itself.
  for (const auto& quantity : db::kConditionQuantities) {
    c.Measured(
        quantity.name, quantity.meaning,
        [member = quantity.member](const Trial& t) {
          return t.conditions ? &((*t.conditions).*member) : nullptr;
        },
        [member = quantity.member](Trial& t) { return &(Stated(t).*member); });
  }
  c.Add({{"note", "the operator's"},
         [](const Trial& t) {
           return t.conditions ? t.conditions->note : std::string();
         },
         [](Trial& t, const std::string& cell) { Stated(t).note = cell; }});
  c.Add({{"anomaly",
          "none, rig, camera, light, body, surface, operator, other, not "
          "applicable or not recorded"},
         [](const Trial& t) {
           return t.conditions ? std::string(core::Name(t.conditions->anomaly))
                               : std::string();
         },
         [](Trial& t, const std::string& cell) {
           const auto word = core::ParseAnomaly(cell);
           if (!word) {
             throw std::invalid_argument(
                 "none, rig, camera, light, body, surface, operator, other, "
                 "not applicable or not recorded was expected");
           }
           Stated(t).anomaly = *word;
         }});
  c.Add({{"anomaly_note", "what it was"},
         [](const Trial& t) {
           return t.conditions ? t.conditions->anomaly_note : std::string();
         },
         [](Trial& t, const std::string& cell) {
           Stated(t).anomaly_note = cell;
         }});
}

// All columns in the order in which they are written: who the trial is, what
// was thrown, what was seen, under what conditions, from which recording, and
// who states it. `touchdown import --columns` prints the same order.
std::vector<TrialColumn> MakeColumns() {
  Columns c;
  // Columns that the store gives are written for people. Reading skips them, so
  // that nobody has to take them out of an exported file.
  const auto ignore = [](Trial&, const std::string&) {};
  c.Text("id", "UUID; empty: a new trial",
         [](Trial& t) -> std::string& { return t.id; });
  c.Add({{"revision", "given by the store; not read"},
         [](const Trial& t) { return fmt::format("{}", t.revision); },
         ignore});
  c.Text("campaign", "name; empty: none",
         [](Trial& t) -> std::string& { return t.campaign; });
  c.Word<core::Origin>(
      "origin", "where the trial comes from",
      [](Trial& t) -> core::Origin& { return t.origin; }, core::ParseOrigin,
      "recorded, simulated or manual");
  c.Word<core::BodyKind>(
      "body_kind", "must be there",
      [](Trial& t) -> core::BodyKind& { return t.body.kind; },
      core::ParseBodyKind, "sphere or rectangle");
  for (std::size_t i = 0; i < core::kBodyQuantities.size(); ++i) {
    c.Measured(core::kBodyQuantities.at(i).name,
               core::kBodyQuantities.at(i).meaning, BodyMeasured, i);
  }
  // What was thrown and how: kind of angle and set-points.
  c.Word<core::AngleKind>(
      "angle_kind", "which angle is the contact angle",
      [](Trial& t) -> core::AngleKind& { return t.angle_kind; },
      core::ParseAngleKind, "approach, radius or face");
  c.Add(OptionalNumber(
      "set_angle_deg", "set-point of the varied angle", core::kDegree,
      [](Trial& t) -> std::optional<double>& { return t.set_angle_rad; }));
  c.Add(OptionalNumber(
      "set_speed_mps", "set-point of the launch speed", 1.0,
      [](Trial& t) -> std::optional<double>& { return t.set_speed_mps; }));
  // What was seen at the first contact. Later contacts are not in this table.
  c.Word<core::MotionState>(
      "state", "must be there",
      [](Trial& t) -> core::MotionState& { return t.first.state.label; },
      core::ParseMotionState,
      "bounce, slide, roll-slide, roll, stick, stays-down or undecided");
  c.Add(OptionalNumber("p_bounce", "probability of a bounce", 1.0,
                       [](Trial& t) -> std::optional<double>& {
                         return t.first.state.p_bounce;
                       }));
  c.Text("state_because", "evidence of the state",
         [](Trial& t) -> std::string& { return t.first.state.reason; });
  c.Add(Flag("micro_bounce", "left the ground below the bounce height",
             [](Trial& t) -> bool& { return t.first.state.micro_bounce; }));
  c.Add(Flag("contact_found", "a touchdown was seen",
             [](Trial& t) -> bool& { return t.first.contact.found; }));
  c.Text("not_found_because", "why not",
         [](Trial& t) -> std::string& { return t.first.contact.reason; });
  c.Add(Flag("from_start", "on the ground from the first frame",
             [](Trial& t) -> bool& { return t.first.contact.from_start; }));
  c.Add({{"corner", "which touched first: leading, trailing or flush"},
         [](const Trial& t) {
           const auto& corner = t.first.contact.corner;
           return corner ? std::string(core::Name(*corner)) : std::string();
         },
         [](Trial& t, const std::string& cell) {
           t.first.contact.corner = core::ParseCorner(cell);
           if (!t.first.contact.corner) {
             throw std::invalid_argument(
                 "leading, trailing or flush was expected");
           }
         }});
  // Every measured number of the contact, its state and its motion.
  for (std::size_t i = 0; i < core::kContactQuantities.size(); ++i) {
    c.Measured(core::kContactQuantities.at(i).name,
               core::kContactQuantities.at(i).meaning, ContactMeasured, i);
  }
  AddConditions(c);
  // The recording, by which a trial finds its film again.
  c.Text("clip_path", "where the clip was last seen",
         [](Trial& t) -> std::string& { return t.clip.path; });
  c.Text("clip_id", "clip.id of `analyze`",
         [](Trial& t) -> std::string& { return t.clip.id; });
  c.Text("clip_sha256", "of the whole clip",
         [](Trial& t) -> std::string& { return t.clip.sha256; });
  c.Add({{"clip_size_bytes", "of the clip"},
         [](const Trial& t) { return fmt::format("{}", t.clip.size_bytes); },
         [](Trial& t, const std::string& cell) {
           t.clip.size_bytes = ToInteger(cell);
         }});
  // The statement itself: who, why, and with which version of the program.
  c.Text("author", "who states this",
         [](Trial& t) -> std::string& { return t.author; });
  c.Text("reason", "why this revision was made",
         [](Trial& t) -> std::string& { return t.reason; });
  c.Add({{"recorded_at_utc", "given by the store; not read"},
         [](const Trial& t) { return t.recorded_at_utc; },
         ignore});
  c.Text("software_version", "of the analysis",
         [](Trial& t) -> std::string& { return t.software_version; });
  c.Text("options_hash", "of the analysis",
         [](Trial& t) -> std::string& { return t.options_hash; });
  c.Add(Flag("excluded", "does not count",
             [](Trial& t) -> bool& { return t.excluded; }));
  c.Text("exclusion_reason", "why not",
         [](Trial& t) -> std::string& { return t.exclusion_reason; });
  return c.Done();
}

}  // namespace

core::Measured& BodyMeasured(Trial& trial, std::size_t i) {
  return trial.body.*core::kBodyQuantities.at(i).member;
}
core::Measured& ContactMeasured(Trial& trial, std::size_t i) {
  return core::At(trial.first, core::kContactQuantities.at(i));
}

const std::vector<TrialColumn>& AllColumns() {
  // Made at the first call and never changed: the pointers of FindColumn() stay
  // valid as long as the program runs.
  static const std::vector<TrialColumn> columns = MakeColumns();
  return columns;
}

const TrialColumn* FindColumn(std::string_view name) {
  for (const auto& column : AllColumns()) {
    if (column.about.name == name) return &column;
  }
  return nullptr;
}

}  // namespace touchdown::report
