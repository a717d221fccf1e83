// A seal: what the store held at an instant, in a form to be kept apart from it
// (on paper, with a colleague, signed). Whoever alters what was sealed, and
// makes every digest anew with this very program, does not agree with it; a
// store that has only grown since does.
//
// The head, one line, finds any such change. The whole seal, a file with a line
// for each link of the store's chain, also names the first row that changed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/db/store.h"

namespace touchdown::db {

struct SealHead {
  std::string store;       // its UUID
  std::int64_t links = 0;  // of the chain, those that were sealed
  std::string sha256;      // of the last

  friend bool operator==(const SealHead&, const SealHead&) = default;
};

// "UUID:LINKS:SHA256", and back; nothing where it is no head.
std::string HeadText(const SealHead& head);
std::optional<SealHead> ParseHead(std::string_view text);

// One link: what it is of ("revision", "plan", "spring" ...), which, and the
// digest of its rows.
struct SealLine {
  std::string subject;
  std::string key;
  std::string row_sha256;

  friend bool operator==(const SealLine&, const SealLine&) = default;
};

struct Seal {
  SealHead head;
  std::string sealed_at_utc;
  std::vector<SealLine> lines;  // empty: the head alone is known
};

// Of what the store holds now. Throws core::StoreError where it is not sound
// (Check): what is wrong is not to be sealed.
Seal MakeSeal(const Store& store);

// A file of text: "touchdown seal 1", the head, the date, one line a link.
std::string SealText(const Seal& seal);
// Throws core::InputError naming `name` and the line: no seal, a part of one,
// or one whose lines do not lead to its head.
Seal ParseSeal(std::string_view text, std::string_view name);

struct SealCheck {
  // Empty where all that was sealed is there as it was. Else one line that
  // names the first row changed, removed or put in its place; of a head alone,
  // where digests were made anew, it can only be said that there is one.
  std::string problem;
  std::int64_t links_since = 0;  // that the store has grown by
};
SealCheck CheckStoreSeal(const Store& store, const Seal& seal);

}  // namespace touchdown::db
