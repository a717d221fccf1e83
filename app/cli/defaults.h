// What need not be typed each time: the store and the campaign that a person
// works with, from touchdown.toml in the folder or from the environment.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/cli/command.h"

namespace touchdown::cli {

inline constexpr const char* kDefaultsFile = "touchdown.toml";
inline constexpr const char* kStoreVariable = "TOUCHDOWN_DB";
inline constexpr const char* kCampaignVariable = "TOUCHDOWN_CAMPAIGN";

// Empty: nobody said.
struct Defaults {
  std::string store;
  std::string campaign;
};

// From kDefaultsFile in `folder`; the environment, where it says something,
// goes before the file. Throws core::InputError naming file and line where the
// file cannot be understood.
Defaults ReadDefaults(const std::filesystem::path& folder);

// Writes them to kDefaultsFile in `folder`.
void WriteDefaults(const Defaults& defaults,
                   const std::filesystem::path& folder);

// The arguments (without the program's name) with --db and --campaign where the
// command has these options and the line names no source of trials of its own
// (--db, --trials, --paper-table1). A campaign goes with its own store only.
// `analyze` gets none: it logs nothing unless it is told to. The defaults are
// those of `folder`; they are read, and a file that cannot be understood is an
// error, only where the line needs them. `doctor` goes without them then.
std::vector<std::string> WithDefaults(std::vector<std::string> arguments,
                                      const CLI::App& app,
                                      const std::filesystem::path& folder);

// touchdown use (use_command.cc).
void AddUse(CLI::App& app, Action& action);

}  // namespace touchdown::cli
