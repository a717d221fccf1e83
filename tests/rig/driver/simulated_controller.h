// The rig's controller on the other end of a pseudo-terminal, well behaved or
// not, and a clock that runs only where it stays silent.
//
// Its heartbeat is a matter of real time and off unless Watch() asks for it.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/pseudo_terminal.h"
#include "touchdown/rig/driver/line_protocol.h"
#include "touchdown/rig/driver/serial_line.h"

namespace touchdown::rig {

// What the controller makes of one request.
enum class Act {
  kAnswer,
  kSilence,    // does it and says nothing
  kDeafness,   // does nothing and says nothing
  kGarbage,    // bytes that are no line
  kHalf,       // the first half of the answer
  kDamaged,    // an answer with one bit turned over
  kLate,       // the answer when the next request comes, before that one's
  kWrongEcho,  // "ok", with another value
  kEmpty,      // "ok", with none
  kRefusal,    // "no", and does nothing
  kHangUp
};

class SimulatedController {
 public:
  SimulatedController() {
    end_ = eventfd(0, EFD_CLOEXEC);
    silence_ = eventfd(0, EFD_NONBLOCK | EFD_SEMAPHORE | EFD_CLOEXEC);
    thread_ = std::thread([this] { Run(); });
  }
  ~SimulatedController() {
    StopListening();
    close(end_);
    close(silence_);
  }
  SimulatedController(const SimulatedController&) = delete;
  SimulatedController& operator=(const SimulatedController&) = delete;

  const std::string& port() const { return line_.port(); }
  int master() const { return line_.master(); }

  // What becomes of the next requests with `verb`; afterwards it behaves.
  void Script(const std::string& verb, std::deque<Act> acts) {
    const std::lock_guard lock(mutex_);
    script_[verb] = std::move(acts);
  }
  // Called as soon as a request with `verb` has come, before it is answered.
  void When(const std::string& verb, std::function<void()> what) {
    const std::lock_guard lock(mutex_);
    when_[verb] = std::move(what);
  }
  void OpenInterlock(bool open = true) {
    const std::lock_guard lock(mutex_);
    interlock_open_ = open;
    if (open) armed_ = false;
  }
  // How often a movement is looked at before it has ended; where it sticks.
  void Moves(int looks, std::int64_t stuck_angle = -1) {
    const std::lock_guard lock(mutex_);
    looks_ = looks;
    stuck_angle_ = stuck_angle;
  }

