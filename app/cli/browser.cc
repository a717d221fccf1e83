#include "app/cli/browser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

namespace touchdown::cli {
namespace {

std::filesystem::path OwnFolder() {
  const char* const own = std::getenv("XDG_RUNTIME_DIR");
  std::error_code ignored;
  if (own != nullptr && std::filesystem::is_directory(own, ignored)) return own;
  return std::filesystem::temp_directory_path(ignored);
}

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
  constexpr int kSuffix = 5;  // ".html", by which a browser is chosen
  std::string name = (OwnFolder() / "touchdown-XXXXXX.html").string();
  const int descriptor = mkostemps(name.data(), kSuffix, O_CLOEXEC);
  if (descriptor < 0) return;
  path_ = name;
  const std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><title>touchdown review</title>\n"
      "<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\">\n"
      "<p><a href=\"{0}\">touchdown review</a></html>\n",
      address);
  const bool is_written = WriteToDescriptor(descriptor, page);
  close(descriptor);
  if (is_written) return;
  unlink(name.c_str());
  path_.clear();
}

BrowserPage::~BrowserPage() {
  if (!path_.empty()) unlink(path_.c_str());
}

void BrowserPage::Show() const {
  const pid_t child = fork();
  if (child != 0) {
    if (child > 0) waitpid(child, nullptr, 0);
    return;
  }
  // A grandchild, so that nobody waits for the browser.
  if (fork() != 0) _exit(0);
  // Its words are not ours, and it ends by its own signals.
  const int nowhere = open("/dev/null", O_RDWR);
  if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 ||
      dup2(nowhere, STDERR_FILENO) < 0) {
    _exit(127);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execlp("xdg-open", "xdg-open", path_.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace touchdown::cli
