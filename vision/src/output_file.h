// Output that appears under its name only when it is complete: written beside
// it under a temporary name, then renamed.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

#include "touchdown/core/unfinished.h"

namespace touchdown::vision {

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

  // Renames to the target, replacing a file. Throws core::InputError.
  void Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  std::unique_ptr<core::Unfinished> unfinished_;
  bool committed_ = false;
};

// A file under a temporary name. Every member throws core::InputError, naming
// the target, if the disk is full or the like.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Write(std::span<const std::byte> bytes);
  // Flushes, closes and renames.
  void Commit();

 private:
  TemporaryName name_;
  std::FILE* file_ = nullptr;
};

}  // namespace touchdown::vision
