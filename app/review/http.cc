#include "app/review/http.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "app/review/guard.h"
#include "app/text/parse_number.h"

namespace touchdown::review {
namespace {

// Fields of one head; a browser sends about 15. More are refused: each costs
// memory beyond its bytes.
constexpr std::size_t kMostFields = 64;
// Every line of a head ends so (RFC 9112, section 2.2).
constexpr std::string_view kLineEnd = "\r\n";

// Compares names of fields and their keywords, in which HTTP tells no upper
// from lower case.
bool Same(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

// Returns a field's value without the blanks around it.
std::string_view Trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// What stands before `end`, which is taken away with it; all where `end` is
// not there.
std::string_view TakeToken(std::string_view& rest, std::string_view end) {
  const std::size_t at = rest.find(end);
  const std::string_view taken = rest.substr(0, at);
  rest = at == std::string_view::npos ? "" : rest.substr(at + end.size());
  return taken;
}

// Says whether a field may have this name: visible ASCII, no blank. A blank
// before the colon is refused: servers and proxies disagree about it, which
// lets a request say two things.
bool IsName(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return c > ' ' && c < 0x7f && c != ':';
  });
}

// Returns the answer to what is no HTTP.
tl::unexpected<Reply> NotUnderstood(const std::string& what) {
  return tl::unexpected(Refusal(400, "the request is not understood: " + what));
}

// Returns the value of a hexadecimal digit; -1 where `c` is none.
int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Reads "/api/trials/ID?revision=3" into path and query. Both are decoded only
// after they were divided: an encoded "?" or "&" belongs to a name.
void ReadTarget(std::string_view target, Request& request) {
  std::string_view rest = target;
  request.path = Decoded(TakeToken(rest, "?"), false);
  while (!rest.empty()) {
    std::string_view pair = TakeToken(rest, "&");
    const std::string name = Decoded(TakeToken(pair, "="), true);
    if (!name.empty()) request.query[name] = Decoded(pair, true);
  }
}

// Where a field of the head goes that the answer depends on.
std::string* FindPlace(std::string_view name, Request& request) {
  const struct {
    std::string_view name;
    std::string* place;
  } places[] = {{"Host", &request.host},
                {"Origin", &request.origin},
                {"Sec-Fetch-Site", &request.fetch_site},
                {"Cookie", &request.cookie},
                {"X-Touchdown-Token", &request.token},
                {"Content-Type", &request.content_type},
                {"If-None-Match", &request.if_none_match}};
  for (const auto& entry : places) {
    if (Same(entry.name, name)) return entry.place;
  }
  return nullptr;
}

// What a field says of the connection or of the body.
std::optional<Reply> ReadTransfer(std::string_view name, std::string_view value,
                                  std::optional<std::size_t>& length,
                                  Head& head) {
  // A length that stands twice is refused, even where both agree.
  if (Same(name, "Content-Length")) {
    const auto n = report::ParseNumber<std::size_t>(value);
    if (!n || length) {
      return Refusal(400, "the request is not understood: Content-Length");
    }
    length = *n;
  } else if (Same(name, "Transfer-Encoding")) {
    // Chunks do not say beforehand how much will come, and the server bounds
    // its memory by that.
    return Refusal(411, "a body must say its length (Content-Length)");
  } else if (Same(name, "Content-Encoding") && !Same(value, "identity")) {
    return Refusal(415, "a body must not be compressed");
  } else if (Same(name, "Connection")) {
    if (Same(value, "close")) head.keeps_alive = false;
  } else if (Same(name, "Expect")) {
    head.awaits_continue = Same(value, "100-continue");
  }
  return std::nullopt;
}

// Returns the words after the status, for people who look at the bytes.
std::string_view ReasonPhrase(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 303:
      return "See Other";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    default:
      return "Answer";  // HTTP asks for the number alone
  }
}

// Says whether an answer has the field already.
bool Says(const Reply& reply, std::string_view name) {
  return std::any_of(
      reply.headers.begin(), reply.headers.end(),
      [name](const auto& header) { return Same(header.first, name); });
}

}  // namespace

// The empty line is looked for as bytes: what stands before it is not read
// until it is all there.
std::optional<std::size_t> HeadLength(std::string_view bytes) {
  constexpr std::string_view kEnd = "\r\n\r\n";
  const std::size_t end = bytes.find(kEnd);
  if (end == std::string_view::npos) return std::nullopt;
  return end + kEnd.size();
}

std::string Decoded(std::string_view text, bool plus_is_space) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && HexDigit(text[i + 1]) >= 0 &&
        HexDigit(text[i + 2]) >= 0) {
      decoded +=
          static_cast<char>(HexDigit(text[i + 1]) * 16 + HexDigit(text[i + 2]));
      i += 2;
    } else {
      decoded += plus_is_space && text[i] == '+' ? ' ' : text[i];
    }
  }
  return decoded;
}

tl::expected<Head, Reply> ReadHead(std::string_view bytes) {
  Head head;
  std::string_view rest = bytes;
  std::string_view line = TakeToken(rest, kLineEnd);
  head.request.method = TakeToken(line, " ");
  const std::string_view target = TakeToken(line, " ");
  if (line != "HTTP/1.1" && line != "HTTP/1.0") {
    return NotUnderstood("its first line");
  }
  if (head.request.method != "GET" && head.request.method != "HEAD" &&
      head.request.method != "POST") {
    return tl::unexpected(Refusal(501, "only GET, HEAD and POST are answered"));
  }
  if (!target.starts_with('/')) return NotUnderstood("its path");
  // HTTP/1.1 keeps a connection unless told otherwise, 1.0 closes it.
  head.keeps_alive = line == "HTTP/1.1";
  ReadTarget(target, head.request);
  std::optional<std::size_t> length;
  std::size_t fields = 0;
  // Each line holds one field; the empty line ends them.
  for (line = TakeToken(rest, kLineEnd); !line.empty();
       line = TakeToken(rest, kLineEnd)) {
    if (++fields > kMostFields) {
      return tl::unexpected(Refusal(431, "the request has too many fields"));
    }
    if (line.find(':') == std::string_view::npos) {
      return NotUnderstood("a field without a colon");
    }
    const std::string_view name = TakeToken(line, ":");
    const std::string_view value = Trimmed(line);
    if (!IsName(name)) return NotUnderstood("the name of a field");
    if (auto refused = ReadTransfer(name, value, length, head)) {
      return tl::unexpected(*std::move(refused));
    }
    if (std::string* const place = FindPlace(name, head.request)) {
      // Of two, one could be for the guard and one for the rest.
      if (!place->empty()) return NotUnderstood("a field that stands twice");
      *place = value;
    }
  }
  head.body_bytes = length.value_or(0);
  return head;
}

std::string WriteReply(const Reply& reply, const ReplyForm& form) {
  std::string bytes = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
      "Connection: {}\r\n",
      reply.status, ReasonPhrase(reply.status), reply.type, reply.body.size(),
      form.keeps_alive ? "keep-alive" : "close");
  // The answer's own fields come first, so that they stand in place of the
  // usual ones: a report brings its own Content-Security-Policy.
  const auto add = [&bytes](std::string_view name, std::string_view value) {
    bytes += fmt::format("{}: {}\r\n", name, value);
  };
  for (const auto& [name, value] : reply.headers) add(name, value);
  for (const auto& [name, value] : SafeHeaders()) {
    if (!Says(reply, name)) add(name, value);
  }
  if (!Says(reply, "Cache-Control")) add("Cache-Control", "no-store");
  bytes += kLineEnd;
  if (form.has_body) bytes += reply.body;
  return bytes;
}

}  // namespace touchdown::review
