// The lab's register: rigs, cameras, springs, calibrations, bodies, surfaces,
// operators. A trial's conditions refer to them.
//
// An entry is never overwritten: a change is a further version, and what refers
// to an entry refers to one version of it. So a trial keeps the spring as it
// was when the shot was made.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/conditions.h"
#include "touchdown/core/estimate.h"
#include "touchdown/db/records.h"
#include "touchdown/db/store.h"

namespace touchdown::db {

enum class RegisterKind {
  kRig,
  kCamera,
  kSpring,
  kCalibration,
  kBody,
  kSurface,
  kOperator
};
// In an order in which no kind refers to a later one.
inline constexpr std::array<RegisterKind, 7> kRegisterKinds{
    RegisterKind::kRig,         RegisterKind::kCamera, RegisterKind::kSpring,
    RegisterKind::kCalibration, RegisterKind::kBody,   RegisterKind::kSurface,
    RegisterKind::kOperator};
std::string_view Name(RegisterKind kind);  // "rig", "camera" ...
std::optional<RegisterKind> ParseRegisterKind(std::string_view word);

// What a trial's conditions refer to, and the numbers they hold.
struct ConditionEntry {
  RegisterKind kind;
  core::Registered core::Conditions::*member;
};
inline constexpr std::array<ConditionEntry, 7> kConditionEntries{{
    {RegisterKind::kRig, &core::Conditions::rig},
    {RegisterKind::kSpring, &core::Conditions::spring},
    {RegisterKind::kCamera, &core::Conditions::camera},
    {RegisterKind::kCalibration, &core::Conditions::calibration},
    {RegisterKind::kBody, &core::Conditions::body},
    {RegisterKind::kSurface, &core::Conditions::surface},
    {RegisterKind::kOperator, &core::Conditions::person},
}};
struct ConditionQuantity {
  std::string_view name;
  core::Measured core::Conditions::*member;
  std::string_view meaning;
  // Since version 8 of the store: NULL in rows that are older.
  bool is_later = false;
};
inline constexpr std::array<ConditionQuantity, 5> kConditionQuantities{{
    {"temperature_k", &core::Conditions::temperature_k, "of the air"},
    {"relative_humidity", &core::Conditions::relative_humidity,
     "of the air, 0 to 1"},
    {"elevation_rad", &core::Conditions::elevation_rad,
     "of the barrel above horizontal, as set", true},
    {"compression_m", &core::Conditions::compression_m,
     "travel of the springs, as set", true},
    {"muzzle_height_m", &core::Conditions::muzzle_height_m,
     "of the body's centre above the ground as it leaves, as set", true},
}};

// What an entry of a kind can say.
enum class FieldType { kText, kWord, kMeasured, kEntry };
struct RegisterField {
  std::string_view name;  // column and key; SI, with the unit where it has one
  FieldType type = FieldType::kText;
  std::string_view meaning;
  // kWord: one of these, "dry, damp, wet", or other, not applicable or not
  // recorded. `other` needs a note.
  std::string_view words = {};
  RegisterKind entry = RegisterKind::kRig;  // kEntry: of which kind
};
std::span<const RegisterField> ListFields(RegisterKind kind);

// One version of an entry. The maps hold every field of the kind by its name.
struct Entry {
  RegisterKind kind = RegisterKind::kRig;
  std::string name;             // unique within its kind
  std::string id;               // UUID of this version, given by the store
  std::int64_t version = 0;     // 1 for the first, given by the store
  std::string author;           // who states this
  std::string reason;           // why; of the first version it may be empty
  std::string recorded_at_utc;  // given by the store

  std::map<std::string, std::string, std::less<>> texts;  // kText, kWord
  std::map<std::string, core::Measured, std::less<>> measured;
  std::map<std::string, core::Registered, std::less<>> entries;

  friend bool operator==(const Entry&, const Entry&) = default;
};

// An entry of which nothing is recorded but its name.
Entry NewEntry(RegisterKind kind, std::string_view name);

// Throws std::invalid_argument naming the field: name or author empty, a field
// missing or unknown, a word that is none of the field's, `other` without a
// note, a number that is negative or not finite.
void RequireStorable(const Entry& entry);

// What two versions say differently; who, when and why do not count.
std::vector<Change> Changes(const Entry& before, const Entry& after);

// Records the first version of an entry, or a further one: on the disk on
// return, which is the entry as it was recorded. AddEntry throws
// core::StoreError if the name is taken. ChangeEntry takes the version in force
// with the changes made to it, and throws core::StoreError if there is none or
// somebody changed it since, std::invalid_argument if nothing is different or
// the reason is empty. Both throw std::invalid_argument if an entry that is
// referred to does not exist.
Entry AddEntry(Store& store, const Entry& entry);
Entry ChangeEntry(Store& store, const Entry& seen);

// The conditions with the id of every entry that they name: of the version in
// force where none is given. Throws std::invalid_argument naming the entry that
// does not exist.
core::Conditions Resolved(const Store& store,
                          const core::Conditions& conditions);
// Whether they name any entry.
bool NameEntries(const core::Conditions& conditions);

// The version in force; nothing if there is no entry of that name.
std::optional<Entry> FindEntry(const Store& store, RegisterKind kind,
                               std::string_view name);
// The versions in force of all entries of a kind, by name.
std::vector<Entry> Entries(const Store& store, RegisterKind kind);
// Every version of every entry, kinds in the order of kRegisterKinds, by name,
// oldest first: what an export or a merge carries.
std::vector<Entry> AllVersions(const Store& store);
// Every version of one entry, oldest first.
std::vector<Entry> ReadEntryVersions(const Store& store, RegisterKind kind,
                                     std::string_view name);

}  // namespace touchdown::db
