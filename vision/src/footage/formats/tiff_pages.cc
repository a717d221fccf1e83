#include "footage/formats/tiff_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <unordered_set>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Tags and values of TIFF 6.0, sections 3 to 8 and 15.
enum TiffTag : std::uint16_t {
  kNewSubfileType = 254,
  kImageWidth = 256,
  kImageLength = 257,
  kBitsPerSample = 258,
  kCompression = 259,
  kPhotometric = 262,
  kFillOrder = 266,
  kImageDescription = 270,
  kStripOffsets = 273,
  kSamplesPerPixel = 277,
  kStripByteCounts = 279,
  kMaxSampleValue = 281,
  kTileOffsets = 324,
  kTileByteCounts = 325,
  kSampleFormat = 339,
};
// Values of the fields above.
constexpr std::uint64_t kReducedPicture = 1;  // bit of NewSubfileType
constexpr std::uint64_t kTransparency = 4;    // another: a mask
constexpr std::uint64_t kUncompressed = 1;
constexpr std::uint64_t kBlackIsZero = 1;
constexpr std::uint64_t kLeftToRight = 1;  // of FillOrder
constexpr std::uint64_t kUnsigned = 1;     // of SampleFormat

// The file's bytes with its byte order; nothing is read beyond the end.
class Bytes {
 public:
  explicit Bytes(FileBytes file) : file_(file) {
    const auto magic = [&](std::uint8_t mark, std::uint8_t version) {
      const bool big = mark == 'M';
      return file.size() >= 8 && file[0] == mark && file[1] == mark &&
             file[big ? 3 : 2] == version && file[big ? 2 : 3] == 0;
    };
    big_endian_ = magic('M', 42) || magic('M', 43);
    big_tiff_ = magic('I', 43) || magic('M', 43);
    is_tiff_ = big_endian_ || big_tiff_ || magic('I', 42);
  }

  bool is_tiff() const { return is_tiff_; }
  bool big_endian() const { return big_endian_; }
  bool big_tiff() const { return big_tiff_; }
  std::uint64_t size() const { return file_.size(); }
  bool Holds(std::uint64_t at, std::uint64_t count) const {
    return at <= size() && count <= size() - at;
  }

  // A number of `bytes` bytes, or nothing beyond the end.
  std::optional<std::uint64_t> Number(std::uint64_t at, unsigned bytes) const {
    if (!Holds(at, bytes)) return std::nullopt;
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
      const std::uint64_t byte = file_[at + (big_endian_ ? i : bytes - 1 - i)];
      value = value << 8 | byte;
    }
    return value;
  }

  std::string_view Text(std::uint64_t at, std::uint64_t count) const {
    if (!Holds(at, count)) return {};
    return {reinterpret_cast<const char*>(file_.data() + at), count};
  }

 private:
  FileBytes file_;
  bool is_tiff_ = false;
  bool big_endian_ = false;
  bool big_tiff_ = false;
};

// Bytes of a value of a field's type, 0 of those that hold no whole numbers.
unsigned BytesOfType(std::uint64_t type) {
  switch (type) {
    case 1:  // BYTE
    case 2:  // ASCII
      return 1;
    case 3:  // SHORT
      return 2;
    case 4:   // LONG
    case 13:  // IFD
      return 4;
    case 16:  // LONG8
    case 18:  // IFD8
      return 8;
    default:
      return 0;
  }
}

// The values of one field, which stand within the file.
struct Field {
  std::uint64_t count = 0;
  std::uint64_t at = 0;
  unsigned bytes = 0;  // of a value
};

struct Directory {
  std::optional<Field> width, height, bits, samples, compression, meaning, fill,
      offsets, lengths, largest, format, purpose, description;
  bool tiled = false;
  std::uint64_t next = 0;  // 0: the last one
};

std::optional<Field>* FindSlot(Directory& directory, std::uint64_t tag) {
  switch (tag) {
    case kNewSubfileType:
      return &directory.purpose;
    case kImageWidth:
      return &directory.width;
    case kImageLength:
      return &directory.height;
    case kBitsPerSample:
      return &directory.bits;
    case kCompression:
      return &directory.compression;
    case kPhotometric:
      return &directory.meaning;
    case kFillOrder:
      return &directory.fill;
    case kImageDescription:
      return &directory.description;
    case kStripOffsets:
    case kTileOffsets:
      return &directory.offsets;
    case kSamplesPerPixel:
      return &directory.samples;
    case kStripByteCounts:
    case kTileByteCounts:
      return &directory.lengths;
    case kMaxSampleValue:
      return &directory.largest;
    case kSampleFormat:
      return &directory.format;
    default:
      return nullptr;
  }
}

