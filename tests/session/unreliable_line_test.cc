// Sessions over a line that loses, delays, garbles and repeats answers, ended
// at random moments in every way there is. The two limits are the issue's:
// springs that are latched are called "not armed" for at most 1.2 s, and are
// latched for at most 2 s after the program is gone.
//
// 20 sessions; TOUCHDOWN_LONG_TESTS=1 runs 2000.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/session/bench.h"
#include "tests/session/unreliable_controller.h"
#include "tests/support/running_program.h"

namespace touchdown::session {
namespace {

using Clock = UnreliableController::Clock;
using Instant = UnreliableController::Instant;
using testing::RunningProgram;

constexpr std::chrono::milliseconds kLongestWrongWord{1200};
constexpr std::chrono::milliseconds kLongestLatched{2000};

// What a line says of the springs, if anything.
enum class Word { kNothing, kNotArmed, kArmed };
Word WordOf(const std::string& line) {
  if (line.find("not armed") != std::string::npos) return Word::kNotArmed;
  if (line.find("ARMED") != std::string::npos) return Word::kArmed;
  return Word::kNothing;
}

struct Shown {
  Instant at;
  Word word;
};

// The longest time for which springs were latched and called "not armed".
std::chrono::nanoseconds LongestWrongWord(
    const std::vector<Shown>& shown,
    const std::vector<UnreliableController::Latched>& latched, Instant gone) {
  std::chrono::nanoseconds longest{0};
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown[i].word != Word::kNotArmed) continue;
    Instant until = gone;
    // The same said again is no correction.
    for (std::size_t k = i + 1; k < shown.size(); ++k) {
      if (shown[k].word == Word::kArmed) {
        until = shown[k].at;
        break;
      }
    }
    for (const auto& one : latched) {
      const Instant from = std::max(one.from, shown[i].at);
      const Instant to = std::min(one.to.value_or(gone), until);
      longest = std::max<std::chrono::nanoseconds>(longest, to - from);
    }
  }
  return longest;
}

struct Count {
  std::atomic<int> sessions = 0, latched_at_end = 0, shots = 0, failures = 0;
  std::atomic<std::int64_t> longest_wrong_ms = 0, longest_latched_ms = 0;
};

void Tell(const Count& count) {
  std::printf(
      "%d sessions: %d shots, latched at the end of the program %d, longest "
      "'not armed' while latched %lld ms, longest latched after the end %lld "
      "ms\n",
      count.sessions.load(), count.shots.load(), count.latched_at_end.load(),
      static_cast<long long>(count.longest_wrong_ms),
      static_cast<long long>(count.longest_latched_ms));
  std::fflush(stdout);
}

void Raise(std::atomic<std::int64_t>& greatest, std::int64_t value) {
  std::int64_t before = greatest;
  while (before < value && !greatest.compare_exchange_weak(before, value)) {
  }
}

// How a session ends: quit, the end of the input, or a signal.
constexpr int kQuit = 0;
constexpr int kEndOfInput = -1;
constexpr int kEnds[] = {kQuit,  kEndOfInput, SIGTERM, SIGINT,
                         SIGHUP, SIGQUIT,     SIGABRT, SIGSEGV,
                         SIGBUS, SIGPIPE,     SIGKILL};

