// Lines that a person types, or a script pipes in, while other things happen.
//
// A thread of its own reads them, so that the line `stop` acts within
// milliseconds whatever the rest of the program does.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace touchdown::cli {

struct TypedLine {
  std::string text;  // without its line feed
  // When the first of its bytes was read.
  std::chrono::steady_clock::time_point began;
  // No other byte was read with it, and none waits behind it: it was not
  // pasted with others.
  bool is_alone = false;
};

class TerminalLines {
 public:
  // `on_stop`: called from the thread that reads, as soon as a line is `stop`;
  // the line is handed on like all others, and those that wait before it are
  // dropped.
  explicit TerminalLines(std::function<void()> on_stop);
  ~TerminalLines();
  TerminalLines(const TerminalLines&) = delete;
  TerminalLines& operator=(const TerminalLines&) = delete;

  // Readable while there is a line, or the input has ended.
  int descriptor() const { return ready_; }
  // The next whole line, if there is one.
  std::optional<TypedLine> Next();
  // Drops the lines that wait and were begun until then: after a stop, nothing
  // that was typed before it is done.
  void DropOldLines(std::chrono::steady_clock::time_point last);
  // A question and its answer; nothing at the end of the input, or where a
  // signal came first.
  std::optional<std::string> Ask(const std::string& question);
  // The input has ended and all lines were handed out.
  bool at_end() const;

 private:
  void Read();
  void Take(const char* bytes, std::size_t size);
  bool IsFull() const;
  void Forget();

  std::function<void()> on_stop_;
  int ready_ = -1;  // an eventfd
  int end_ = -1;    // an eventfd: the thread is to end
  mutable std::mutex mutex_;
  std::condition_variable taken_;
  std::deque<TypedLine> lines_;
  std::size_t bytes_ = 0;  // of lines_
  std::string begun_;      // a line without its end
  std::chrono::steady_clock::time_point begun_at_;
  bool begun_alone_ = true;
  bool ended_ = false;
  bool closes_ = false;
  std::thread thread_;
};

}  // namespace touchdown::cli
