#include "footage/formats/tiff_file.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace touchdown::vision {
namespace {

int OnTiffError(TIFF*, void* user, const char*, const char* format,
                va_list args) {
  auto* const memory = static_cast<TiffMemory*>(user);
  // The first message is the cause; later ones follow from it.
  if (memory->error[0] == '\0') {
    std::vsnprintf(memory->error, sizeof memory->error, format, args);
  }
  return 1;
}

int OnTiffWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

tmsize_t OnTiffRead(thandle_t handle, void* out, tmsize_t count) {
  auto* const memory = static_cast<TiffMemory*>(handle);
  if (count <= 0 || memory->at >= memory->size()) return 0;
  const auto got = std::min<std::uint64_t>(static_cast<std::uint64_t>(count),
                                           memory->size() - memory->at);
  const std::uint8_t* const from =
      memory->output ? memory->output->data() : memory->input.data();
  std::memcpy(out, from + memory->at, got);
  memory->at += got;
  return static_cast<tmsize_t>(got);
}

tmsize_t OnTiffWrite(thandle_t handle, void* bytes, tmsize_t count) {
  auto* const memory = static_cast<TiffMemory*>(handle);
  if (memory->output == nullptr || count < 0) return 0;
  const std::uint64_t end = memory->at + static_cast<std::uint64_t>(count);
  if (end > memory->output->size()) memory->output->resize(end);
  std::memcpy(memory->output->data() + memory->at, bytes,
              static_cast<std::size_t>(count));
  memory->at = end;
  return count;
}

// Beyond the end is allowed: reads there return nothing.
toff_t OnSeek(thandle_t handle, toff_t offset, int whence) {
  auto* const memory = static_cast<TiffMemory*>(handle);
  if (whence == SEEK_CUR) offset += memory->at;
  if (whence == SEEK_END) offset += memory->size();
  memory->at = offset;
  return offset;
}

int OnClose(thandle_t) { return 0; }

toff_t OnSize(thandle_t handle) {
  return static_cast<const TiffMemory*>(handle)->size();
}

}  // namespace

// libtiff on memory, with its messages kept instead of printed.
TiffHandle OpenTiff(TiffMemory& memory, const char* mode) {
  TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, OnTiffError, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options, OnTiffWarning, &memory);
  TIFF* const tiff =
      TIFFClientOpenExt("", mode, &memory, OnTiffRead, OnTiffWrite, OnSeek,
                        OnClose, OnSize, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return TiffHandle(tiff);
}

}  // namespace touchdown::vision