// The directory at byte `at`; nothing if the file does not hold all of it.
std::optional<Directory> ReadDirectory(const Bytes& file, std::uint64_t at) {
  const bool big = file.big_tiff();
  const unsigned word = big ? 8 : 4;  // of counts and offsets
  const std::uint64_t entry_bytes = big ? 20 : 12;
  const auto entries = file.Number(at, big ? 8 : 2);
  if (!entries || *entries > file.size() / entry_bytes) return std::nullopt;
  at += big ? 8 : 2;
  const auto next = file.Number(at + *entries * entry_bytes, word);
  if (!next) return std::nullopt;
  Directory directory;
  directory.next = *next;
  for (std::uint64_t i = 0; i < *entries; ++i, at += entry_bytes) {
    const std::uint64_t tag = *file.Number(at, 2);
    std::optional<Field>* const slot = FindSlot(directory, tag);
    directory.tiled = directory.tiled || tag == kTileOffsets;
    const unsigned bytes = BytesOfType(*file.Number(at + 2, 2));
    if (slot == nullptr || bytes == 0) continue;
    Field field{*file.Number(at + 4, word), at + 4 + word, bytes};
    if (field.count > file.size() / bytes) return std::nullopt;
    if (field.count * bytes > word) field.at = *file.Number(field.at, word);
    if (!file.Holds(field.at, field.count * bytes)) return std::nullopt;
    *slot = field;
  }
  return directory;
}

// The number-th value of a field, or `fallback` where it is absent or cut.
std::uint64_t Value(const Bytes& file, const std::optional<Field>& field,
                    std::uint64_t fallback, std::uint64_t number = 0) {
  if (!field || number >= field->count) return fallback;
  return file.Number(field->at + number * field->bytes, field->bytes)
      .value_or(fallback);
}

std::int32_t PageBitDepth(const Bytes& file, const Directory& directory,
                          bool colour) {
  const std::uint64_t bits = Value(file, directory.bits, 1);
  if (bits == 16 && !colour) {
    const std::uint64_t largest = Value(file, directory.largest, 0);
    for (std::int32_t depth = 9; depth < 16; ++depth) {
      if (largest == (1u << depth) - 1u) return depth;
    }
  }
  return static_cast<std::int32_t>(std::min<std::uint64_t>(bits, 64));
}

TiffPage DescribePage(const Bytes& file, std::uint64_t at,
                      const Directory& directory) {
  TiffPage page;
  page.directory = at;
  // A side that no TIFF has: larger claims are cut to it, so that products of
  // sides do not overflow.
  constexpr std::uint64_t kNoPicture = std::uint64_t{1} << 32;
  const std::uint64_t width =
      std::min(Value(file, directory.width, 0), kNoPicture);
  const std::uint64_t height =
      std::min(Value(file, directory.height, 0), kNoPicture);
  page.width_px = static_cast<std::int64_t>(width);
  page.height_px = static_cast<std::int64_t>(height);
  const std::uint64_t samples = Value(file, directory.samples, 1);
  const std::uint64_t bits = Value(file, directory.bits, 1);
  page.bit_depth = PageBitDepth(file, directory, samples > 2);
  if (!directory.offsets || directory.offsets->count == 0) {
    page.whole = false;
    return page;
  }
  const std::uint64_t first = Value(file, directory.offsets, 0);
  std::uint64_t end = first;
  bool one_piece = true;
  for (std::uint64_t i = 0; i < directory.offsets->count; ++i) {
    const std::uint64_t begin = Value(file, directory.offsets, 0, i);
    const std::uint64_t length = Value(file, directory.lengths, 0, i);
    page.whole = page.whole && file.Holds(begin, length);
    one_piece = one_piece && begin == end;
    end = begin + length;
  }
  const std::uint64_t bytes = bits / 8;
  const bool plain =
      page.whole && one_piece && !directory.tiled && first > 0 &&
      samples == 1 && (bits == 8 || bits == 16) &&
      Value(file, directory.compression, kUncompressed) == kUncompressed &&
      Value(file, directory.meaning, 0) == kBlackIsZero &&
      Value(file, directory.fill, kLeftToRight) == kLeftToRight &&
      Value(file, directory.format, kUnsigned) == kUnsigned;
  // Both are at most 2^32: the product of the sides does not overflow.
  if (plain && width > 0 && height > 0 &&
      width * height <= (end - first) / bytes) {
    page.samples = first;
  }
  return page;
}

