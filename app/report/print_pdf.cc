// The page is printed by Chromium, which reads the same HTML as the user's
// browser: there is one layout. It prints into a folder of its own, and the PDF
// is copied to its place only after the browser has ended well.
#include "app/report/print_pdf.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "app/text/scratch_folder.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/unfinished.h"

namespace touchdown::report {
namespace {

namespace fs = std::filesystem;

// A browser that takes longer for one page hangs.
constexpr std::chrono::seconds kLimit{120};

// The absolute path as a file:// address. Bytes that are no plain letters are
// written as %XX: a "#" or "?" in the name of a folder would end the path.
std::string FileUrl(const fs::path& path) {
  std::string out = "file://";
  for (const char c : fs::absolute(path).string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       (c >= '0' && c <= '9') || c == '/' || c == '-' ||
                       c == '_' || c == '.';
    out += plain ? std::string(1, c)
                 : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

// The command line that prints `page` to `pdf`; the name of the program comes
// first and is filled in by Start(). Nothing in it asks for the network.
std::vector<std::string> Arguments(const fs::path& page, const fs::path& pdf,
                                   const fs::path& scratch) {
  std::vector<std::string> out{
      "",
      "--headless",
      "--disable-gpu",
      "--disable-dev-shm-usage",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--disable-extensions",
      "--no-pdf-header-footer",
      "--export-tagged-pdf",
      "--generate-pdf-document-outline",
      "--user-data-dir=" + (scratch / "profile").string(),
      "--print-to-pdf=" + pdf.string()};
  // It refuses root its sandbox. The page is ours and loads nothing.
  if (geteuid() == 0) out.emplace_back("--no-sandbox");
  out.push_back(FileUrl(page));
  return out;
}

// Starts the program `name` in an environment of its own, with its messages in
// the file `log` of `scratch`. False where no such program is installed; else
// `child` is its process id.
bool Start(const char* name, std::vector<std::string> arguments,
           const fs::path& scratch, pid_t& child) {
  arguments[0] = name;
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const char* path = std::getenv("PATH");
  // HOME is the scratch folder: the browser writes into it whatever its profile
  // says.
  std::array<std::string, 3> variables{
      "HOME=" + scratch.string(), "LC_ALL=C.UTF-8",
      std::string("PATH=") + (path != nullptr ? path : "/usr/bin:/bin")};
  std::array<char*, 4> environment{variables[0].data(), variables[1].data(),
                                   variables[2].data(), nullptr};
  const std::string log = (scratch / "log").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null",
                                   O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  const int trouble = posix_spawnp(&child, name, &actions, nullptr, argv.data(),
                                   environment.data());
  posix_spawn_file_actions_destroy(&actions);
  return trouble == 0;
}

// Waits for the browser. True where it ended with status 0 within kLimit; one
// that takes longer is killed.
bool EndsWell(pid_t child) {
  const auto end = std::chrono::steady_clock::now() + kLimit;
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (ended < 0 && errno != EINTR) return false;
    if (std::chrono::steady_clock::now() > end) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return false;
    }
    // Asked 50 times a second: little is added to the time of a page.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

// The last line of the browser's messages that is not empty; "" without a file.
std::string LastLine(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

}  // namespace

void PrintPdf(const fs::path& page, const fs::path& pdf) {
  const pipeline::ScratchFolder scratch;
  const fs::path printed = scratch.path() / "page.pdf";
  pid_t child = -1;
  bool started = false;
  // Debian's name first; the others are those of other distributions and of
  // Google.
  for (const char* name : {"chromium", "chromium-browser", "google-chrome",
                           "google-chrome-stable"}) {
    started = Start(name, Arguments(page, printed, scratch.path()),
                    scratch.path(), child);
    if (started) break;
  }
  if (!started) {
    throw core::InputError(
        "chromium: not found; the PDF needs it: install the package chromium, "
        "or print the page table1.html from any browser");
  }
  // A browser can end well and write no file.
  if (!EndsWell(child) || !std::filesystem::exists(printed)) {
    throw core::InputError(
        fmt::format("chromium: printed no page: {}; print table1.html from any "
                    "browser instead",
                    LastLine(scratch.path() / "log")));
  }
  // Throws core::OutputError where the target cannot be written.
  WriteTextFile(pdf, ReadTextFile(printed));
}

}  // namespace touchdown::report
