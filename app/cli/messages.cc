#include "app/cli/messages.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>

#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

// Reads one UTF-8 sequence at the start of `text`, which must not be empty.
// Returns its length in bytes, with its code point in `point`; 0 where the
// bytes are no UTF-8 (RFC 3629): cut off, overlong, a surrogate, or beyond
// U+10FFFF.
std::size_t Decode(std::string_view text, std::uint32_t& point) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t first = byte(0);
  std::size_t length = 1;
  std::uint32_t least = 0;
  if (first < 0x80) {
    point = first;
    return 1;
  }
  // The first byte gives the length. `least` is the smallest code point that
  // needs it: anything below is an overlong form, by which a control character
  // could be smuggled past a filter.
  if (first >= 0xc2 && first < 0xe0) {
    length = 2;
    point = first & 0x1fU;
    least = 0x80;
  } else if (first >= 0xe0 && first < 0xf0) {
    length = 3;
    point = first & 0x0fU;
    least = 0x800;
  } else if (first >= 0xf0 && first < 0xf5) {
    length = 4;
    point = first & 0x07U;
    least = 0x10000;
  } else {
    return 0;
  }
  if (text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return 0;
    point = (point << 6) | (byte(i) & 0x3fU);
  }
  const bool surrogate = point >= 0xd800 && point < 0xe000;
  return point < least || surrogate || point > 0x10ffff ? 0 : length;
}

// Returns whether a terminal may be sent the character. Refused are control
// characters, zero-width ones, and marks that turn the direction of writing:
// with these a file's name could show another text than it holds, or command
// the terminal.
bool IsHarmless(std::uint32_t point) {
  const auto within = [point](std::uint32_t low, std::uint32_t high) {
    return point >= low && point <= high;
  };
  return point >= 0x20 && !within(0x7f, 0x9f) &&  // control characters
         !within(0x200b, 0x200f) && !within(0x2028, 0x202e) &&
         !within(0x2060, 0x206f) && point != 0x61c && point != 0xfeff;
}

}  // namespace

std::string Printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    std::uint32_t point = 0;
    const std::size_t length = Decode(text, point);
    if (length > 0 && IsHarmless(point)) {
      out += text.substr(0, length);
    } else {
      // A refused character is shown byte by byte; of what is no UTF-8, only
      // the first byte, and reading goes on with the next.
      for (const char c : text.substr(0, length == 0 ? 1 : length)) {
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
      }
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

// Errors are passed over: there is nobody left who could be told of them.
void TellRaw(std::string_view bytes) noexcept {
  std::fwrite(bytes.data(), 1, bytes.size(), stderr);
  std::fflush(stderr);
}

void Tell(std::string_view text) noexcept {
  try {
    TellRaw("touchdown: " + Printable(text) + "\n");
  } catch (const std::exception&) {  // no memory is left to say it
    TellRaw("touchdown: out of memory\n");
  }
}

// Runs before any file is opened; the numbers 0 to 2 are tried in order, so
// that the one that is missing is the lowest that is free.
void KeepStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest that is free: `stream` itself. Only for reading, so that
    // results that nobody gets are an error.
    const int flags = stream == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    if (open("/dev/null", flags) < 0) return;
  }
}

void RequireStdoutWritten() {
  // Where an earlier write failed, errno is no longer its reason: then the
  // message has none.
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (flushed && std::ferror(stdout) == 0 && std::cout) return;
  throw core::OutputError(fmt::format(
      "stdout: the results could not be written{}{}", error != 0 ? ": " : "",
      error != 0 ? std::strerror(error) : ""));
}

}  // namespace touchdown::cli
