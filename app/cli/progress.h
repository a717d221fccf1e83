// A progress bar with an estimate of the time left, on stderr and only where
// that is a terminal.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace touchdown::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar() { Finish(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void Show(double share);  // 0..1; draws at most ten times a second
  // With an estimate of one's own, nothing while there is none, and what has
  // been done in words.
  void Show(double share, std::optional<double> left_s,
            const std::string& done);
  void Finish();  // takes the bar off the screen

 private:
  bool IsTimeToDraw();

  std::string what_;
  bool terminal_ = false;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace touchdown::cli
