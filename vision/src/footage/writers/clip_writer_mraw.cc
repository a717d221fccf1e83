#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <system_error>
#include <vector>

#include "footage/formats/clip_formats.h"
#include "footage/writers/frame_feed.h"
#include "touchdown/core/output_file.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {
namespace {

static_assert(std::endian::native == std::endian::little,
              "16-bit samples are written as they lie in memory");

// Packs 12-bit samples two to three bytes, on and on across rows and frames.
class Packer {
 public:
  void Add(std::uint16_t sample, std::vector<std::byte>& out) {
    waiting_ = !waiting_;
    if (waiting_) {
      first_ = sample;
      return;
    }
    out.push_back(static_cast<std::byte>(first_ >> 4));
    out.push_back(
        static_cast<std::byte>((first_ & 0xF) << 4 | (sample >> 8 & 0xF)));
    out.push_back(static_cast<std::byte>(sample & 0xFF));
  }
  void Finish(std::vector<std::byte>& out) const {
    if (!waiting_) return;
    out.push_back(static_cast<std::byte>(first_ >> 4));
    out.push_back(static_cast<std::byte>((first_ & 0xF) << 4));
  }

 private:
  bool waiting_ = false;  // first_ waits for its partner
  std::uint16_t first_ = 0;
};

struct Facts {
  core::Frame first;
  std::int64_t frames = 0;
  int stored_bits = 8;
};

std::string Cih(const Facts& facts, const MrawOptions& options) {
  const double rate = options.fps * static_cast<double>(options.save_step);
  return fmt::format(
      "#Camera Information Header\n"
      "Record Rate(fps) : {}\n"
      "Original Total Frame : {}\n"
      "Total Frame : {}\n"
      "Start Frame : {}\n"
      "Save Step : {}\n"
      "Image Width : {}\n"
      "Image Height : {}\n"
      "Color Type : Mono\n"
      "Color Bit : {}\n"
      "File Format : MRaw\n"
      "EffectiveBit Depth : {}\n"
      "EffectiveBit Side : Lower\n",
      rate, facts.frames, facts.frames, options.start_frame, options.save_step,
      facts.first.width_px, facts.first.height_px, facts.stored_bits,
      facts.first.bit_depth);
}

std::string Cihx(const Facts& facts, const MrawOptions& options) {
  const double rate = options.fps * static_cast<double>(options.save_step);
  const std::string place =
      options.sensor_origin
          ? fmt::format(
                "<segmentPos><sensorXpos>{}</sensorXpos>"
                "<sensorYpos>{}</sensorYpos></segmentPos>",
                options.sensor_origin->x_px, options.sensor_origin->y_px)
          : "";
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
      "<cih>\n"
      "<imageFileInfo><fileFormat>Mraw</fileFormat><resolution><width>{0}"
      "</width><height>{1}</height></resolution></imageFileInfo>\n"
      "<imageDataInfo><resolution><width>{0}</width><height>{1}</height>"
      "</resolution><colorInfo><type>Mono</type><bit>{2}</bit></colorInfo>"
      "<effectiveBit><depth>{3}</depth><side>Lower</side></effectiveBit>{4}"
      "</imageDataInfo>\n"
      "<frameInfo><recordedFrame>{5}</recordedFrame><totalFrame>{5}"
      "</totalFrame><startFrame>{6}</startFrame><skipFrame>{7}</skipFrame>"
      "</frameInfo>\n"
      "<recordInfo><recordRate>{8}</recordRate></recordInfo>\n"
      "</cih>\n",
      facts.first.width_px, facts.first.height_px, facts.stored_bits,
      facts.first.bit_depth, place, facts.frames, options.start_frame,
      options.save_step, rate);
}

// The form in the file: the smallest that holds the depth, unless the options
// say otherwise.
int StoredBits(const core::Frame& frame, const MrawOptions& options) {
  const MrawBits bits =
      options.bits.value_or(frame.bit_depth <= 8    ? MrawBits::k8
                            : frame.bit_depth == 12 ? MrawBits::k12Packed
                                                    : MrawBits::k16);
  const bool fits = bits == MrawBits::k8          ? frame.bit_depth == 8
                    : bits == MrawBits::k12Packed ? frame.bit_depth == 12
                                                  : frame.bit_depth > 8;
  if (!fits) {
    throw std::invalid_argument(fmt::format(
        "bit_depth of the frames is {}, must be 8 for 8-bit, 12 for packed and "
        "9 .. 16 for 16-bit .mraw",
        frame.bit_depth));
  }
  return bits == MrawBits::k8 ? 8 : bits == MrawBits::k12Packed ? 12 : 16;
}

}  // namespace

void CheckFps(double fps) {
  if (!std::isfinite(fps) || fps <= 0.0) {
    throw std::invalid_argument(fmt::format(
        "fps is {}, must be positive and finite (frames per second)", fps));
  }
}

std::int64_t WriteMraw(const std::filesystem::path& path,
                       const MrawOptions& options, const FrameSource& next) {
  CheckFps(options.fps);
  if (options.save_step < 1) {
    throw std::invalid_argument(
        fmt::format("save_step is {}, must be 1 or more", options.save_step));
  }
  if (LowerExtension(path) != ".mraw") {
    throw std::invalid_argument(
        fmt::format("path is {}, must end in .mraw", path.string()));
  }
  FrameFeed feed(next);
  Facts facts;
  core::OutputFile data(path);
  Packer packer;
  std::vector<std::byte> packed;
  while (const auto frame = feed.Next()) {
    if (feed.count() == 1) {
      facts.first = *frame;
      facts.stored_bits = StoredBits(*frame, options);
    }
    const auto width = static_cast<std::size_t>(frame->width_px);
    for (std::int32_t y = 0; y < frame->height_px; ++y) {
      if (facts.stored_bits == 12) {
        for (const auto sample :
             std::span(frame->row<std::uint16_t>(y), width)) {
          packer.Add(sample, packed);
        }
      } else {
        data.Write({frame->row<std::byte>(y),
                    width * static_cast<std::size_t>(facts.stored_bits / 8)});
      }
    }
    data.Write(packed);
    packed.clear();
  }
  packer.Finish(packed);
  data.Write(packed);
  facts.frames = feed.count();

  std::filesystem::path header_path = path;
  header_path.replace_extension(options.xml_header ? ".cihx" : ".cih");
  core::OutputFile header(header_path);
  const std::string text =
      options.xml_header ? Cihx(facts, options) : Cih(facts, options);
  header.Write(std::as_bytes(std::span(text)));
  data.Finish();
  header.Finish();
  // The data first: a header whose recording is missing says so when opened.
  data.Commit();
  header.Commit();
  // The other form of header, if there is one, was of the replaced recording.
  std::error_code ignored;
  std::filesystem::remove(
      header_path.replace_extension(options.xml_header ? ".cih" : ".cihx"),
      ignored);
  return facts.frames;
}

}  // namespace touchdown::vision
