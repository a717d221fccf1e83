// Several files in one: a ZIP archive whose members are stored as they are
// (pictures are compressed already), dated 1980-01-01: the same members make
// the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/output_file.h"

namespace touchdown::pipeline {

class ZipFile {
 public:
  // Appears under its name when it is committed. Throws core::OutputError, as
  // every function here does.
  explicit ZipFile(std::filesystem::path target);

  // `name` with '/' between folders. Throws std::invalid_argument where the
  // archive would grow beyond 4 GiB or 65535 members, the format's limits.
  void Add(std::string_view name, std::string_view bytes);
  void Commit();

 private:
  struct Member {
    std::string name;
    std::uint32_t crc = 0;
    std::uint32_t size = 0;
    std::uint32_t offset = 0;
  };
  void Write(std::string_view bytes);

  core::OutputFile file_;
  std::vector<Member> members_;
  std::uint64_t written_ = 0;
};

}  // namespace touchdown::pipeline
