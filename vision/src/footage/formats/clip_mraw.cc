// Photron .mraw: samples without any framing, row after row, frame after frame.
//
// 8 bit: a byte each. 12 bit: two samples in three bytes, the first in the
// upper bits (AB Cx yz -> ABC, xyz), packed across rows and frames. 16 bit:
// little- endian words in which the header says which bits carry signal:
//   Lower   right-aligned already: handed out in place, bit_depth = effective;
//   Higher  shifted down on the way out, so that a Frame is right-aligned.
// A header that says Lower 12 over words that exceed 12 bits (software that
// resaves recordings does this) is not believed: all 16 bits count, with a
// warning. 8-bit files hold the upper 8 of the effective bits: bit_depth is 8.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <initializer_list>

#include "footage/formats/clip_formats.h"
#include "footage/formats/mapped_file.h"
#include "footage/formats/photron_header.h"
#include "numbers/lanes.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

static_assert(std::endian::native == std::endian::little,
              "16-bit samples are handed out in place");

// Bytes of a stream of packed samples, the last one filled up.
std::int64_t PackedBytes(std::int64_t samples, std::int32_t bits) {
  return (samples * bits + 7) / 8;
}

// Sample number `i` of a stream of packed 12-bit samples.
std::uint16_t Unpack12(const std::uint8_t* stream, std::int64_t i) {
  const std::uint8_t* const p = stream + i / 2 * 3;
  return static_cast<std::uint16_t>(i % 2 == 0 ? p[0] << 4 | p[1] >> 4
                                               : (p[1] & 0xF) << 8 | p[2]);
}

// Eight samples of twelve bytes at a time, as long as sixteen bytes are there.
TOUCHDOWN_WIDEST
void Unpack12Eights(const std::uint8_t*& bytes, std::int32_t& samples,
                    std::uint16_t*& to) {
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  using Words = std::uint16_t __attribute__((vector_size(16)));
  // Even and odd samples of eight: the former lie in the upper, the latter in
  // the lower 12 bits of their 16-bit window.
  constexpr Words kEven = {0xFFF, 0, 0xFFF, 0, 0xFFF, 0, 0xFFF, 0};
  constexpr Words kOdd = {0, 0xFFF, 0, 0xFFF, 0, 0xFFF, 0, 0xFFF};
  const std::uint8_t* p = bytes;
  std::uint16_t* out = to;
  std::int32_t left = samples;
  for (; left >= 12; left -= 8, p += 12, out += 8) {
    Bytes sixteen;
    std::memcpy(&sixteen, p, sizeof sixteen);
    const auto words = reinterpret_cast<Words>(__builtin_shufflevector(
        sixteen, sixteen, 1, 0, 2, 1, 4, 3, 5, 4, 7, 6, 8, 7, 10, 9, 11, 10));
    const Words eight = ((words >> 4) & kEven) | (words & kOdd);
    std::memcpy(out, &eight, sizeof eight);
  }
  bytes = p;
  to = out;
  samples = left;
}

// Unpacks samples from number `first` on, which may be the second of a pair: by
// eights, by fours, by pairs, and one.
void UnpackRow12(const std::uint8_t* stream, std::int64_t first,
                 std::int32_t count, std::uint16_t* out) {
  if (count > 0 && first % 2 != 0) {
    *out++ = Unpack12(stream, first++);
    --count;
  }
  const std::uint8_t* p = stream + first / 2 * 3;
  Unpack12Eights(p, count, out);
  // Four at a time of eight bytes, of which six count; the last few, which have
  // no eight, by two.
  for (; count >= 8; count -= 4, p += 6, out += 4) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, p, sizeof eight);
    if constexpr (std::endian::native == std::endian::little) {
      eight = __builtin_bswap64(eight);
    }
    out[0] = static_cast<std::uint16_t>(eight >> 52);
    out[1] = static_cast<std::uint16_t>(eight >> 40 & 0xFFF);
    out[2] = static_cast<std::uint16_t>(eight >> 28 & 0xFFF);
    out[3] = static_cast<std::uint16_t>(eight >> 16 & 0xFFF);
  }
  for (std::int32_t pair = 0; pair < count / 2; ++pair, p += 3, out += 2) {
    out[0] = static_cast<std::uint16_t>(p[0] << 4 | p[1] >> 4);
    out[1] = static_cast<std::uint16_t>((p[1] & 0xF) << 8 | p[2]);
  }
  if (count % 2 != 0) *out = static_cast<std::uint16_t>(p[0] << 4 | p[1] >> 4);
}

// A Photron recording. 8-bit samples and right-aligned words are views of the
// mapped file; everything else is unpacked window by window.
class MrawClip final : public Clip {
 public:
  MrawClip(const std::filesystem::path& path, const ClipOptions& options)
      : pair_(FindMrawPair(path)),
        header_(ReadPhotronHeader(pair_.header)),
        file_(std::make_shared<const MappedFile>(pair_.data)) {
    info_.path = path;
    info_.format = "mraw";
    info_.width_px = header_.width_px;
    info_.height_px = header_.height_px;
    info_.first_camera_frame = header_.start_frame;
    info_.sensor_origin = header_.sensor_origin;
    info_.frames = CountFrames();
    info_.bit_depth = FindDepth();
    SetTimeBase(options);
  }

