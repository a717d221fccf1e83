// Answers as every route makes them.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/review/clip_shelf.h"
#include "app/review/message.h"

namespace touchdown::review {

// A path, a number or a trial that there is not.
class NotThere : public std::runtime_error {
 public:
  explicit NotThere(const std::string& path)
      : std::runtime_error(path + ": there is nothing here") {}
};

Reply JsonReply(const nlohmann::ordered_json& json);

// A picture, which stays what it is as long as a person looks at it.
Reply PictureReply(const Picture& picture);

// Size, frames, format and depth of a recording.
nlohmann::ordered_json ClipJson(const vision::ClipInfo& info);

// A number from 0 on; throws NotThere naming `path` where `text` is none.
std::int64_t ParsePathNumber(const std::string& text, const std::string& path);

// The frames FIRST:LAST of ?steady, nothing where it is not asked for; throws
// NotThere where it is something else (ShownRecording::steady).
std::optional<std::pair<std::int64_t, std::int64_t>> AskedSteady(
    const Request& request);

}  // namespace touchdown::review
