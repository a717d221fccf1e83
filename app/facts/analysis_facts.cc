#include "app/facts/analysis_facts.h"

#include <fmt/core.h>

#include "app/facts/stored_document.h"
#include "app/text/format.h"

namespace touchdown::report {
namespace {

// A text, a whole number or a number to six digits as it is printed; empty
// where `json` is something else or null.
std::string ScalarText(const nlohmann::json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_integer()) {
    return fmt::format("{}", json.get<std::int64_t>());
  }
  return json.is_number() ? fmt::format("{:.6g}", json.get<double>()) : "";
}

// "1000.0 ± 0.8 px/m" of a {"value", "u"} of the document, which is in `unit`
// already; empty where one of the two is missing.
std::string EstimateText(const nlohmann::json& json, const char* unit) {
  const nlohmann::json& value = FindValue(json, {"value"});
  const nlohmann::json& u = FindValue(json, {"u"});
  if (!value.is_number() || !u.is_number()) return "";
  return WithU({value.get<double>(), u.get<double>(), {}}, 1.0) + " " + unit;
}

// The parts that say something, with commas between them.
std::string Joined(std::initializer_list<std::string> parts) {
  std::string out;
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    out += (out.empty() ? "" : ", ") + part;
  }
  return out;
}

// `text` between two pieces of a sentence, or nothing at all: "from " without a
// source would end in the air.
std::string Enclose(const char* before, const std::string& text,
                    const char* after = "") {
  return text.empty() ? "" : before + text + after;
}

// "2000 frames/s, from the header"; empty where the document has no frame rate.
std::string FramesPerSecond(const nlohmann::json& json) {
  const nlohmann::json& base = FindValue(json, {"clip", "time_base"});
  const nlohmann::json& fps = FindValue(base, {"fps"});
  if (!fps.is_number()) return "";
  const std::string source = ScalarText(FindValue(base, {"source"}));
  return fmt::format("{:g} frames/s, from the {}", fps.get<double>(),
                     source.empty() ? "file" : source);
}

// "camera south, of 2026-08-01, lens to 0.12 px rms" of the calibration that
// the analysis took; "none" where a clip was analysed without one, and empty
// where the document says nothing of a clip either.
std::string CalibrationText(const nlohmann::json& json) {
  const nlohmann::json& calibration = FindValue(json, {"calibration"});
  if (calibration.is_object()) {
    const std::string rms = ScalarText(FindValue(calibration, {"lens_rms_px"}));
    return Joined(
        {Enclose("camera ", ScalarText(FindValue(calibration, {"camera"}))),
         Enclose("of ", ScalarText(FindValue(calibration, {"date"}))),
         rms.empty() ? "no lens" : "lens to " + rms + " px rms"});
  }
  return FindValue(json, {"clip"}).is_object() ? "none" : "";
}

// The items of a list with semicolons between them. Of an object, as
// scene_model.left_out is one, each name with its reason: "spin (not
// measured)".
std::string ListText(const nlohmann::json& json) {
  std::string out;
  if (json.is_array()) {
    for (const nlohmann::json& item : json) {
      out += Enclose(out.empty() ? "" : "; ", ScalarText(item));
    }
  } else if (json.is_object()) {
    for (const auto& [name, why] : json.items()) {
      out += (out.empty() ? "" : "; ") + name + " (" + ScalarText(why) + ")";
    }
  }
  return out;
}

}  // namespace

// All four are texts that repeat over the trials of a set-up, so that they can
// be counted; numbers that differ from clip to clip are left to
// AnalysisFacts().
std::vector<NameValue> AnalysisSources(const core::Trial& trial) {
  const auto json = StoredDocument(trial);
  if (json.is_null()) return {};
  return {
      {"scale from", ScalarText(FindValue(json, {"scale", "source"}))},
      {"ground line from", ScalarText(FindValue(json, {"ground", "source"}))},
      {"calibration", CalibrationText(json)},
      {"time base", FramesPerSecond(json)}};
}

std::vector<NameValue> AnalysisFacts(const core::Trial& trial) {
  const auto json = StoredDocument(trial);
  if (json.is_null()) return {};
  const nlohmann::json& clip = FindValue(json, {"clip"});
  // The sides of the picture stand together or not at all.
  const std::string width = ScalarText(FindValue(clip, {"width_px"}));
  const nlohmann::json& scale = FindValue(json, {"scale"});
  const nlohmann::json& ground = FindValue(json, {"ground"});
  return {
      {"recording",
       Joined(
           {ScalarText(FindValue(clip, {"format"})),
            width.empty()
                ? ""
                : fmt::format("{} x {} px", width,
                              ScalarText(FindValue(clip, {"height_px"}))),
            Enclose("", ScalarText(FindValue(clip, {"bit_depth"})), " bit"),
            Enclose("", ScalarText(FindValue(clip, {"frames"})), " frames")})},
      {"time base", FramesPerSecond(json)},
      {"scale",
       Joined({EstimateText(FindValue(scale, {"px_per_m"}), "px/m"),
               Enclose("from ", ScalarText(FindValue(scale, {"source"})))})},
      {"calibration", CalibrationText(json)},
      {"ground line",
       Joined(
           {Enclose("from ", ScalarText(FindValue(ground, {"source"}))),
            Enclose("u of its angle ",
                    ScalarText(FindValue(ground, {"u_angle_deg"})), " deg"),
            Enclose("u of its height ",
                    ScalarText(FindValue(ground, {"u_offset_px"})), " px")})},
      {"model of the scene",
       ListText(FindValue(json, {"scene_model", "used"}))},
      {"left out of it",
       ListText(FindValue(json, {"scene_model", "left_out"}))},
      {"warnings", ListText(FindValue(json, {"warnings"}))}};
}

const core::Budget& AngleBudget(const core::Trial& trial) {
  // Radius and face angle are both attitudes of the body and share one budget.
  const core::Contact& contact = trial.first.contact;
  return trial.angle_kind == core::AngleKind::kApproach
             ? contact.approach_budget
             : contact.attitude_budget;
}

}  // namespace touchdown::report
