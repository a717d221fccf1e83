// Trials as JSON, one line each: nothing is lost on the way there and back.
//
// Numbers are SI and radians, as in the store, with the unit in the name;
// doubles have as many digits as they need to come back bit for bit (infinities
// are "inf" and "-inf"). A measured number is {"value", "u"} with "interval95":
// [low, high] where it has one, or {"absent": reason}. Text that is not UTF-8
// is {"bytes": hexadecimal}.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/records.h"
#include "touchdown/db/register.h"

namespace touchdown::report {

// schema "touchdown.campaign/1" and "touchdown.revision/1"; no line break.
std::string CampaignJson(const core::Campaign& campaign);
std::string RevisionJson(const db::Revision& revision);
// schema "touchdown.trial/1": the current revision with all before it.
std::string HistoryJson(const std::vector<db::Revision>& history);

// The inverse of the two. Throw std::invalid_argument naming the field that is
// missing or wrong.
core::Campaign CampaignFromJson(std::string_view line);
db::Revision RevisionFromJson(std::string_view line);

// An export: a header line {"schema": "touchdown.export/1", "store": UUID},
// then a line for each version of the register's entries (register_json.h), a
// line for each campaign, a line for each plan of these and each look at them
// (plan_json.h), then a line for each revision, those of one trial together and
// in order.
void WriteExportHeader(std::ostream& out, const std::string& store_uuid);

// Reads an export piece by piece. Every function throws core::InputError naming
// file and line.
class ExportReader {
 public:
  // Reads the header, the register, the campaigns and their plans. `name` is
  // the file's, for errors.
  ExportReader(std::istream& in, std::string name);

  const std::string& store_uuid() const { return store_uuid_; }
  const std::vector<db::Entry>& entries() const { return entries_; }
  const std::vector<core::Campaign>& campaigns() const { return campaigns_; }
  const std::vector<db::PlanEvent>& plan() const { return plan_; }

  // The revisions of the next trial; nothing at the end.
  std::optional<std::vector<db::Revision>> NextHistory();

 private:
  bool NextLine();
  [[noreturn]] void Fail(const std::string& what) const;

  std::istream& in_;
  std::string name_;
  std::size_t number_ = 0;
  std::string line_;  // the line read last; empty: none left
  std::string store_uuid_;
  std::vector<db::Entry> entries_;
  std::vector<core::Campaign> campaigns_;
  std::vector<db::PlanEvent> plan_;
  std::optional<db::Revision> ahead_;
};

}  // namespace touchdown::report
