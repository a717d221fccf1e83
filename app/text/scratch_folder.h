// A folder for files that nobody keeps.
#pragma once

#include <filesystem>
#include <memory>

#include "touchdown/core/unfinished.h"

namespace touchdown::pipeline {

// Of its own name among the temporary ones; goes with its owner, or with the
// process where a signal ends it. Throws core::OutputError where none can be
// made.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<core::Unfinished> unfinished_;
};

}  // namespace touchdown::pipeline
