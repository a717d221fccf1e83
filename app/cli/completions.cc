#include "app/cli/completions.h"

#include <fmt/format.h>

#include <string_view>

namespace touchdown::cli {
namespace {

// In single quotes, for any of the three shells.
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

// A colon ends the name before a description of zsh's.
std::string WithoutColons(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == ':') out += '\\';
    out += c;
  }
  return out;
}

// Every word that may stand behind a command, with what it is.
struct Completion {
  std::string name;
  std::string description;
};
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

// Finds in `before`, the words before the cursor, the command that they name.
constexpr std::string_view kFindPath = R"(  local at=touchdown word
  for word in "${before[@]:1}"; do
    case " $commands " in
      *" $at/$word "*) at=$at/$word ;;
    esac
  done
)";

std::string Slashed(std::string path) {
  for (char& c : path) {
    if (c == ' ') c = '/';
  }
  return path;
}

std::string AllPaths(const std::vector<CommandText>& tree) {
  std::string all;
  for (const CommandText& command : tree) all += " " + Slashed(command.path);
  return all.substr(1);
}

}  // namespace

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
      if (option.takes_value) out += " -r";
      out += fmt::format(" -d {}\n", Quoted(option.description));
    }
  }
  return out;
}

}  // namespace touchdown::cli
