// Output that appears under its name only when it is complete: written beside
// it under a name that nobody can foretell, then renamed.
//
// What stands under the target's name is replaced only where it is a plain
// file: nothing is written through a symbolic link, into a device, a FIFO or a
// socket. Every function throws OutputError, naming the target.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "touchdown/core/unfinished.h"

namespace touchdown::core {

// The temporary name of an output file or folder; removed again unless Commit
// was called.
class TemporaryName {
 public:
  explicit TemporaryName(std::filesystem::path target);
  ~TemporaryName();
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }

  // Makes an empty file of that name, which was not there before, and opens it
  // for writing; who calls it closes the descriptor.
  int MakeFile() const;
  // Renames to the target, replacing a file.
  void Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  std::unique_ptr<Unfinished> unfinished_;
  bool committed_ = false;
};

// A file under a temporary name.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Write(std::span<const std::byte> bytes);
  void Write(std::string_view text);
  // Flushes and closes: of several files that are of use only together, each
  // before the first is committed.
  void Finish();
  // Finishes and renames.
  void Commit();

 private:
  TemporaryName name_;
  std::FILE* file_ = nullptr;
};

}  // namespace touchdown::core
