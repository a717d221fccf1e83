#include "app/measure/options_hash.h"

#include <fmt/format.h>

#include <cstdint>

namespace touchdown::pipeline {
namespace {

// Hexadecimal, so that no rounding makes two options look the same.
std::string Text(const std::optional<double>& v) {
  return v ? fmt::format("{:a}", *v) : "-";
}
std::string Text(const std::optional<core::Estimate>& e) {
  return e ? fmt::format("{:a}+-{:a}", e->value, e->u) : "-";
}

}  // namespace

std::string OptionsHash(const AnalyzeOptions& o) {
  // Options that came later are appended only where they are set: hashes of
  // stored trials stay what they were.
  std::string text = fmt::format(
      "fps={};scale={};kind={};diameter={};long={};short={};frames={}:{};"
      "region={},{},{},{};angle={};bounce={};",
      Text(o.fps), Text(o.scale_px_per_m),
      o.body_kind ? Name(*o.body_kind) : "auto", Text(o.diameter_m),
      Text(o.long_m), Text(o.short_m), o.first_frame, o.last_frame, o.region.x,
      o.region.y, o.region.width, o.region.height,
      o.angle_kind ? Name(*o.angle_kind) : "default", Text(o.bounce_height_m));
  if (o.ground) {
    text +=
        fmt::format("ground={:a},{:a},{:a},{:a},{:a},{:a}", o.ground->p1.x_px,
                    o.ground->p1.y_px, o.ground->p2.x_px, o.ground->p2.y_px,
                    o.ground->u_offset_px, o.ground->u_angle_rad);
  }
  if (o.contact_frame) text += fmt::format("contact={};", *o.contact_frame);
  if (o.calibration) text += calib::CalibrationText(*o.calibration);
  if (o.crop) text += fmt::format("crop={},{}", o.crop->x_px, o.crop->y_px);
  if (o.gamma) text += fmt::format("gamma={:a};", *o.gamma);
  if (o.stop_early) text += "stop-early;";
  // FNV-1a (Fowler, Noll, Vo): offset basis and prime for 64 bits.
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 1099511628211ull;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace touchdown::pipeline
