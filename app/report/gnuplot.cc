// gnuplot as a child process with three pipes: the script goes in, the SVG and
// the complaints come out. InlineSvg() then makes its answer fit for a page
// that has several plots.
#include "app/report/gnuplot.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

// A file descriptor that closes itself: also where a later pipe cannot be
// opened.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void Reset(int fd) {
    Close();
    fd_ = fd;
  }
  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  int get() const { return fd_; }
  bool open() const { return fd_ >= 0; }

 private:
  int fd_;
};

// The read end is where one process reads what the other writes to the write
// end.
struct Pipe {
  Descriptor read_end;
  Descriptor write_end;
};

// Throws core::InputError where the process has no descriptors left. O_CLOEXEC:
// the child keeps only the ends that Spawn() puts in place of its standard
// streams, so that it sees the end of the script when we close our end.
void Open(Pipe& pipe) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw core::InputError(
        fmt::format("gnuplot: no pipe to it: {}", std::strerror(errno)));
  }
  pipe.read_end.Reset(ends[0]);
  pipe.write_end.Reset(ends[1]);
}

// A closed pipe answers with an error instead of a signal while this lives:
// gnuplot may end before it has read the whole script. The setting is the whole
// process's.
class IgnoreBrokenPipe {
 public:
  IgnoreBrokenPipe() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &before_);
  }
  ~IgnoreBrokenPipe() { sigaction(SIGPIPE, &before_, nullptr); }
  IgnoreBrokenPipe(const IgnoreBrokenPipe&) = delete;
  IgnoreBrokenPipe& operator=(const IgnoreBrokenPipe&) = delete;

 private:
  struct sigaction before_ {};
};

// Appends what can be read at once; closes `from` at the end of the stream or
// on an error, so that Converse() ends.
void ReadSome(Descriptor& from, std::string& into) {
  std::array<char, 65536> buffer{};
  const ssize_t n = read(from.get(), buffer.data(), buffer.size());
  if (n > 0) {
    into.append(buffer.data(), static_cast<std::size_t>(n));
  } else if (n == 0 || errno != EINTR) {
    from.Close();
  }
}

// Sends `script` and collects `answer` and `complaint` until gnuplot closes
// both. Feeds and drains at the same time: either pipe may fill up before the
// other.
void Converse(const std::string& script, Descriptor& to, Descriptor& out,
              Descriptor& err, std::string& answer, std::string& complaint) {
  std::size_t sent = 0;
  while (out.open() || err.open()) {
    // A closed descriptor is -1, which poll() passes over.
    std::array<pollfd, 3> polled{{{to.get(), POLLOUT, 0},
                                  {out.get(), POLLIN, 0},
                                  {err.get(), POLLIN, 0}}};
    if (poll(polled.data(), polled.size(), -1) < 0) {
      if (errno == EINTR) continue;
      break;
    }
    if (to.open() && polled[0].revents != 0) {
      const ssize_t n =
          write(to.get(), script.data() + sent, script.size() - sent);
      if (n > 0) sent += static_cast<std::size_t>(n);
      if ((n < 0 && errno != EINTR && errno != EAGAIN) ||
          sent == script.size()) {
        // The end of the script is the end of the stream.
        to.Close();
      }
    }
    if (out.open() && polled[1].revents != 0) ReadSome(out, answer);
    if (err.open() && polled[2].revents != 0) ReadSome(err, complaint);
  }
}

// Starts gnuplot with the pipes as its standard streams and an environment of
// its own. The process id; throws core::InputError, with the package to
// install, where it is not there.
pid_t Spawn(const Pipe& in, const Pipe& out, const Pipe& err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.read_end.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.write_end.get(),
                                   STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.write_end.get(),
                                   STDERR_FILENO);
  // posix_spawn takes words that can be changed, hence the strings.
  std::string name = "gnuplot";
  std::string defaults = "-d";  // no start-up files
  std::string stdin_word = "-";
  std::array<char*, 4> argv{name.data(), defaults.data(), stdin_word.data(),
                            nullptr};
  // The locale decides the decimal sign. PATH is passed on, and no other
  // variable of the user: none of them may change a plot.
  std::string locale = "LC_ALL=C";
  const char* path_value = std::getenv("PATH");
  std::string path = std::string("PATH=") +
                     (path_value != nullptr ? path_value : "/usr/bin:/bin");
  std::array<char*, 3> environment{locale.data(), path.data(), nullptr};
  pid_t child = -1;
  const int trouble = posix_spawnp(&child, name.c_str(), &actions, nullptr,
                                   argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (trouble != 0) {
    throw core::InputError(fmt::format(
        "gnuplot: {}: the report's plots need it; install the package "
        "gnuplot-nox",
        std::strerror(trouble)));
  }
  return child;
}

void ReplaceAll(std::string& text, const std::string& what,
                const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

// The values of all id attributes of an SVG, in either kind of quotes.
std::set<std::string> Identifiers(const std::string& svg) {
  std::set<std::string> out;
  for (std::size_t at = svg.find(" id="); at != std::string::npos;
       at = svg.find(" id=", at + 4)) {
    const std::size_t end = svg.find(svg[at + 4], at + 5);
    if (end != std::string::npos) out.insert(svg.substr(at + 5, end - at - 5));
  }
  return out;
}

}  // namespace

std::string RunGnuplot(const std::string& script) {
  Pipe in;
  Pipe out;
  Pipe err;
  Open(in);
  Open(out);
  Open(err);
  const IgnoreBrokenPipe guard;
  const pid_t child = Spawn(in, out, err);
  // Our copies of the child's ends: while one is open, neither side sees the
  // end of a stream.
  in.read_end.Close();
  out.write_end.Close();
  err.write_end.Close();
  // A pipe that is full must not hold us while gnuplot waits for us to read.
  fcntl(in.write_end.get(), F_SETFL, O_NONBLOCK);
  std::string answer;
  std::string complaint;
  Converse(script, in.write_end, out.read_end, err.read_end, answer, complaint);
  int status = 0;
  // Without this the child would stay as a zombie.
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    // An error of the program is one line.
    for (char& c : complaint) {
      if (c == '\n') c = ' ';
    }
    throw core::InputError(fmt::format(
        "gnuplot: refused a plot: {}; the package gnuplot-nox 5.4 is known to "
        "draw it",
        complaint));
  }
  return answer;
}

std::string GnuplotQuote(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      // gnuplot 5.4 reads '' at the start of a constant as an empty one.
      out += "\u2019";
    } else {
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  out += '\'';
  return out;
}

std::string InlineSvg(std::string svg, const std::string& id) {
  const std::size_t start = svg.find("<svg");
  // An XML declaration and a doctype may not stand inside a page.
  if (start != std::string::npos) svg.erase(0, start);
  for (const std::string& name : Identifiers(svg)) {
    // Names occur as id='...', href='#...' and url(#...). The character behind
    // the name is part of what is replaced: "plot_1" must not match in
    // "plot_10".
    for (const char end : {'\'', '"', ')'}) {
      const std::string own = name + end;
      for (const char* before : {"id='", "id=\"", "'#", "\"#", "(#"}) {
        ReplaceAll(svg, before + own, before + (id + own));
      }
    }
  }
  // Browsers would show the title, a name for programs, as a tooltip.
  const std::size_t title = svg.find("<title>");
  const std::size_t title_end = svg.find("</title>");
  if (title != std::string::npos && title_end != std::string::npos) {
    svg.erase(title, title_end + 8 - title);
  }
  return svg;
}

}  // namespace touchdown::report
