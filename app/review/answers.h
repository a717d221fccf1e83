// Answers as every route makes them.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

#include "app/review/message.h"

namespace touchdown::review {

// A path, a number or a trial that there is not.
class NotThere : public std::runtime_error {
 public:
  explicit NotThere(const std::string& path)
      : std::runtime_error(path + ": there is nothing here") {}
};

Reply JsonReply(const nlohmann::ordered_json& json);

// A number from 0 on; throws NotThere naming `path` where `text` is none.
std::int64_t NumberIn(const std::string& text, const std::string& path);

}  // namespace touchdown::review
