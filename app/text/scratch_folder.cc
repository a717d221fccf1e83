#include "app/text/scratch_folder.h"

#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "touchdown/core/errors.h"

namespace touchdown::pipeline {

ScratchFolder::ScratchFolder() {
  std::error_code trouble;
  const auto folder = std::filesystem::temp_directory_path(trouble);
  if (trouble) {
    throw core::OutputError("TMPDIR: no temporary folder is there (" +
                            trouble.message() +
                            "); let it name a folder, or unset it");
  }
  std::string name = (folder / "touchdown-XXXXXX").string();
  // mkdtemp() makes a new folder that only this user can enter: two commands at
  // the same time never share one. It writes the name over the X's.
  if (mkdtemp(name.data()) == nullptr) {
    throw core::OutputError(name + ": no temporary folder can be made (" +
                            std::strerror(errno) +
                            "); make room, or set TMPDIR to another folder");
  }
  // From here on a signal that ends the process removes the folder, too.
  path_ = name;
  unfinished_ = std::make_unique<core::Unfinished>(path_);
}

ScratchFolder::~ScratchFolder() {
  // A destructor must not throw. What cannot be removed stays among the
  // temporary files.
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace touchdown::pipeline
