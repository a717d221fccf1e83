#include "app/cli/command_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

namespace touchdown::cli {
namespace {

// Form and description are CLI11's own, as --help prints them, so that manual
// pages and completions cannot disagree with it.
OptionText DescribeOption(const CLI::Option& option,
                          const CLI::Formatter& formatter) {
  OptionText text;
  text.form = formatter.make_option_opts(&option);
  text.description = option.get_description();
  // A flag expects no items; an option whose value may be left out expects one
  // at most.
  text.takes_value = option.get_items_expected_max() > 0;
  if (!option.nonpositional()) {
    text.name = option.get_name(true);
    return text;
  }
  if (!option.get_lnames().empty()) text.name = "--" + option.get_lnames()[0];
  if (!option.get_snames().empty()) {
    text.short_name = "-" + option.get_snames()[0];
  }
  return text;
}

// Adds `app` and then all below it to `tree`. `above` is the path of its parent
// with a blank behind it, empty for the program.
void Describe(const CLI::App& app, const std::string& above,
              std::vector<CommandText>& tree) {
  const CLI::Formatter formatter;
  CommandText command;
  command.path = above + app.get_name();
  command.description = app.get_description();
  command.footer = app.get_footer();
  // What has no group is hidden: earlier names of options, and this program's
  // own tools.
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    // CLI11 calls an option nonpositional where it has a name with dashes.
    (option->nonpositional() ? command.options : command.positionals)
        .push_back(DescribeOption(*option, formatter));
  }
  const auto below = app.get_subcommands(
      [](const CLI::App* one) { return !one->get_group().empty(); });
  for (const CLI::App* one : below) command.commands.push_back(one->get_name());
  // The command goes in before those below it: the header promises that order.
  tree.push_back(command);
  for (const CLI::App* one : below) Describe(*one, command.path + " ", tree);
}

}  // namespace

std::vector<CommandText> DescribeCommands(const CLI::App& app) {
  std::vector<CommandText> tree;
  Describe(app, "", tree);
  return tree;
}

const CommandText& FindCommand(const std::vector<CommandText>& tree,
                               std::string_view path) {
  const auto found = std::find_if(
      tree.begin(), tree.end(),
      [&](const CommandText& command) { return command.path == path; });
  if (found == tree.end()) {
    // Only a path that a caller made up can be missing: a defect, no user's
    // error.
    throw std::logic_error("no command " + std::string(path));
  }
  return *found;
}

}  // namespace touchdown::cli
