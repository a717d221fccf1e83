// Lines that a person types, or a script pipes in, while other things happen.
#pragma once

#include <optional>
#include <string>

namespace touchdown::cli {

class TerminalLines {
 public:
  static constexpr int kDescriptor = 0;  // stdin

  // Reads what is there; waits where there is nothing. After a descriptor has
  // been found readable it does not wait. False at the end of the input.
  bool Read();
  // The next whole line that was read, without its line feed.
  std::optional<std::string> Next();
  // A question and its answer; nothing at the end of the input, or where a
  // signal came first.
  std::optional<std::string> Ask(const std::string& question);

  bool at_end() const { return at_end_; }

 private:
  std::string read_;
  bool at_end_ = false;
};

}  // namespace touchdown::cli
