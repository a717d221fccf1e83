// Check sums of FFV1 (RFC 9043, version 3): libav's decoder fills a slice whose
// sum is wrong from the picture before and does not tell, so we look ourselves.
#pragma once

#include <cstdint>
#include <span>

namespace touchdown::vision {

// Whether the packet is a chain of slices whose CRC-32 all hold. False too for
// streams written without check sums: only a stream whose first packet has them
// can be checked.
bool Ffv1SumsHold(std::span<const std::uint8_t> packet);

}  // namespace touchdown::vision
