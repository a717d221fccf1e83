// A request and its answer, apart from the protocol that carries them: what is
// decided about them can be called and tested without a socket.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace touchdown::review {

struct Request {
  std::string method = "GET";
  std::string path = "/";
  std::map<std::string, std::string> query = {};
  std::string body = {};

  // Header fields; empty where absent.
  std::string host = {};
  std::string origin = {};
  std::string fetch_site = {};  // Sec-Fetch-Site
  std::string cookie = {};
  std::string token = {};  // X-Touchdown-Token
  std::string content_type = {};
  std::string if_none_match = {};
};

struct Reply {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
  std::vector<std::pair<std::string, std::string>> headers = {};
};

// Trouble as the page shows it: {"error": what}.
Reply Refusal(int status, const std::string& what);

}  // namespace touchdown::review
