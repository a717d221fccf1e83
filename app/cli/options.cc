// Each function passes on to the one of CLI11 that does it. The names differ
// where CLI11's do not tell what the user will see.
#include "app/cli/options.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <utility>

namespace touchdown::cli {

Option Option::Require(bool required) const {
  return Option(option_->required(required));
}

Option Option::ShowDefault() const {
  return Option(option_->capture_default_str());
}

Option Option::NameType(const std::string& name) const {
  return Option(option_->type_name(name));
}

// CLI11 checks while it parses, so that its message names the option.
Option Option::OneOf(const std::vector<std::string>& words) const {
  return Option(option_->check(CLI::IsMember(words)));
}

Option Option::Between(int least, int most) const {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Option::SplitAtCommas() const { return Option(option_->delimiter(',')); }

Option Option::AllowNoValue() const { return Option(option_->expected(0, 1)); }

// Otherwise a list takes all words that follow it, the next positional too.
Option Option::OneAtATime() const {
  return Option(option_->allow_extra_args(false));
}

Option Option::Hide() const { return Option(option_->group("")); }

Option Option::Exclude(const Option& other) const {
  return Option(option_->excludes(other.option_));
}

bool Option::IsGiven() const { return option_->count() > 0; }

CLI::App* AddCommand(CLI::App& parent, const std::string& name,
                     const std::string& about) {
  return parent.add_subcommand(name, about);
}

template <class Value>
Option AddOption(CLI::App& command, const std::string& name, Value& value,
                 const std::string& about) {
  return Option(command.add_option(name, value, about));
}

// The template is defined here only; other sources link to these. A type that
// is missing from the list is an error of the linker.
#define TOUCHDOWN_OPTION_OF(...)                                         \
  template Option AddOption(CLI::App&, const std::string&, __VA_ARGS__&, \
                            const std::string&)
TOUCHDOWN_OPTION_OF(std::string);
TOUCHDOWN_OPTION_OF(double);
TOUCHDOWN_OPTION_OF(int);
TOUCHDOWN_OPTION_OF(std::int64_t);
TOUCHDOWN_OPTION_OF(std::uint64_t);
TOUCHDOWN_OPTION_OF(std::optional<std::string>);
TOUCHDOWN_OPTION_OF(std::optional<double>);
TOUCHDOWN_OPTION_OF(std::optional<int>);
TOUCHDOWN_OPTION_OF(std::optional<std::int64_t>);
TOUCHDOWN_OPTION_OF(std::vector<std::string>);
TOUCHDOWN_OPTION_OF(std::vector<double>);
#undef TOUCHDOWN_OPTION_OF

Option AddFlag(CLI::App& command, const std::string& name, bool& value,
               const std::string& about) {
  return Option(command.add_flag(name, value, about));
}

// CLI11 calls this back while it parses. Nothing is run there: main runs the
// action when the whole line is known to be right.
void SetAction(CLI::App& command, Action& action, Action run) {
  command.callback(
      [&action, run = std::move(run)]() mutable { action = std::move(run); });
}

void RequireSubcommand(CLI::App& command) { command.require_subcommand(1); }

void Hide(CLI::App& command) { command.group(""); }

std::vector<GivenOption> ListGiven(const CLI::App& command) {
  std::vector<GivenOption> given;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    // The first long name, whichever name was typed: "-h" is listed as
    // "--help".
    const auto& names = option->get_lnames();
    given.push_back({names.empty() ? option->get_name() : "--" + names.front(),
                     option->results(), option->get_items_expected_max() == 0});
  }
  return given;
}

}  // namespace touchdown::cli
