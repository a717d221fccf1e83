// Reads and writes touchdown.toml, and adds what it says to the command line
// before CLI11 parses it. So a default behaves in every respect as if the user
// had typed it. toml++ stays in this file.
#include "app/cli/defaults.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "app/text/text_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

// Returns the variable of the environment, "" where it is not set; an empty
// value counts as not set.
std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Returns where options end: at "--", behind which all is positional, else at
// the end of the line.
std::vector<std::string>::const_iterator FindEndOfOptions(
    const std::vector<std::string>& arguments) {
  return std::find(arguments.begin(), arguments.end(), "--");
}

// Returns whether the line has the option, as "--db lab.db" or "--db=lab.db".
bool Has(const std::vector<std::string>& arguments, const std::string& name) {
  return std::any_of(arguments.begin(), FindEndOfOptions(arguments),
                     [&](const std::string& argument) {
                       return argument == name ||
                              argument.starts_with(name + "=");
                     });
}

// Returns the command that the line calls: each word at its beginning that
// names a subcommand leads one step down. CLI11 has not parsed yet, so options
// before the command's name end the search there.
const CLI::App* CalledCommand(const std::vector<std::string>& arguments,
                              const CLI::App& app) {
  const CLI::App* at = &app;
  for (const std::string& word : arguments) {
    const auto called = at->get_subcommands(
        [&](const CLI::App* one) { return one->get_name() == word; });
    if (called.empty()) break;
    at = called.front();
  }
  return at;
}

}  // namespace

Defaults ReadDefaults(const std::filesystem::path& folder) {
  Defaults out;
  const std::filesystem::path path = folder / kDefaultsFile;
  // No file is the usual case and no error.
  if (std::filesystem::exists(path)) {
    const std::string name = path.string();
    const std::string text = report::ReadTextFile(path);
    try {
      const toml::table table = toml::parse(text, name);
      for (const auto& [key, node] : table) {
        // A key that is not known is refused: a misspelt "campain" would
        // otherwise send trials into no campaign without a word.
        std::string* to = key == "db"         ? &out.store
                          : key == "campaign" ? &out.campaign
                                              : nullptr;
        const auto* value = node.as_string();
        if (to == nullptr || value == nullptr) {
          throw core::InputError(fmt::format(
              "{}:{}: {}; expected db = \"lab.db\" and campaign = \"name\"",
              name, key.source().begin.line, key.str()));
        }
        *to = value->get();
      }
    } catch (const toml::parse_error& error) {
      throw core::InputError(fmt::format(
          "{}:{}: {}", name, error.source().begin.line, error.description()));
    }
    // A store is named as seen from the folder.
    if (!out.store.empty() && std::filesystem::path(out.store).is_relative() &&
        !folder.empty()) {
      out.store = (folder / out.store).string();
    }
  }
  const std::string store = Variable(kStoreVariable);
  // A store of the environment drops the file's campaign, too: that campaign is
  // one of the file's store.
  if (!store.empty()) out = {store, ""};
  const std::string campaign = Variable(kCampaignVariable);
  if (!campaign.empty()) out.campaign = campaign;
  return out;
}

void WriteDefaults(const Defaults& defaults,
                   const std::filesystem::path& folder) {
  toml::table table;
  // toml++ quotes the values, whatever characters a name has.
  table.insert("db", defaults.store);
  if (!defaults.campaign.empty()) table.insert("campaign", defaults.campaign);
  std::ostringstream text;
  text << table << "\n";
  report::WriteTextFile(folder / kDefaultsFile, text.str());
}

std::vector<std::string> WithDefaults(std::vector<std::string> arguments,
                                      const CLI::App& app,
                                      const std::filesystem::path& folder) {
  // `analyze` may be tried out on any clip: a default store would fill with
  // trials that nobody wanted to log.
  if (arguments.empty() || arguments.front() == "analyze") return arguments;
  // With one of these the line names its own source of trials, or only prints
  // something.
  for (const char* own : {"--db", "--trials", "--paper-table1", "--help", "-h",
                          "--details-example", "--columns"}) {
    if (Has(arguments, own)) return arguments;
  }
  const CLI::App* command = CalledCommand(arguments, app);
  // A broken file stops nobody who does not need it, and `use` mends it.
  if (command->get_option_no_throw("--db") == nullptr) return arguments;
  Defaults defaults;
  try {
    defaults = ReadDefaults(folder);
  } catch (const core::InputError&) {
    // It is one of the troubles that `doctor` finds.
    if (arguments.front() != "doctor") throw;
  }
  // Adds the option to the line where the command knows it and the user has not
  // given it; true where it was added.
  const auto add = [&](const char* option, const std::string& value) {
    if (value.empty() || Has(arguments, option) ||
        command->get_option_no_throw(option) == nullptr) {
      return false;
    }
    arguments.insert(FindEndOfOptions(arguments),
                     fmt::format("{}={}", option, value));
    return true;
  };
  // A campaign is a name in one store: it is added only together with it.
  if (add("--db", defaults.store)) add("--campaign", defaults.campaign);
  return arguments;
}

}  // namespace touchdown::cli
