#include "app/cli/manual_pages.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/text/version.h"

namespace touchdown::cli {
namespace {

// Returns `text` escaped for troff: a dot at the beginning of a line would make
// a request of it. Hyphens become minus signs, so that options can be copied
// from the page.
std::string Roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '\n':
        out += "\n.br\n";
        break;
      case '.':
        if (out.empty() || out.back() == '\n') out += "\\&";
        out += c;
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Turns "touchdown rig plan" into "touchdown-rig-plan", the name of its page.
std::string Dashed(std::string_view path) {
  std::string name(path);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

// Adds a section with one paragraph for each option: its names in bold, its
// form, its description. Without options there is no section.
void AddOptionSection(std::string& page, std::string_view title,
                      const std::vector<OptionText>& options) {
  if (options.empty()) return;
  page += fmt::format(".SH {}\n", title);
  for (const OptionText& option : options) {
    const std::string names = option.short_name.empty() ? option.name
                              : option.name.empty()
                                  ? option.short_name
                                  : option.short_name + ", " + option.name;
    page += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", Roff(names),
                        Roff(option.form), Roff(option.description));
  }
}

// Lists the commands below this one with their descriptions and pages.
void AddCommandSection(std::string& page, const CommandText& command,
                       const std::vector<CommandText>& tree) {
  if (command.commands.empty()) return;
  page += ".SH COMMANDS\n";
  for (const std::string& name : command.commands) {
    const CommandText& below = FindCommand(tree, command.path + " " + name);
    page += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", Roff(Dashed(below.path)),
                        Roff(below.description));
  }
}

}  // namespace

std::string ManualPageName(const CommandText& command) {
  return Dashed(command.path) + ".1";
}

std::string ManualPage(const CommandText& command,
                       const std::vector<CommandText>& tree) {
  // The date in .TH stays empty: a page of the same sources has the same bytes.
  std::string page = fmt::format(
      ".TH {} 1 \"\" \"touchdown {}\" \"touchdown\"\n.SH NAME\n{} \\- {}\n"
      ".SH SYNOPSIS\n\\fB{}\\fR",
      Dashed(command.path), pipeline::Version(), Roff(Dashed(command.path)),
      Roff(command.description), Roff(command.path));
  if (!command.options.empty()) page += " [OPTIONS]";
  for (const OptionText& positional : command.positionals) {
    page += " " + Roff(positional.name);
  }
  if (!command.commands.empty()) page += " SUBCOMMAND";
  page += "\n";
  AddOptionSection(page, "ARGUMENTS", command.positionals);
  AddOptionSection(page, "OPTIONS", command.options);
  AddCommandSection(page, command, tree);
  if (!command.footer.empty()) {
    page += fmt::format(".SH NOTES\n{}\n", Roff(command.footer));
  }
  // A page refers to the command above it; the program's own has none.
  const auto above = command.path.rfind(' ');
  if (above != std::string::npos) {
    page += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n",
                        Roff(Dashed(command.path.substr(0, above))));
  }
  return page;
}

}  // namespace touchdown::cli
