// HTTP/1.1 as the page's server speaks it: the head of a request read from
// bytes, an answer written as bytes. No socket here.
//
// What a browser or curl needs, and no more: no chunked and no compressed
// bodies, no field over two lines. Whatever a head says, reading it takes
// memory in proportion to its bytes, and the server bounds those.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "app/review/message.h"

namespace touchdown::review {

struct Head {
  Request request;  // without its body
  std::size_t body_bytes = 0;
  bool keeps_alive = true;
  // The client waits for "100 Continue" before it sends the body.
  bool awaits_continue = false;
};

// The length of the head at the beginning of `bytes`, its empty line included;
// nothing where it is not all there yet.
std::optional<std::size_t> HeadLength(std::string_view bytes);

// A head, up to and with its empty line. The answer to give instead where it
// is none: 400 not understood, 411 a body whose length is not said, 415 a
// compressed body, 431 too many fields, 501 another method.
tl::expected<Head, Reply> ReadHead(std::string_view bytes);

// `%41` and, where `plus_is_space`, `+` as they are meant.
std::string Decoded(std::string_view text, bool plus_is_space);

struct ReplyForm {
  bool keeps_alive = true;
  bool has_body = true;  // false: the answer to HEAD
};

// Status line, fields and body. A field of the answer stands; SafeHeaders()
// and Cache-Control: no-store are added where they are absent.
std::string WriteReply(const Reply& reply, const ReplyForm& form);

}  // namespace touchdown::review
