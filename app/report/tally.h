// The distinct values of one thing among trials, and how many have each.
#pragma once

#include <fmt/core.h>

#include <map>
#include <string>

namespace touchdown::report {

class Tally {
 public:
  void Add(const std::string& value) {
    if (!value.empty()) ++count_[value];
  }
  // "0.1.0 (9 trials); 0.2.0 (1 trial)"; empty where nothing was added.
  std::string Text() const {
    // Beyond these the text would say less than "many".
    constexpr std::size_t kMost = 6;
    if (count_.size() > kMost) {
      return fmt::format("{} different ones", count_.size());
    }
    std::string out;
    for (const auto& [value, n] : count_) {
      out += fmt::format("{}{} ({} trial{})", out.empty() ? "" : "; ", value, n,
                         n == 1 ? "" : "s");
    }
    return out;
  }

 private:
  std::map<std::string, int> count_;
};

}  // namespace touchdown::report
