// Completion scripts for three shells, written when the program is built: the
// scripts hold the whole tree of commands and never start the program. In them
// a command is a path with slashes, "touchdown/rig/plan", which is one word for
// every shell.
#include "app/cli/completions.h"

#include <fmt/format.h>

#include <string_view>

namespace touchdown::cli {
namespace {

// Returns `text` in single quotes, which bash, zsh and fish read alike. A line
// feed would end the entry of a list: it becomes a blank.
std::string Quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else if (c == '\n') {
      out += ' ';
    } else {
      out += c;
    }
  }
  return out + "'";
}

// zsh ends the name of a completion at the first colon, where its description
// begins: colons of a name are escaped.
std::string WithoutColons(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == ':') out += '\\';
    out += c;
  }
  return out;
}

// Holds a word that may stand behind a command, and the text that zsh shows
// with it.
struct Completion {
  std::string name;
  std::string description;
};
// Lists the subcommands first, then the options with their short names.
// Positional arguments are left out: the shell completes file names there.
std::vector<Completion> ListCompletions(const CommandText& command,
                                        const std::vector<CommandText>& tree) {
  std::vector<Completion> words;
  for (const std::string& name : command.commands) {
    words.push_back(
        {name, FindCommand(tree, command.path + " " + name).description});
  }
  for (const OptionText& option : command.options) {
    for (const std::string& name : {option.name, option.short_name}) {
      if (!name.empty()) words.push_back({name, option.description});
    }
  }
  return words;
}

// This shell code is the same in bash and zsh. From the words before the cursor
// (`before`) it finds the path of the command, in `at`. Words that lead to no
// command, such as options and their values, are passed over.
constexpr std::string_view kFindPath = R"(  local at=touchdown word
  for word in "${before[@]:1}"; do
    case " $commands " in
      *" $at/$word "*) at=$at/$word ;;
    esac
  done
)";

// Turns "touchdown rig plan" into "touchdown/rig/plan".
std::string Slashed(std::string path) {
  for (char& c : path) {
    if (c == ' ') c = '/';
  }
  return path;
}

// Returns every path with slashes, separated by blanks, for the lookup of
// kFindPath.
std::string AllPaths(const std::vector<CommandText>& tree) {
  std::string all;
  for (const CommandText& command : tree) all += " " + Slashed(command.path);
  return all.substr(1);
}

}  // namespace

// One `case` branch for each command sets the words that may follow. "-o
// default" falls back to file names where none of them fits.
std::string BashCompletion(const std::vector<CommandText>& tree) {
  std::string out = fmt::format(
      "# bash completion of touchdown\n"
      "_touchdown() {{\n  local commands={}\n"
      "  local before=(\"${{COMP_WORDS[@]:0:COMP_CWORD}}\")\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} known=\n{}"
      "  case $at in\n",
      Quoted(AllPaths(tree)), kFindPath);
  for (const CommandText& command : tree) {
    std::string names;
    for (const Completion& word : ListCompletions(command, tree)) {
      names += " " + word.name;
    }
    out += fmt::format("    {}) known={} ;;\n", Slashed(command.path),
                       Quoted(names.empty() ? names : names.substr(1)));
  }
  out +=
      "  esac\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$known\" -- \"$current\")\n"
      "}\n"
      "complete -o default -F _touchdown touchdown\n";
  return out;
}

// As in bash, but each word bears its description; file names are offered as
// well unless the word begins with a dash.
std::string ZshCompletion(const std::vector<CommandText>& tree) {
  std::string out = fmt::format(
      "#compdef touchdown\n"
      "# zsh completion of touchdown\n"
      "_touchdown() {{\n  local commands={}\n  local -a known\n"
      "  local -a before=(\"${{words[@]:0:CURRENT-1}}\")\n{}"
      "  case $at in\n",
      Quoted(AllPaths(tree)), kFindPath);
  for (const CommandText& command : tree) {
    out += fmt::format("    {}) known=(\n", Slashed(command.path));
    for (const Completion& word : ListCompletions(command, tree)) {
      out += fmt::format("      {}\n", Quoted(WithoutColons(word.name) + ":" +
                                              word.description));
    }
    out += "    ) ;;\n";
  }
  out +=
      "  esac\n"
      "  _describe touchdown known\n"
      "  [[ ${words[CURRENT]} == -* ]] || _files\n"
      "}\n"
      "_touchdown \"$@\"\n";
  return out;
}

// fish wants one line for each completion, with a condition: __touchdown_at
// tells whether the words so far name exactly that command.
std::string FishCompletion(const std::vector<CommandText>& tree) {
  std::string out = fmt::format(
      "# fish completion of touchdown\n"
      "function __touchdown_at\n"
      "  set -l at touchdown\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    if contains -- $at/$word {}\n"
      "      set at $at/$word\n    end\n  end\n"
      "  test $at = $argv[1]\nend\n",
      AllPaths(tree));
  for (const CommandText& command : tree) {
    const std::string here = fmt::format(
        "complete -c touchdown -n '__touchdown_at {}'", Slashed(command.path));
    for (const std::string& name : command.commands) {
      out += fmt::format(
          "{} -a {} -d {}\n", here, name,
          Quoted(FindCommand(tree, command.path + " " + name).description));
    }
    for (const OptionText& option : command.options) {
      out += here;
      if (!option.name.empty()) out += " -l " + option.name.substr(2);
      if (!option.short_name.empty())
        out += " -s " + option.short_name.substr(1);
      // -r: the option needs an argument, for which fish offers files.
      if (option.takes_value) out += " -r";
      out += fmt::format(" -d {}\n", Quoted(option.description));
    }
  }
  return out;
}

}  // namespace touchdown::cli
