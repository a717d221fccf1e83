#include "app/text/text_file.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"

namespace touchdown::report {

void WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  // Nothing appears under `path` before Commit(): a reader never sees half a
  // file, and an exception leaves the old one as it is.
  core::OutputFile file(path);
  file.Write(text);
  file.Commit();
}

std::string ReadTextFile(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw core::InputError(
        fmt::format("{}: is a folder; expected a file", path.string()));
  }
  errno = 0;
  // Binary, so that line ends and bytes arrive as they are in the file.
  std::ifstream in(path, std::ios::binary);
  // The buffer's iterators set no flag where reading fails: read() does.
  std::string out;
  constexpr std::size_t kPiece = 65536;  // bytes; any size gives the same text
  while (in) {
    const std::size_t before = out.size();
    out.resize(before + kPiece);
    in.read(out.data() + before, kPiece);
    out.resize(before + static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) {
    throw core::InputError(
        fmt::format("{}: cannot be read: {}", path.string(),
                    std::strerror(errno == 0 ? EIO : errno)));
  }
  return out;
}

}  // namespace touchdown::report
