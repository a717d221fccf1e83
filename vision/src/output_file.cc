#include "output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path,
                       const std::string& why) {
  throw core::InputError(
      fmt::format("{}: cannot be written: {}", path.string(), why));
}

[[noreturn]] void Fail(const std::filesystem::path& path, int error) {
  Fail(path, std::generic_category().message(error));
}

}  // namespace

TemporaryName::TemporaryName(std::filesystem::path target)
    : target_(std::move(target)) {
  // The process number keeps two writers of the same output apart.
  path_ = target_.parent_path() /
          fmt::format(".{}.{}.part", target_.filename().string(), ::getpid());
  unfinished_ = std::make_unique<core::Unfinished>(path_);
}

TemporaryName::~TemporaryName() {
  if (committed_) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void TemporaryName::Commit() {
  std::error_code trouble;
  std::filesystem::rename(path_, target_, trouble);
  if (trouble) Fail(target_, trouble.message());
  committed_ = true;
}

OutputFile::OutputFile(std::filesystem::path target)
    : name_(std::move(target)) {
  file_ = std::fopen(name_.path().c_str(), "wbe");
  if (file_ == nullptr) Fail(name_.target(), errno);
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

void OutputFile::Commit() {
  std::FILE* const file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0) Fail(name_.target(), errno);
  name_.Commit();
}

}  // namespace touchdown::vision
