// The document of an analysis, as a merged or imported store may hold it: it is
// replayed and drawn, or refused with a reason.
#include <nlohmann/json.hpp>
#include <string>

#include "app/documents/replay.h"
#include "app/review/trial_view.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  core::Trial trial;
  trial.document_json = std::string(fuzz::Text(data, size));
  fuzz::Answers([&] {
    const auto analysis = pipeline::Replay(trial);
    if (!analysis) {
      fuzz::Require(!analysis.error().reason.empty(), "a refusal says why");
      return;
    }
    review::ViewJson(*analysis);
  });
  return 0;
}
