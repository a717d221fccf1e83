#include "app/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "app/cli/messages.h"

namespace touchdown::cli {

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

// Progress may come for every frame, thousands a second: ten drawings a second
// are all that a person sees.
bool ProgressBar::IsTimeToDraw() {
  if (!terminal_) return false;
  const auto now = std::chrono::steady_clock::now();
  constexpr auto kRedraw = std::chrono::milliseconds(100);
  if (now - last_ < kRedraw) return false;
  last_ = now;
  return true;
}

// Takes the work to go on as fast as it did so far.
void ProgressBar::Show(double share) {
  const double gone =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_)
          .count();
  Show(share, share > 0.0 ? gone * (1.0 - share) / share : 0.0, "");
}

void ProgressBar::Show(double share, std::optional<double> left_s,
                       const std::string& done) {
  if (!IsTimeToDraw()) return;
  drawn_ = true;
  share = std::clamp(share, 0.0, 1.0);
  constexpr int kWidth = 30;
  const int full = static_cast<int>(share * kWidth);
  // The line is drawn over itself; \033[K clears what a longer one left.
  TellRaw(fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f} %  {}{}\033[K", what_, "",
                      full, "", kWidth - full, 100.0 * share, done,
                      left_s ? fmt::format("{:.0f} s left ", *left_s) : ""));
}

// Leaves an empty line to the results or messages that follow.
void ProgressBar::Finish() {
  if (!drawn_) return;
  TellRaw("\r\033[K");
  drawn_ = false;
}

}  // namespace touchdown::cli
