#include "app/review/guard.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

namespace touchdown::review {

Reply Refusal(int status, const std::string& what) {
  Reply reply;
  reply.status = status;
  // A message may hold bytes of a file's name that are no UTF-8.
  reply.body = nlohmann::json{{"error", what}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
  return reply;
}

const std::vector<std::pair<std::string, std::string>>& SafeHeaders() {
  // Scripts, styles and pictures come from this server alone; nothing inline
  // runs, so that a name with markup in it does nothing.
  static const std::vector<std::pair<std::string, std::string>> kHeaders = {
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src "
       "'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
       "frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"}};
  return kHeaders;
}

namespace {

// Asks for the key in a page that loads nothing; its form may send it here
// alone.
Reply KeyPage(std::string_view what) {
  Reply reply;
  reply.status = 403;
  reply.type = "text/html; charset=utf-8";
  reply.body = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><title>touchdown review</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<h1>touchdown review</h1>\n<p>{}</p>\n"
      "<form action=\"/\"><label>The address that <code>touchdown "
      "review</code> printed last <input name=\"token\" size=\"60\" "
      "autofocus></label> <button>Open the page</button></form></html>\n",
      what);
  reply.headers = {{"Content-Security-Policy",
                    "default-src 'none'; base-uri 'none'; form-action 'self'; "
                    "frame-ancestors 'none'"}};
  return reply;
}

// The key in an address that holds it, or the key itself.
// A person may paste the whole printed address into the field.
std::string ExtractKey(std::string_view text) {
  constexpr std::string_view kName = "token=";
  const std::size_t at = text.rfind(kName);
  if (at != std::string_view::npos) text.remove_prefix(at + kName.size());
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

}  // namespace

// A Cookie header is "name=value; name=value": a browser sends those of all
// servers on this machine, whatever their port.
std::string CookieValue(const std::string& header, const std::string& name) {
  std::string_view rest(header);
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    std::string_view pair = rest.substr(0, end);
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
    while (!pair.empty() && pair.front() == ' ') pair.remove_prefix(1);
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) {
      return std::string(pair.substr(equals + 1));
    }
  }
  return "";
}

Guard::Guard(std::string token, int port)
    : token_(std::move(token)), port_(port) {}

std::string Guard::Address() const {
  return fmt::format("http://127.0.0.1:{}/?token={}", port_, token_);
}

// Cookies are shared by all ports of a machine: two servers must not take each
// other's away.
std::string Guard::CookieName() const {
  return fmt::format("touchdown_{}", port_);
}

// Says whether a Host header names this server. A page whose own name was made
// to resolve to 127.0.0.1 sends that name.
bool Guard::IsOwnHost(const std::string& host) const {
  return host == fmt::format("127.0.0.1:{}", port_) ||
         host == fmt::format("localhost:{}", port_);
}

bool Guard::IsOurs(const std::string& token) const {
  // As long for the first wrong character as for the last.
  if (token.size() != token_.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different |= static_cast<unsigned char>(token[i] ^ token_[i]);
  }
  return different == 0;
}

// The tests go from what a stranger's page cannot hide (Host, Origin,
// Sec-Fetch-Site) to the key, and then to what a change must be besides.
std::optional<Reply> Guard::Refuse(const Request& request) const {
  if (!IsOwnHost(request.host)) {
    return Refusal(403,
                   "this server answers under the address it printed only");
  }
  if (!request.origin.empty() && request.origin != "http://" + request.host) {
    return Refusal(403, "requests from other pages are not answered");
  }
  // A link that a person follows into the page is `none` or a navigation; what
  // other sites' pages fetch is not.
  if (request.fetch_site == "cross-site" || request.fetch_site == "same-site") {
    if (request.method != "GET" || request.path != "/") {
      return Refusal(403, "requests from other pages are not answered");
    }
  }
  if (!IsOurs(request.token) &&
      !IsOurs(CookieValue(request.cookie, CookieName()))) {
    // A person who opens the page gets a form; a program gets one line.
    if (request.method == "GET" && request.path == "/") {
      return KeyPage("This page needs the key of the session.");
    }
    return Refusal(403,
                   "open the whole address that `touchdown review` printed: it "
                   "holds the key of this session");
  }
  if (request.method != "GET" && request.method != "HEAD") {
    // A form of another page can send text or form data without asking; for
    // JSON a browser asks first, and is refused.
    if (request.content_type.rfind("application/json", 0) != 0) {
      return Refusal(415, "a request that changes something must be JSON");
    }
    // Browsers send Origin with every POST; programs send the token's header.
    if (request.origin.empty() && request.token.empty()) {
      return Refusal(403, "the request does not say where it comes from");
    }
  }
  return std::nullopt;
}

std::optional<Reply> Guard::Welcome(const Request& request) const {
  const auto given = request.query.find("token");
  if (request.method != "GET" || request.path != "/" ||
      given == request.query.end() || !IsOwnHost(request.host)) {
    return std::nullopt;
  }
  // Most often this is a tab of an earlier run of the server.
  if (!IsOurs(ExtractKey(given->second))) {
    return KeyPage("This address is of another session.");
  }
  // A page and no redirection: where another page or a file led here, as the
  // one that opens the browser does, a redirection would go without the cookie
  // (SameSite=Strict); what this page leads to is asked for by our own.
  Reply reply;
  reply.type = "text/html; charset=utf-8";
  reply.body =
      "<!DOCTYPE html>\n<html lang=\"en\"><title>touchdown review</title>\n"
      "<meta http-equiv=\"refresh\" content=\"0; url=/\">\n"
      "<p><a href=\"/\">touchdown review</a></html>\n";
  reply.headers = {
      {"Cache-Control", "no-store"},
      {"Set-Cookie", fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict",
                                 CookieName(), token_)}};
  return reply;
}

}  // namespace touchdown::review
