#include "app/documents/options_json.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <tuple>
#include <type_traits>

#include "app/documents/named_word.h"
#include "app/text/json_fields.h"
#include "app/text/whole_number.h"

namespace touchdown::pipeline {
namespace {

using report::Json;

// --- the value of an option, there ------------------------------------------

Json ValueJson(double value) { return value; }
Json ValueJson(bool value) { return value; }
Json ValueJson(std::int64_t value) { return value; }
Json ValueJson(const core::Estimate& value) {
  return report::EstimateJson(value);
}
Json ValueJson(core::BodyKind value) { return core::Name(value); }
Json ValueJson(core::AngleKind value) { return core::Name(value); }
Json ValueJson(const calib::GroundLine& value) { return GroundLineJson(value); }
Json ValueJson(const calib::Calibration& value) {
  return Json::parse(calib::CalibrationText(value));
}
Json ValueJson(const calib::SensorCorner& value) {
  return {value.x_px, value.y_px};
}
Json ValueJson(const core::PixelRect& value) {
  return {value.x, value.y, value.width, value.height};
}
Json ValueJson(
    const std::tuple<const std::int64_t&, const std::int64_t&>& value) {
  return {std::get<0>(value), std::get<1>(value)};
}

// --- and back ----------------------------------------------------------------

void Read(const Json& json, const char*, double& value) { json.get_to(value); }
void Read(const Json& json, const char*, bool& value) { json.get_to(value); }
void Read(const Json& json, const char* name, std::int64_t& value) {
  value = WholeNumber(json, name);
}
void Read(const Json& json, const char*, core::Estimate& value) {
  value = report::ReadEstimate(json);
}
void Read(const Json& json, const char*, core::BodyKind& value) {
  using enum core::BodyKind;
  value = ReadNamed(json, {kSphere, kRectangle});
}
void Read(const Json& json, const char*, core::AngleKind& value) {
  using enum core::AngleKind;
  value = ReadNamed(json, {kApproach, kRadius, kFace});
}
void Read(const Json& json, const char*, calib::GroundLine& value) {
  value = ReadGroundLine(json);
}
void Read(const Json& json, const char*, calib::Calibration& value) {
  value =
      calib::ParseCalibration(json.dump(), "the calibration of the analysis");
}
void Read(const Json& json, const char* name, calib::SensorCorner& value) {
  value = {WholeNumber<std::int32_t>(json.at(0), name),
           WholeNumber<std::int32_t>(json.at(1), name)};
}
void Read(const Json& json, const char* name, core::PixelRect& value) {
  value = {WholeNumber<std::int32_t>(json.at(0), name),
           WholeNumber<std::int32_t>(json.at(1), name),
           WholeNumber<std::int32_t>(json.at(2), name),
           WholeNumber<std::int32_t>(json.at(3), name)};
}
void Read(const Json& json, const char* name,
          const std::tuple<std::int64_t&, std::int64_t&>& value) {
  std::get<0>(value) = WholeNumber(json.at(0), name);
  std::get<1>(value) = WholeNumber(json.at(1), name);
}

core::PixelPoint ReadPoint(const Json& json) {
  return {json.at(0), json.at(1)};
}

}  // namespace

Json GroundLineJson(const calib::GroundLine& g) {
  return {{"p1_px", {g.p1.x_px, g.p1.y_px}},
          {"p2_px", {g.p2.x_px, g.p2.y_px}},
          {"reference_px", {g.reference.x_px, g.reference.y_px}},
          {"u_offset_px", g.u_offset_px},
          {"u_angle_rad", g.u_angle_rad},
          {"source", calib::Name(g.source)}};
}

calib::GroundLine ReadGroundLine(const Json& json) {
  using enum calib::GroundSource;
  calib::GroundLine g;
  g.p1 = ReadPoint(json.at("p1_px"));
  g.p2 = ReadPoint(json.at("p2_px"));
  g.reference = ReadPoint(json.at("reference_px"));
  g.u_offset_px = json.at("u_offset_px");
  g.u_angle_rad = json.at("u_angle_rad");
  g.source = ReadNamed(json.at("source"),
                       {kUser, kCalibration, kDetected, kContactPoints});
  return g;
}

Json OptionsJson(const AnalyzeOptions& options) {
  Json json = Json::object();
  VisitOptions(options, [&json]<class T>(const char* name, const T& value,
                                         OptionScope /*scope*/) {
    if constexpr (std::is_same_v<T, bool>) {
      if (value) json[name] = true;
    } else if constexpr (requires { value.has_value(); }) {
      if (value) json[name] = ValueJson(*value);
    } else {
      json[name] = ValueJson(value);
    }
  });
  return json;
}

AnalyzeOptions ReadOptions(const Json& json, std::optional<OptionScope> only) {
  AnalyzeOptions options;
  VisitOptions(options,
               [&]<class T>(const char* name, T&& value, OptionScope scope) {
                 if (only && scope != *only) return;
                 using Value = std::remove_cvref_t<T>;
                 if constexpr (requires { value.has_value(); }) {
                   if (!json.contains(name) || json.at(name).is_null()) return;
                   Read(json.at(name), name, value.emplace());
                 } else if constexpr (std::is_same_v<Value, bool>) {
                   if (json.contains(name)) Read(json.at(name), name, value);
                 } else {
                   Read(json.at(name), name, value);
                 }
               });
  return options;
}

}  // namespace touchdown::pipeline
