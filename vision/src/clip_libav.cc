#include <fmt/format.h>

#include "clip_formats.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {

std::unique_ptr<Clip> OpenVideo(const std::filesystem::path& path,
                                const ClipOptions&) {
  throw core::InputError(
      fmt::format("{}: not a kind of recording that is read: expected .mraw or "
                  "a folder of images",
                  path.string()));
}

}  // namespace touchdown::vision
