#include "app/cli/theory/theory_words.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace touchdown::cli {
namespace {

// Returns the number that the whole of `text` is; `whole` is what the user
// typed, which the message quotes. Throws std::invalid_argument also for
// infinities.
double ParseNumber(const std::string& text, const std::string& whole) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size() ||
      !std::isfinite(value)) {
    throw std::invalid_argument(
        fmt::format("'{}' is not a number or a fraction like 4/3", whole));
  }
  return value;
}

}  // namespace

// The words are those of the reference cases: the sign is that of the slip
// along x in the frame of corner.h.
std::string PhasesText(const analysis::ImpactResult& result) {
  std::string out;
  for (const analysis::ImpactPhase& phase : result.Phases()) {
    if (!out.empty()) out += '>';
    switch (phase.slip) {
      case analysis::Slip::kLeading:
        out += "slip+1";
        break;
      case analysis::Slip::kTrailing:
        out += "slip-1";
        break;
      case analysis::Slip::kNone:
        out += "stick";
        break;
    }
  }
  return out;
}

std::string_view Word(analysis::ImpactStatus status) {
  switch (status) {
    case analysis::ImpactStatus::kCollision:
      return "collision";
    case analysis::ImpactStatus::kWithoutCollision:
      return "without collision";
    case analysis::ImpactStatus::kNone:
      break;
  }
  return "none";
}

std::string_view Word(analysis::SpinBoundaryStatus status) {
  switch (status) {
    case analysis::SpinBoundaryStatus::kExists:
      return "OK";
    case analysis::SpinBoundaryStatus::kAt90:
      return "AT_90";
    case analysis::SpinBoundaryStatus::kNone:
      break;
  }
  return "NONE (R w^2<g): slide for every alpha";
}

double ParseFraction(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return ParseNumber(text, text);
  const double above = ParseNumber(text.substr(0, slash), text);
  const double below = ParseNumber(text.substr(slash + 1), text);
  // Infinity would pass for a number.
  if (below == 0.0) {
    throw std::invalid_argument(fmt::format("'{}' divides by 0", text));
  }
  return above / below;
}

}  // namespace touchdown::cli
