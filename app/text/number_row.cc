#include "app/text/number_row.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <iterator>

namespace touchdown::report {
namespace {

// Appends `value` as printf would with %.*f or %.*g, whatever the locale.
// Documents hold a row for each frame, and with a precision std::to_chars takes
// half of the time of fmt.
void Append(double value, std::chars_format format, int precision,
            std::string& text) {
  // The longest double with 12 decimals has 309 digits before the point, a
  // point, a sign and 12 digits behind it. No caller asks for more decimals.
  std::array<char, 340> room;
  const auto end = std::to_chars(room.data(), room.data() + room.size(), value,
                                 format, precision);
  text.append(room.data(), end.ptr);
}

}  // namespace

// Puts the blank between two entries; the row neither begins nor ends with one.
void NumberRow::Begin() {
  if (!text_.empty()) text_ += ' ';
}

NumberRow& NumberRow::AddWhole(std::int64_t value) {
  Begin();
  text_ += std::to_string(value);
  return *this;
}

NumberRow& NumberRow::AddShortest(double value) {
  Begin();
  fmt::format_to(std::back_inserter(text_), "{}", value);
  return *this;
}

NumberRow& NumberRow::AddFixed(double value, int decimals) {
  Begin();
  Append(value, std::chars_format::fixed, decimals, text_);
  return *this;
}

NumberRow& NumberRow::AddGeneral(double value, int digits) {
  Begin();
  Append(value, std::chars_format::general, digits, text_);
  return *this;
}

NumberRow& NumberRow::AddWord(const std::string& word) {
  Begin();
  text_ += word;
  return *this;
}

}  // namespace touchdown::report
