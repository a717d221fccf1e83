#include "app/review/routes.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "app/review/page_files.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

using Json = nlohmann::ordered_json;

Reply JsonReply(const Json& json) {
  Reply reply;
  reply.body = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return reply;
}

Reply NothingThere(const std::string& path) {
  return Refusal(404, path + ": there is nothing here");
}

std::string TypeOf(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  return "text/javascript; charset=utf-8";
}

Reply PageReply(const std::string& name) {
  const auto file = PageFile(name);
  if (!file) return NothingThere("/page/" + name);
  Reply reply;
  reply.type = TypeOf(name);
  reply.body = *file;
  return reply;
}

// The part of `path` after `prefix`; nothing where it begins otherwise.
std::optional<std::string> After(const std::string& path,
                                 std::string_view prefix) {
  if (!path.starts_with(prefix)) return std::nullopt;
  return path.substr(prefix.size());
}

Reply PlotReply(Desk& desk, const std::string& number) {
  std::size_t n = 0;
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), n);
  const auto statistics = desk.StatisticsNow();
  if (error != std::errc{} || end != number.data() + number.size() ||
      n >= statistics->plots.size()) {
    return NothingThere("/api/plots/" + number);
  }
  Reply reply;
  reply.type = "image/svg+xml";
  reply.body = statistics->plots[n];
  return reply;
}

Reply Get(Desk& desk, const Request& request) {
  const std::string& path = request.path;
  if (path == "/") return PageReply("index.html");
  if (const auto name = After(path, "/page/")) return PageReply(*name);
  if (path == "/api/stamp") return JsonReply({{"stamp", desk.Stamp()}});
  if (path == "/api/trials") {
    const std::string stamp = desk.Stamp();
    Json json = TrialListJson(desk.Open(db::OpenMode::kRead), desk.triage());
    json["stamp"] = stamp;
    return JsonReply(json);
  }
  if (path == "/api/statistics") {
    Reply reply;
    reply.body = desk.StatisticsNow()->json;
    return reply;
  }
  if (const auto n = After(path, "/api/plots/")) return PlotReply(desk, *n);
  return NothingThere(path);
}

}  // namespace

Reply Route(Desk& desk, const Request& request) {
  try {
    if (request.method == "GET" || request.method == "HEAD") {
      return Get(desk, request);
    }
    return NothingThere(request.path);
  } catch (const nlohmann::json::exception& error) {
    return Refusal(400, fmt::format("the request is no JSON that is "
                                    "understood: {}",
                                    error.what()));
  } catch (const std::invalid_argument& error) {
    return Refusal(400, error.what());
  } catch (const core::InputError& error) {
    return Refusal(422, error.what());
  } catch (const core::StoreError& error) {
    return Refusal(503, error.what());
  } catch (const std::exception& error) {
    return Refusal(500, error.what());
  }
}

}  // namespace touchdown::review