  std::int64_t shots() const { return Locked(shots_); }
  bool armed() const { return Locked(armed_); }
  bool stopped() const { return Locked(stopped_); }
  int stop_bytes() const { return Locked(stop_bytes_); }
  // Disarms after the longest silence, as a controller must.
  void Watch() {
    const std::lock_guard lock(mutex_);
    watches_ = true;
  }
  // Somebody else latched it, before any program came.
  void LatchByHand() {
    const std::lock_guard lock(mutex_);
    armed_ = true;
  }
  // The mushroom button.
  void PressButton() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    armed_ = false;
  }
  void Unstop() {
    const std::lock_guard lock(mutex_);
    stopped_ = false;
  }
  // Whatever it is told from now on, its springs stay latched; it says so.
  void StickLatch(bool sticks = true) {
    const std::lock_guard lock(mutex_);
    stuck_latch_ = sticks;
  }
  bool BecomesDisarmed() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [this] { return !armed_; });
  }
  int silences() const { return Locked(silences_); }
  // Bytes that a program of its own has sent may still be on their way.
  bool BecomesStopped() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [this] { return stopped_; });
  }
  // Verbs in the order in which they came, repetitions too.
  std::vector<std::string> heard() const { return Locked(heard_); }
  long HowOften(const std::string& verb) const {
    long n = 0;
    for (const auto& one : heard()) n += one == verb ? 1 : 0;
    return n;
  }

  // Waits until `verb` has come so often.
  bool Hears(const std::string& verb, long times) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] {
      return std::count(heard_.begin(), heard_.end(), verb) >= times;
    });
  }

  void StopListening() {
    if (!thread_.joinable()) return;
    const std::uint64_t one = 1;
    if (write(end_, &one, sizeof one) != sizeof one) std::abort();
    thread_.join();
  }

  // Time that stands still while the controller has something to say.
  SerialTime Time() {
    SerialTime time;
    time.now = [this] { return now_; };
    time.wait = [this](int port, int wake, std::chrono::milliseconds longest) {
      std::array<pollfd, 3> ends{pollfd{port, POLLIN, 0},
                                 pollfd{wake, POLLIN, 0},
                                 pollfd{silence_, POLLIN, 0}};
      // Nothing is on its way where the port is not listened to. Else a limit
      // that only a broken test reaches.
      constexpr int kHang_ms = 20'000;
      if (poll(ends.data(), ends.size(), port < 0 ? 0 : kHang_ms) < 0) return;
      if (ends[0].revents != 0 || ends[1].revents != 0) return;
      std::uint64_t count = 0;
      if (port >= 0 && read(silence_, &count, sizeof count) < 0) {
        throw std::runtime_error("the simulated controller hangs");
      }
      now_ += longest;
    };
    return time;
  }

 private:
  template <class T>
  T Locked(const T& member) const {
    const std::lock_guard lock(mutex_);
    return member;
  }

  void Run() {
    std::string line;
    while (true) {
      std::array<pollfd, 2> ends{pollfd{line_.master(), POLLIN, 0},
                                 pollfd{end_, POLLIN, 0}};
      if (poll(ends.data(), ends.size(), UntilSilent_ms()) == 0) {
        const std::lock_guard lock(mutex_);
        armed_ = false;
        compress_ = 0;
        silent_since_.reset();
        ++silences_;
        changed_.notify_all();
        continue;
      }
      if (ends[1].revents != 0) return;
      std::array<char, 256> bytes{};
      const ssize_t n = read(line_.master(), bytes.data(), bytes.size());
      if (n <= 0) return;
      for (ssize_t i = 0; i < n; ++i) {
        const char c = bytes[static_cast<std::size_t>(i)];
        if (c == kStopByte) {
          line.clear();
          const std::lock_guard lock(mutex_);
          stopped_ = true;
          armed_ = stuck_latch_;
          ++stop_bytes_;
          changed_.notify_all();
        } else if (c != '\n') {
          line += c;
        } else {
          const auto request = ParseRequest(line);
          line.clear();
          if (!request) continue;
          {
            const std::lock_guard lock(mutex_);
            if (watches_) silent_since_ = std::chrono::steady_clock::now();
          }
          if (!Handle(*request)) return;
        }
      }
    }
  }

  // Until the longest silence is over; -1: it is not watched, or was noticed.
  int UntilSilent_ms() const {
    const std::lock_guard lock(mutex_);
    if (!watches_ || !silent_since_) return -1;
    // What README says of a controller: a fifth of a second to spare.
    constexpr std::chrono::milliseconds kWatch{1800};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(
        *silent_since_ + kWatch - std::chrono::steady_clock::now());
    return std::max(0, static_cast<int>(left.count()));
  }

  bool Handle(const Request& request) {
    std::function<void()> what;
    {
      const std::lock_guard lock(mutex_);
      heard_.push_back(request.verb);
      changed_.notify_all();
      if (const auto it = when_.find(request.verb); it != when_.end()) {
        what = it->second;
      }
    }
    if (what) what();
    const std::lock_guard lock(mutex_);
    Act act = Act::kAnswer;
    if (auto& acts = script_[request.verb]; !acts.empty()) {
      act = acts.front();
      acts.pop_front();
    }
    const bool said =
        !late_.empty() && last_ && request.number == last_->number;
    Say(late_);
    late_.clear();
    if (act == Act::kDeafness) return Silence();
    if (act == Act::kHangUp) {
      line_.HangUp();
      return false;
    }
    const Answer refusal{request.number, false, request.verb, "worn"};
    Answer answer = act == Act::kRefusal ? refusal : Done(request);
    last_ = answer;
    if (act == Act::kWrongEcho) answer.text = "99999";
    if (act == Act::kEmpty) answer.text.clear();
    std::string bytes = FormatLine(answer);
    switch (act) {
      case Act::kSilence:
        return Silence();
      case Act::kGarbage:
        Say(std::string("\0\xff*\n*0000\n7 ok\n", 15) +
            std::string(3 * kLongestLine, '#') + "\n");
        return Silence();
      case Act::kHalf:
        Say(bytes.substr(0, bytes.size() / 2));
        return Silence();
      case Act::kDamaged:
        bytes[3] = static_cast<char>(bytes[3] ^ 1);
        Say(bytes);
        return Silence();
      case Act::kLate:
        late_ = bytes;
        return said || Silence();
      default:
        Say(bytes);
        return true;
    }
  }

  // A request that comes again is answered again, and not done again.
  Answer Done(const Request& request) {
    if (last_ && request.number == last_->number &&
        request.number != kAlwaysNew) {
      return *last_;
    }
    Answer answer{request.number, true, request.verb, ""};
    const auto refuse = [&](const char* why) {
      answer.ok = false;
      answer.text = why;
    };
    const std::string& verb = request.verb;
    const bool moves = verb == "angle" || verb == "compress" || verb == "arm" ||
                       verb == "fire";
    if (moves && stopped_) {
      refuse("stopped");
    } else if (verb == "hello") {
      answer.text = "touchdown-rig/2 simulated";
    } else if (verb == "angle") {
      angle_ = stuck_angle_ >= 0 ? stuck_angle_ : std::stoll(request.argument);
      moving_ = looks_;
      answer.text = request.argument;
    } else if (verb == "compress") {
      compress_ = std::stoll(request.argument);
      answer.text = request.argument;
    } else if (verb == "interlock") {
      answer.text = interlock_open_ ? "open" : "closed";
    } else if (verb == "arm") {
      armed_ = !interlock_open_;
      if (armed_) {
        answer.text = "T" + std::to_string(++tokens_);
      } else {
        refuse("interlock open");
      }
    } else if (verb == "disarm") {
      armed_ = stuck_latch_;
      changed_.notify_all();
    } else if (verb == "fire") {
      if (!armed_ || request.argument != "T" + std::to_string(tokens_)) {
        refuse(interlock_open_ ? "interlock open" : "not armed");
      } else {
        armed_ = false;
        ++shots_;
        answer.text = "shots=" + std::to_string(shots_);
      }
    } else if (verb == "reset") {
      stopped_ = false;
    } else if (verb == "status") {
      answer.text = "angle=" + std::to_string(angle_) +
                    " compress=" + std::to_string(compress_) +
                    " moving=" + std::to_string(moving_ > 0 ? 1 : 0) +
                    " armed=" + std::to_string(armed_ ? 1 : 0) +
                    " stopped=" + std::to_string(stopped_ ? 1 : 0) +
                    " shots=" + std::to_string(shots_);
      if (moving_ > 0) --moving_;
    } else {
      refuse("unknown");
    }
    last_ = answer;
    return answer;
  }

  void Say(const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n =
          write(line_.master(), bytes.data() + done, bytes.size() - done);
      if (n <= 0) return;
      done += static_cast<std::size_t>(n);
    }
  }
  bool Silence() {
    const std::uint64_t one = 1;
    return write(silence_, &one, sizeof one) == sizeof one;
  }

  testing::PseudoTerminal line_;
  int end_ = -1, silence_ = -1;
  SerialTime::Instant now_{};  // of the driver's thread

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::deque<Act>> script_;
  std::map<std::string, std::function<void()>> when_;
  std::string late_;
  std::optional<Answer> last_;
  std::int64_t angle_ = 0, compress_ = 0, shots_ = 0, tokens_ = 0;
  std::int64_t stuck_angle_ = -1;
  int looks_ = 0, moving_ = 0, stop_bytes_ = 0;
  bool interlock_open_ = false, armed_ = false, stopped_ = false;
  bool watches_ = false, stuck_latch_ = false;
  std::optional<std::chrono::steady_clock::time_point> silent_since_;
  int silences_ = 0;
  std::vector<std::string> heard_;
  std::thread thread_;
};

}  // namespace touchdown::rig
