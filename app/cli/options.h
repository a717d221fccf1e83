// Commands with their options and flags. CLI11 is a library of headers alone:
// each source that includes it compiles its parser and its templates again. It
// is included by options.cc alone, but for the sources that parse or describe
// the whole command line.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/cli/command.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class Option;
}

namespace touchdown::cli {

// An option or a flag of a command. Each function that says more of it returns
// it again.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option Require(bool required = true) const;
  // In the help, as the value that it has now.
  Option ShowDefault() const;
  // The name of its value in the help.
  Option NameType(const std::string& name) const;
  Option OneOf(const std::vector<std::string>& words) const;
  Option Between(int least, int most) const;
  Option SplitAtCommas() const;
  Option AllowNoValue() const;
  // Of a list: each value has the option's name before it.
  Option OneAtATime() const;
  // Not in the help.
  Option Hide() const;
  // Not both.
  Option Exclude(const Option& other) const;
  // On the command line that was parsed.
  bool IsGiven() const;

 private:
  CLI::Option* option_;
};

// A command below `parent`, which keeps it.
CLI::App* AddCommand(CLI::App& parent, const std::string& name,
                     const std::string& about);

// An option with a value: "--name", or "NAME" of a positional one. Value:
// std::string, double, a whole number, one of these that may be absent, or a
// list (options.cc has them all).
template <class Value>
Option AddOption(CLI::App& command, const std::string& name, Value& value,
                 const std::string& about);

// Without a value; false where it is not given.
Option AddFlag(CLI::App& command, const std::string& name, bool& value,
               const std::string& about);

// `action` becomes `run` where `command` is the one called.
void SetAction(CLI::App& command, Action& action, Action run);

// One of the commands below must be given.
void RequireSubcommand(CLI::App& command);

// Not in the help.
void Hide(CLI::App& command);

// What was given of a command's options, in the order of its help.
struct GivenOption {
  std::string name;  // "--name", or "NAME" of a positional one
  std::vector<std::string> values;
  bool is_flag = false;  // without a value
};
std::vector<GivenOption> ListGiven(const CLI::App& command);

}  // namespace touchdown::cli
