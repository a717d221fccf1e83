#include "app/report/text_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "touchdown/core/errors.h"
#include "touchdown/core/unfinished.h"

namespace touchdown::report {

void WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path part = path;
  part += fmt::format(".part{}", getpid());
  const core::Unfinished unfinished(part);
  const auto fail = [&](int error) {
    std::remove(part.c_str());
    throw core::InputError(fmt::format("{}: cannot be written: {}",
                                       path.string(), std::strerror(error)));
  };
  std::FILE* file = std::fopen(part.c_str(), "wb");
  if (file == nullptr) fail(errno);
  const bool written =
      std::fwrite(text.data(), 1, text.size(), file) == text.size() &&
      std::fflush(file) == 0;
  const int error = errno;
  if (std::fclose(file) != 0 || !written) fail(written ? errno : error);
  std::error_code trouble;
  std::filesystem::rename(part, path, trouble);
  if (trouble) fail(trouble.value());
}

std::optional<std::string> ReadTextFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(file), {}};
}

}  // namespace touchdown::report
