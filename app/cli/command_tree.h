// The tree of commands as --help tells it, for who writes it down elsewhere:
// manual pages (manual_pages.h), completion in shells (completions.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

struct OptionText {
  std::string name;        // "--db", or "CLIP" of a positional
  std::string short_name;  // "-h"; mostly empty
  std::string form;        // " TEXT REQUIRED", as --help has it
  std::string description;
  bool takes_value = false;
};

struct CommandText {
  std::string path;  // "touchdown rig plan"
  std::string description;
  std::string footer;
  std::vector<OptionText> positionals;
  std::vector<OptionText> options;
  std::vector<std::string> commands;  // the names below it
};

// Every command, the program itself first, each before those below it.
std::vector<CommandText> DescribeCommands(const CLI::App& app);

// Of `tree`, the one of that path.
const CommandText& FindCommand(const std::vector<CommandText>& tree,
                               std::string_view path);

}  // namespace touchdown::cli
