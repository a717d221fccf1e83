// Where the journal goes (measure/journal.h).
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

struct LogFlags {
  bool verbose = false;  // to stderr
  std::string file;      // empty: none
};

// --verbose and --log, before or behind a command's name. To be called before
// commands are added.
void AddLogFlags(CLI::App& app, LogFlags& flags);

// Quiet where neither is given. Throws core::OutputError where the file cannot
// be written, or is none that may be replaced (a device, a FIFO, a link).
void SetUpLog(const LogFlags& flags);

}  // namespace touchdown::cli
