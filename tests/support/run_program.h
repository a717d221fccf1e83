// Runs the program as a user does.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/temporary_folder.h"

namespace touchdown::testing {

struct Ran {
  int status = -1;
  std::string out;
  std::string err;
};

// `arguments` as they would be typed.
inline Ran RunProgram(const std::string& arguments) {
  const TemporaryFolder folder;
  const auto err = folder.path() / "err";
  const std::string command =
      std::string(TOUCHDOWN_BINARY) + " " + arguments + " 2>" + err.string();
  Ran ran;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return ran;
  std::array<char, 4096> buffer{};
  std::size_t n = 0;
  while ((n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0) {
    ran.out.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  ran.err = ReadAll(err);
  return ran;
}

}  // namespace touchdown::testing
