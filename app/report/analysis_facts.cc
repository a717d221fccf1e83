#include "app/report/analysis_facts.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "app/report/format.h"

namespace touchdown::report {
namespace {

using Json = nlohmann::json;

// The document is what some version once wrote: nothing in it is relied on.
const Json& At(const Json& json, std::initializer_list<const char*> path) {
  static const Json none;
  const Json* at = &json;
  for (const char* name : path) {
    if (!at->is_object()) return none;
    const auto found = at->find(name);
    if (found == at->end()) return none;
    at = &*found;
  }
  return *at;
}

std::string Text(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_integer()) {
    return fmt::format("{}", json.get<std::int64_t>());
  }
  return json.is_number() ? fmt::format("{:.6g}", json.get<double>()) : "";
}

std::string Estimate(const Json& json, const char* unit) {
  const Json& value = At(json, {"value"});
  const Json& u = At(json, {"u"});
  if (!value.is_number() || !u.is_number()) return "";
  return WithU({value.get<double>(), u.get<double>(), {}}, 1.0) + " " + unit;
}

std::string Joined(std::initializer_list<std::string> parts) {
  std::string out;
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    out += (out.empty() ? "" : ", ") + part;
  }
  return out;
}

std::string With(const char* before, const std::string& text,
                 const char* after = "") {
  return text.empty() ? "" : before + text + after;
}

std::optional<Json> Document(const core::Trial& trial) {
  if (trial.document_json.empty()) return std::nullopt;
  Json json = Json::parse(trial.document_json, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

std::string FramesPerSecond(const Json& json) {
  const Json& base = At(json, {"clip", "time_base"});
  const Json& fps = At(base, {"fps"});
  if (!fps.is_number()) return "";
  const std::string source = Text(At(base, {"source"}));
  return fmt::format("{:g} frames/s, from the {}", fps.get<double>(),
                     source.empty() ? "file" : source);
}

std::string Calibration(const Json& json) {
  const Json& calibration = At(json, {"calibration"});
  if (calibration.is_object()) {
    const std::string rms = Text(At(calibration, {"lens_rms_px"}));
    return Joined({With("camera ", Text(At(calibration, {"camera"}))),
                   With("of ", Text(At(calibration, {"date"}))),
                   rms.empty() ? "no lens" : "lens to " + rms + " px rms"});
  }
  return At(json, {"clip"}).is_object() ? "none" : "";
}

std::string List(const Json& json) {
  std::string out;
  if (json.is_array()) {
    for (const Json& item : json)
      out += With(out.empty() ? "" : "; ", Text(item));
  } else if (json.is_object()) {
    for (const auto& [name, why] : json.items()) {
      out += (out.empty() ? "" : "; ") + name + " (" + Text(why) + ")";
    }
  }
  return out;
}

}  // namespace

std::vector<NameValue> AnalysisSources(const core::Trial& trial) {
  const auto json = Document(trial);
  if (!json) return {};
  return {{"scale from", Text(At(*json, {"scale", "source"}))},
          {"ground line from", Text(At(*json, {"ground", "source"}))},
          {"calibration", Calibration(*json)},
          {"time base", FramesPerSecond(*json)}};
}

std::vector<NameValue> AnalysisFacts(const core::Trial& trial) {
  const auto json = Document(trial);
  if (!json) return {};
  const Json& clip = At(*json, {"clip"});
  const std::string width = Text(At(clip, {"width_px"}));
  const Json& scale = At(*json, {"scale"});
  const Json& ground = At(*json, {"ground"});
  return {
      {"recording",
       Joined({Text(At(clip, {"format"})),
               width.empty() ? ""
                             : fmt::format("{} x {} px", width,
                                           Text(At(clip, {"height_px"}))),
               With("", Text(At(clip, {"bit_depth"})), " bit"),
               With("", Text(At(clip, {"frames"})), " frames")})},
      {"time base", FramesPerSecond(*json)},
      {"scale", Joined({Estimate(At(scale, {"px_per_m"}), "px/m"),
                        With("from ", Text(At(scale, {"source"})))})},
      {"calibration", Calibration(*json)},
      {"ground line", Joined({With("from ", Text(At(ground, {"source"}))),
                              With("u of its angle ",
                                   Text(At(ground, {"u_angle_deg"})), " deg"),
                              With("u of its height ",
                                   Text(At(ground, {"u_offset_px"})), " px")})},
      {"model of the scene", List(At(*json, {"scene_model", "used"}))},
      {"left out of it", List(At(*json, {"scene_model", "left_out"}))},
      {"warnings", List(At(*json, {"warnings"}))}};
}

const core::Budget& AngleBudget(const core::Trial& trial) {
  const core::Contact& contact = trial.first.contact;
  return trial.angle_kind == core::AngleKind::kApproach
             ? contact.approach_budget
             : contact.attitude_budget;
}

}  // namespace touchdown::report
