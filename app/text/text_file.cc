#include "app/text/text_file.h"

#include <fstream>
#include <iterator>

#include "touchdown/core/output_file.h"

namespace touchdown::report {

void WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  core::OutputFile file(path);
  file.Write(text);
  file.Commit();
}

std::optional<std::string> ReadTextFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(file), {}};
}

}  // namespace touchdown::report
