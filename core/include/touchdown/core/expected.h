// The second error lane: "science says no" is a value with its reason.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace touchdown::core {

// Why something could not be measured; one sentence fragment that reads well
// after "absent: ", e.g. "no mark on the sphere".
struct Absent {
  std::string reason;

  friend bool operator==(const Absent&, const Absent&) = default;
};

template <class T>
using Expected = tl::expected<T, Absent>;

// Makes the absent value of any Expected<T>.
inline tl::unexpected<Absent> AbsentBecause(std::string reason) {
  return tl::unexpected<Absent>(Absent{std::move(reason)});
}

}  // namespace touchdown::core
