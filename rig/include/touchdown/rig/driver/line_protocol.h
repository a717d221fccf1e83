// The lines that go between the program and the rig's controller: touchdown-rig
// version 2, written out in rig/README.md.
//
//   7 angle 12500*5C1E         the program asks: number, verb, argument
//   7 ok angle 12500*A0B3      the controller did it, and says what
//   7 no angle range*9D07      it did not, and says why
//
// ASCII; `*` and the CRC-16/CCITT-FALSE of what stands before it, four
// hexadecimal digits; a line feed, and one before the line, so that half a line
// spoils no other. A line that is damaged, or empty, is passed over by either
// side, as if it had been lost.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace touchdown::rig {

// Polynomial 0x1021, start 0xFFFF, no reflection, no final XOR; of "123456789"
// it is 0x29B1.
std::uint16_t Crc16(std::string_view bytes);

// A longer line is no line.
inline constexpr std::size_t kLongestLine = 200;

// Emergency stop: one byte (CAN), no line. The controller acts on it wherever
// it comes, drops what it has read of a line, and stays stopped until `reset`.
inline constexpr char kStopByte = 0x18;

// The heartbeat: a controller that has heard no whole, undamaged line for so
// long disarms and takes the load off its springs.
inline constexpr std::chrono::milliseconds kLongestSilence{2000};

// Of a request that is carried out each time it comes, never taken for a
// repetition. All others are numbered from 1.
inline constexpr std::uint32_t kAlwaysNew = 0;

struct Request {
  std::uint32_t number = kAlwaysNew;  // tells which answer belongs to it
  std::string verb;
  std::string argument;  // may be empty
};

struct Answer {
  std::uint32_t number = 0;
  bool ok = false;
  std::string verb;
  std::string text;  // what was done, or why not
};

// Whole lines, with both line feeds.
std::string FormatLine(const Request& request);
std::string FormatLine(const Answer& answer);

// A line without line feeds; nothing where it is damaged or no such line.
std::optional<Request> ParseRequest(std::string_view line);
std::optional<Answer> ParseAnswer(std::string_view line);

// The value of `name` in "angle=12500 moving=0"; nothing where it is not there
// or no whole number.
std::optional<std::int64_t> ReadField(std::string_view text,
                                      std::string_view name);

}  // namespace touchdown::rig
