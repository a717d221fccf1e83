// touchdown register add|change|list|show keeps rigs, cameras, springs,
// calibrations, bodies, surfaces and operators. The table of fields
// (db::ListFields) makes the flags, the help and the text of each kind, so that
// a field is declared once.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/cli/values.h"
#include "app/exchange/register_json.h"
#include "app/text/text_file.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/db/names.h"
#include "touchdown/db/register.h"
#include "touchdown/rig/description.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::cli {
namespace {

using db::Entry;
using db::FieldType;
using db::RegisterField;
using db::RegisterKind;

constexpr const char* kKindWords =
    "rig, camera, spring, calibration, body, surface or operator";

// --- what an entry says ------------------------------------------------------

// Returns whether --file alone fills the field: text and digest must be those
// of the same bytes.
bool IsOfFile(const RegisterField& field) {
  return field.name == "document" || field.name == "sha256";
}

// Returns whether entries of this kind keep a file: rigs and calibrations.
bool HasFile(RegisterKind kind) {
  return std::ranges::any_of(db::ListFields(kind), IsOfFile);
}

// Returns "wire_diameter_mm" for the inner "wire_diameter_m": people type and
// read that unit.
std::string EdgeName(const RegisterField& field) {
  const core::EdgeUnit unit = core::AtTheEdge(field.name);
  return unit.stem + unit.suffix;
}

// Returns the flag, such as "--wire-diameter-mm".
std::string FlagName(const RegisterField& field) {
  std::string flag = "--" + EdgeName(field);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

// Returns the field's meaning, with the words or the form that it takes.
std::string Help(const RegisterField& field) {
  std::string help(field.meaning);
  if (field.type == FieldType::kWord) {
    help +=
        fmt::format(": {}, other, not applicable or not recorded", field.words);
  } else if (field.type == FieldType::kMeasured) {
    help += ", as 40+-0.02, or absent:REASON";
  }
  return help;
}

// Holds an entry as typed. `fields` holds a place for each flag of the kind, by
// the field's inner name; nothing where the flag was not given.
struct EntryFlags {
  std::string db;
  std::string name;
  std::string by;
  std::string why;
  std::string file;
  std::map<std::string, std::optional<std::string>, std::less<>> fields;
  bool json = false;
};

// Keeps a rig.toml or a calibration file whole in `entry`, with its SHA-256.
// Throws core::InputError where it cannot be read as what it is to be.
void ApplyFile(const std::string& file, Entry& entry) {
  if (entry.kind == RegisterKind::kRig) {
    rig::ReadDescription(file);
  } else {
    const calib::Calibration calibration = calib::ReadCalibration(file);
    // `contents` is a word of the register: one part of the calibration, or
    // several.
    const int parts = (calibration.lens ? 1 : 0) + (calibration.scale ? 1 : 0) +
                      (calibration.ground ? 1 : 0);
    entry.texts["contents"] = parts > 1           ? "several"
                              : calibration.lens  ? "lens"
                              : calibration.scale ? "scale"
                                                  : "ground";
    entry.texts["made_on"] = calibration.date;
  }
  entry.texts["document"] = report::ReadTextFile(file);
  entry.texts["sha256"] = vision::Sha256(file);
}

// Puts the typed fields into `entry`; the others stay as they are. Throws
// std::invalid_argument naming the flag of a number that is none.
void Apply(const EntryFlags& flags, Entry& entry) {
  if (!flags.file.empty()) ApplyFile(flags.file, entry);
  for (const RegisterField& field : db::ListFields(entry.kind)) {
    const auto given = flags.fields.find(field.name);
    if (given == flags.fields.end() || !given->second) continue;
    const std::string& text = *given->second;
    const std::string key(field.name);
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        entry.texts[key] = text;
        break;
      case FieldType::kMeasured:
        entry.measured.insert_or_assign(
            key, ParseMeasured(FlagName(field), text,
                               core::AtTheEdge(field.name).factor));
        break;
      // Only the name is given: the store finds the version in force.
      case FieldType::kEntry:
        entry.entries[key] = {text, ""};
        break;
    }
  }
  entry.author = flags.by;
  entry.reason = flags.why;
}

// --- what is printed ---------------------------------------------------------

// Returns the field for a person, with u, in the unit of its name. A document
// is counted and not printed.
std::string FieldText(const Entry& entry, const RegisterField& field) {
  const std::string key(field.name);
  switch (field.type) {
    case FieldType::kMeasured: {
      const core::Measured& number = entry.measured.at(key);
      return number ? WithU(number, core::AtTheEdge(field.name).factor)
                    : "absent: " + Printable(number.error().reason);
    }
    case FieldType::kEntry:
      return Printable(entry.entries.at(key).name);
    case FieldType::kText:
    case FieldType::kWord:
      break;
  }
  const std::string& text = entry.texts.at(key);
  return field.name == "document" && !text.empty()
             ? fmt::format("{} bytes, in --json", text.size())
             : Printable(text);
}

// Returns "2, 2026-03-01T09:00:00Z by A. Lee: new wire".
std::string VersionText(const Entry& entry) {
  return fmt::format("{}, {} by {}{}{}", entry.version, entry.recorded_at_utc,
                     Printable(entry.author), entry.reason.empty() ? "" : ": ",
                     Printable(entry.reason));
}

// Returns one line for each field that says something; empty ones are left out.
std::string EntryText(const Entry& entry) {
  std::vector<std::vector<std::string>> rows = {
      {std::string(Name(entry.kind)), Printable(entry.name)},
      {"version", VersionText(entry)},
      {"id", entry.id}};
  for (const RegisterField& field : db::ListFields(entry.kind)) {
    const std::string text = FieldText(entry, field);
    if (!text.empty()) rows.push_back({EdgeName(field), text});
  }
  return Aligned(rows);
}

// Lists each version, oldest first, with what it changed against the one
// before.
std::string EntryHistoryText(const std::vector<Entry>& versions) {
  std::string text = "history\n";
  for (std::size_t i = 0; i < versions.size(); ++i) {
    text += fmt::format("  {}\n", VersionText(versions[i]));
    if (i == 0) continue;
    for (const auto& change : db::Changes(versions[i - 1], versions[i])) {
      text += fmt::format("       {}: {} -> {}\n", change.field,
                          Printable(change.from), Printable(change.to));
    }
  }
  return text;
}

// Prints this version as a table, or as one touchdown.register/1 line.
void PrintEntry(const Entry& entry, bool json) {
  if (json) {
    fmt::print("{}\n", report::EntryJson(entry));
  } else {
    fmt::print("{}", EntryText(entry));
  }
}

// --- commands ----------------------------------------------------------------

// Records a new entry. Returns 0; throws core::StoreError where the name is
// taken.
int AddToRegister(const EntryFlags& flags, RegisterKind kind) {
  Entry entry = db::NewEntry(kind, flags.name);
  Apply(flags, entry);
  // A store is made only for what has been found right.
  db::RequireStorable(entry);
  // An entry that names others can only be right in a store that has them.
  const bool refers = std::ranges::any_of(entry.entries, [](const auto& field) {
    return !field.second.name.empty();
  });
  auto store = db::Store::Open(
      flags.db, refers ? db::OpenMode::kWrite : db::OpenMode::kCreate);
  PrintEntry(db::AddEntry(store, entry), flags.json);
  return 0;
}

// Records a further version: the one in force, with the typed fields changed.
int ChangeInRegister(const EntryFlags& flags, RegisterKind kind) {
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  Entry entry = db::RequireEntry(store, kind, flags.name);
  Apply(flags, entry);
  PrintEntry(db::ChangeEntry(store, entry), flags.json);
  return 0;
}

// Holds the flags of `list` and `show` as typed; an empty `kind` lists all.
struct LookFlags {
  std::string db;
  std::string kind;
  std::string name;
  bool history = false;
  bool json = false;
};

// Throws std::invalid_argument with the seven words for any other.
RegisterKind DetermineKind(const std::string& word) {
  return ParseWord<RegisterKind>("KIND", word, db::ParseRegisterKind,
                                 kKindWords);
}

// Prints the versions in force by kind and name.
int ListRegister(const LookFlags& flags) {
  std::vector<RegisterKind> kinds(db::kRegisterKinds.begin(),
                                  db::kRegisterKinds.end());
  if (!flags.kind.empty()) kinds = {DetermineKind(flags.kind)};
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  std::vector<std::vector<std::string>> rows = {
      {"kind", "name", "version", "since", "by"}};
  for (const RegisterKind kind : kinds) {
    for (const Entry& entry : db::Entries(store, kind)) {
      if (flags.json) fmt::print("{}\n", report::EntryJson(entry));
      rows.push_back({std::string(Name(kind)), Printable(entry.name),
                      fmt::format("{}", entry.version), entry.recorded_at_utc,
                      Printable(entry.author)});
    }
  }
  if (!flags.json) fmt::print("{}", Aligned(rows));
  return 0;
}

// Prints one entry, with --history all its versions. As JSON lines the history
// has the version in force as its last line.
int ShowEntry(const LookFlags& flags) {
  const RegisterKind kind = DetermineKind(flags.kind);
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const Entry entry = db::RequireEntry(store, kind, flags.name);
  const auto versions = db::ReadEntryVersions(store, kind, flags.name);
  if (flags.json && flags.history) {
    for (const Entry& version : versions) PrintEntry(version, true);
    return 0;
  }
  PrintEntry(entry, flags.json);
  if (flags.history) fmt::print("{}", EntryHistoryText(versions));
  return 0;
}

// Adds `register add` or `register change` with a subcommand for each kind,
// since each kind has other fields. A change needs a reason (--why), a first
// version none.
void AddEntryCommands(CLI::App& parent, const std::string& verb,
                      const std::string& about, Action& action,
                      int (*run)(const EntryFlags&, RegisterKind)) {
  CLI::App* command = AddCommand(parent, verb, about);
  RequireSubcommand(*command);
  for (const RegisterKind kind : db::kRegisterKinds) {
    auto flags = std::make_shared<EntryFlags>();
    CLI::App* one = AddCommand(*command, std::string(Name(kind)),
                               fmt::format("{} a {}", verb, Name(kind)));
    AddOption(*one, "NAME", flags->name, "as the lab calls it").Require();
    AddDbFlag(*one, flags->db);
    AddOption(*one, "--by", flags->by, "who states this").Require();
    AddOption(*one, "--why", flags->why, "the reason")
        .Require(verb == "change");
    for (const RegisterField& field : db::ListFields(kind)) {
      if (IsOfFile(field)) continue;
      // The map's values stay where they are when others come in, so CLI11 may
      // keep a reference to each.
      AddOption(*one, FlagName(field), flags->fields[std::string(field.name)],
                Help(field));
    }
    if (HasFile(kind)) {
      AddOption(*one, "--file", flags->file,
                kind == RegisterKind::kRig
                    ? "its rig.toml, which is kept whole"
                    : "a file of `touchdown calibrate`, which is kept whole");
    }
    AddFlag(*one, "--json", flags->json, "one JSON line");
    SetAction(*one, action, [flags, kind, run] { return run(*flags, kind); });
  }
}

}  // namespace

