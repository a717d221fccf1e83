// What a session left beside its store: whatever stands there is understood or
// passed over, and what was understood is written and read back.
#include "app/session/session_file.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const auto store = fuzz::Scratch() / "lab.db";
  fuzz::WriteScratch("lab.db.session.json", fuzz::Text(data, size));
  const auto read = session::ReadSession(store);
  if (!read) return 0;
  if (fuzz::Answers([&] { session::WriteSession(store, *read); })) {
    fuzz::Require(session::ReadSession(store).has_value(),
                  "what is written can be read");
  }
  return 0;
}
