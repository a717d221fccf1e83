// Flags that several commands of the store share. Each Parse... throws
// std::invalid_argument naming the flag, what was given and what is expected.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/trials/campaign_entry.h"
#include "touchdown/core/body.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/store.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

// --db FILE
void AddDbFlag(CLI::App& command, std::string& db);

// Throws std::invalid_argument where no store was given, for a command of which
// some forms need none.
void RequireDb(const std::string& db);

// The word of an enumeration, e.g. ParseWord("--state", text, ParseMotionState,
// "bounce, slide ...").
template <class T>
T ParseWord(const std::string& flag, const std::string& text,
            std::optional<T> (*parse)(std::string_view),
            const std::string& words) {
  if (const auto word = parse(text)) return *word;
  throw std::invalid_argument(flag + " is '" + text + "', must be " + words);
}

// --body, --diameter-mm and --sides-mm.
void AddBodyFlags(CLI::App& command, pipeline::BodyEntry& flags);

// --corner as typed; nothing where it was not given.
std::optional<core::Corner> ReadCorner(const std::string& corner);

// The trial of that id or beginning of an id; core::StoreError where none is.
core::Trial RequireTrial(const db::Store& store, const std::string& id);

// "sphere 40 mm", "rectangle 60 x 20 mm".
std::string BodyText(const core::Body& body);

}  // namespace touchdown::cli
