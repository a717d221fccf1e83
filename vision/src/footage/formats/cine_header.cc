#include "footage/formats/cine_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "footage/formats/mapped_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Stamps and exposures are 32.32 fixed-point seconds.
constexpr double kTwoTo32 = 4294967296.0;
// Seconds: no camera misses frames for so long and goes on with the same
// recording.
constexpr double kLongestGapS = 3600.0;
constexpr std::uint64_t kStampFlags = 3;  // IRIG in step, event input
constexpr std::uint32_t kPacked10 = 256;  // biCompression

class Reader {
 public:
  Reader(std::span<const std::uint8_t> file, const std::string& name)
      : file_(file), name_(name) {}

  template <class T>
  T Number(std::uint64_t at, const char* what) const {
    if (at > file_.size() || file_.size() - at < sizeof(T)) {
      throw core::InputError(fmt::format(
          "{}: {} is expected at byte {}, but the file has {} bytes; copy it "
          "from the camera again",
          name_, what, at, file_.size()));
    }
    T value{};
    std::memcpy(&value, file_.data() + at, sizeof value);
    return value;
  }

  bool Marked(std::uint64_t at, const char* mark) const {
    return at <= file_.size() && file_.size() - at >= 2 &&
           std::memcmp(file_.data() + at, mark, 2) == 0;
  }

  // Bytes of `size` from `at`, or none if the file ends before.
  std::span<const std::uint8_t> Piece(std::uint64_t at,
                                      std::uint64_t size) const {
    if (at > file_.size() || file_.size() - at < size) return {};
    return file_.subspan(at, size);
  }

 private:
  std::span<const std::uint8_t> file_;
  const std::string& name_;
};

// A block of `images` values of T, or nothing if it has fewer.
template <class T>
std::vector<T> Values(std::span<const std::uint8_t> block,
                      std::int64_t images) {
  const auto count = static_cast<std::uint64_t>(images);
  if (images < 1 || block.size() / sizeof(T) < count) return {};
  std::vector<T> values(count);
  std::memcpy(values.data(), block.data(), count * sizeof(T));
  return values;
}

void TakeStamps(const std::vector<std::uint64_t>& stamps, CineHeader& header) {
  header.times_s.clear();
  header.stamps_trouble.clear();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    // Differences of whole numbers: seconds since 1970 leave a double only
    // quarters of a microsecond.
    const std::uint64_t now = stamps[i] & ~kStampFlags;
    const std::uint64_t before = stamps[i > 0 ? i - 1 : 0] & ~kStampFlags;
    const double step_s = static_cast<double>(now - before) / kTwoTo32;
    if (i > 0 && (now <= before || step_s > kLongestGapS)) {
      header.stamps_trouble =
          now <= before
              ? fmt::format("frame {} is not later than frame {}", i, i - 1)
              : fmt::format("frame {} is {:.6g} s later than frame {}", i,
                            step_s, i - 1);
      header.times_s.clear();
      return;
    }
    const std::uint64_t first = stamps[0] & ~kStampFlags;
    header.times_s.push_back(static_cast<double>(now - first) / kTwoTo32);
  }
}

// Blocks that are cut or too short are left out: they are not needed to read
// the pictures.
void ReadBlocks(const Reader& reader, std::uint64_t at, std::uint64_t end,
                CineHeader& header) {
  // Bytes of a block's head (size, type, reserved), and types of blocks, as the
  // Cine file format numbers them.
  constexpr std::uint64_t kBlockHead = 8;
  constexpr std::uint16_t kTimes = 1002;
  constexpr std::uint16_t kExposures = 1003;
  while (at + kBlockHead <= end) {
    const auto size = reader.Number<std::uint32_t>(at, "a tagged block");
    const auto type = reader.Number<std::uint16_t>(at + 4, "a block's type");
    if (size < kBlockHead || size > end - at) return;
    const auto block = reader.Piece(at + kBlockHead, size - kBlockHead);
    if (type == kTimes) {
      TakeStamps(Values<std::uint64_t>(block, header.images), header);
    } else if (type == kExposures) {
      header.exposures_s.clear();
      for (const auto e : Values<std::uint32_t>(block, header.images)) {
        header.exposures_s.push_back(e / kTwoTo32);
      }
    }
    at += size;
  }
}

}  // namespace

CineHeader ParseCineHeader(std::span<const std::uint8_t> file,
                           const std::string& name) {
  const Reader reader(file, name);
  if (!reader.Marked(0, "CI")) {
    throw core::InputError(
        fmt::format("{}: does not begin with CI, expected a .cine", name));
  }
  CineHeader header;
  header.first_image = reader.Number<std::int32_t>(16, "FirstImageNo");
  header.images = reader.Number<std::uint32_t>(20, "ImageCount");
  const std::uint64_t picture =
      reader.Number<std::uint32_t>(24, "OffImageHeader");
  const std::uint64_t setup = reader.Number<std::uint32_t>(28, "OffSetup");
  const std::uint64_t offsets =
      reader.Number<std::uint32_t>(32, "OffImageOffsets");
  header.packed_10 =
      reader.Number<std::uint32_t>(picture + 16, "biCompression") == kPacked10;
  if (!reader.Marked(setup + 140, "ST")) return header;  // of older software
  const auto length = reader.Number<std::uint16_t>(setup + 142, "Length");
  // Bytes of a SETUP structure that reaches to the field FrameRate.
  constexpr std::uint16_t kHasFrameRate = 772;
  if (length >= kHasFrameRate) {
    header.stated_fps = reader.Number<std::uint32_t>(setup + 768, "FrameRate");
  }
  const std::uint64_t end = std::min<std::uint64_t>(offsets, file.size());
  ReadBlocks(reader, setup + length, end, header);
  return header;
}

CineHeader ReadCineHeader(const std::filesystem::path& path) {
  const MappedFile file(path);
  return ParseCineHeader({reinterpret_cast<const std::uint8_t*>(file.data()),
                          static_cast<std::size_t>(file.size_bytes())},
                         path.string());
}

}  // namespace touchdown::vision
