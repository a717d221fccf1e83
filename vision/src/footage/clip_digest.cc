#include "touchdown/vision/footage/clip_digest.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "footage/formats/clip_formats.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Bytes of a block, and blocks that an id is made of. Both are part of the id's
// definition (touchdown.clip/1): another number would give other ids.
constexpr std::int64_t kBlockBytes = 1 << 20;
constexpr std::int64_t kBlocks = 64;

// SHA-256 of bytes that are added one after the other.
class Sha {
 public:
  Sha() : context_(EVP_MD_CTX_new()) {
    if (!context_) throw std::bad_alloc();
    Require(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
  }
  void Add(const std::uint8_t* bytes, std::size_t count) {
    Require(EVP_DigestUpdate(context_.get(), bytes, count));
  }
  void Add(std::string_view text) {
    Add(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
  std::string Hex() {
    std::array<std::uint8_t, 32> digest{};
    Require(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
    std::string hex;
    for (const std::uint8_t byte : digest) hex += fmt::format("{:02x}", byte);
    return hex;
  }

 private:
  static void Require(int done) {
    if (done != 1) throw std::logic_error("SHA-256 is not to be had");
  }
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_;
};

// One file of a clip, read by pieces.
class Input {
 public:
  explicit Input(std::filesystem::path path)
      : path_(std::move(path)),
        file_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (file_ < 0) Fail(errno);
    if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
      const int error = S_ISREG(status.st_mode) ? errno : EISDIR;
      ::close(file_);
      Fail(error);
    }
    size_bytes_ = status.st_size;
  }
  ~Input() { ::close(file_); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  std::int64_t size_bytes() const { return size_bytes_; }

  // Adds bytes [begin, begin + count) of the file.
  void HashBytes(Sha& sha, std::int64_t begin, std::int64_t count) const {
    std::vector<std::uint8_t> buffer(
        static_cast<std::size_t>(std::min(count, kBlockBytes)));
    while (count > 0) {
      const auto wanted =
          std::min(static_cast<std::size_t>(count), buffer.size());
      const ::ssize_t got = ::pread(file_, buffer.data(), wanted, begin);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) Fail(errno);
      if (got == 0) {
        throw core::InputError(fmt::format(
            "{}: became shorter while it was read", path_.string()));
      }
      sha.Add(buffer.data(), static_cast<std::size_t>(got));
      begin += got;
      count -= got;
    }
  }

 private:
  [[noreturn]] void Fail(int error) const {
    throw core::InputError(fmt::format("{}: {}", path_.string(),
                                       std::generic_category().message(error)));
  }

  std::filesystem::path path_;
  int file_;
  std::int64_t size_bytes_ = 0;
};

// All files of a recording, in a fixed order.
std::vector<std::filesystem::path> ListFiles(
    const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return ListImages(path);
  if (IsMrawOrHeader(path)) {
    const MrawPair pair = FindMrawPair(path);
    return {pair.header, pair.data};
  }
  return {path};
}

bool IsFolder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

}  // namespace

std::string ClipId(const std::filesystem::path& path) {
  const auto files = ListFiles(path);
  Sha sha;
  // The kind of digest is part of it: ids of another kind can never be equal.
  sha.Add("touchdown.clip/1\n");
  std::vector<std::int64_t> ends;  // of each file, laid end to end
  std::int64_t total = 0;
  for (const auto& file : files) {
    const std::int64_t size = Input(file).size_bytes();
    sha.Add(IsFolder(path)
                ? fmt::format("{} {}\n", size, file.filename().string())
                : fmt::format("{}\n", size));
    total += size;
    ends.push_back(total);
  }
  // Bytes [begin, end) of the whole, from the files they lie in.
  const auto add = [&](std::int64_t begin, std::int64_t end) {
    auto k = static_cast<std::size_t>(
        std::upper_bound(ends.begin(), ends.end(), begin) - ends.begin());
    while (begin < end) {
      const std::int64_t start = k == 0 ? 0 : ends[k - 1];
      const std::int64_t stop = std::min(end, ends[k]);
      Input(files[k]).HashBytes(sha, begin - start, stop - begin);
      begin = stop;
      ++k;
    }
  };
  if (total <= kBlocks * kBlockBytes) {
    add(0, total);
  } else {
    for (std::int64_t k = 0; k < kBlocks; ++k) {
      // floor(k (total - block) / 63) without the large product.
      const std::int64_t span = total - kBlockBytes;
      const std::int64_t begin =
          span / (kBlocks - 1) * k + span % (kBlocks - 1) * k / (kBlocks - 1);
      add(begin, begin + kBlockBytes);
    }
  }
  return sha.Hex();
}

std::int64_t SizeBytes(const std::filesystem::path& path) {
  std::int64_t total = 0;
  for (const auto& file : ListFiles(path)) total += Input(file).size_bytes();
  return total;
}

std::string Sha256(const std::filesystem::path& path) {
  const auto files = ListFiles(path);
  Sha whole;
  for (const auto& file : files) {
    const Input input(file);
    if (IsFolder(path)) {
      Sha sha;
      input.HashBytes(sha, 0, input.size_bytes());
      whole.Add(fmt::format("{}  {}\n", sha.Hex(), file.filename().string()));
    } else {
      input.HashBytes(whole, 0, input.size_bytes());
    }
  }
  return whole.Hex();
}

}  // namespace touchdown::vision