void AddRegister(CLI::App& app, Action& action) {
  CLI::App* command =
      AddCommand(app, "register",
                 "the lab's rigs, cameras, springs, calibrations, bodies, "
                 "surfaces and operators");
  RequireSubcommand(*command);
  AddEntryCommands(*command, "add", "a new entry", action, AddToRegister);
  AddEntryCommands(*command, "change",
                   "a further version of an entry; nothing is overwritten",
                   action, ChangeInRegister);
  auto flags = std::make_shared<LookFlags>();
  CLI::App* list = AddCommand(*command, "list", "what is in the register");
  AddOption(*list, "KIND", flags->kind, kKindWords);
  AddDbFlag(*list, flags->db);
  AddFlag(*list, "--json", flags->json, "one JSON line for each");
  SetAction(*list, action, [flags] { return ListRegister(*flags); });
  CLI::App* show = AddCommand(*command, "show", "one entry");
  AddOption(*show, "KIND", flags->kind, kKindWords).Require();
  AddOption(*show, "NAME", flags->name, "of the entry").Require();
  AddDbFlag(*show, flags->db);
  AddFlag(*show, "--history", flags->history, "who changed what, when and why");
  AddFlag(*show, "--json", flags->json, "one JSON line for each version");
  SetAction(*show, action, [flags] { return ShowEntry(*flags); });
}

}  // namespace touchdown::cli
