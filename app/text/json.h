// The JSON of the documents that we write: its fields keep their order.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace touchdown::report {

using Json = nlohmann::ordered_json;

}  // namespace touchdown::report
