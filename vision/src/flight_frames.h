// Which frames beside a blow are of the flight before it and of the one after.
#pragma once

#include <cstddef>
#include <span>

#include "contact_event.h"
#include "touchdown/vision/flight.h"
#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

// Frames of a flight, so that one is spare.
std::size_t Least(const EventOptions& options);

// Two frames tell place and velocity where gravity is known, and none is spare:
// enough only before a rebound whose own flight tells where and when it began.
inline constexpr std::size_t kLeastBeforeRebound = 2;
std::size_t LeastBefore(const EventOptions& options);

// Of a sample from a flight: the largest of its numbers', in sigmas.
double Deviation(const PlaneSample& s, const Flight& flight);
bool Deviates(const PlaneSample& s, const Flight& flight, double sigmas);

// The frames next to the blow may be in contact: those further off are fitted,
// and of the nearest only what the fit predicts is kept. `blow_at_end`: the
// blow follows the samples [begin, end).
void TrimAtBlow(std::span<const PlaneSample> samples, std::size_t& begin,
                std::size_t& end, bool blow_at_end,
                const EventOptions& options);

// From a few frames at the blow outwards, as long as the flight explains them.
Flight Grow(std::span<const PlaneSample> samples, std::size_t& begin,
            std::size_t& end, bool outwards_is_back,
            const EventOptions& options);

// Two frames foretell a third so vaguely that they may explain what follows the
// blow. Whether `s` is better explained by the flight of the frames [from,
// end).
bool BelongsAfter(std::span<const PlaneSample> samples, const PlaneSample& s,
                  const Flight& before, std::size_t from, std::size_t end,
                  const EventOptions& options);

}  // namespace touchdown::vision
