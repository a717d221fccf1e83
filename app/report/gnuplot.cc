#include "app/report/gnuplot.h"

#include <fmt/core.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "touchdown/core/errors.h"

extern char** environ;

namespace touchdown::report {
namespace {

constexpr const char* kAdvice =
    "install the package gnuplot-nox, or ask for output without plots";

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { Close(); }

  int Get() const { return fd_; }
  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

// A pair of connected sockets: unlike a pipe, a broken one raises no signal
// when it is written with MSG_NOSIGNAL.
std::pair<Descriptor, Descriptor> Channel() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw core::InputError(
        fmt::format("gnuplot: no channel to it: {}", std::strerror(errno)));
  }
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

// The file actions of posix_spawn: our ends of the channels as 0, 1 and 2.
class Wiring {
 public:
  Wiring(int in, int out, int err) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, err, STDERR_FILENO);
  }
  Wiring(const Wiring&) = delete;
  Wiring& operator=(const Wiring&) = delete;
  ~Wiring() { posix_spawn_file_actions_destroy(&actions_); }

  const posix_spawn_file_actions_t* Get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// Reads what is there; false at the end.
bool Drain(Descriptor& from, std::string& into) {
  std::array<char, 65536> buffer;
  const ssize_t n = read(from.Get(), buffer.data(), buffer.size());
  if (n > 0) into.append(buffer.data(), static_cast<std::size_t>(n));
  if (n > 0 || (n < 0 && errno == EINTR)) return true;
  from.Close();
  return false;
}

// Feeds and empties the child at once: it may answer before it has read all.
void Converse(Descriptor& in, const std::string& script, Descriptor& out,
              std::string& drawing, Descriptor& err, std::string& complaint) {
  std::size_t sent = 0;
  while (out.Get() >= 0 || err.Get() >= 0) {
    std::array<pollfd, 3> wait{{{in.Get(), POLLOUT, 0},
                                {out.Get(), POLLIN, 0},
                                {err.Get(), POLLIN, 0}}};
    if (poll(wait.data(), wait.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    if (wait[0].revents != 0) {
      const ssize_t n = send(in.Get(), script.data() + sent,
                             script.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n > 0) sent += static_cast<std::size_t>(n);
      const bool broken =
          n < 0 && errno != EINTR && errno != EAGAIN && errno != EWOULDBLOCK;
      if (broken || sent == script.size()) in.Close();
    }
    if (wait[1].revents != 0) Drain(out, drawing);
    if (wait[2].revents != 0) Drain(err, complaint);
  }
}

std::string FirstLine(const std::string& text) {
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string::npos) return {};
  return text.substr(start, text.find('\n', start) - start);
}

}  // namespace

std::string RunGnuplot(const std::string& script) {
  auto [our_in, its_in] = Channel();
  auto [our_out, its_out] = Channel();
  auto [our_err, its_err] = Channel();
  pid_t child = -1;
  {
    const Wiring wiring(its_in.Get(), its_out.Get(), its_err.Get());
    std::array<char, 8> name{"gnuplot"};
    std::array<char, 3> defaults{"-d"};  // no start-up files
    std::array<char, 2> stdin_file{"-"};
    std::array<char*, 4> argv{name.data(), defaults.data(), stdin_file.data(),
                              nullptr};
    const int error = posix_spawnp(&child, name.data(), wiring.Get(), nullptr,
                                   argv.data(), environ);
    if (error != 0) {
      throw core::InputError(fmt::format("gnuplot: cannot be run ({}); {}",
                                         std::strerror(error), kAdvice));
    }
  }
  its_in.Close();
  its_out.Close();
  its_err.Close();
  std::string drawing;
  std::string complaint;
  Converse(our_in, script, our_out, drawing, our_err, complaint);
  our_in.Close();
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
    throw core::InputError(fmt::format("gnuplot: cannot be run; {}", kAdvice));
  }
  if (!done || drawing.empty()) {
    throw core::InputError(
        fmt::format("gnuplot: failed: {}", FirstLine(complaint)));
  }
  return drawing;
}

std::string GnuplotQuote(std::string_view text, bool enhanced) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "''";
    } else if (c == '\n' || c == '\r') {
      out += ' ';  // a literal ends with its line
    } else {
      if (enhanced &&
          std::string_view("_^{}@&~\\").find(c) != std::string_view::npos) {
        out += '\\';
      }
      out += c;
    }
  }
  return out + "'";
}

std::string GnuplotSvg(int width, int height) {
  return fmt::format(
      "set terminal svg size {},{} dynamic enhanced rounded "
      "font 'DejaVu Sans,Helvetica,Arial,sans-serif,13' "
      "background rgb 'white'\n"
      "set encoding utf8\n"
      "set border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out scale 0.6\n"
      "set grid lw 0.5 lc rgb '#e0e0e0'\n",
      width, height);
}

}  // namespace touchdown::report
