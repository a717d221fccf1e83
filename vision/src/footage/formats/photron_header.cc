#include "footage/formats/photron_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>

#include "footage/formats/clip_formats.h"
#include "footage/formats/mapped_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Bytes: real headers are 8 to 20 kB; a preview picture in a .cihx may add to
// that. Frames and frame numbers beyond any recording, with which no product
// overflows.
constexpr std::int64_t kMaxHeaderBytes = 64 << 20;
constexpr std::int64_t kMaxFrames = std::int64_t{1} << 40;
constexpr std::int64_t kMaxFrameNumber = std::int64_t{1} << 60;

// Without blanks at both ends.
std::string_view Trim(std::string_view text) {
  // In any locale.
  constexpr std::string_view kBlank = " \t\r\n";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

// What stands in a message for a value of unknown origin: short and printable.
std::string Printable(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) {
    shown += c >= ' ' && c <= '~' ? c : '?';
  }
  if (text.size() > 40) shown += "...";
  return shown;
}

// Where the two forms differ: how an entry is named and found.
struct Entries {
  std::string file;
  std::function<std::optional<std::string_view>(std::string_view)> find;

  [[noreturn]] void Refuse(std::string_view entry, std::string_view value,
                           std::string_view expected) const {
    throw core::InputError(fmt::format("{}: '{}' is '{}', expected {}", file,
                                       entry, Printable(value), expected));
  }

  std::string_view Text(std::string_view entry) const {
    const auto value = find(entry);
    if (!value) {
      throw core::InputError(fmt::format(
          "{}: '{}' is missing; is it the camera's own header?", file, entry));
    }
    return Trim(*value);
  }

  std::int64_t Integer(std::string_view entry, std::int64_t low,
                       std::int64_t high) const {
    const std::string_view text = Text(entry);
    std::int64_t value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() ||
        value < low || value > high) {
      Refuse(entry, text, fmt::format("a whole number in {} .. {}", low, high));
    }
    return value;
  }

  double Positive(std::string_view entry) const {
    const std::string_view text = Text(entry);
    double value = 0.0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(value) || value <= 0.0) {
      Refuse(entry, text, "a positive number");
    }
    return value;
  }
};

// The entries' names in one of the two forms.
struct Names {
  std::string_view width, height, frames, start, step, rate, bits, depth, side,
      type, format;
};
// Lines of a .cih.
constexpr Names kCih = {
    "Image Width", "Image Height",       "Total Frame",
    "Start Frame", "Save Step",          "Record Rate(fps)",
    "Color Bit",   "EffectiveBit Depth", "EffectiveBit Side",
    "Color Type",  "File Format"};
// Paths of elements in the XML of a .cihx.
constexpr Names kCihx = {"imageDataInfo/resolution/width",
                         "imageDataInfo/resolution/height",
                         "frameInfo/totalFrame",
                         "frameInfo/startFrame",
                         "frameInfo/skipFrame",
                         "recordInfo/recordRate",
                         "imageDataInfo/colorInfo/bit",
                         "imageDataInfo/effectiveBit/depth",
                         "imageDataInfo/effectiveBit/side",
                         "imageDataInfo/colorInfo/type",
                         "imageFileInfo/fileFormat"};

// The same entries with the same ranges, from either form of header.
PhotronHeader Interpret(const Entries& entries, const Names& names) {
  PhotronHeader header;
  if (const auto format = entries.find(names.format);
      format && !EqualIgnoringCase(Trim(*format), "mraw")) {
    entries.Refuse(names.format, Trim(*format), "MRaw");
  }
  if (const auto type = entries.find(names.type)) {
    // "Raw" is what a monochrome head writes too.
    const std::string_view kind = Trim(*type);
    if (!EqualIgnoringCase(kind, "mono") && !EqualIgnoringCase(kind, "raw")) {
      entries.Refuse(names.type, kind, "Mono or Raw (colour is not read)");
    }
  }
  header.width_px =
      static_cast<std::int32_t>(entries.Integer(names.width, 1, kMaxSidePx));
  header.height_px =
      static_cast<std::int32_t>(entries.Integer(names.height, 1, kMaxSidePx));
  header.frames = entries.Integer(names.frames, 1, kMaxFrames);
  header.record_rate_hz = entries.Positive(names.rate);
  header.stored_bits =
      static_cast<std::int32_t>(entries.Integer(names.bits, 1, 64));
  if (header.stored_bits != 8 && header.stored_bits != 12 &&
      header.stored_bits != 16) {
    entries.Refuse(names.bits, std::to_string(header.stored_bits),
                   "8, 12 or 16");
  }
  if (entries.find(names.start)) {
    header.start_frame =
        entries.Integer(names.start, -kMaxFrameNumber, kMaxFrameNumber);
  }
  if (entries.find(names.step)) {
    header.save_step = entries.Integer(names.step, 0, kMaxFrames);
  }
  header.effective_bits = header.stored_bits;
  if (entries.find(names.depth)) {
    header.effective_bits =
        static_cast<std::int32_t>(entries.Integer(names.depth, 1, 16));
  }
  if (const auto side = entries.find(names.side)) {
    const std::string_view word = Trim(*side);
    header.effective_higher = EqualIgnoringCase(word, "higher");
    if (!header.effective_higher && !EqualIgnoringCase(word, "lower")) {
      entries.Refuse(names.side, word, "Lower or Higher");
    }
  }
  return header;
}

