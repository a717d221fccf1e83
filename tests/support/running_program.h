// A program that runs while the test types and reads what it says.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::testing {

class RunningProgram {
 public:
  explicit RunningProgram(std::vector<std::string> arguments) {
    std::array<int, 2> out{};
    std::array<int, 2> in{};
    std::array<int, 2> begins{};
    if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(in.data(), O_CLOEXEC) != 0 ||
        pipe2(begins.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe");
    }
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::fflush(nullptr);
    child_ = fork();
    if (child_ == 0) {
      // As a shell starts it, whatever this process ignores: what is ignored
      // until the program has its own handlers is lost.
      for (const int signal :
           {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM, SIGABRT}) {
        std::signal(signal, SIG_DFL);
      }
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(out[1]);
    close(in[0]);
    // Until it is the program that runs: before, signals are this process's.
    close(begins[1]);
    char none = 0;
    while (read(begins[0], &none, 1) < 0 && errno == EINTR) {
    }
    close(begins[0]);
    out_ = fdopen(out[0], "r");
    in_ = in[1];
  }
  ~RunningProgram() {
    if (child_ > 0) End(SIGKILL);
    std::fclose(out_);
    CloseInput();
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  // Waits for the next line of stdout; empty at its end.
  std::string Line() {
    std::string line;
    for (int c = std::fgetc(out_); c != EOF; c = std::fgetc(out_)) {
      line += static_cast<char>(c);
      if (c == '\n') break;
    }
    return line;
  }
  // Waits for a line with `text` in it; all lines up to it. Ends where stdout
  // does.
  std::string Until(std::string_view text) {
    std::string lines;
    while (true) {
      const std::string line = Line();
      lines += line;
      if (line.empty() || line.find(text) != std::string::npos) return lines;
    }
  }
  void Type(const std::string& line) {
    const std::string bytes = line + "\n";
    if (write(in_, bytes.data(), bytes.size()) < 0) {
      throw std::runtime_error("the program reads no more");
    }
  }
  void CloseInput() {
    if (in_ >= 0) close(in_);
    in_ = -1;
  }
  // Waits until the program has worked for so long on its processors; false if
  // it ended before.
  bool UntilItHasWorked_s(double least_s) const {
    const std::string path = "/proc/" + std::to_string(child_) + "/stat";
    while (true) {
      std::ifstream in(path);
      std::string text;
      std::getline(in, text);
      // After the name in brackets: state, ten numbers, user and system time.
      std::istringstream fields(text.substr(text.rfind(')') + 1));
      std::string state;
      fields >> state;
      if (state.empty() || state == "Z") return false;
      double ticks = 0.0;
      for (int k = 0; k < 10; ++k) fields >> ticks;
      double user = 0.0;
      double system = 0.0;
      fields >> user >> system;
      if (user + system >= least_s * static_cast<double>(sysconf(_SC_CLK_TCK)))
        return true;
      sched_yield();
    }
  }
  void Signal(int signal) { kill(child_, signal); }
  pid_t pid() const { return child_; }
  // Sends a signal (0: none) and waits for the end; -1 where a signal ended it.
  int End(int signal) {
    if (signal != 0) kill(child_, signal);
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t child_ = -1;
  FILE* out_ = nullptr;
  int in_ = -1;
};

}  // namespace touchdown::testing
