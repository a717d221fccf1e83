// touchdown use STORE [CAMPAIGN]: writes touchdown.toml, by which the commands
// that follow in this folder know store and campaign (defaults.h).
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/defaults.h"
#include "app/cli/options.h"
#include "touchdown/core/nearest.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

// Checks that store and campaign are there, then writes the file. Returns 0;
// throws core::StoreError or std::invalid_argument with the name that may have
// been meant.
int RunUse(const Defaults& defaults) {
  const db::Store store = db::Store::Open(defaults.store, db::OpenMode::kRead);
  if (!defaults.campaign.empty()) {
    std::vector<std::string> names;
    for (const core::Campaign& campaign : store.Campaigns()) {
      names.push_back(campaign.name);
    }
    if (std::ranges::find(names, defaults.campaign) == names.end()) {
      throw std::invalid_argument(
          fmt::format("{}: there is no campaign '{}'; {}", defaults.store,
                      defaults.campaign,
                      core::DidYouMean(defaults.campaign, names,
                                       "see `touchdown campaign list`")));
    }
  }
  // The empty folder is the one that the command runs in.
  WriteDefaults(defaults, "");
  fmt::print("{}: commands in this folder mean {}{}\n", kDefaultsFile,
             defaults.store,
             defaults.campaign.empty()
                 ? ""
                 : fmt::format(", campaign '{}'", defaults.campaign));
  return 0;
}

}  // namespace

void AddUse(CLI::App& app, Action& action) {
  auto defaults = std::make_shared<Defaults>();
  CLI::App* command = AddCommand(
      app, "use",
      "Write touchdown.toml: the store and campaign that commands in this "
      "folder mean where they name no --db. TOUCHDOWN_DB and "
      "TOUCHDOWN_CAMPAIGN go before it; `analyze` logs only where told to");
  AddOption(*command, "store", defaults->store, "the trial store, e.g. lab.db")
      .Require();
  AddOption(*command, "campaign", defaults->campaign, "one of its campaigns");
  SetAction(*command, action, [defaults] { return RunUse(*defaults); });
}

}  // namespace touchdown::cli