  // Reads what `like` reads.
  explicit MrawClip(const MrawClip* like)
      : pair_(like->pair_),
        header_(like->header_),
        file_(like->file_),
        info_(like->info_),
        shift_(like->shift_) {}

  const ClipInfo& info() const override { return info_; }

  bool views_last() const override {
    return header_.stored_bits == 8 ||
           (header_.stored_bits == 16 && shift_ == 0);
  }

  bool windows_are_cheap() const override { return true; }
  std::unique_ptr<Clip> Another() const override {
    return std::make_unique<MrawClip>(this);
  }

  void WillRead(std::int64_t index, const core::PixelRect& window) override {
    const Bytes rows = WindowRows(index, window);
    file_->WillRead(rows.begin, rows.end);
    copied_ = {};
  }
  // A copy by pread costs less than the faults of mapped pages that are looked
  // at once.
  void WillReadOnce(std::int64_t index,
                    const core::PixelRect& window) override {
    const Bytes rows = WindowRows(index, window);
    const auto size = static_cast<std::size_t>(rows.end - rows.begin);
    if (copy_.size() < size) copy_.resize(size);
    copied_ = {};
    file_->Copy(rows.begin, rows.end, copy_.data());
    copied_ = rows;
  }
  void HasRead() const override { file_->HasRead(); }
  void RequireWhole() const override { file_->RequireWhole(); }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    file_->RequireNothingLost();
    core::Frame frame;
    frame.bit_depth = info_.bit_depth;
    frame.time_s = static_cast<double>(index) / info_.time_base.fps;
    const Bytes rows = WindowRows(index, window);
    const bool copied = rows.begin >= copied_.begin && rows.end <= copied_.end;
    const std::byte* const data =
        copied ? copy_.data() + (rows.begin - copied_.begin)
               : file_->data() + rows.begin;
    if (header_.stored_bits == 8) {
      frame.data = data + window.x;
      frame.stride_bytes = info_.width_px;
    } else if (header_.stored_bits == 16 && shift_ == 0) {
      frame.data = data + std::ptrdiff_t{2} * window.x;
      frame.stride_bytes = std::ptrdiff_t{2} * info_.width_px;
    } else {
      Unpack(data, FirstSample(index, window), window);
      frame.data = reinterpret_cast<const std::byte*>(buffer_.data());
      frame.stride_bytes = std::ptrdiff_t{2} * window.width;
    }
    return frame;
  }

 private:
  // Of the file; of packed samples whole pairs.
  struct Bytes {
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };
  std::int64_t FirstSample(std::int64_t index,
                           const core::PixelRect& window) const {
    return index * samples_per_frame() +
           static_cast<std::int64_t>(window.y) * info_.width_px;
  }
  // Those that hold a window's rows, as wide as the picture.
  Bytes WindowRows(std::int64_t index, const core::PixelRect& window) const {
    const std::int64_t first = FirstSample(index, window);
    const std::int64_t last =
        first + static_cast<std::int64_t>(window.height) * info_.width_px;
    if (header_.stored_bits == 12) {
      return {first / 2 * 3, std::min((last + 1) / 2 * 3, file_->size_bytes())};
    }
    return {first * header_.stored_bits / 8, last * header_.stored_bits / 8};
  }

  std::int64_t samples_per_frame() const {
    return static_cast<std::int64_t>(header_.width_px) * header_.height_px;
  }

  std::string Geometry() const {
    return fmt::format("{} frames of {}x{} at {} bits", header_.frames,
                       header_.width_px, header_.height_px,
                       header_.stored_bits);
  }

  // How many whole frames there are; the file's size must agree with the
  // header.
  std::int64_t CountFrames() {
    // A frame has at most 2^36 bits and a file fewer than 2^63 bytes, so the
    // quotient bounds the header's claim before anything is multiplied by it.
    const std::int64_t size = file_->size_bytes();
    const std::int64_t bits_per_frame =
        samples_per_frame() * header_.stored_bits;
    const std::int64_t whole =
        size / bits_per_frame * 8 + size % bits_per_frame * 8 / bits_per_frame;
    const std::string header = pair_.header.filename().string();
    if (whole < 1) {
      throw core::InputError(
          fmt::format("{}: has {} bytes, less than one frame; {} describes {}",
                      pair_.data.string(), size, header, Geometry()));
    }
    if (whole < header_.frames) {
      info_.warnings.push_back(fmt::format(
          "{} ends early: {} of the {} frames that {} describes "
          "are there",
          pair_.data.filename().string(), whole, header_.frames, header));
      return whole;
    }
    const std::int64_t expected =
        PackedBytes(header_.frames * samples_per_frame(), header_.stored_bits);
    if (size != expected) {
      throw core::InputError(fmt::format(
          "{}: has {} bytes, but {} describes {}, which are {} bytes; is it "
          "the header of this recording?",
          pair_.data.string(), size, header, Geometry(), expected));
    }
    return header_.frames;
  }

  std::int32_t FindDepth() {
    if (header_.stored_bits < 16) return header_.stored_bits;
    const std::int32_t depth = header_.effective_bits;
    if (depth == 16) return 16;
    if (depth <= 8) {
      throw core::InputError(fmt::format(
          "{}: effective bit depth is {} in 16-bit words, expected 9 .. 16",
          pair_.header.string(), depth));
    }
    if (header_.effective_higher) {
      shift_ = 16 - depth;
      return depth;
    }
    const auto* const samples =
        reinterpret_cast<const std::uint16_t*>(file_->data());
    // The first frame shows whether the header's word on the signal's bits can
    // be right.
    std::uint32_t bits = 0;
    for (std::int64_t i = 0; i < samples_per_frame(); ++i) bits |= samples[i];
    if (bits >> depth == 0) return depth;
    info_.warnings.push_back(fmt::format(
        "{} says that the lower {} bits carry signal, but higher ones are set: "
        "all 16 are read",
        pair_.header.filename().string(), depth));
    return 16;
  }

  void SetTimeBase(const ClipOptions& options) {
    info_.time_base.uniform = true;
    info_.time_base.trusted = true;
    if (options.fps) {
      info_.time_base.fps = *options.fps;
      info_.time_base.source = FpsSource::kUser;
      return;
    }
    // Every save_step-th frame was saved: that is the spacing of what we have.
    const std::int64_t step = std::max<std::int64_t>(header_.save_step, 1);
    info_.time_base.fps = header_.record_rate_hz / static_cast<double>(step);
    info_.time_base.source = FpsSource::kHeader;
    if (header_.save_step == 0) {
      info_.warnings.push_back(fmt::format(
          "{} has a save step of 0, taken as 1: every recorded frame was saved",
          pair_.header.filename().string()));
    }
    if (step > 1) {
      info_.warnings.push_back(fmt::format(
          "only every {}th frame was saved: {} fps recorded, {} fps in the "
          "file",
          step, header_.record_rate_hz, info_.time_base.fps));
    }
  }

  // `data`: of the rows, whose first sample is number `first` of the file.
  void Unpack(const std::byte* data, std::int64_t first,
              const core::PixelRect& window) {
    buffer_.resize(static_cast<std::size_t>(window.width) *
                   static_cast<std::size_t>(window.height));
    std::uint16_t* out = buffer_.data();
    for (std::int32_t y = 0; y < window.height; ++y) {
      const std::int64_t row = std::int64_t{y} * info_.width_px + window.x;
      if (header_.stored_bits == 12) {
        UnpackRow12(reinterpret_cast<const std::uint8_t*>(data),
                    first % 2 + row, window.width, out);
      } else {
        const auto* const in =
            reinterpret_cast<const std::uint16_t*>(data) + row;
        for (std::int32_t x = 0; x < window.width; ++x) {
          out[x] = static_cast<std::uint16_t>(in[x] >> shift_);
        }
      }
      out += window.width;
    }
  }

  MrawPair pair_;
  PhotronHeader header_;
  std::shared_ptr<const MappedFile> file_;
  ClipInfo info_;
  std::int32_t shift_ = 0;             // of 16-bit words
  std::vector<std::uint16_t> buffer_;  // the window, where it must be unpacked
  std::vector<std::byte> copy_;        // of what is read once
  Bytes copied_;                       // where it lies in the file
};

