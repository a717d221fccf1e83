// The words of the field, with the spelling used in commands, JSON, columns and
// reports. Each enumeration has Name(); those that are read have a Parse...()
// that returns nothing for an unknown word.
#pragma once

#include <optional>
#include <string_view>

namespace touchdown::core {

// The thing thrown.
enum class BodyKind { kSphere, kRectangle };

// Which angle between body or path and ground is meant; kinds are never pooled.
//   approach  between the ground and the centre's velocity at touchdown, 0..90
//   radius    acute, between the ground and the line from the centre to the
//             contact point: the paper's alpha (Fig. 1)
//   face      inclination of a rectangle's long side to the ground at
//   touchdown,
//             positive with the leading end up
enum class AngleKind { kApproach, kRadius, kFace };

// Which part of a rectangle touches first; the sign of friction follows from it
// (leading: the contact point is ahead of the centre).
enum class Corner { kLeading, kTrailing, kFlush };

// What the body did after touchdown. `bounce`: the 95 % interval of the
// greatest gap between release and the end of what was filmed lies above the
// bounce height; the others: it lies below; `undecided`: neither.
enum class MotionState {
  kBounce,
  kSlide,
  kRollSlide,
  kRoll,
  kStick,
  kStaysDown,
  kUndecided
};

// Where a trial comes from. Never pooled.
enum class Origin { kRecorded, kSimulated, kManual };

// What the trials say of a theory's boundary angle.
enum class Verdict { kConfirmed, kContradicted, kInconclusive };

std::string_view Name(BodyKind kind);
std::string_view Name(AngleKind kind);
std::string_view Name(Corner corner);
std::string_view Name(MotionState state);
std::string_view Name(Origin origin);
std::string_view Name(Verdict verdict);

std::optional<BodyKind> ParseBodyKind(std::string_view word);
std::optional<AngleKind> ParseAngleKind(std::string_view word);
std::optional<Corner> ParseCorner(std::string_view word);
std::optional<MotionState> ParseMotionState(std::string_view word);
std::optional<Origin> ParseOrigin(std::string_view word);

// True for slide, roll-slide, roll, stick and stays-down: what a table in the
// paper's two words prints as "slide".
bool IsNotBounce(MotionState state);

}  // namespace touchdown::core
