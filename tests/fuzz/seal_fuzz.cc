// A seal, of a file that was kept apart for years: what is understood leads to
// its own head, and is written and read back.
#include "tests/fuzz/fuzz.h"
#include "touchdown/db/seal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const std::string text(fuzz::Text(data, size));
  db::ParseHead(text);
  fuzz::Answers([&] {
    const db::Seal seal = db::ParseSeal(text, "a seal");
    const db::Seal again = db::ParseSeal(db::SealText(seal), "a seal");
    fuzz::Require(again.head == seal.head && again.lines == seal.lines,
                  "what is written can be read");
  });
  return 0;
}