// Extensions as cameras and users write them.
std::filesystem::path FirstThatExists(
    const std::filesystem::path& path,
    std::initializer_list<const char*> extensions) {
  for (const char* extension : extensions) {
    std::filesystem::path candidate = path;
    candidate.replace_extension(extension);
    std::error_code ignored;
    if (std::filesystem::exists(candidate, ignored)) return candidate;
  }
  return {};
}

}  // namespace

bool IsMrawOrHeader(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".mraw" || extension == ".cih" || extension == ".cihx";
}

MrawPair FindMrawPair(const std::filesystem::path& path) {
  const bool is_data = LowerExtension(path) == ".mraw";
  const std::filesystem::path other =
      is_data ? FirstThatExists(path, {".cihx", ".cih", ".CIHX", ".CIH"})
              : FirstThatExists(path, {".mraw", ".MRAW", ".Mraw", ".MRaw"});
  if (other.empty()) {
    throw core::InputError(fmt::format(
        "{}: no {} of the same name beside it; copy both files of the "
        "recording",
        path.string(), is_data ? ".cihx or .cih" : ".mraw"));
  }
  return is_data ? MrawPair{path, other} : MrawPair{other, path};
}

std::unique_ptr<Clip> OpenMraw(const std::filesystem::path& path,
                               const ClipOptions& options) {
  return std::make_unique<MrawClip>(path, options);
}

}  // namespace touchdown::vision