// "images=250" of the description that ImageJ writes; 0 if it says nothing.
std::uint64_t ImagesOfImageJ(const Bytes& file, const Directory& directory) {
  if (!directory.description) return 0;
  const std::string_view text =
      file.Text(directory.description->at, directory.description->count);
  // As ImageJ writes it.
  constexpr std::string_view kCount = "\nimages=";
  const std::size_t at = text.find(kCount);
  if (!text.starts_with("ImageJ=") || at == std::string_view::npos) return 0;
  const std::string_view digits = text.substr(at + kCount.size());
  std::uint64_t count = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), count);
  return count;
}

// The pictures that follow the first without directories of their own.
void AddPicturesOfImageJ(const Bytes& file, std::uint64_t count,
                         TiffPages& list) {
  const TiffPage first = list.pages.front();
  const std::uint64_t bytes = static_cast<std::uint64_t>(first.width_px) *
                              static_cast<std::uint64_t>(first.height_px) *
                              (first.bit_depth > 8 ? 2u : 1u);
  const std::uint64_t there = (file.size() - first.samples) / bytes;
  list.ended_early.clear();
  if (there < count) {
    list.ended_early =
        fmt::format("its description tells of {} pictures", count);
  }
  for (std::uint64_t i = 1; i < std::min(there, count); ++i) {
    TiffPage page = first;
    page.samples += i * bytes;
    list.pages.push_back(page);
  }
}

bool IsThumbnail(const Bytes& file, const Directory& directory) {
  const std::uint64_t purpose = Value(file, directory.purpose, 0);
  return (purpose & (kReducedPicture | kTransparency)) != 0;
}

std::uint64_t FirstDirectory(const Bytes& file) {
  return file.Number(file.big_tiff() ? 8 : 4, file.big_tiff() ? 8 : 4)
      .value_or(0);
}

}  // namespace

// Follows the chain of directories; one that leads back ends the list.
TiffPages ListTiffPages(FileBytes bytes, const std::string& name) {
  const Bytes file(bytes);
  if (!file.is_tiff()) {
    throw core::InputError(
        fmt::format("{}: not a TIFF picture, whatever its name", name));
  }
  TiffPages list;
  list.big_endian = file.big_endian();
  std::unordered_set<std::uint64_t> seen;
  std::uint64_t images = 0;
  for (std::uint64_t at = FirstDirectory(file); at != 0;) {
    const auto directory = ReadDirectory(file, at);
    if (!directory || !seen.insert(at).second) {
      list.ended_early =
          fmt::format("the directory of page {} is {}", seen.size() + 1,
                      directory ? "that of an earlier one" : "not there");
      break;
    }
    if (IsThumbnail(file, *directory)) {
      ++list.thumbnails;
    } else {
      list.pages.push_back(DescribePage(file, at, *directory));
      if (list.pages.size() == 1) images = ImagesOfImageJ(file, *directory);
    }
    at = directory->next;
  }
  if (list.pages.size() == 1 && images > 1 && list.pages[0].samples != 0) {
    AddPicturesOfImageJ(file, images, list);
  }
  while (!list.pages.empty() && !list.pages.back().whole) {
    list.pages.pop_back();
    if (list.ended_early.empty()) list.ended_early = "the last page is cut";
  }
  return list;
}

bool HasSeveralTiffPages(FileBytes bytes) {
  const Bytes file(bytes);
  if (!file.is_tiff()) return false;
  // Directories: thumbnails of the first picture may stand before the second. A
  // bound, since this is asked of every file.
  constexpr int kMaxLooks = 8;
  int pictures = 0;
  std::uint64_t at = FirstDirectory(file);
  for (int look = 0; look < kMaxLooks && at != 0; ++look) {
    const auto directory = ReadDirectory(file, at);
    if (!directory) return look > 0;  // there was one
    if (!IsThumbnail(file, *directory)) ++pictures;
    if (pictures > 1 || ImagesOfImageJ(file, *directory) > 1) return true;
    at = directory->next;
  }
  return false;
}

}  // namespace touchdown::vision
