// Names and dates that the store gives: random UUIDs and UTC time stamps.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace touchdown::db {

// A version 4 UUID (RFC 9562, section 5.4) from 128 random bits, lower case:
// "f81d4fae-7dec-41d0-a765-00a0c91e6bf6". Six of the bits are overwritten by
// version and variant.
std::string UuidFromBits(std::uint64_t high, std::uint64_t low);

// The same from any engine that yields 64 random bits a call.
template <class Engine>
std::string RandomUuid(Engine& engine) {
  static_assert(Engine::min() == 0 && Engine::max() == UINT64_MAX);
  const std::uint64_t high = engine();
  return UuidFromBits(high, engine());
}

// True for 36 characters 8-4-4-4-12 of lower-case hexadecimal digits.
bool IsUuid(std::string_view text);

// The beginning of a UUID, which is enough to find a trial by (Store::Find).
inline std::string ShortId(std::string_view uuid) {
  return std::string(uuid.substr(0, 8));
}

// The UUID (version 8) of the statement that settles two diverged revisions:
// the same whichever of the two comes first, so that two stores merged into
// each other agree. Throws std::invalid_argument unless both are UUIDs.
std::string UuidOfPair(std::string_view a, std::string_view b);

// ISO 8601 in UTC with milliseconds: "2026-08-01T09:30:00.125Z". Such stamps
// sort as text.
std::string UtcStamp(std::chrono::system_clock::time_point instant);
bool IsUtcStamp(std::string_view text);

// Where the store takes time and names from; tests pass their own.
struct Sources {
  std::function<std::string()> now_utc;  // returns a UtcStamp
  std::function<std::string()>
      new_uuid;  // returns a UUID, never twice the same
};

// The system's clock, and the kernel's random numbers (getrandom).
Sources SystemSources();

}  // namespace touchdown::db
