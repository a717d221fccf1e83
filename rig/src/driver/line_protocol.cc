#include "touchdown/rig/driver/line_protocol.h"

#include <fmt/core.h>

#include <charconv>

namespace touchdown::rig {
namespace {

template <class T>
std::optional<T> Whole(std::string_view text, int base = 10) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

std::string Sealed(const std::string& text) {
  return fmt::format("\n{}*{:04X}\n", text, Crc16(text));
}

std::optional<std::string_view> Unsealed(std::string_view line) {
  constexpr std::size_t kSeal = 5;  // '*' and four digits
  if (line.size() < kSeal || line.size() > kLongestLine) return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - kSeal);
  const auto crc = Whole<std::uint16_t>(line.substr(text.size() + 1), 16);
  if (line[text.size()] != '*' || crc != Crc16(text)) return std::nullopt;
  return text;
}

// The first word, which is taken off `rest`.
std::string_view TakeWord(std::string_view& rest) {
  const std::size_t space = rest.find(' ');
  const std::string_view word = rest.substr(0, space);
  rest.remove_prefix(space == std::string_view::npos ? rest.size() : space + 1);
  return word;
}

std::string Joined(std::string text, const std::string& last) {
  if (!last.empty()) text += " " + last;
  return text;
}

}  // namespace

std::uint16_t Crc16(std::string_view bytes) {
  unsigned crc = 0xFFFF;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned>(static_cast<unsigned char>(c)) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1;
    }
  }
  return static_cast<std::uint16_t>(crc & 0xFFFF);
}

std::string FormatLine(const Request& request) {
  return Sealed(Joined(fmt::format("{} {}", request.number, request.verb),
                       request.argument));
}

std::string FormatLine(const Answer& answer) {
  return Sealed(Joined(fmt::format("{} {} {}", answer.number,
                                   answer.ok ? "ok" : "no", answer.verb),
                       answer.text));
}

std::optional<Request> ParseRequest(std::string_view line) {
  auto rest = Unsealed(line);
  if (!rest) return std::nullopt;
  const auto number = Whole<std::uint32_t>(TakeWord(*rest));
  const std::string_view verb = TakeWord(*rest);
  if (!number || verb.empty()) return std::nullopt;
  return Request{*number, std::string(verb), std::string(*rest)};
}

std::optional<Answer> ParseAnswer(std::string_view line) {
  auto rest = Unsealed(line);
  if (!rest) return std::nullopt;
  const auto number = Whole<std::uint32_t>(TakeWord(*rest));
  const std::string_view outcome = TakeWord(*rest);
  const std::string_view verb = TakeWord(*rest);
  if (!number || verb.empty() || (outcome != "ok" && outcome != "no")) {
    return std::nullopt;
  }
  return Answer{*number, outcome == "ok", std::string(verb),
                std::string(*rest)};
}

std::optional<std::int64_t> ReadField(std::string_view text,
                                      std::string_view name) {
  while (!text.empty()) {
    const std::string_view word = TakeWord(text);
    const std::size_t sign = word.find('=');
    if (sign != std::string_view::npos && word.substr(0, sign) == name) {
      return Whole<std::int64_t>(word.substr(sign + 1));
    }
  }
  return std::nullopt;
}

}  // namespace touchdown::rig
