#include "flight_frames.h"

#include <algorithm>
#include <cmath>

namespace touchdown::vision {

std::size_t Least(const EventOptions& options) {
  return options.flight.gravity_px_per_s2 ? 3 : 4;
}

std::size_t LeastBefore(const EventOptions& options) {
  return options.flight.gravity_px_per_s2 ? kLeastBeforeRebound
                                          : Least(options);
}

double Deviation(const PlaneSample& s, const Flight& flight) {
  const FlightState at = flight.At(s.time_s);
  const double h = std::hypot(at.u_height_px, s.u_height_px);
  const double a = std::hypot(at.u_along_px, s.u_along_px);
  // A blow on a corner turns a rectangle before it moves its centre.
  const double f = std::hypot(at.u_face_rad, s.u_face_rad);
  const double turned = f > 0.0 ? std::abs(s.face_rad - at.face_rad) / f : 0.0;
  return std::max({std::abs(s.height_px - at.height_px) / h,
                   std::abs(s.along_px - at.along_px) / a, turned});
}

bool Deviates(const PlaneSample& s, const Flight& flight, double sigmas) {
  return Deviation(s, flight) > sigmas;
}

// The nearest are judged by a fit of those further off.
void TrimAtBlow(std::span<const PlaneSample> samples, std::size_t& begin,
                std::size_t& end, bool blow_at_end,
                const EventOptions& options) {
  constexpr std::size_t kMostDoubtful = 3;  // frames looked at next to the blow
  constexpr std::size_t kTrusted = 8;       // frames that judge them
  const std::size_t count = end - begin;
  // With few frames only the nearest, which may be exposed across the blow.
  const std::size_t least = Least(options);
  if (count < least + 1) return;
  const std::size_t doubtful =
      std::clamp<std::size_t>(count - least, 2, kMostDoubtful + 1) - 1;
  const std::size_t trusted = std::min(kTrusted, count - doubtful);
  const double sigmas = options.flight_sigmas;
  if (blow_at_end) {
    const std::size_t last = end - doubtful;
    const Flight flight =
        FitFlight(samples.subspan(last - trusted, trusted), options.flight);
    for (std::size_t i = last; i < end; ++i) {
      if (Deviates(samples[i], flight, sigmas)) {
        end = i;
        return;
      }
    }
  } else {
    const std::size_t first = begin + doubtful;
    const Flight flight =
        FitFlight(samples.subspan(first, trusted), options.flight);
    for (std::size_t i = first; i-- > begin;) {
      if (Deviates(samples[i], flight, sigmas)) {
        begin = i + 1;
        return;
      }
    }
  }
}

Flight Grow(std::span<const PlaneSample> samples, std::size_t& begin,
            std::size_t& end, bool outwards_is_back,
            const EventOptions& options) {
  constexpr std::size_t kStart = 8;
  const std::size_t low = begin;
  const std::size_t high = end;
  const std::size_t count = std::min(kStart, high - low);
  if (outwards_is_back) {
    begin = high - count;
  } else {
    end = low + count;
  }
  Flight flight =
      FitFlight(samples.subspan(begin, end - begin), options.flight);
  std::size_t fitted = end - begin;
  int strikes = 0;
  while (true) {
    const bool more = outwards_is_back ? begin > low : end < high;
    if (!more) break;
    const std::size_t next = outwards_is_back ? begin - 1 : end;
    strikes = Deviates(samples[next], flight, options.flight_sigmas)
                  ? strikes + 1
                  : 0;
    if (outwards_is_back) {
      --begin;
    } else {
      ++end;
    }
    if (strikes == 2) {
      // The two that no longer belong, and two that may have begun to leave.
      const std::size_t drop =
          std::min<std::size_t>(4, end - begin - std::min(count, end - begin));
      const std::size_t cut = std::max<std::size_t>(2, drop);
      if (outwards_is_back) {
        begin += cut;
      } else {
        end -= cut;
      }
      break;
    }
    // Again when a tenth was added: predictions far out need a fresh fit.
    if (end - begin >= fitted + std::max<std::size_t>(1, fitted / 10)) {
      fitted = end - begin;
      flight = FitFlight(samples.subspan(begin, fitted), options.flight);
    }
  }
  return FitFlight(samples.subspan(begin, end - begin), options.flight);
}

bool BelongsAfter(std::span<const PlaneSample> samples, const PlaneSample& s,
                  const Flight& before, std::size_t from, std::size_t end,
                  const EventOptions& options) {
  constexpr std::size_t kJudges = 8;  // frames
  if (from + Least(options) > end) return false;
  const Flight after = FitFlight(
      samples.subspan(from, std::min(kJudges, end - from)), options.flight);
  return Deviation(s, after) < Deviation(s, before);
}

}  // namespace touchdown::vision
