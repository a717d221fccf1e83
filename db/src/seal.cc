#include "touchdown/db/seal.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "chain.h"
#include "statement.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

// The kind and version of the document.
constexpr std::string_view kFirstLine = "touchdown seal 1";

bool IsSha256(std::string_view text) {
  return text.size() == 64 &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::optional<std::int64_t> ParseCount(std::string_view text) {
  std::int64_t count = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, count);
  if (error != std::errc() || stop != end || count < 1) return std::nullopt;
  return count;
}

// Takes what stands before `until` (or all) away from `text`.
std::string_view TakeToken(std::string_view& text, char until) {
  const std::size_t end = std::min(text.find(until), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::string ExtendDigest(std::string_view before, std::int64_t number,
                         const SealLine& line) {
  return LinkDigest(
      before, {number, line.subject, line.key, line.row_sha256, std::string()});
}

// Why what stands at link `number` is not what was sealed there.
std::string Differs(Connection& connection, std::int64_t number,
                    const SealLine& sealed, const SealLine& now) {
  const std::string was = Describe(connection, sealed.subject, sealed.key);
  const std::string where = fmt::format("(link {})", number);
  if (RowDigest(connection, sealed.subject, sealed.key).empty()) {
    return fmt::format("{} was removed {}", was, where);
  }
  if (sealed.subject == now.subject && sealed.key == now.key) {
    return fmt::format("{} was changed {}", was, where);
  }
  return fmt::format("{} was put in the place of {} {}",
                     Describe(connection, now.subject, now.key), was, where);
}

}  // namespace

std::string HeadText(const SealHead& head) {
  return fmt::format("{}:{}:{}", head.store, head.links, head.sha256);
}

std::optional<SealHead> ParseHead(std::string_view text) {
  const std::string_view store = TakeToken(text, ':');
  const auto links = ParseCount(TakeToken(text, ':'));
  if (!IsUuid(store) || !links || !IsSha256(text)) return std::nullopt;
  return SealHead{std::string(store), *links, std::string(text)};
}

Seal MakeSeal(const Store& store) {
  Connection& connection = store.connection();
  const CheckReport report = Check(store);
  if (!report.problems.empty()) {
    throw core::StoreError(fmt::format(
        "{}: {}; such a store is not sealed, see `touchdown db check`",
        store.path().string(), report.problems.front()));
  }
  Seal seal;
  seal.head.store = store.uuid();
  seal.sealed_at_utc = store.sources().now_utc();
  VisitLinks(connection, [&](const Link& link) {
    seal.head.links = link.number;
    seal.head.sha256 = link.sha256;
    seal.lines.push_back({link.subject, link.key, link.row_sha256});
  });
  return seal;
}

std::string SealText(const Seal& seal) {
  std::string text = fmt::format("{}\nhead {}\nsealed {}\n", kFirstLine,
                                 HeadText(seal.head), seal.sealed_at_utc);
  for (const SealLine& line : seal.lines) {
    text += fmt::format("{} {} {}\n", line.subject, line.key, line.row_sha256);
  }
  return text;
}

Seal ParseSeal(std::string_view text, std::string_view name) {
  std::size_t at = 0;
  const auto refuse = [&](std::string_view expected) {
    throw core::InputError(fmt::format(
        "{}: line {}: {} was expected; this is no seal of `touchdown db seal`, "
        "or it was altered",
        name, at, expected));
  };
  const auto line = [&] {
    ++at;
    return TakeToken(text, '\n');
  };
  Seal seal;
  if (line() != kFirstLine) refuse(fmt::format("'{}'", kFirstLine));
  std::string_view head = line();
  const auto parsed =
      TakeToken(head, ' ') == "head" ? ParseHead(head) : std::nullopt;
  if (!parsed) refuse("the head");
  seal.head = *parsed;
  std::string_view sealed = line();
  if (TakeToken(sealed, ' ') != "sealed" || !IsUtcStamp(sealed)) {
    refuse("the date of the seal");
  }
  seal.sealed_at_utc = sealed;
  std::string digest;
  while (!text.empty()) {
    std::string_view rest = line();
    SealLine one;
    one.subject = TakeToken(rest, ' ');
    one.key = TakeToken(rest, ' ');
    one.row_sha256 = rest;
    if (one.subject.empty() || one.key.empty() || !IsSha256(rest)) {
      refuse("what a link is of, which, and its SHA-256");
    }
    seal.lines.push_back(std::move(one));
    digest = ExtendDigest(digest, static_cast<std::int64_t>(seal.lines.size()),
                          seal.lines.back());
  }
  if (static_cast<std::int64_t>(seal.lines.size()) != seal.head.links ||
      digest != seal.head.sha256 || seal.lines.front().subject != "store" ||
      seal.lines.front().key != seal.head.store) {
    refuse(fmt::format("an end after {} links that lead to its head",
                       seal.head.links));
  }
  return seal;
}

SealCheck CheckStoreSeal(const Store& store, const Seal& seal) {
  Connection& connection = store.connection();
  Transaction snapshot(connection, Transaction::Kind::kRead);
  SealCheck check;
  if (seal.head.store != store.uuid()) {
    check.problem =
        fmt::format("the seal is of another store, {}; this one is {}",
                    seal.head.store, store.uuid());
    return check;
  }
  // What stands there now, whatever the digests beside it say.
  std::string digest;
  std::int64_t count = 0;
  std::string unlike_its_own;
  VisitLinks(connection, [&](const Link& link) {
    if (++count > seal.head.links || !check.problem.empty()) return;
    const SealLine now{link.subject, link.key,
                       RowDigest(connection, link.subject, link.key)};
    digest = ExtendDigest(digest, count, now);
    if (!seal.lines.empty()) {
      const SealLine& sealed =
          seal.lines.at(static_cast<std::size_t>(count - 1));
      if (sealed != now) {
        check.problem = Differs(connection, count, sealed, now);
      }
    } else if (unlike_its_own.empty() && now.row_sha256 != link.row_sha256) {
      unlike_its_own = fmt::format(
          "{} was {} (link {})", Describe(connection, link.subject, link.key),
          now.row_sha256.empty() ? "removed" : "changed", count);
    }
  });
  check.links_since = std::max<std::int64_t>(count - seal.head.links, 0);
  if (!check.problem.empty()) return check;
  if (count < seal.head.links) {
    check.problem =
        seal.lines.empty()
            ? fmt::format(
                  "{} links were sealed and {} are there: from link {} "
                  "on they were removed",
                  seal.head.links, count, count + 1)
            : fmt::format(
                  "{} {} was removed (link {})",
                  seal.lines.at(static_cast<std::size_t>(count)).subject,
                  seal.lines.at(static_cast<std::size_t>(count)).key,
                  count + 1);
  } else if (digest != seal.head.sha256) {
    check.problem =
        !unlike_its_own.empty()
            ? unlike_its_own
            : fmt::format(
                  "the first {} links are not those that were sealed, and "
                  "their digests were made anew; which is the first, the file "
                  "of `touchdown db seal --out` would tell",
                  seal.head.links);
  }
  return check;
}

}  // namespace touchdown::db
