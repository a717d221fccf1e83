// A controller whose line loses, delays, garbles and repeats what it answers,
// at random, in real time; and a record of when its springs were latched. What
// README asks of a controller it does, the heartbeat too.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/pseudo_terminal.h"
#include "touchdown/rig/driver/line_protocol.h"

namespace touchdown::session {

// Chances, of one answer each.
struct LineTrouble {
  double lost_request = 0.08;
  double lost = 0.12;
  double delayed = 0.12;
  double garbled = 0.10;
  double halved = 0.05;
  double repeated = 0.10;
  double empty = 0.04;
  double refused = 0.04;
  std::chrono::milliseconds longest_delay{1500};
};

class UnreliableController {
 public:
  using Clock = std::chrono::steady_clock;
  using Instant = Clock::time_point;
  struct Latched {
    Instant from;
    std::optional<Instant> to;  // nothing: it is latched now
  };

  UnreliableController(std::uint64_t seed, LineTrouble trouble)
      : random_(seed), trouble_(trouble) {
    end_ = eventfd(0, EFD_CLOEXEC);
    thread_ = std::thread([this] { Run(); });
  }
  ~UnreliableController() {
    const std::uint64_t one = 1;
    if (write(end_, &one, sizeof one) != sizeof one) std::abort();
    thread_.join();
    close(end_);
  }
  UnreliableController(const UnreliableController&) = delete;
  UnreliableController& operator=(const UnreliableController&) = delete;

