// Text files that appear under their name only when they are complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchdown::report {

// Writes beside `path`, then renames. Throws core::OutputError naming the file
// if it cannot be written (no such folder, no right, disk full); nothing is
// left.
void WriteTextFile(const std::filesystem::path& path, std::string_view text);

// The whole of a file, byte by byte. Throws core::InputError with the system's
// reason where it cannot be read, also where its disk fails on the way.
std::string ReadTextFile(const std::filesystem::path& path);

}  // namespace touchdown::report
