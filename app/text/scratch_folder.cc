#include "app/text/scratch_folder.h"

#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "touchdown/core/errors.h"

namespace touchdown::pipeline {

ScratchFolder::ScratchFolder() {
  std::error_code ignored;
  std::string name =
      (std::filesystem::temp_directory_path(ignored) / "touchdown-XXXXXX")
          .string();
  if (mkdtemp(name.data()) == nullptr) {
    throw core::OutputError(name + ": no temporary folder can be made (" +
                            std::strerror(errno) +
                            "); make room, or set TMPDIR to another folder");
  }
  path_ = name;
  unfinished_ = std::make_unique<core::Unfinished>(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace touchdown::pipeline
