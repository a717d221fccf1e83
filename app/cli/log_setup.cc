#include "app/cli/log_setup.h"

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include "app/cli/options.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// A file of the journal, bytes, and how many older ones are kept: an analysis
// writes 3 kB, a session's day at a controller 10 MB; 40 MB are a week's.
constexpr std::size_t kFileBytes = std::size_t{10} << 20;
constexpr std::size_t kOlderFiles = 3;

// Returns a sink that writes the journal to the file and rotates it. Throws
// core::OutputError where the name is no plain file: rotating renames it, which
// would replace a device or the target of a link.
spdlog::sink_ptr FileSink(const std::string& name) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(name, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw core::OutputError(fmt::format(
        "{}: --log writes plain files, and this is none; give another name",
        name));
  }
  try {
    return std::make_shared<spdlog::sinks::rotating_file_sink_mt>(
        name, kFileBytes, kOlderFiles);
  } catch (const spdlog::spdlog_ex& error) {
    throw core::OutputError(
        fmt::format("{}: --log cannot be written: {}", name, error.what()));
  }
}

}  // namespace

// They belong to the program and not to a command, so that they may stand
// anywhere in the line.
void AddLogFlags(CLI::App& app, LogFlags& flags) {
  AddFlag(app, "--verbose", flags.verbose,
          "say on stderr what is done, how long it takes and why");
  AddOption(app, "--log", flags.file,
            fmt::format("say it in this file (after {} MB a new one is begun, "
                        "{} older ones are kept)",
                        kFileBytes >> 20, kOlderFiles));
}

void SetUpLog(const LogFlags& flags) {
  std::vector<spdlog::sink_ptr> sinks;
  if (flags.verbose) {
    auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    // A terminal shows the time of day; a file, which outlives the day, has
    // date, zone, process and thread besides.
    sink->set_pattern("touchdown: %H:%M:%S.%e  %v");
    sinks.push_back(std::move(sink));
  }
  if (!flags.file.empty()) {
    auto sink = FileSink(flags.file);
    sink->set_pattern("%Y-%m-%dT%H:%M:%S.%e%z  %P  %t  %v");
    sinks.push_back(std::move(sink));
  }
  auto logger =
      std::make_shared<spdlog::logger>("touchdown", sinks.begin(), sinks.end());
  // Without sinks the level is off, and JournalIsKept() spares the work of
  // making lines that nobody reads.
  logger->set_level(sinks.empty() ? spdlog::level::off : spdlog::level::debug);
  // After a crash the last line is what matters: none waits in a buffer.
  logger->flush_on(spdlog::level::debug);
  // A journal that cannot be written is no reason for a command to fail.
  logger->set_error_handler([](const std::string&) {});
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace touchdown::cli
