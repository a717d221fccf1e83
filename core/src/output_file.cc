#include "touchdown/core/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include "touchdown/core/errors.h"

namespace touchdown::core {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path,
                       const std::string& why) {
  throw OutputError(path.string() + ": cannot be written: " + why);
}

[[noreturn]] void Fail(const std::filesystem::path& path, int error) {
  Fail(path, std::generic_category().message(error));
}

// 64 bits of the system's own randomness.
std::string Unforeseeable() {
  // Hexadecimal, in any locale.
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string text;
  for (int word = 0; word < 2; ++word) {
    std::uint32_t bits = random();
    for (int digit = 0; digit < 8; ++digit, bits >>= 4) {
      text += kDigits[bits & 0xfU];
    }
  }
  return text;
}

void RequirePlain(const std::filesystem::path& target) {
  struct stat there = {};
  if (lstat(target.c_str(), &there) != 0) return;  // it is new
  if (S_ISREG(there.st_mode) || S_ISDIR(there.st_mode)) return;
  Fail(target, S_ISLNK(there.st_mode)
                   ? "it is a symbolic link; name the file that it points to"
                   : "it is no plain file; give another name, or write to "
                     "stdout");
}

}  // namespace

TemporaryName::TemporaryName(std::filesystem::path target)
    : target_(std::move(target)) {
  RequirePlain(target_);
  // File systems take 255 bytes; what is added has 23.
  constexpr std::size_t kMostOfName = 200;
  std::string name = ".";
  name += target_.filename().string().substr(0, kMostOfName);
  name += "." + Unforeseeable() + ".part";
  path_ = target_.parent_path() / name;
  unfinished_ = std::make_unique<Unfinished>(path_);
}

TemporaryName::~TemporaryName() {
  if (committed_) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

int TemporaryName::MakeFile() const {
  const int file =
      open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
           0666);
  if (file < 0) Fail(target_, errno);
  return file;
}

void TemporaryName::Commit() {
  // It may have become something else meanwhile.
  RequirePlain(target_);
  std::error_code trouble;
  std::filesystem::rename(path_, target_, trouble);
  if (trouble) Fail(target_, trouble.message());
  committed_ = true;
}

OutputFile::OutputFile(std::filesystem::path target)
    : name_(std::move(target)) {
  const int file = name_.MakeFile();
  file_ = fdopen(file, "wb");
  if (file_ == nullptr) {
    const int error = errno;
    close(file);
    Fail(name_.target(), error);
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
}

void OutputFile::Write(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) {
    Fail(name_.target(), errno);
  }
}

void OutputFile::Write(std::string_view text) {
  Write(std::as_bytes(std::span(text.data(), text.size())));
}

void OutputFile::Finish() {
  if (file_ == nullptr) return;
  std::FILE* const file = std::exchange(file_, nullptr);
  const bool written = std::fflush(file) == 0;
  const int error = errno;
  // Network drives tell of a full disk when a file is closed.
  if (std::fclose(file) != 0 || !written) {
    Fail(name_.target(), written ? errno : error);
  }
}

void OutputFile::Commit() {
  Finish();
  name_.Commit();
}

}  // namespace touchdown::core
