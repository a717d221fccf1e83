#include "app/trials/looks.h"

#include "touchdown/core/campaign.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {

std::string KeepLooks(const std::filesystem::path& store,
                      const std::set<std::string>& campaigns,
                      std::string_view command) {
  // How long another process may hold the store, s. A commit takes some
  // milliseconds; a person who asks for the answer is not to wait for a bulk
  // import only so that the look is recorded.
  constexpr double kPatience_s = 1.0;
  try {
    db::OpenOptions options;
    options.patience_s = kPatience_s;
    auto open = db::Store::Open(store, db::OpenMode::kWrite, options);
    for (const std::string& name : campaigns) {
      db::RecordLook(open, name, command);
    }
  } catch (const core::StoreError& error) {
    // Also a store on a read-only disk ends here: the answer is shown all the
    // same, and the caller says that the look is not on record.
    return error.what();
  }
  return "";
}

std::set<std::string> CampaignsWithAnswer(const std::filesystem::path& store) {
  std::set<std::string> names;
  for (const core::Campaign& campaign :
       db::Store::Open(store, db::OpenMode::kRead).Campaigns()) {
    // Check shots have a control chart and no boundary: nothing in them is an
    // answer that a look could bias.
    if (!core::HasCheckShots(campaign)) names.insert(campaign.name);
  }
  return names;
}

}  // namespace touchdown::pipeline
