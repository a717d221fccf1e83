// Fields of JSON documents there and back: texts, numbers, words, measured
// numbers. What says nothing else is of the lossless lines of trials and
// registers, where no bit changes.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "app/text/json.h"
#include "touchdown/core/estimate.h"

namespace touchdown::report {

// Text that is not UTF-8 becomes {"bytes": hexadecimal}.
Json TextJson(const std::string& text);
Json NumberJson(double value);  // infinities: "inf" and "-inf"
Json OptionalNumberJson(const std::optional<double>& value);
Json MeasuredJson(const core::Measured& measured);
// {"value", "u"[, "interval95"]} of a document that people read: in the unit
// that SI is multiplied with by `factor`.
Json EstimateJson(const core::Estimate& estimate, double factor = 1.0);

// The inverse. Each throws std::invalid_argument naming the field that is
// missing or wrong.
const Json& Field(const Json& json, const std::string& name);
[[noreturn]] void WrongField(const std::string& name,
                             std::string_view expected);
std::string ReadTextField(const Json& json, const std::string& name);
bool ReadFlag(const Json& json, const std::string& name);
std::int64_t ReadInteger(const Json& json, const std::string& name);
double ReadNumberField(const Json& json, const std::string& name);
std::optional<double> ReadOptionalNumber(const Json& json,
                                         const std::string& name);
core::Measured ReadMeasured(const Json& json, const std::string& name);
// The inverse of EstimateJson; throws as nlohmann::json does.
core::Estimate ReadEstimate(const Json& json);

template <class T>
T ReadWord(const Json& json, const std::string& name,
           std::optional<T> (*parse)(std::string_view)) {
  const Json& field = Field(json, name);
  const auto word =
      field.is_string() ? parse(field.get<std::string>()) : std::optional<T>();
  if (!word) WrongField(name, "one of the words of the field");
  return *word;
}

// The document of a line, of which `schema` says what it is.
Json ParsedLine(std::string_view line, std::string_view schema);
// What a line says it is; empty where it says nothing.
std::string ReadSchema(std::string_view line);

}  // namespace touchdown::report
