// PNG, TIFF and JPEG: what is read has the size that it says.
#include "tests/fuzz/fuzz.h"
#include "touchdown/vision/footage/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const auto path = fuzz::WriteScratch("image", fuzz::Text(data, size));
  fuzz::Answers([&] {
    const vision::Image image = vision::ReadImage(path);
    fuzz::Require(
        image.pixels.size() == static_cast<std::size_t>(image.width_px) *
                                   static_cast<std::size_t>(image.height_px) *
                                   (image.bit_depth > 8 ? 2u : 1u),
        "as many bytes as pixels");
    fuzz::Touch(image.View());
  });
  return 0;
}
