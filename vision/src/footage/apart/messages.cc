#include "footage/apart/messages.h"

#include <algorithm>
#include <cmath>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Bytes of a text, and number of warnings: with some of them a message still
// fits a datagram of 32 KiB (socket_pair.cc). Longer texts are cut.
constexpr std::size_t kMaxText = 8000;
constexpr std::uint32_t kMaxWarnings = 16;

// A reader works on hostile files and may be taken over: what it says is
// checked like a file.
[[noreturn]] void Refuse() {
  throw core::InputError("the reader's answer is not understood");
}

template <class T>
void PutMaybe(Packed& to, const std::optional<T>& value) {
  to.Put<std::uint8_t>(value.has_value());
  if (value) to.Put(*value);
}

template <class T>
std::optional<T> GetMaybe(Packed& from) {
  if (!from.GetFlag()) return std::nullopt;
  return from.Get<T>();
}

}  // namespace

void Packed::PutText(std::string_view text) {
  text = text.substr(0, kMaxText);
  Put(static_cast<std::uint32_t>(text.size()));
  bytes_.append(text);
}

// Throws where the message is shorter than what is asked of it.
const char* Packed::Need(std::size_t bytes) {
  if (bytes > bytes_.size() - at_) Refuse();
  const char* const here = bytes_.data() + at_;
  at_ += bytes;
  return here;
}

std::string Packed::GetText() {
  const auto size = Get<std::uint32_t>();
  return {Need(size), size};
}

void PutOptions(Packed& to, const ClipOptions& options) {
  to.Put(options.channel);
  PutMaybe(to, options.fps);
  to.Put(options.decoder_threads);
}

ClipOptions GetOptions(Packed& from) {
  ClipOptions options;
  options.channel = from.Get<Channel>();
  options.fps = GetMaybe<double>(from);
  options.decoder_threads = from.Get<std::int32_t>();
  return options;
}

void PutInfo(Packed& to, const ClipInfo& info) {
  to.PutText(info.format);
  to.Put(info.width_px);
  to.Put(info.height_px);
  to.Put(info.bit_depth);
  to.Put<std::uint8_t>(info.is_predicted);
  to.Put<std::uint8_t>(info.gamma_is_known);
  to.Put<std::uint8_t>(info.has_colour);
  to.Put(info.frames);
  to.Put(info.first_camera_frame);
  PutMaybe(to, info.sensor_origin);
  to.Put(info.time_base.fps);
  to.Put(info.time_base.source);
  to.Put<std::uint8_t>(info.time_base.uniform);
  to.Put<std::uint8_t>(info.time_base.trusted);
  const auto warnings =
      std::min<std::size_t>(kMaxWarnings, info.warnings.size());
  to.Put(static_cast<std::uint32_t>(warnings));
  for (std::size_t i = 0; i < warnings; ++i) {
    to.PutText(
        std::string_view(info.warnings[i]).substr(0, kMaxText / kMaxWarnings));
  }
}

ClipInfo GetInfo(Packed& from) {
  ClipInfo info;
  info.format = from.GetText();
  info.width_px = from.Get<std::int32_t>();
  info.height_px = from.Get<std::int32_t>();
  info.bit_depth = from.Get<std::int32_t>();
  info.is_predicted = from.GetFlag();
  info.gamma_is_known = from.GetFlag();
  info.has_colour = from.GetFlag();
  info.frames = from.Get<std::int64_t>();
  info.first_camera_frame = from.Get<std::int64_t>();
  info.sensor_origin = GetMaybe<SensorOrigin>(from);
  info.time_base.fps = from.Get<double>();
  info.time_base.source = from.Get<FpsSource>();
  info.time_base.uniform = from.GetFlag();
  info.time_base.trusted = from.GetFlag();
  const auto warnings = from.Get<std::uint32_t>();
  if (warnings > kMaxWarnings) Refuse();
  for (std::uint32_t i = 0; i < warnings; ++i) {
    info.warnings.push_back(from.GetText());
  }
  // Facts that the program computes with are checked here, once.
  const auto is_side = [](std::int32_t side_px) {
    return side_px >= 1 && side_px <= kMostSide_px;
  };
  if (!is_side(info.width_px) || !is_side(info.height_px) ||
      info.bit_depth < 1 || info.bit_depth > 16 || info.frames < 1 ||
      !std::isfinite(info.time_base.fps) || info.time_base.fps <= 0.0 ||
      static_cast<int>(info.time_base.source) < 0 ||
      info.time_base.source > FpsSource::kUser) {
    Refuse();
  }
  return info;
}

}  // namespace touchdown::vision
