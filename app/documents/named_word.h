// A word of a document that is the name of a value.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "app/text/json.h"

namespace touchdown::pipeline {

// The one of `values` whose Name() the word is. Throws std::invalid_argument
// where it is another word: a fact of unknown source is none.
template <class T, std::size_t N>
T ReadNamed(const report::Json& json, const T (&values)[N]) {
  const auto word = json.get<std::string>();
  std::string known;
  for (const T value : values) {
    if (Name(value) == word) return value;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", Name(value));
  }
  throw std::invalid_argument(
      fmt::format("'{}' is unknown, must be one of {}", word, known));
}

}  // namespace touchdown::pipeline
