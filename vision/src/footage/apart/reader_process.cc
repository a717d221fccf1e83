#include "footage/apart/reader_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "footage/apart/reader.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// How often a wait looks whether the work is to end: Ctrl-C is answered within
// that. Shorter costs wake-ups.
constexpr std::chrono::milliseconds kLookEvery{50};

std::string SignalName(int signal) {
  const char* const name = sigabbrev_np(signal);
  return name != nullptr ? fmt::format("SIG{}", name)
                         : fmt::format("signal {}", signal);
}

// Starts this program again as a reader: its name, then the argument that makes
// it one; both lines as the descriptors that it expects; no output. A process
// group of its own keeps the terminal's signals from it.
pid_t Spawn(int life_line, int first_line) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&files, standard, "/dev/null", O_RDWR, 0);
  }
  // Neither line takes the other's place before that one has moved.
  posix_spawn_file_actions_adddup2(&files, first_line, kFirstLine);
  posix_spawn_file_actions_adddup2(&files, life_line, kLifeLine);
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&how, &none);
  posix_spawnattr_setsigdefault(&how, &all);
  posix_spawnattr_setpgroup(&how, 0);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK |
                                     POSIX_SPAWN_SETSIGDEF |
                                     POSIX_SPAWN_SETPGROUP);
  std::string name = "touchdown";
  std::string argument = kReaderArgument;
  std::array<char*, 3> arguments = {name.data(), argument.data(), nullptr};
  pid_t process = -1;
  const int trouble = posix_spawn(&process, "/proc/self/exe", &files, &how,
                                  arguments.data(), environ);
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  if (trouble != 0) {
    throw core::InputError(
        fmt::format("a reader cannot be started: {}", std::strerror(trouble)));
  }
  return process;
}

// A copy of the descriptor above those that a reader expects.
Descriptor RaiseDescriptor(Descriptor descriptor) {
  if (descriptor.get() > kFirstLine) return descriptor;
  return Descriptor(fcntl(descriptor.get(), F_DUPFD_CLOEXEC, kFirstLine + 1));
}

}  // namespace

ReaderProcess::ReaderProcess(const std::filesystem::path& path,
                             const ReaderLimits& limits)
    : path_(path), silence_s_(limits.silence_s) {
  auto [life, its_life] = MakeSocketPair();
  auto [first, its_first] = MakeSocketPair();
  life_line_ = std::move(life);
  first_line_ = std::move(first);
  its_life = RaiseDescriptor(std::move(its_life));
  its_first = RaiseDescriptor(std::move(its_first));
  process_ = Spawn(its_life.get(), its_first.get());
  Packed message;
  message.Put(limits);
  message.PutText(path.string());
  SendMessage(life_line_.get(), message.bytes());
}

ReaderProcess::~ReaderProcess() { End(); }

// Ends the process at most once, and returns its status.
int ReaderProcess::End() {
  const std::lock_guard lock(mutex_);
  if (process_ < 0) return status_;
  kill(process_, SIGKILL);
  while (waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status_;
}

// Throws the reason why the reader is gone, as one line.
void ReaderProcess::Lose(const std::string& why) {
  const int status = End();
  const std::string how =
      !why.empty() ? why
      : WIFSIGNALED(status)
          ? fmt::format("was ended by {}", SignalName(WTERMSIG(status)))
          : fmt::format("ended with status {}", WEXITSTATUS(status));
  throw core::InputError(fmt::format(
      "{}: the process that reads it {}; expected a recording that its decoder "
      "survives: convert it with another program, or record it again",
      path_.string(), how));
}

ReaderLine::ReaderLine(std::shared_ptr<ReaderProcess> process,
                       Descriptor socket)
    : process_(std::move(process)), socket_(std::move(socket)) {
  SetPatience(socket_.get(), kLookEvery);
}

Descriptor ReaderLine::Greeting(Confinement& granted) {
  const std::lock_guard lock(mutex_);
  Answered greeting = Wait(0, {});
  granted.is_apart = true;
  granted.landlock = greeting.answer.GetText();
  granted.seccomp = greeting.answer.GetText();
  if (!greeting.descriptor) process_->Lose("gave no memory and was ended");
  return std::move(greeting.descriptor);
}

Answered ReaderLine::Question(Ask ask, const Packed& rest,
                              const core::Cancellation& until) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t number = ++number_;
  Packed question;
  question.Put(number);
  question.Put(ask);
  // Where the reader has ended its last words may still be there.
  SendMessage(socket_.get(), question.bytes() + rest.bytes());
  return Wait(number, until);
}

Answered ReaderLine::Wait(std::uint32_t number,
                          const core::Cancellation& until) {
  std::chrono::milliseconds silent{0};
  std::uint64_t beats = memory_ ? memory_->beats() : 0;
  for (;;) {
    Received received = ReceiveMessage(socket_.get());
    if (received.what == Received::What::kEnd) process_->Lose();
    if (received.what == Received::What::kNothingYet) {
      until.Check();
      const std::uint64_t now = memory_ ? memory_->beats() : 0;
      // A reader that decodes lets its counter run: only one that does nothing
      // at all is given up.
      silent = now == beats ? silent + kLookEvery : kLookEvery;
      beats = now;
      if (std::chrono::duration<double>(silent).count() >
          process_->silence_s()) {
        process_->Lose(
            fmt::format("has said nothing for {:g} s", process_->silence_s()));
      }
      continue;
    }
    Packed answer(std::move(received.bytes));
    // The answer to a question that was given up.
    if (answer.Get<std::uint32_t>() != number) continue;
    switch (answer.Get<Said>()) {
      case Said::kDone:
        return {std::move(answer), std::move(received.descriptor)};
      case Said::kInputError:
        throw core::InputError(answer.GetText());
      case Said::kInvalidArgument:
        throw std::invalid_argument(answer.GetText());
      default:
        throw core::InputError(
            fmt::format("{}: {}", process_->path().string(), answer.GetText()));
    }
  }
}

}  // namespace touchdown::vision
