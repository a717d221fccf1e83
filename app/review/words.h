// The store's columns in words, with the units that people read: degrees and
// millimetres, never a radian.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace touchdown::review {

// inner = shown * factor + offset.
struct Shown {
  std::string name;   // "approach_angle_deg"
  std::string words;  // "approach angle"
  std::string unit;   // "deg"; empty: none
  double factor = 1.0;
  double offset = 0.0;
};

// Of a column of the store, "approach_angle_rad". One that has no words of its
// own is told by its name.
Shown ShownAs(std::string_view column);

// "approach angle, deg"
std::string Label(const Shown& shown);

// The columns of a contact, what a person looks for first before the others.
std::span<const std::string_view> ColumnsInOrder();

}  // namespace touchdown::review
