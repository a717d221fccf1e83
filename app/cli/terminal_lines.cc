#include "app/cli/terminal_lines.h"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>

namespace touchdown::cli {

bool TerminalLines::Read() {
  std::array<char, 4096> bytes{};
  const ssize_t n = ::read(kDescriptor, bytes.data(), bytes.size());
  if (n > 0) {
    read_.append(bytes.data(), static_cast<std::size_t>(n));
  } else if (n == 0 || errno != EINTR) {
    at_end_ = true;
  }
  return n > 0;
}

std::optional<std::string> TerminalLines::Next() {
  const std::size_t end = read_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = read_.substr(0, end);
  read_.erase(0, end + 1);
  return line;
}

std::optional<std::string> TerminalLines::Ask(const std::string& question) {
  fmt::print("{} ", question);
  std::fflush(stdout);
  while (true) {
    if (auto line = Next()) return line;
    if (!Read()) return std::nullopt;
  }
}

}  // namespace touchdown::cli
