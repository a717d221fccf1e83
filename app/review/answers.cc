#include "app/review/answers.h"

#include <nlohmann/json.hpp>

#include "app/text/parse_number.h"

namespace touchdown::review {

Reply JsonReply(const nlohmann::ordered_json& json) {
  Reply reply;
  // Names of files need not be UTF-8; such bytes are replaced.
  reply.body = json.dump(-1, ' ', false,
                         nlohmann::ordered_json::error_handler_t::replace);
  return reply;
}

Reply PictureReply(const Picture& picture) {
  Reply reply;
  reply.type = picture.type;
  reply.body = *picture.bytes;
  // This browser alone may keep it for ten minutes: stepping to and fro asks
  // for each frame once.
  reply.headers = {{"Cache-Control", "private, max-age=600"}};
  return reply;
}

nlohmann::ordered_json ClipJson(const vision::ClipInfo& info) {
  return {{"width_px", info.width_px},
          {"height_px", info.height_px},
          {"frames", info.frames},
          {"format", info.format},
          {"bit_depth", info.bit_depth}};
}

std::int64_t ParsePathNumber(const std::string& text, const std::string& path) {
  const auto n = report::ParseNumber<std::int64_t>(text);
  // A path that holds no number leads nowhere: 404, not 400.
  if (!n || *n < 0) throw NotThere(path);
  return *n;
}

std::optional<std::pair<std::int64_t, std::int64_t>> AskedSteady(
    const Request& request) {
  const auto found = request.query.find("steady");
  if (found == request.query.end()) return std::nullopt;
  const std::string& text = found->second;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw NotThere(request.path);
  return std::pair(ParsePathNumber(text.substr(0, colon), request.path),
                   ParsePathNumber(text.substr(colon + 1), request.path));
}

}  // namespace touchdown::review
