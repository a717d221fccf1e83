#include "app/review/fields.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "app/text/parse_number.h"
#include "app/trials/statement.h"

namespace touchdown::review {
namespace {

using pipeline::FieldError;

// Turns "angle_u_deg" of the page into "angle-u-deg" of the command line.
std::string Flag(std::string field) {
  for (char& c : field) c = c == '_' ? '-' : c;
  return field;
}

}  // namespace

std::string ReadTextField(const nlohmann::json& asked, const char* field) {
  const auto found = asked.find(field);
  if (found == asked.end() || found->is_null()) return "";
  if (!found->is_string()) throw FieldError(Flag(field), "must be text");
  return found->get<std::string>();
}

std::string RequiredText(const nlohmann::json& asked, const char* field,
                         const char* what) {
  std::string text = ReadTextField(asked, field);
  // Blanks alone are no name and no reason.
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw FieldError(Flag(field), fmt::format("is missing, must be {}", what));
  }
  return text;
}

std::optional<std::pair<core::PixelPoint, core::PixelPoint>> ReadTwoPoints(
    const nlohmann::json& asked, const char* field) {
  const auto given = asked.find(field);
  if (given == asked.end() || given->is_null()) return std::nullopt;
  const auto n = given->get<std::vector<double>>();
  if (n.size() != 4) {
    throw std::invalid_argument(
        fmt::format("{} has {} numbers, must be two points x1, y1, x2, y2",
                    field, n.size()));
  }
  return std::pair(core::PixelPoint{n[0], n[1]}, core::PixelPoint{n[2], n[3]});
}

std::optional<double> ReadNumberField(const nlohmann::json& asked,
                                      const char* field) {
  const auto found = asked.find(field);
  // Forms send text, programs numbers.
  if (found != asked.end() && found->is_number()) return found->get<double>();
  const std::string text = ReadTextField(asked, field);
  if (text.empty()) return std::nullopt;
  const auto value = report::ParseNumber<double>(text);
  if (!value) {
    throw FieldError(
        Flag(field),
        fmt::format("is '{}', must be a number with a decimal point", text));
  }
  return value;
}

}  // namespace touchdown::review
