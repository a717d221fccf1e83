// Import of trials from CSV: what was accepted is written and read back.
#include <sstream>
#include <string>
#include <vector>

#include "app/exchange/trial_csv.h"
#include "tests/fuzz/fuzz.h"

namespace touchdown::fuzz {
namespace {

std::vector<core::Trial> TrialsOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<core::Trial> trials;
  for (auto& read : report::ReadTrialsCsv(in, "trials.csv", "Ada").trials) {
    trials.push_back(std::move(read.trial));
  }
  return trials;
}

std::string CsvOf(const std::vector<core::Trial>& trials) {
  std::ostringstream out;
  report::WriteTrialsCsv(out, trials);
  return out.str();
}

}  // namespace
}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  std::vector<core::Trial> trials;
  if (!fuzz::Answers([&] {
        trials = fuzz::TrialsOf(std::string(fuzz::Text(data, size)));
      })) {
    return 0;
  }
  const std::string written = fuzz::CsvOf(trials);
  fuzz::Require(fuzz::Answers([&] {
                  fuzz::Require(fuzz::TrialsOf(written).size() == trials.size(),
                                "every trial that is written is read");
                }),
                "what is written can be read");
  return 0;
}
