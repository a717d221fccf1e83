#include "chain.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <stdexcept>

#include "register_rows.h"

namespace touchdown::db {
namespace {

struct Subject {
  std::string word;
  std::string rows;  // the rows that have a link: FROM, and what they must be
  std::string key;   // of a row
  std::string name;  // for a person, of row ?1
  std::vector<DigestPart> parts;  // of a link's digest
};

std::vector<DigestPart> PartsOfRevision() {
  const std::string of_trial =
      "FROM revisions r JOIN trials t ON t.id = r.trial_id ";
  return {
      {"trial", "SELECT t.* " + of_trial + "WHERE r.id = ?1"},
      {"campaign", "SELECT c.* " + of_trial +
                       "JOIN campaigns c ON c.id = t.campaign_id "
                       "WHERE r.id = ?1"},
      {"clip", "SELECT k.clip_id, k.size_bytes " + of_trial +
                   "JOIN clips k ON k.id = t.clip_id WHERE r.id = ?1"},
      {"revision", "SELECT * FROM revisions WHERE id = ?1"},
      {"statement", "SELECT * FROM statements WHERE revision_id = ?1"},
      {"contact",
       "SELECT * FROM contacts WHERE revision_id = ?1 ORDER BY ordinal"},
      {"budget line",
       "SELECT * FROM budget_lines WHERE revision_id = ?1 "
       "ORDER BY ordinal, budget, line"},
      {"exclusion", "SELECT * FROM exclusions WHERE revision_id = ?1"},
      {"conditions", "SELECT * FROM conditions WHERE revision_id = ?1"},
  };
}

// In an order in which no row refers to a later one.
std::vector<Subject> MakeSubjects() {
  std::vector<Subject> all = {{"store",
                               "FROM store WHERE true",
                               "uuid",
                               "SELECT 'the store''s own row' WHERE ?1",
                               {{"store", "SELECT * FROM store"}}}};
  for (const RegisterKind kind : kRegisterKinds) {
    const std::string_view table = TableOf(kind).table;
    all.push_back(
        {std::string(Name(kind)),
         fmt::format("FROM {} WHERE true", table),
         "uuid",
         fmt::format("SELECT '{} ''' || name || ''', version ' || version "
                     "FROM {} WHERE id = ?1",
                     Name(kind), table),
         {{"version", fmt::format("SELECT * FROM {} WHERE id = ?1", table)}}});
  }
  all.push_back({"clip",
                 "FROM clips WHERE sha256 IS NOT NULL",
                 "CAST(id AS TEXT)",
                 "SELECT 'clip ' || clip_id FROM clips WHERE id = ?1",
                 {{"clip",
                   "SELECT clip_id, size_bytes, sha256 FROM clips "
                   "WHERE id = ?1"}}});
  all.push_back({"revision", "FROM revisions WHERE true", "uuid",
                 "SELECT 'trial ' || ifnull(t.uuid, '?') || ', revision ' || "
                 "r.number || ' (' || r.kind || ' by ' || r.author || ' at ' "
                 "|| r.recorded_at_utc || ')' FROM revisions r "
                 "LEFT JOIN trials t ON t.id = r.trial_id WHERE r.id = ?1",
                 PartsOfRevision()});
  // Its campaign may change until the first trial, but for id and name.
  all.push_back({"plan",
                 "FROM plan_events WHERE true",
                 "uuid",
                 "SELECT 'the plan of campaign ''' || ifnull(c.name, '?') || "
                 "''' (' || e.kind || ' by ' || e.author || ' at ' || e.at_utc "
                 "|| ')' FROM plan_events e "
                 "LEFT JOIN campaigns c ON c.id = e.campaign_id "
                 "WHERE e.id = ?1",
                 {{"event", "SELECT * FROM plan_events WHERE id = ?1"},
                  {"campaign",
                   "SELECT c.id, c.uuid, c.name FROM plan_events e JOIN "
                   "campaigns c ON c.id = e.campaign_id WHERE e.id = ?1"}}});
  return all;
}

const std::vector<Subject>& Subjects() {
  static const std::vector<Subject> subjects = MakeSubjects();
  return subjects;
}

// Null where another program wrote a word of its own.
const Subject* Find(std::string_view word) {
  for (const Subject& subject : Subjects()) {
    if (subject.word == word) return &subject;
  }
  return nullptr;
}

std::optional<std::int64_t> FindRow(Connection& connection,
                                    const Subject& subject,
                                    std::string_view key) {
  // A text compared with the number of a row is taken for a number.
  Statement row(connection,
                fmt::format("SELECT id {} AND {} = ?", subject.rows,
                            subject.word == "clip" ? "id" : subject.key));
  row.Add(key);
  if (!row.Step()) return std::nullopt;
  return row.TakeInteger();
}

std::string DigestOfRow(Connection& connection, const Subject& subject,
                        std::int64_t row) {
  std::string text = "touchdown.row/1\n";
  for (const DigestPart& part : subject.parts) {
    Statement rows(connection, part.sql);
    if (subject.word != "store") rows.Add(row);
    while (rows.Step()) {
      text += part.word + '\n';
      rows.AppendRow(text);
    }
  }
  return Sha256(text);
}

}  // namespace

std::string Sha256(std::string_view text) {
  std::array<unsigned char, 32> digest{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(),
                 nullptr) != 1 ||
      size != digest.size()) {
    throw std::logic_error("SHA-256 is not to be had");
  }
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::string LinkDigest(std::string_view before, const Link& link) {
  return Sha256(fmt::format("touchdown.link/1\n{}\n{}\n{} {}\n{}\n", before,
                            link.number, link.subject, link.key,
                            link.row_sha256));
}

std::string RowDigest(Connection& connection, std::string_view subject,
                      std::string_view key) {
  const Subject* known = Find(subject);
  if (known == nullptr) return {};
  const auto row = FindRow(connection, *known, key);
  return row ? DigestOfRow(connection, *known, *row) : std::string();
}

std::string Describe(Connection& connection, std::string_view subject,
                     std::string_view key) {
  const Subject* known = Find(subject);
  const auto row =
      known == nullptr ? std::nullopt : FindRow(connection, *known, key);
  if (!row) return fmt::format("{} {}", subject, key);
  Statement name(connection, known->name);
  name.Add(*row);
  return name.Step() ? name.TakeText() : fmt::format("{} {}", subject, key);
}

void KeepLink(Connection& connection, std::string_view subject,
              std::string_view key) {
  Link link;
  std::string before;
  {
    Statement last(connection,
                   "SELECT number, sha256 FROM chain ORDER BY number DESC "
                   "LIMIT 1");
    if (last.Step()) {
      link.number = last.TakeInteger();
      before = last.TakeText();
    }
  }
  ++link.number;
  link.subject = subject;
  link.key = key;
  link.row_sha256 = RowDigest(connection, subject, key);
  Statement(connection,
            "INSERT INTO chain (number, subject, key, row_sha256, sha256) "
            "VALUES (?, ?, ?, ?, ?)")
      .Add(link.number)
      .Add(subject)
      .Add(key)
      .Add(link.row_sha256)
      .Add(LinkDigest(before, link))
      .Run();
}

void KeepClipLink(Connection& connection, std::int64_t clip_row) {
  const std::string key = fmt::format("{}", clip_row);
  {
    Statement row(connection,
                  "SELECT sha256 IS NOT NULL AND NOT EXISTS (SELECT 1 FROM "
                  "chain WHERE subject = 'clip' AND key = ?1) FROM clips "
                  "WHERE id = CAST(?1 AS INTEGER)");
    row.Add(key);
    if (!row.Step() || !row.TakeBool()) return;
  }
  KeepLink(connection, "clip", key);
}

void KeepAllLinks(Connection& connection) {
  for (const Subject& subject : Subjects()) {
    Statement row(connection, fmt::format("SELECT {} {} ORDER BY id",
                                          subject.key, subject.rows));
    while (row.Step()) KeepLink(connection, subject.word, row.TakeText());
  }
}

void VisitLinks(Connection& connection,
                const std::function<void(const Link&)>& visit) {
  Statement row(connection,
                "SELECT number, subject, key, row_sha256, sha256 FROM chain "
                "ORDER BY number");
  while (row.Step()) {
    Link link;
    link.number = row.TakeInteger();
    link.subject = row.TakeText();
    link.key = row.TakeText();
    link.row_sha256 = row.TakeText();
    link.sha256 = row.TakeText();
    visit(link);
  }
}

void CheckChain(Connection& connection, std::vector<std::string>& problems) {
  std::int64_t number = 0;
  std::string before;
  VisitLinks(connection, [&](const Link& link) {
    const auto what = [&] {
      return Describe(connection, link.subject, link.key);
    };
    ++number;
    if (link.number != number) {
      problems.push_back(
          fmt::format("link {} of the chain is missing: another "
                      "program removed it",
                      number));
      number = link.number;
    }
    const std::string digest = RowDigest(connection, link.subject, link.key);
    if (digest.empty()) {
      problems.push_back(what() + " is gone: another program removed it");
    } else if (digest != link.row_sha256) {
      problems.push_back(
          what() + " is not what was recorded: its digest does not agree");
    }
    if (LinkDigest(before, link) != link.sha256) {
      problems.push_back(fmt::format(
          "link {} of the chain ({}) does not follow from the one before it",
          link.number, what()));
    }
    before = link.sha256;
  });
  for (const Subject& subject : Subjects()) {
    Statement row(
        connection,
        fmt::format("SELECT {0} {1} AND NOT EXISTS (SELECT 1 FROM chain l "
                    "WHERE l.subject = '{2}' AND l.key = {0}) ORDER BY id",
                    subject.key, subject.rows, subject.word));
    while (row.Step()) {
      problems.push_back(Describe(connection, subject.word, row.TakeText()) +
                         " is not in the chain: another program added it");
    }
  }
}

}  // namespace touchdown::db
