// One thread (Read) takes bytes from stdin and makes lines of them; the thread
// of the command takes lines out with Next(). mutex_ guards all that both
// touch. ready_ can be read exactly while a line waits or the input has ended,
// so that the command can wait for it together with other things; end_ wakes
// the thread at the end.
#include "app/cli/terminal_lines.h"

#include <fmt/core.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <utility>

#include "touchdown/core/blocked_signals.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

using Clock = std::chrono::steady_clock;

// A script that is piped in waits when this much of it is not obeyed yet: more
// than a person types in a day.
constexpr std::size_t kMostWaiting_bytes = 1 << 20;

// Makes the eventfd readable.
void Signal(int event) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(event, &one, sizeof one);
}

// Makes it unreadable again; it counts, so one read takes all signals.
void Clear(int event) {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto read_bytes = read(event, &count, sizeof count);
}

// Returns whether the line is `stop`, whatever blanks are around it.
bool IsStop(std::string_view line) {
  const auto begin = line.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return false;
  const auto end = line.find_last_not_of(" \t\r") + 1;
  return line.substr(begin, end - begin) == "stop";
}

}  // namespace

TerminalLines::TerminalLines(std::function<void()> on_stop)
    : on_stop_(std::move(on_stop)),
      ready_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      end_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (ready_ < 0 || end_ < 0) {
    throw core::InputError("no eventfd is left; close other programs");
  }
  // The reader must get no signals: they are to end the waiting of the thread
  // that runs the command.
  const core::BlockedSignals blocked;
  thread_ = std::thread([this] { Read(); });
}

TerminalLines::~TerminalLines() {
  {
    const std::lock_guard lock(mutex_);
    closes_ = true;
  }
  Signal(end_);
  taken_.notify_all();
  thread_.join();
  close(ready_);
  close(end_);
}

// Counts the bytes of waiting lines and of the one that is begun.
bool TerminalLines::IsFull() const {
  return bytes_ + begun_.size() > kMostWaiting_bytes;
}

// The reader's thread runs this until the input ends, or the object does.
void TerminalLines::Read() {
  std::array<char, 4096> bytes{};
  while (true) {
    std::array<pollfd, 2> ends{pollfd{STDIN_FILENO, POLLIN, 0},
                               pollfd{end_, POLLIN, 0}};
    if (poll(ends.data(), ends.size(), -1) < 0) continue;
    if (ends[1].revents != 0) return;
    // Where poll() was woken for another reason there may be nothing to read.
    const ssize_t n = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n > 0) {
      Take(bytes.data(), static_cast<std::size_t>(n));
      std::unique_lock lock(mutex_);
      // A script that is faster than the session waits here, and so does its
      // pipe.
      taken_.wait(lock, [this] { return closes_ || !IsFull(); });
      continue;
    }
    // The end of the input makes ready_ readable for good.
    const std::lock_guard lock(mutex_);
    ended_ = true;
    Signal(ready_);
    return;
  }
}

// Makes lines of the bytes of one read. A line is alone where this read held
// nothing else, before it or behind it.
void TerminalLines::Take(const char* bytes, std::size_t size) {
  const auto now = Clock::now();
  std::unique_lock lock(mutex_);
  std::size_t whole = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (begun_.empty()) {
      begun_at_ = now;
      begun_alone_ = whole == 0;
    }
    if (bytes[i] != '\n') {
      // No line of a person is so long: the rest of it is dropped.
      if (begun_.size() < kMostWaiting_bytes) begun_ += bytes[i];
      continue;
    }
    ++whole;
    // `stop` acts here and now, in this thread: the command may be busy for
    // seconds. Lines that wait before it are dropped, since nothing that was
    // typed before a stop may be done after it.
    const bool is_stop = IsStop(begun_);
    if (is_stop) Forget();
    bytes_ += begun_.size() + 1;
    lines_.push_back({std::exchange(begun_, {}), begun_at_,
                      begun_alone_ && whole == 1 && i + 1 == size});
    if (is_stop && on_stop_) {
      // The lock is given up: what is called might need this object.
      lock.unlock();
      on_stop_();
      lock.lock();
    }
  }
  if (whole > 0) Signal(ready_);
}

// Drops the lines that wait. mutex_ is held by the caller.
void TerminalLines::Forget() {
  lines_.clear();
  bytes_ = 0;
}

void TerminalLines::DropOldLines(Clock::time_point last) {
  const std::lock_guard lock(mutex_);
  while (!lines_.empty() && lines_.front().began <= last) {
    bytes_ -= lines_.front().text.size() + 1;
    lines_.pop_front();
  }
  // ready_ must not be readable without a line, or the caller would spin.
  if (lines_.empty() && !ended_) Clear(ready_);
  taken_.notify_all();
}

std::optional<TypedLine> TerminalLines::Next() {
  const std::lock_guard lock(mutex_);
  if (lines_.empty()) return std::nullopt;
  TypedLine line = std::move(lines_.front());
  lines_.pop_front();
  bytes_ -= line.text.size() + 1;
  // What came behind it meanwhile counts, too: it may have been pasted slowly.
  if (!lines_.empty() || !begun_.empty()) line.is_alone = false;
  if (lines_.empty() && !ended_) Clear(ready_);
  taken_.notify_all();
  return line;
}

bool TerminalLines::at_end() const {
  const std::lock_guard lock(mutex_);
  return ended_ && lines_.empty();
}

std::optional<std::string> TerminalLines::Ask(const std::string& question) {
  fmt::print("{} ", question);
  std::fflush(stdout);
  while (true) {
    if (auto line = Next()) return std::move(line->text);
    if (at_end()) return std::nullopt;
    pollfd ready{ready_, POLLIN, 0};
    if (poll(&ready, 1, -1) < 0) return std::nullopt;  // a signal
  }
}

}  // namespace touchdown::cli
