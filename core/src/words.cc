#include "touchdown/core/words.h"

#include <array>
#include <utility>

namespace touchdown::core {
namespace {

template <class T, std::size_t N>
using Table = std::array<std::pair<T, std::string_view>, N>;

// The words of columns, commands and documents, one table for each kind: they
// are never changed, since stored trials bear them.
constexpr Table<BodyKind, 2> kBodyKinds{{
    {BodyKind::kSphere, "sphere"},
    {BodyKind::kRectangle, "rectangle"},
}};
// Which angle a protocol names.
constexpr Table<AngleKind, 3> kAngleKinds{{
    {AngleKind::kApproach, "approach"},
    {AngleKind::kRadius, "radius"},
    {AngleKind::kFace, "face"},
}};
// Which corner of a rectangle touched.
constexpr Table<Corner, 3> kCorners{{
    {Corner::kLeading, "leading"},
    {Corner::kTrailing, "trailing"},
    {Corner::kFlush, "flush"},
}};
// Motion states.
constexpr Table<MotionState, 7> kMotionStates{{
    {MotionState::kBounce, "bounce"},
    {MotionState::kSlide, "slide"},
    {MotionState::kRollSlide, "roll-slide"},
    {MotionState::kRoll, "roll"},
    {MotionState::kStick, "stick"},
    {MotionState::kStaysDown, "stays-down"},
    {MotionState::kUndecided, "undecided"},
}};
// Origins of a trial.
constexpr Table<Origin, 3> kOrigins{{
    {Origin::kRecorded, "recorded"},
    {Origin::kSimulated, "simulated"},
    {Origin::kManual, "manual"},
}};
// Verdicts on a theory.
constexpr Table<Verdict, 3> kVerdicts{{
    {Verdict::kConfirmed, "confirmed"},
    {Verdict::kContradicted, "contradicted"},
    {Verdict::kInconclusive, "inconclusive"},
}};

template <class T, std::size_t N>
std::string_view FindName(const Table<T, N>& table, T value) {
  for (const auto& [key, name] : table) {
    if (key == value) return name;
  }
  return "?";
}

template <class T, std::size_t N>
std::optional<T> FindValue(const Table<T, N>& table, std::string_view word) {
  for (const auto& [key, name] : table) {
    if (name == word) return key;
  }
  return std::nullopt;
}

}  // namespace

std::string_view Name(BodyKind kind) { return FindName(kBodyKinds, kind); }
std::string_view Name(AngleKind kind) { return FindName(kAngleKinds, kind); }
std::string_view Name(Corner corner) { return FindName(kCorners, corner); }
std::string_view Name(MotionState s) { return FindName(kMotionStates, s); }
std::string_view Name(Origin origin) { return FindName(kOrigins, origin); }
std::string_view Name(Verdict verdict) { return FindName(kVerdicts, verdict); }

std::optional<BodyKind> ParseBodyKind(std::string_view word) {
  return FindValue(kBodyKinds, word);
}
std::optional<AngleKind> ParseAngleKind(std::string_view word) {
  return FindValue(kAngleKinds, word);
}
std::optional<Corner> ParseCorner(std::string_view word) {
  return FindValue(kCorners, word);
}
std::optional<MotionState> ParseMotionState(std::string_view word) {
  return FindValue(kMotionStates, word);
}
std::optional<Origin> ParseOrigin(std::string_view word) {
  return FindValue(kOrigins, word);
}

bool IsNotBounce(MotionState state) {
  return state != MotionState::kBounce && state != MotionState::kUndecided;
}

}  // namespace touchdown::core
