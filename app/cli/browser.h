// The user's browser, shown an address that nobody else is to read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "touchdown/core/unfinished.h"

namespace touchdown::cli {

// A desktop to show a browser on.
bool HasDesktop();

// Arguments of programs are shown to every user of the machine (`ps`); so the
// browser gets the name of a file of mode 600 in the user's own run-time folder
// (XDG_RUNTIME_DIR, else that for temporary files), which leads on to the
// address. The file is removed at the end of this, also where a signal ends the
// process.
class BrowserPage {
 public:
  // Writes the file, for an `address` that holds no quotes; empty path() where
  // it cannot be written.
  explicit BrowserPage(const std::string& address);
  ~BrowserPage();
  BrowserPage(const BrowserPage&) = delete;
  BrowserPage& operator=(const BrowserPage&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Starts xdg-open and does not wait for it. Whether a page appears is the
  // desktop's business.
  void Show() const;

 private:
  std::filesystem::path path_;
  std::optional<core::Unfinished> unfinished_;
};

}  // namespace touchdown::cli