  const std::string& port() const { return line_.port(); }
  void LatchByHand() {
    const std::lock_guard lock(mutex_);
    // Whoever comes now is heard from now on.
    heard_at_ = Clock::now();
    SetLatched(true);
  }
  // False where that takes longer than any limit of the protocol.
  bool BecomesDisarmed() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [this] { return !IsLatched(); });
  }
  // Waits until stop and disarm have come; what was sent before a program ended
  // may still be read.
  bool HearsFarewell() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [this] { return stops_ > 0 && farewells_ > 0; });
  }
  std::vector<Latched> latched() const {
    const std::lock_guard lock(mutex_);
    return latched_;
  }
  std::int64_t shots() const {
    const std::lock_guard lock(mutex_);
    return shots_;
  }

 private:
  struct Later {
    Instant at;
    std::string bytes;
  };

  bool IsLatched() const { return !latched_.empty() && !latched_.back().to; }
  void SetLatched(bool latched) {
    if (latched == IsLatched()) return;
    if (latched) {
      latched_.push_back({Clock::now(), std::nullopt});
    } else {
      latched_.back().to = Clock::now();
    }
    changed_.notify_all();
  }
  bool Happens(double chance) {
    return std::uniform_real_distribution<>(0.0, 1.0)(random_) < chance;
  }

  void Run() {
    // A fifth of a second to spare.
    constexpr std::chrono::milliseconds kWatch{1800};
    std::string line;
    while (true) {
      Instant next = Clock::now() + std::chrono::hours(1);
      {
        const std::lock_guard lock(mutex_);
        for (const Later& later : later_) next = std::min(next, later.at);
        if (IsLatched()) next = std::min(next, heard_at_ + kWatch);
      }
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now());
      // Short, for a latching by hand that comes meanwhile.
      constexpr std::int64_t kLook_ms = 100;
      std::array<pollfd, 2> ends{pollfd{line_.master(), POLLIN, 0},
                                 pollfd{end_, POLLIN, 0}};
      poll(ends.data(), ends.size(),
           static_cast<int>(
               std::clamp<std::int64_t>(left.count(), 0, kLook_ms)));
      if (ends[1].revents != 0) return;
      {
        const std::lock_guard lock(mutex_);
        if (IsLatched() && Clock::now() >= heard_at_ + kWatch) {
          SetLatched(false);
        }
        const auto now = Clock::now();
        for (const Later& later : later_) {
          if (later.at <= now) Say(later.bytes);
        }
        std::erase_if(later_, [&](const Later& one) { return one.at <= now; });
      }
      if ((ends[0].revents & POLLIN) == 0) continue;
      std::array<char, 256> bytes{};
      const ssize_t n = read(line_.master(), bytes.data(), bytes.size());
      if (n <= 0) return;
      const std::lock_guard lock(mutex_);
      for (ssize_t i = 0; i < n; ++i) {
        const char c = bytes[static_cast<std::size_t>(i)];
        if (c == rig::kStopByte) {
          line.clear();
          stopped_ = true;
          ++stops_;
          SetLatched(false);
          changed_.notify_all();
        } else if (c != '\n') {
          line += c;
        } else {
          const auto request = rig::ParseRequest(line);
          line.clear();
          if (request) Handle(*request);
        }
      }
    }
  }

  void Handle(const rig::Request& request) {
    // The farewell is one write with the stop bytes: it arrives with them.
    const bool is_farewell = request.number == rig::kAlwaysNew;
    if (!is_farewell && Happens(trouble_.lost_request)) return;
    heard_at_ = Clock::now();
    rig::Answer answer = Done(request);
    if (is_farewell) {
      ++farewells_;
      changed_.notify_all();
    }
    if (Happens(trouble_.lost)) return;
    if (Happens(trouble_.empty)) answer.text.clear();
    std::string bytes = FormatLine(answer);
    if (Happens(trouble_.garbled)) {
      const std::size_t at = random_() % bytes.size();
      bytes[at] = static_cast<char>(random_());
    }
    if (Happens(trouble_.halved)) bytes.resize(bytes.size() / 2);
    if (Happens(trouble_.repeated)) {
      later_.push_back({Clock::now() + Delay(), bytes});
    }
    if (Happens(trouble_.delayed)) {
      later_.push_back({Clock::now() + Delay(), bytes});
    } else {
      Say(bytes);
    }
  }
  std::chrono::milliseconds Delay() {
    return std::chrono::milliseconds(
        random_() %
        static_cast<std::uint64_t>(trouble_.longest_delay.count() + 1));
  }

  rig::Answer Done(const rig::Request& request) {
    if (last_ && last_->number == request.number &&
        request.number != rig::kAlwaysNew) {
      return *last_;
    }
    rig::Answer answer{request.number, true, request.verb, ""};
    const auto refuse = [&](const char* why) {
      answer.ok = false;
      answer.text = why;
    };
    const std::string& verb = request.verb;
    const bool moves = verb == "angle" || verb == "compress" || verb == "arm" ||
                       verb == "fire";
    if (moves && stopped_) {
      refuse("stopped");
    } else if (moves && Happens(trouble_.refused)) {
      refuse("worn");
    } else if (verb == "hello") {
      answer.text = "touchdown-rig/2 unreliable";
    } else if (verb == "angle" || verb == "compress") {
      (verb == "angle" ? angle_ : compress_) = request.argument;
      SetLatched(false);
      answer.text = request.argument;
    } else if (verb == "interlock") {
      answer.text = "closed";
    } else if (verb == "arm") {
      SetLatched(true);
      answer.text = "T" + std::to_string(++tokens_);
    } else if (verb == "disarm") {
      SetLatched(false);
    } else if (verb == "fire") {
      if (!IsLatched() || request.argument != "T" + std::to_string(tokens_)) {
        refuse("not armed");
      } else {
        SetLatched(false);
        answer.text = "shots=" + std::to_string(++shots_);
      }
    } else if (verb == "reset") {
      stopped_ = false;
    } else if (verb == "status") {
      answer.text = "angle=" + angle_ + " compress=" + compress_ +
                    " moving=0 armed=" + (IsLatched() ? "1" : "0") +
                    " stopped=" + (stopped_ ? "1" : "0") +
                    " shots=" + std::to_string(shots_);
    } else {
      refuse("unknown");
    }
    last_ = answer;
    return answer;
  }

  void Say(const std::string& bytes) {
    // Never more than a terminal holds: nobody may read any more.
    pollfd room{line_.master(), POLLOUT, 0};
    if (poll(&room, 1, 0) != 1) return;
    [[maybe_unused]] const auto n =
        write(line_.master(), bytes.data(), bytes.size());
  }

  testing::PseudoTerminal line_;
  int end_ = -1;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::mt19937_64 random_;
  LineTrouble trouble_;
  std::vector<Later> later_;
  std::vector<Latched> latched_;
  std::optional<rig::Answer> last_;
  Instant heard_at_ = Clock::now();
  std::string angle_ = "0", compress_ = "0";
  std::int64_t shots_ = 0, tokens_ = 0;
  int stops_ = 0, farewells_ = 0;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace touchdown::session
