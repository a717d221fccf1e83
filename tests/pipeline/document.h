// The document of DESIGN.md section 4, checked for shape whatever was found.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "app/documents/analysis_json.h"
#include "app/documents/analysis_text.h"
#include "app/measure/analyze.h"

namespace touchdown::pipeline::filmed {

using nlohmann::json;

using Visit = std::function<void(const std::string&, const json&)>;
inline void Walk(const json& value, const std::string& path,
                 const Visit& visit) {
  visit(path, value);
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      Walk(child, path.empty() ? key : path + "." + key, visit);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      Walk(value[i], path + "[" + std::to_string(i) + "]", visit);
    }
  }
}

// Every key is there;
// null where absent, with its reason under "absent", and nothing else there.
inline json ExpectDocument(const Analysis& analysis) {
  json document;
  try {
    document = json::parse(ToJson(analysis));
  } catch (const json::exception& error) {
    ADD_FAILURE() << error.what();
    return document;
  }
  EXPECT_EQ(document["schema"], "touchdown.analysis/1");
  const char* const keys[] = {"/clip/path",
                              "/clip/id",
                              "/clip/sha256",
                              "/clip/format",
                              "/clip/width_px",
                              "/clip/height_px",
                              "/clip/bit_depth",
                              "/clip/frames",
                              "/clip/first_camera_frame",
                              "/clip/time_base/fps",
                              "/clip/time_base/source",
                              "/clip/time_base/uniform",
                              "/clip/time_base/trusted",
                              "/scale",
                              "/ground",
                              "/body",
                              "/contact/found",
                              "/contact/time_s",
                              "/contact/frame",
                              "/contact/angle_kind",
                              "/contact/angle_deg",
                              "/contact/approach_angle_deg",
                              "/contact/radius_angle_deg",
                              "/contact/face_angle_deg",
                              "/contact/corner",
                              "/contact/duration_s",
                              "/contact/budget",
                              "/state/label",
                              "/state/p_bounce",
                              "/state/reason",
                              "/state/max_gap_mm",
                              "/state/bounce_height_mm",
                              "/state/detectable_gap_mm",
                              "/state/extrapolated_gap_mm",
                              "/state/micro_bounce",
                              "/later_contacts",
                              "/motion/before/speed_mps",
                              "/motion/before/normal_mps",
                              "/motion/before/tangential_mps",
                              "/motion/before/omega_rad_per_s",
                              "/motion/after/normal_mps",
                              "/motion/after/tangential_mps",
                              "/motion/after/omega_rad_per_s",
                              "/motion/restitution",
                              "/motion/centre_rebound_ratio",
                              "/motion/impulse_ratio",
                              "/motion/gravity_check_mps2",
                              "/scene_model/used",
                              "/scene_model/left_out",
                              "/warnings",
                              "/timing_s/total",
                              "/timing_s/decode",
                              "/timing_s/track",
                              "/timing_s/digest",
                              "/absent",
                              "/software/version",
                              "/software/options_hash"};
  for (const char* key : keys) {
    EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
  }
  if (document["scale"].is_object()) {
    for (const char* key :
         {"/scale/px_per_m/value", "/scale/px_per_m/u", "/scale/source"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  if (document["ground"].is_object()) {
    for (const char* key :
         {"/ground/x1_px", "/ground/y1_px", "/ground/x2_px", "/ground/y2_px",
          "/ground/u_angle_deg", "/ground/source"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  if (document["body"].is_object()) {
    for (const char* key : {"/body/kind", "/body/diameter_mm", "/body/long_mm",
                            "/body/short_mm"}) {
      EXPECT_TRUE(document.contains(json::json_pointer(key))) << key;
    }
  }
  std::set<std::string> nulls;
  Walk(document, "", [&](const std::string& path, const json& value) {
    if (path.rfind("absent", 0) == 0) return;
    if (value.is_null()) {
      nulls.insert(path);
      EXPECT_TRUE(document["absent"].contains(path))
          << path << " is null without a reason";
    }
    if (value.is_number()) {
      EXPECT_TRUE(std::isfinite(value.get<double>()));
    }
    // A measured number has its uncertainty.
    if (value.is_object() && value.contains("value")) {
      EXPECT_TRUE(value["value"].is_number()) << path;
      EXPECT_TRUE(value["u"].is_number()) << path;
      EXPECT_GE(value["u"].get<double>(), 0.0) << path;
    }
  });
  for (const auto& [path, reason] : document["absent"].items()) {
    EXPECT_TRUE(nulls.contains(path)) << path << " is said to be absent";
    EXPECT_FALSE(reason.get<std::string>().empty()) << path;
  }
  return document;
}

}  // namespace touchdown::pipeline::filmed
