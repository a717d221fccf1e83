#include "app/text/text_file.h"

#include <fstream>
#include <iterator>

#include "touchdown/core/output_file.h"

namespace touchdown::report {

void WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  // Nothing appears under `path` before Commit(): a reader never sees half a
  // file, and an exception leaves the old one as it is.
  core::OutputFile file(path);
  file.Write(text);
  file.Commit();
}

std::optional<std::string> ReadTextFile(const std::filesystem::path& path) {
  // Binary, so that line ends and bytes arrive as they are in the file.
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(file), {}};
}

}  // namespace touchdown::report
