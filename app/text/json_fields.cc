#include "app/text/json_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace touchdown::report {
namespace {

// Whether all of `text` is UTF-8 (RFC 3629): no cut-off sequences, no overlong
// forms, no surrogates, nothing above U+10FFFF. JSON holds UTF-8 alone, but
// paths of files and old notes may hold any bytes.
bool IsUtf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // `more` counts the bytes that follow the first one; `code` collects their
    // bits into the number of the character.
    std::size_t more = 0;
    unsigned code = 0;
    if (byte < 0x80) {
      ++i;
      continue;
    }
    // C0 and C1 would begin overlong forms of ASCII and are refused here.
    if (byte >= 0xc2 && byte <= 0xdf) {
      more = 1;
      code = byte & 0x1fU;
    } else if (byte >= 0xe0 && byte <= 0xef) {
      more = 2;
      code = byte & 0x0fU;
    } else if (byte >= 0xf0 && byte <= 0xf4) {
      more = 3;
      code = byte & 0x07U;
    } else {
      return false;
    }
    // The text ends inside a character.
    if (i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      // Each following byte has the form 10xxxxxx and holds six bits.
      if ((next & 0xc0U) != 0x80U) return false;
      code = (code << 6U) | (next & 0x3fU);
    }
    // One character in two spellings would make equal texts differ.
    const bool overlong =
        (more == 2 && code < 0x800) || (more == 3 && code < 0x10000);
    if (overlong || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) {
      return false;
    }
    i += more + 1;
  }
  return true;
}

// The number in `field`, in the unit that the field's name bears. JSON has no
// infinities, so NumberJson() writes them as words. Throws
// std::invalid_argument naming the field for anything else, null included: a
// NaN is null in JSON.
double NumberOrInfinity(const Json& field, const std::string& name) {
  if (field.is_number()) return field.get<double>();
  if (field == "inf") return std::numeric_limits<double>::infinity();
  if (field == "-inf") return -std::numeric_limits<double>::infinity();
  WrongField(name, "a number");
}

}  // namespace

Json TextJson(const std::string& text) {
  if (IsUtf8(text)) return text;
  // The bytes come back unchanged from {"bytes": "66fc72"}. Replacing the wrong
  // ones would change the name of a file that somebody has to find again.
  std::string hex;
  for (const char c : text) {
    hex += fmt::format("{:02x}", static_cast<unsigned char>(c));
  }
  return {{"bytes", hex}};
}

