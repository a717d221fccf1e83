// What shows that the store holds what was recorded, in the order in which it
// was: a hash chain with one link for each row that is never to change.
//
//   R(n) = SHA-256("touchdown.row/1\n" rows of link n)
//   C(n) = SHA-256("touchdown.link/1\n" C(n-1) "\n" n "\n" subject " " key "\n"
//                  R(n) "\n"),  C(0) = ""
//
// A link's rows: of a revision its trial, campaign, clip (id and size),
// revision, statement with document and track, contacts, budgets, exclusion and
// conditions; of a clip its SHA-256, which may become known after the trial; of
// a plan or look, a version of the register, and the store itself, their row. A
// row is its table and each column that is not NULL: name, type, length, bytes.
// So a column that a later version of the schema adds, NULL in old rows, leaves
// old links as they are: an upgrade never breaks a seal (seal.h).
//
// Write functions belong inside a write transaction.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "statement.h"

namespace touchdown::db {

std::string Sha256(std::string_view text);

// A link that has been made: "revision", "plan", "clip", "store" or a kind of
// the register; UUID of its row, of a clip the row's number.
struct Link {
  std::int64_t number = 0;
  std::string subject;
  std::string key;
  std::string row_sha256;
  std::string sha256;
};

// What a digest covers: the word for it, and the rows, of parameter ?1, a row's
// number.
struct DigestPart {
  std::string word;
  std::string sql;
};

// C(n) of a link whose other members are known.
std::string LinkDigest(std::string_view before, const Link& link);

// R(n) of what stands there now; empty where the row is gone.
std::string RowDigest(Connection& connection, std::string_view subject,
                      std::string_view key);

// For a person: "trial UUID, revision 2 (corrected by Ada at ...)".
std::string Describe(Connection& connection, std::string_view subject,
                     std::string_view key);

// After the row was added. A clip gets its link when its SHA-256 is known.
void KeepLink(Connection& connection, std::string_view subject,
              std::string_view key);
void KeepClipLink(Connection& connection, std::int64_t clip_row);

// Of all rows, in a store of a version that had no chain.
void KeepAllLinks(Connection& connection);

// All links, by number.
void VisitLinks(Connection& connection,
                const std::function<void(const Link&)>& visit);

// What does not agree with the chain, one line each.
void CheckChain(Connection& connection, std::vector<std::string>& problems);

}  // namespace touchdown::db
