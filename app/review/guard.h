// Who may ask. The server listens on this machine alone, but every page that a
// browser shows can send requests there, and any name can be made to resolve to
// 127.0.0.1. So:
//   Host    must be the address that was printed (against DNS rebinding)
//   Origin  where there is one, must be our own; a request that changes
//           anything must also be JSON, which no form of another page can send
//   token   of 122 random bits, known to whoever was told the address: in a
//           cookie that scripts cannot read and other sites cannot send, or in
//           the header X-Touchdown-Token
#pragma once

#include <optional>
#include <string>

#include "app/review/message.h"

namespace touchdown::review {

class Guard {
 public:
  // `token` is not empty; `port` is where the server listens.
  Guard(std::string token, int port);

  // The answer to a request that may not pass; nothing where it may. Who opens
  // the page itself without the key is asked for it.
  std::optional<Reply> Refuse(const Request& request) const;

  // The answer to the printed address: hands the token over into a cookie, and
  // on to the page without it. The token may be all of the address, as a person
  // pastes it. Nothing where the request bears no token.
  std::optional<Reply> Welcome(const Request& request) const;

  // What a person opens: http://127.0.0.1:PORT/?token=...
  std::string Address() const;

 private:
  bool IsOwnHost(const std::string& host) const;
  bool IsOurs(const std::string& token) const;
  std::string CookieName() const;

  std::string token_;
  int port_;
};

// Header fields of every answer: nothing is loaded from elsewhere, no script
// or style stands inside a page, no other page shows ours in a frame.
const std::vector<std::pair<std::string, std::string>>& SafeHeaders();

// The value of a cookie in a Cookie header; empty where there is none.
std::string CookieValue(const std::string& header, const std::string& name);

}  // namespace touchdown::review
