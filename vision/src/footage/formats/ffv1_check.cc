#include "footage/formats/ffv1_check.h"

#include "footage/formats/libav.h"

namespace touchdown::vision {

bool Ffv1SumsHold(std::span<const std::uint8_t> packet) {
  // From the back: content, its size in 24 bits, error status in 8, CRC in 32;
  // the CRC of a slice with its CRC is zero (RFC 9043, sections 4.5 and 4.9).
  constexpr std::size_t kFooterBytes = 3 + 1 + 4;
  if (packet.empty()) return false;
  while (!packet.empty()) {
    if (packet.size() < kFooterBytes) return false;
    const std::uint8_t* const footer =
        packet.data() + packet.size() - kFooterBytes;
    const std::size_t slice = (std::size_t{footer[0]} << 16 |
                               std::size_t{footer[1]} << 8 | footer[2]) +
                              kFooterBytes;
    if (slice > packet.size()) return false;
    const std::uint8_t* const begin = packet.data() + packet.size() - slice;
    if (Libav().av_crc(Libav().av_crc_get_table(AV_CRC_32_IEEE), 0, begin,
                       slice) != 0) {
      return false;
    }
    packet = packet.first(packet.size() - slice);
  }
  return true;
}

}  // namespace touchdown::vision
