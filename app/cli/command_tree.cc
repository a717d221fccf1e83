#include "app/cli/command_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

namespace touchdown::cli {
namespace {

OptionText DescribeOption(const CLI::Option& option,
                          const CLI::Formatter& formatter) {
  OptionText text;
  text.form = formatter.make_option_opts(&option);
  text.description = option.get_description();
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

void Describe(const CLI::App& app, const std::string& above,
              std::vector<CommandText>& tree) {
  const CLI::Formatter formatter;
  CommandText command;
  command.path = above + app.get_name();
  command.description = app.get_description();
  command.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    (option->nonpositional() ? command.options : command.positionals)
        .push_back(DescribeOption(*option, formatter));
  }
  // What has no group is hidden: this program's own tools.
  const auto below = app.get_subcommands(
      [](const CLI::App* one) { return !one->get_group().empty(); });
  for (const CLI::App* one : below) command.commands.push_back(one->get_name());
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
    throw std::logic_error("no command " + std::string(path));
  }
  return *found;
}

}  // namespace touchdown::cli
