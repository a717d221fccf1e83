#include <fmt/format.h>

#include <utility>

#include "register_rows.h"
#include "schema_parts.h"

namespace touchdown::db {
namespace {

// Also against INSERT OR REPLACE, which deletes without asking the triggers
// above (other programs leave recursive triggers off); and the numbers of a
// trial's revisions have no gap. One EXISTS a key: with OR inside, SQLite makes
// a temporary table for each row. The id of a row that gives none is -1 here.
std::string InsertTriggers() {
  return "CREATE TRIGGER trials_refuse_REPLACE BEFORE INSERT ON trials\n"
         "WHEN EXISTS (SELECT 1 FROM trials WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM trials WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM trials\n"
         "             WHERE ifnull(campaign_id, 0) = ifnull(NEW.campaign_id, "
         "0)\n"
         "             AND clip_id = NEW.clip_id)\n"
         "BEGIN SELECT raise(ABORT, 'this trial exists already'); END;\n"
         "CREATE TRIGGER revisions_in_order BEFORE INSERT ON revisions\n"
         "WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM "
         "revisions\n"
         "                        WHERE trial_id = NEW.trial_id)\n"
         "  OR EXISTS (SELECT 1 FROM revisions WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM revisions WHERE id = NEW.id)\n"
         "BEGIN SELECT raise(ABORT, 'revisions are added one after the "
         "other');\n"
         "END;\n"
         "CREATE TRIGGER contacts_refuse_REPLACE BEFORE INSERT ON contacts\n"
         "WHEN NEW.ordinal >= (SELECT contacts FROM statements\n"
         "                     WHERE revision_id = NEW.revision_id)\n"
         "  OR EXISTS (SELECT 1 FROM contacts WHERE ordinal = NEW.ordinal\n"
         "             AND revision_id = NEW.revision_id)\n"
         "  OR EXISTS (SELECT 1 FROM contacts WHERE rowid = NEW.rowid)\n"
         "BEGIN SELECT raise(ABORT, 'contacts is append-only: add a "
         "revision');\n"
         "END;\n"
         "CREATE TRIGGER clips_refuse_REPLACE BEFORE INSERT ON clips\n"
         "WHEN EXISTS (SELECT 1 FROM clips WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM clips WHERE clip_id = NEW.clip_id\n"
         "             AND sha256 = NEW.sha256)\n"
         "BEGIN SELECT raise(ABORT, 'clips are kept'); END;\n"
         "CREATE TRIGGER campaigns_refuse_REPLACE BEFORE INSERT ON campaigns\n"
         "WHEN EXISTS (SELECT 1 FROM campaigns WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM campaigns WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM campaigns WHERE name = NEW.name)\n"
         "BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;\n";
}

// A change of the register is a further version.
std::string RegisterTriggers() {
  std::string sql;
  for (const RegisterKind kind : kRegisterKinds) {
    for (const std::string_view act : {"UPDATE", "DELETE"}) {
      sql += fmt::format(
          "CREATE TRIGGER {0}_refuse_{1} BEFORE {1} ON {0} BEGIN\n"
          "  SELECT raise(ABORT, '{0} are kept: add a version');\n"
          "END;\n",
          FindTable(kind).table, act);
    }
    sql += fmt::format(
        "CREATE TRIGGER {0}_refuse_REPLACE BEFORE INSERT ON {0}\n"
        "WHEN EXISTS (SELECT 1 FROM {0} WHERE id = NEW.id)\n"
        "  OR EXISTS (SELECT 1 FROM {0} WHERE uuid = NEW.uuid)\n"
        "BEGIN SELECT raise(ABORT, '{0} are kept: add a version');\n"
        "END;\n",
        FindTable(kind).table);
  }
  return sql;
}

}  // namespace

// Nothing is overwritten: evidence may be added to, never changed or removed.
std::string TriggersSql() {
  std::string sql;
  for (const char* table : {"trials", "revisions", "statements", "contacts",
                            "budget_lines", "exclusions", "conditions"}) {
    for (const char* act : {"UPDATE", "DELETE"}) {
      sql += fmt::format(
          "CREATE TRIGGER {0}_refuse_{1} BEFORE {1} ON {0} BEGIN\n"
          "  SELECT raise(ABORT, '{0} is append-only: add a revision');\n"
          "END;\n",
          table, act);
    }
  }
  for (const char* table : {"statements", "exclusions", "conditions"}) {
    sql += fmt::format(
        "CREATE TRIGGER {0}_refuse_REPLACE BEFORE INSERT ON {0}\n"
        "WHEN EXISTS (SELECT 1 FROM {0} WHERE revision_id = NEW.revision_id)\n"
        "BEGIN SELECT raise(ABORT, '{0} is append-only: add a revision');\n"
        "END;\n",
        table);
  }
  sql +=
      "CREATE TRIGGER budget_lines_refuse_REPLACE BEFORE INSERT ON "
      "budget_lines\n"
      "WHEN EXISTS (SELECT 1 FROM budget_lines\n"
      "             WHERE revision_id = NEW.revision_id\n"
      "             AND ordinal = NEW.ordinal AND budget = NEW.budget\n"
      "             AND line = NEW.line)\n"
      "BEGIN SELECT raise(ABORT, 'budget_lines is append-only: add a "
      "revision');\nEND;\n";
  // A clip's digest, once computed, stays.
  sql +=
      "CREATE TRIGGER clips_keep_digest BEFORE UPDATE ON clips\n"
      "WHEN NEW.clip_id <> OLD.clip_id OR NEW.size_bytes <> OLD.size_bytes\n"
      "  OR (OLD.sha256 IS NOT NULL AND NEW.sha256 IS NOT OLD.sha256)\n"
      "BEGIN SELECT raise(ABORT, 'a clip keeps its digest'); END;\n"
      "CREATE TRIGGER clips_refuse_DELETE BEFORE DELETE ON clips\n"
      "BEGIN SELECT raise(ABORT, 'clips are kept'); END;\n";
  // Conventions are fixed before the first trial.
  sql +=
      "CREATE TRIGGER campaigns_keep_conventions BEFORE UPDATE ON campaigns\n"
      "WHEN EXISTS (SELECT 1 FROM trials WHERE campaign_id = OLD.id)\n"
      "BEGIN SELECT raise(ABORT, 'a campaign with trials keeps its "
      "conventions'); END;\n"
      "CREATE TRIGGER campaigns_refuse_DELETE BEFORE DELETE ON campaigns\n"
      "BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;\n";
  for (const char* act : {"UPDATE", "DELETE"}) {
    sql += fmt::format(
        "CREATE TRIGGER plan_events_refuse_{0} BEFORE {0} ON plan_events\n"
        "BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;\n",
        act);
  }
  sql +=
      "CREATE TRIGGER plan_events_refuse_REPLACE BEFORE INSERT ON "
      "plan_events\n"
      "WHEN EXISTS (SELECT 1 FROM plan_events WHERE id = NEW.id)\n"
      "  OR EXISTS (SELECT 1 FROM plan_events WHERE uuid = NEW.uuid)\n"
      "BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;\n";
  // The chain grows by one link at a time.
  for (const char* act : {"UPDATE", "DELETE"}) {
    sql += fmt::format(
        "CREATE TRIGGER chain_refuse_{0} BEFORE {0} ON chain\n"
        "BEGIN SELECT raise(ABORT, 'the chain is kept'); END;\n",
        act);
  }
  sql +=
      "CREATE TRIGGER chain_grows BEFORE INSERT ON chain\n"
      "WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM chain)\n"
      "  OR EXISTS (SELECT 1 FROM chain WHERE subject = NEW.subject\n"
      "             AND key = NEW.key)\n"
      "BEGIN SELECT raise(ABORT, 'the chain grows link by link'); END;\n";
  return sql + RegisterTriggers() + InsertTriggers();
}

}  // namespace touchdown::db
