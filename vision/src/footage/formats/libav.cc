#include "footage/formats/libav.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>
#include <type_traits>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

std::string Reason() {
  const char* text = dlerror();
  return text != nullptr ? text : "no reason given";
}

// Of the version that the headers are of. Never closed: what it gave may be
// used to the program's end.
void* Load(const char* name, int version) {
  const std::string file = fmt::format("{}.so.{}", name, version);
  if (void* library = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
    return library;
  }
  throw core::InputError(fmt::format(
      "{}: cannot be loaded ({}); videos need it: install it, or convert the "
      "recording to a folder of images",
      file, Reason()));
}

}  // namespace

LibavFunctions::LibavFunctions() {
  // In the one the other is found: libavformat needs libavcodec.
  Load("libavcodec", LIBAVCODEC_VERSION_MAJOR);
  void* const library = Load("libavformat", LIBAVFORMAT_VERSION_MAJOR);
  const auto find = [&](auto& function, const char* name) {
    void* const found = dlsym(library, name);
    if (found == nullptr) {
      throw core::InputError(
          fmt::format("libavformat: {}; videos need the version that this "
                      "program was compiled for",
                      Reason()));
    }
    function =
        reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
  };
#define TOUCHDOWN_LIBAV_FUNCTION(name) find(name, #name);
#include "footage/formats/libav_functions.inc"
#undef TOUCHDOWN_LIBAV_FUNCTION
}

const LibavFunctions& Libav() {
  static const LibavFunctions functions;
  return functions;
}

}  // namespace touchdown::vision
