// Import of an export: what was accepted comes back line for line.
#include <sstream>
#include <string>

#include "app/exchange/register_json.h"
#include "app/exchange/trial_json.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  std::istringstream in{std::string(fuzz::Text(data, size))};
  fuzz::Answers([&] {
    report::ExportReader reader(in, "export.jsonl");
    for (const auto& entry : reader.entries()) {
      const std::string line = report::EntryJson(entry);
      fuzz::Require(report::EntryJson(report::EntryFromJson(line)) == line,
                    "a version of the register comes back the same");
    }
    for (const auto& campaign : reader.campaigns()) {
      const std::string line = report::CampaignJson(campaign);
      fuzz::Require(
          report::CampaignJson(report::CampaignFromJson(line)) == line,
          "a campaign comes back the same");
    }
    while (const auto history = reader.NextHistory()) {
      for (const auto& revision : *history) {
        const std::string line = report::RevisionJson(revision);
        fuzz::Require(
            report::RevisionJson(report::RevisionFromJson(line)) == line,
            "a revision comes back the same");
      }
    }
  });
  return 0;
}