void Live(std::uint64_t seed, Count& count) {
  std::mt19937_64 random(seed);
  const auto chance = [&](double of) {
    return std::uniform_real_distribution<>(0.0, 1.0)(random) < of;
  };
  const Bench bench;
  // One in eight is a good line: there the limits are about the signals.
  LineTrouble trouble;
  if (seed % 8 == 0) trouble = {0, 0, 0, 0, 0, 0, 0, 0, {}};
  UnreliableController controller(random(), trouble);
  const int end = kEnds[seed % std::size(kEnds)];
  if (chance(0.2)) controller.LatchByHand();

  RunningProgram session({TOUCHDOWN_BINARY, "session", "--db",
                          bench.db().string(), "--campaign", "asphalt", "--rig",
                          bench.rig().string(), "--watch",
                          bench.films().string(), "--operator", "A. Lee",
                          "--no-check", "--driver", controller.port()});
  std::mutex mutex;
  std::vector<Shown> shown;
  std::string arming;  // as `arm` said it last
  std::string said;
  std::condition_variable heard;
  bool has_ended = false;
  std::thread reads([&] {
    for (std::string line = session.Line(); !line.empty();
         line = session.Line()) {
      const auto now = Clock::now();
      const std::lock_guard lock(mutex);
      said += line;
      heard.notify_all();
      if (const Word word = WordOf(line); word != Word::kNothing) {
        shown.push_back({now, word});
      }
      const auto at = line.find("clear: fire ");
      if (at != std::string::npos) {
        arming = line.substr(at + 7, line.size() - at - 8);
      }
    }
    const std::lock_guard lock(mutex);
    has_ended = true;
    heard.notify_all();
  });
  // A person who types at random, and pastes.
  int fires = 0;
  const auto type = [&](const std::string& line) {
    try {
      session.Type(line);
    } catch (const std::exception&) {  // it has ended
    }
  };
  // Types `line` and waits for one of the answers, not for ever: the line is
  // bad.
  const auto ask = [&](const std::string& line, const std::string& good,
                       const std::string& bad) {
    std::unique_lock lock(mutex);
    const std::size_t from = said.size();
    type(line);
    heard.wait_for(lock, std::chrono::seconds(3), [&] {
      return has_ended || said.find(good, from) != std::string::npos ||
             said.find(bad, from) != std::string::npos;
    });
    return said.find(good, from) != std::string::npos;
  };
  type("");
  // Two of three throw as they should, as far as they come.
  if (chance(0.67)) {
    ask("", "predicted", "no answer");
    for (int i = 0; i < 3 && !ask("set", "it reads", ": "); ++i) {
      ask("reset", "ready", ": ");
    }
    if (ask("arm", "clear: fire ", ": ") && chance(0.5)) {
      std::string fire;
      {
        const std::lock_guard lock(mutex);
        fire = arming;
      }
      ++fires;
      ask(fire, "fired", ": ");
      ask("set", "it reads", ": ");
      ask("arm", "clear: fire ", ": ");
    }
  }
  const std::uint64_t words = random() % 8;
  for (std::uint64_t i = 0; i < words; ++i) {
    // At any moment of a command.
    const timespec pause{0, static_cast<long>(random() % 250'000'000)};
    nanosleep(&pause, nullptr);
    switch (random() % 8) {
      case 0:
        type("stop");
        break;
      case 1:
        type("reset");
        break;
      case 2:
      case 3:
        type("set");
        break;
      case 4:
        type("arm");
        break;
      case 5: {
        const std::lock_guard lock(mutex);
        ++fires;
        type(arming.empty() ? "fire 1" : arming);
        break;
      }
      case 6:
        type("set\narm\nfire 1\nfire 2\nfire 3");
        break;
      default:
        if (chance(0.3)) controller.LatchByHand();
        type("rig");
    }
  }
  if (end == SIGINT) {
    // One stops the rig alone, if it is not stopped; a person goes on.
    std::unique_lock lock(mutex);
    while (!has_ended) {
      session.Signal(SIGINT);
      heard.wait_for(lock, std::chrono::seconds(1), [&] { return has_ended; });
    }
  }
  if (end == kQuit) type("quit");
  if (end == kEndOfInput) session.CloseInput();
  session.End(end > 0 && end != SIGINT ? end : 0);
  const Instant gone = Clock::now();
  reads.join();
  const bool was_latched = std::ranges::any_of(
      controller.latched(),
      [&](const auto& one) { return !one.to || *one.to > gone; });
  const bool is_disarmed = controller.BecomesDisarmed();
  const auto latched = controller.latched();
  const auto wrong = std::chrono::duration_cast<std::chrono::milliseconds>(
      LongestWrongWord(shown, latched, gone));
  std::chrono::milliseconds after{0};
  if (!latched.empty() && latched.back().to) {
    after =
        std::max(after, std::chrono::duration_cast<std::chrono::milliseconds>(
                            *latched.back().to - gone));
  }
  static std::mutex reported;
  const std::lock_guard lock(reported);
  SCOPED_TRACE("seed " + std::to_string(seed) + ", end " +
               (end > 0 ? strsignal(end) : "by itself"));
  EXPECT_TRUE(is_disarmed);
  EXPECT_LE(wrong, kLongestWrongWord);
  EXPECT_LE(after, kLongestLatched);
  EXPECT_LE(controller.shots(), fires);
  count.sessions++;
  count.latched_at_end += was_latched ? 1 : 0;
  count.shots += static_cast<int>(controller.shots());
  Raise(count.longest_wrong_ms, wrong.count());
  Raise(count.longest_latched_ms, after.count());
  if (count.sessions % 100 == 0) Tell(count);
}

// Ten parts, for the time limit of one test.
class UnreliableLine : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Parts, UnreliableLine, ::testing::Range(0, 10));

TEST_P(UnreliableLine, TheRigIsNeverCalledSafeAndNeverLeftLatched) {
  // Where none can be had this test is skipped: here, and in no other thread.
  { const testing::PseudoTerminal there; }
  const bool is_long = std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr;
  const int sessions = is_long ? 200 : 2;
  const int first = GetParam() * sessions;
  // They mostly wait.
  const int at_once = is_long ? 10 : 2;
  const rlimit no_cores{0, 0};
  setrlimit(RLIMIT_CORE, &no_cores);
  std::signal(SIGPIPE, SIG_IGN);  // of programs that have ended
  Count count;
  std::atomic<int> next = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < at_once; ++i) {
    threads.emplace_back([&] {
      while (true) {
        const int k = next++;
        if (k >= sessions || ::testing::Test::HasFailure()) return;
        Live(20261125 + static_cast<std::uint64_t>(first + k), count);
      }
    });
  }
  for (auto& thread : threads) thread.join();
  std::signal(SIGPIPE, SIG_DFL);
  EXPECT_EQ(count.sessions, sessions);
  if (is_long) {
    // What was to be tested did happen.
    EXPECT_GT(count.shots, 0);
    EXPECT_GT(count.latched_at_end, 0);
    EXPECT_GT(count.longest_wrong_ms, 0);
  }
  Tell(count);
}

}  // namespace
}  // namespace touchdown::session