// --- a strict little of XML: elements and their text, nothing else ----------

// The content of the child element `name` of `parent` (the text between the
// tags of an element), or nothing. Linear in the length of `parent`.
std::optional<std::string_view> Child(std::string_view parent,
                                      std::string_view name) {
  int depth = 0;
  bool inside = false;  // the wanted child
  std::size_t content = 0;
  std::size_t at = 0;
  while ((at = parent.find('<', at)) != std::string_view::npos) {
    const std::size_t end = parent.find('>', at);
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view tag = parent.substr(at + 1, end - at - 1);
    if (tag.starts_with('/')) {
      --depth;
      if (depth < 0) return std::nullopt;
      if (depth == 0 && inside) return parent.substr(content, at - content);
    } else if (!tag.starts_with('?') && !tag.starts_with('!') &&
               !tag.ends_with('/')) {
      if (depth == 0 && tag.substr(0, tag.find_first_of(" \t\r\n")) == name) {
        inside = true;
        content = end + 1;
      }
      ++depth;
    }
    at = end + 1;
  }
  return std::nullopt;
}

// The element at a path of names, separated by slashes.
std::optional<std::string_view> Find(std::string_view root,
                                     std::string_view names) {
  std::optional<std::string_view> element = root;
  while (element && !names.empty()) {
    const std::size_t slash = std::min(names.find('/'), names.size());
    element = Child(*element, names.substr(0, slash));
    names.remove_prefix(std::min(slash + 1, names.size()));
  }
  return element;
}

}  // namespace

PhotronHeader ParseCih(std::string_view text, const std::string& name) {
  const auto find =
      [text](std::string_view entry) -> std::optional<std::string_view> {
    std::string_view rest = text;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      const std::size_t colon = line.find(':');
      if (colon != std::string_view::npos &&
          Trim(line.substr(0, colon)) == entry) {
        return line.substr(colon + 1);
      }
    }
    return std::nullopt;
  };
  return Interpret({name, find}, kCih);
}

PhotronHeader ParseCihx(std::string_view bytes, const std::string& name) {
  const std::size_t begin = bytes.find("<cih>");
  const std::size_t end = bytes.rfind("</cih>");
  if (begin == std::string_view::npos || end == std::string_view::npos ||
      end < begin + 5) {
    throw core::InputError(fmt::format(
        "{}: no <cih> ... </cih> in it; is it the camera's own header?", name));
  }
  const std::string_view root = bytes.substr(begin + 5, end - begin - 5);
  const Entries entries{
      name, [root](std::string_view entry) { return Find(root, entry); }};
  PhotronHeader header = Interpret(entries, kCihx);
  // Where the picture lies on the sensor; newer cameras write it.
  constexpr std::string_view kSensorX = "imageDataInfo/segmentPos/sensorXpos";
  constexpr std::string_view kSensorY = "imageDataInfo/segmentPos/sensorYpos";
  if (entries.find(kSensorX) && entries.find(kSensorY)) {
    header.sensor_origin = {
        static_cast<std::int32_t>(entries.Integer(kSensorX, 0, kMaxSidePx)),
        static_cast<std::int32_t>(entries.Integer(kSensorY, 0, kMaxSidePx))};
  }
  return header;
}

PhotronHeader ReadPhotronHeader(const std::filesystem::path& path) {
  const MappedFile file(path);
  if (file.size_bytes() > kMaxHeaderBytes) {
    throw core::InputError(
        fmt::format("{}: {} bytes are too many for a header, expected at most "
                    "{}",
                    path.string(), file.size_bytes(), kMaxHeaderBytes));
  }
  const std::string_view bytes(reinterpret_cast<const char*>(file.data()),
                               static_cast<std::size_t>(file.size_bytes()));
  PhotronHeader header = LowerExtension(path) == ".cihx"
                             ? ParseCihx(bytes, path.string())
                             : ParseCih(bytes, path.string());
  file.RequireWhole();
  return header;
}

}  // namespace touchdown::vision
