// Calibration files: what was accepted can be written and read back.
#include <string>

#include "tests/fuzz/fuzz.h"
#include "touchdown/calib/calibration_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  std::string text;
  if (!fuzz::Answers([&] {
        text = calib::CalibrationText(calib::ParseCalibration(
            std::string(fuzz::Text(data, size)), "cal.json"));
      })) {
    return 0;
  }
  fuzz::Require(
      fuzz::Answers([&] { calib::ParseCalibration(text, "again.json"); }),
      "what is written can be read");
  return 0;
}
