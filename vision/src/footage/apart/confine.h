// What a reader may do, taken away from this process for good.
#pragma once

#include <filesystem>
#include <string>

#include "touchdown/vision/footage/clip_apart.h"

namespace touchdown::vision {

// Limits of memory, open files and core files. Never more than there were.
void Limit(const ReaderLimits& limits);

// From here on this process may open no file but `path`, or those in the folder
// `path` and what its links lead to. Empty; else why the kernel does not.
std::string ConfineToFile(const std::filesystem::path& path);

// From here on this process may make no system call but those of a reader:
// files are opened to be read, sockets are pairs, threads are its own; it
// starts nothing, reaches no network and no other process. Others fail with
// EPERM. Empty; else why the kernel does not.
std::string ConfineCalls();

}  // namespace touchdown::vision
