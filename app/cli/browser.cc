#include "app/cli/browser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

namespace touchdown::cli {
namespace {

// Returns the folder that only this user can read (XDG_RUNTIME_DIR), else the
// one for temporary files, where nothing but its mode 600 protects the file.
std::filesystem::path OwnFolder() {
  const char* const own = std::getenv("XDG_RUNTIME_DIR");
  std::error_code ignored;
  if (own != nullptr && std::filesystem::is_directory(own, ignored)) return own;
  return std::filesystem::temp_directory_path(ignored);
}

// Writes all of `text`; false where the disk is full or the file is gone. A
// short write is no error and goes on.
bool WriteToDescriptor(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n =
        write(descriptor, text.data() + written, text.size() - written);
    if (n <= 0) return false;
    written += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

bool HasDesktop() {
  return std::getenv("DISPLAY") != nullptr ||
         std::getenv("WAYLAND_DISPLAY") != nullptr;
}

BrowserPage::BrowserPage(const std::string& address) {
  // mkostemps() makes the file with mode 600 under a name that was free, so
  // that nobody can put a file of theirs in its place.
  constexpr int kSuffix = 5;  // ".html", by which a browser is chosen
  std::string name = (OwnFolder() / "touchdown-XXXXXX.html").string();
  const int descriptor = mkostemps(name.data(), kSuffix, O_CLOEXEC);
  if (descriptor < 0) return;
  path_ = name;
  // A signal may end the process without its destructors: the key goes, too.
  unfinished_.emplace(path_);
  // The page sends the browser on to the address, and has a link for browsers
  // that do not follow. "no-referrer" keeps the session's key out of the
  // headers of later requests.
  const std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><title>touchdown review</title>\n"
      "<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\">\n"
      "<p><a href=\"{0}\">touchdown review</a></html>\n",
      address);
  const bool is_written = WriteToDescriptor(descriptor, page);
  close(descriptor);
  // Half a page would show nothing: the file goes, and path() stays empty.
  if (is_written) return;
  unlink(name.c_str());
  path_.clear();
}

BrowserPage::~BrowserPage() {
  if (!path_.empty()) unlink(path_.c_str());
}

void BrowserPage::Show() const {
  // The child only starts another child and ends; it is waited for at once, so
  // that no zombie remains. The browser belongs to init.
  const pid_t child = fork();
  if (child != 0) {
    if (child > 0) waitpid(child, nullptr, 0);
    return;
  }
  // The browser runs in a grandchild, so that nobody waits for it.
  if (fork() != 0) _exit(0);
  // What the browser prints must not mix with this program's results.
  const int nowhere = open("/dev/null", O_RDWR);
  if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 ||
      dup2(nowhere, STDERR_FILENO) < 0) {
    _exit(127);
  }
  // review blocks SIGINT and SIGTERM in this thread, and a started program
  // would inherit that: nobody could end the browser with them.
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // exec returns only where xdg-open cannot be started. _exit() runs no
  // destructor of ours: the file must stay for the parent.
  execlp("xdg-open", "xdg-open", path_.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace touchdown::cli