Json NumberJson(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json OptionalNumberJson(const std::optional<double>& value) {
  return value ? NumberJson(*value) : Json(nullptr);
}

Json MeasuredJson(const core::Measured& measured) {
  // The reason travels with the absence: a reader of the file sees why there is
  // no number.
  if (!measured) return {{"absent", TextJson(measured.error().reason)}};
  Json json = {{"value", NumberJson(measured->value)},
               {"u", NumberJson(measured->u)}};
  if (measured->interval95) {
    json["interval95"] = Json::array({NumberJson(measured->interval95->low),
                                      NumberJson(measured->interval95->high)});
  }
  return json;
}

Json EstimateJson(const core::Estimate& estimate, double factor) {
  const core::Estimate e = core::Scaled(estimate, factor);
  // nlohmann::json writes an infinite number as null. Lines that must not lose
  // one use MeasuredJson().
  Json json = {{"value", e.value}, {"u", e.u}};
  if (e.interval95)
    json["interval95"] = {e.interval95->low, e.interval95->high};
  return json;
}

const Json& Field(const Json& json, const std::string& name) {
  const auto it = json.is_object() ? json.find(name) : json.end();
  if (!json.is_object() || it == json.end()) {
    throw std::invalid_argument(fmt::format("field '{}' is missing", name));
  }
  return *it;
}

// The message names the field and what it must be; the caller adds file and
// line.
[[noreturn]] void WrongField(const std::string& name,
                             std::string_view expected) {
  throw std::invalid_argument(
      fmt::format("field '{}' must be {}", name, expected));
}

std::string ReadTextField(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (field.is_string()) return field.get<std::string>();
  // Else the field must be the form of TextJson() for bytes that are not UTF-8.
  const auto bytes = field.is_object() ? field.find("bytes") : field.end();
  if (!field.is_object() || bytes == field.end() || !bytes->is_string()) {
    WrongField(name, "a text");
  }
  const auto hex = bytes->get<std::string>();
  std::string text;
  // Two digits a byte, in lower case as they were written.
  if (hex.size() % 2 != 0 ||
      hex.find_first_not_of("0123456789abcdef") != std::string::npos) {
    WrongField(name, "bytes in hexadecimal");
  }
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    text += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return text;
}

bool ReadFlag(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (!field.is_boolean()) WrongField(name, "true or false");
  return field.get<bool>();
}

std::int64_t ReadInteger(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  // A number with a fraction is refused instead of being cut off.
  // One above the largest std::int64_t would come out negative.
  const bool too_large =
      field.is_number_unsigned() &&
      field.get<std::uint64_t>() >
          std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  if (!field.is_number_integer() || too_large) {
    WrongField(name, "a whole number below 2^63");
  }
  return field.get<std::int64_t>();
}

double ReadNumberField(const Json& json, const std::string& name) {
  return NumberOrInfinity(Field(json, name), name);
}

std::optional<double> ReadOptionalNumber(const Json& json,
                                         const std::string& name) {
  const Json& field = Field(json, name);
  // The field itself must be there: null says that there is no number, a
  // missing field says that the file is damaged.
  if (field.is_null()) return std::nullopt;
  return NumberOrInfinity(field, name);
}

core::Measured ReadMeasured(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  // Either {"absent": reason} or {"value", "u"} with an optional "interval95".
  if (field.is_object() && field.contains("absent")) {
    return core::AbsentBecause(ReadTextField(field, "absent"));
  }
  if (!field.is_object()) WrongField(name, "a value with u, or absent");
  core::Estimate estimate;
  // An error inside names the part, as in 'max_gap_m.u'.
  estimate.value = NumberOrInfinity(Field(field, "value"), name + ".value");
  estimate.u = NumberOrInfinity(Field(field, "u"), name + ".u");
  if (const auto interval = field.find("interval95"); interval != field.end()) {
    if (!interval->is_array() || interval->size() != 2) {
      WrongField(name + ".interval95", "[low, high]");
    }
    estimate.interval95 =
        core::Interval{NumberOrInfinity((*interval)[0], name),
                       NumberOrInfinity((*interval)[1], name)};
  }
  return estimate;
}

core::Estimate ReadEstimate(const Json& json) {
  // Documents that this program wrote are trusted to have the form; nlohmann's
  // own exceptions are enough where one is damaged.
  core::Estimate e{json.at("value"), json.at("u"), std::nullopt};
  if (json.contains("interval95")) {
    e.interval95 =
        core::Interval{json["interval95"].at(0), json["interval95"].at(1)};
  }
  return e;
}

Json ParsedLine(std::string_view line, std::string_view schema) {
  // The parser does not throw: its messages speak of bytes in a buffer, which
  // the user does not have.
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) {
    throw std::invalid_argument("this is not JSON");
  }
  // A line of another schema is refused before any field of it is read: fields
  // of one name may mean different things in two schemas.
  const Json& found = Field(json, "schema");
  if (found != Json(schema)) {
    throw std::invalid_argument(
        fmt::format("field 'schema' must be \"{}\"", schema));
  }
  return json;
}

std::string ReadSchema(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  // A line that is not JSON has no schema, either. The reader that takes it
  // next reports the error.
  if (!json.is_object() || !json.contains("schema")) return "";
  const Json& schema = json["schema"];
  return schema.is_string() ? schema.get<std::string>() : "";
}

}  // namespace touchdown::report
