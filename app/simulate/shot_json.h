// The JSON of a shot (schema touchdown.scene/1) and of a body, shared by the
// scene file and the truth file.
#pragma once

#include <nlohmann/json.hpp>

#include "app/simulate/simulate.h"

namespace touchdown::pipeline {

nlohmann::ordered_json BodyJson(const core::Body& body);
nlohmann::ordered_json SceneJson(const Shot& shot);

}  // namespace touchdown::pipeline
