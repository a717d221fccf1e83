#include "touchdown/db/identity.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <ctime>
#include <stdexcept>

namespace touchdown::db {
namespace {

// Characters: 32 digits and four dashes (RFC 9562).
constexpr std::size_t kUuidLength = 36;

bool IsDash(std::size_t i) { return i == 8 || i == 13 || i == 18 || i == 23; }

std::string Format(std::uint64_t high, std::uint64_t low, unsigned version) {
  // xxxxxxxx-xxxx-Vxxx-Yxxx-xxxxxxxxxxxx with V the version, Y in 8..b.
  high = (high & ~0xf000ULL) | (std::uint64_t{version} << 12);
  low = (low & 0x3fff'ffff'ffff'ffffULL) | 0x8000'0000'0000'0000ULL;
  return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", high >> 32,
                     (high >> 16) & 0xffff, high & 0xffff, low >> 48,
                     low & 0xffff'ffff'ffffULL);
}

std::array<std::uint64_t, 2> Bits(std::string_view uuid) {
  if (!IsUuid(uuid)) {
    throw std::invalid_argument(
        fmt::format("uuid is '{}', must be 8-4-4-4-12 "
                    "lower-case hexadecimal digits",
                    uuid));
  }
  std::array<std::uint64_t, 2> bits{};
  std::size_t digits = 0;
  for (const char c : uuid) {
    if (c == '-') continue;
    const auto digit = static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
    auto& word = bits[digits / 16];
    word = (word << 4) | digit;
    ++digits;
  }
  return bits;
}

}  // namespace

std::string UuidFromBits(std::uint64_t high, std::uint64_t low) {
  return Format(high, low, 4);
}

bool IsUuid(std::string_view text) {
  if (text.size() != kUuidLength) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool hex = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    if (IsDash(i) ? c != '-' : !hex) return false;
  }
  return true;
}

std::string UuidOfPair(std::string_view a, std::string_view b) {
  const auto x = Bits(a);
  const auto y = Bits(b);
  return Format(x[0] ^ y[0], x[1] ^ y[1], 8);
}

std::string UtcStamp(std::chrono::system_clock::time_point instant) {
  using std::chrono::duration_cast;
  using std::chrono::milliseconds;
  const auto since_epoch =
      std::chrono::floor<milliseconds>(instant.time_since_epoch());
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  const std::time_t whole = static_cast<std::time_t>(seconds.count());
  std::tm utc{};
  gmtime_r(&whole, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z",
                     utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec,
                     (since_epoch - seconds).count());
}

bool IsUtcStamp(std::string_view text) {
  // 0 stands for any digit; the rest is as it is.
  constexpr std::string_view kPattern = "0000-00-00T00:00:00.000Z";
  if (text.size() != kPattern.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kPattern[i] == '0' ? !digit : text[i] != kPattern[i]) return false;
  }
  return true;
}

Sources SystemSources() {
  Sources sources;
  sources.now_utc = [] { return UtcStamp(std::chrono::system_clock::now()); };
  sources.new_uuid = [] {
    std::array<std::uint64_t, 2> bits{};
    // Short reads do not happen below 256 bytes; EINTR only before the kernel
    // has gathered its first entropy, at boot.
    while (getrandom(bits.data(), sizeof bits, 0) !=
           static_cast<ssize_t>(sizeof bits)) {
      if (errno != EINTR) {
        throw std::runtime_error(
            "the system's random numbers are not to be had (getrandom)");
      }
    }
    return UuidFromBits(bits[0], bits[1]);
  };
  return sources;
}

}  // namespace touchdown::db
