// Scene files: what was accepted can be written and read back.
#include <string>

#include "app/simulate/scene_file.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  std::string text;
  if (!fuzz::Answers([&] {
        text = pipeline::SceneText(pipeline::ParseScene(
            std::string(fuzz::Text(data, size)), "scene.json"));
      })) {
    return 0;
  }
  fuzz::Require(
      fuzz::Answers([&] { pipeline::ParseScene(text, "again.json"); }),
      "what is written can be read");
  return 0;
}
