#include "app/doctor/bug_report.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "app/measure/open_recording.h"
#include "app/text/scratch_folder.h"
#include "app/text/version.h"
#include "app/text/zip_file.h"
#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/encode_image.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// At most so many bytes of any one file: a journal is 3 kB an analysis, a
// camera's header 10 kB.
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
// Of a recording that cannot be opened: its headers.
constexpr std::size_t kHeadBytes = std::size_t{64} << 10;

// Returns the first bytes of a file, at most `most`; empty where it cannot be
// read.
std::string ReadHead(const fs::path& path, std::size_t most) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(most, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

// Of `analyze`, run as a person does.
struct Run {
  std::string command;
  std::string end;  // "exit status 3", "signal 11 (Segmentation fault)"
  // These are standard output, standard error and the file of --log, each at
  // most kMostBytes.
  std::string out;
  std::string err;
  std::string log;
};

// Owns the list of files that posix_spawn opens for the child.
class SpawnFiles {
 public:
  SpawnFiles() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnFiles() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnFiles(const SpawnFiles&) = delete;
  SpawnFiles& operator=(const SpawnFiles&) = delete;
  // Sends descriptor `fd` of the child into a file that only the owner may
  // read: it names recordings and folders.
  void Redirect(int fd, const fs::path& file) {
    constexpr int kOwnerOnly = 0600;
    posix_spawn_file_actions_addopen(&actions_, fd, file.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, kOwnerOnly);
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

// Waits for the child and says in words how it ended. A signal to this process
// (a resized terminal) interrupts the wait and not the child.
std::string DescribeExit(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) {
    return fmt::format("exit status {}", WEXITSTATUS(status));
  }
  return fmt::format("signal {} ({})", WTERMSIG(status),
                     strsignal(WTERMSIG(status)));
}

// Runs `touchdown analyze` on the clip in a process of its own and collects
// what it said. A crash is then a result like any other. Nothing is thrown for
// what the child does.
Run RunAnalyze(const BugOptions& options) {
  const ScratchFolder folder;
  const fs::path out = folder.path() / "out";
  const fs::path err = folder.path() / "err";
  const fs::path log = folder.path() / "log";
  std::vector<std::string> words{"touchdown", "analyze"};
  words.insert(words.end(), options.flags.begin(), options.flags.end());
  Run run;
  // The report shows the command as the person typed it: --json and --log,
  // which are added behind it, are the report's own business. `--` keeps a clip
  // whose name begins with a dash from being read as a flag.
  run.command =
      fmt::format("{} {}", fmt::join(words, " "), options.clip.string());
  words.insert(words.end(), {"--json", "--log", log.string(), "--",
                             fs::absolute(options.clip).string()});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  SpawnFiles files;
  files.Redirect(STDOUT_FILENO, out);
  files.Redirect(STDERR_FILENO, err);
  pid_t child = 0;
  // The child is the very program that runs, whatever is on the PATH.
  // posix_spawn is used and not fork, since this process may have threads.
  const int refused = posix_spawn(&child, "/proc/self/exe", files.get(),
                                  nullptr, argv.data(), environ);
  run.end = refused == 0 ? DescribeExit(child)
                         : std::string("not started: ") + strerror(refused);
  run.out = ReadHead(out, kMostBytes);
  run.err = ReadHead(err, kMostBytes);
  run.log = ReadHead(log, kMostBytes);
  return run;
}

// Frame of the contact, where the document has one.
std::optional<std::int64_t> ReadContactFrame(const std::string& document) {
  const auto json = nlohmann::json::parse(document, nullptr, false);
  // A child that crashed leaves half a document or none.
  if (!json.is_object() || !json.contains("contact")) return std::nullopt;
  const auto& frame = json["contact"].value("frame", nlohmann::json());
  if (!frame.is_number()) return std::nullopt;
  return static_cast<std::int64_t>(std::floor(frame.get<double>()));
}

// The frames before and after the contact, the first and the last, then evenly
// between them.
std::set<std::int64_t> ChooseFrames(std::int64_t frames, int most,
                                    std::optional<std::int64_t> contact) {
  std::set<std::int64_t> chosen;
  // Frames are offered in the order of their worth until `most` are chosen;
  // those outside of the recording are passed over.
  const auto add = [&](std::int64_t index) {
    if (std::ssize(chosen) < most && index >= 0 && index < frames) {
      chosen.insert(index);
    }
  };
  if (contact) {
    for (const int step : {0, 1, -1, 2}) add(*contact + step);
  }
  add(0);
  add(frames - 1);
  for (int i = 1; i < most; ++i) add(i * (frames - 1) / most);
  return chosen;
}

// Adds whole frames as PNG, with the samples as they were recorded. Of a
// recording that cannot be opened or read on, the reason is added and its first
// bytes, in which its headers are.
void AddFrames(const BugOptions& options, const std::string& document,
               std::vector<BugFile>& files) {
  try {
    // Images tell no frame rate; pictures need none.
    vision::ClipOptions any_rate;
    any_rate.fps = 1.0;
    const auto clip = OpenRecording(options.clip, any_rate);
    for (const std::int64_t index : ChooseFrames(
             clip->info().frames, options.frames, ReadContactFrame(document))) {
      files.push_back({fmt::format("frames/{:06}.png", index),
                       fmt::format("frame {}, whole", index),
                       vision::EncodePng(clip->Read(index))});
    }
  } catch (const std::exception& error) {
    files.push_back({"frames/error.txt", "why there are no more frames",
                     std::string(error.what()) + "\n"});
    if (fs::is_regular_file(options.clip)) {
      files.push_back({"head.bin", "the recording's first bytes",
                       ReadHead(options.clip, kHeadBytes)});
    }
  }
}

// Adds what the analysis read beside the recording: the camera's header, in
// either spelling of its extension, and the files of `also`. What is not there
// is passed over.
void AddHeaders(const BugOptions& options, std::vector<BugFile>& files) {
  std::set<fs::path> headers(options.also.begin(), options.also.end());
  for (fs::path& header : ListCameraHeaders(options.clip)) {
    headers.insert(std::move(header));
  }
  for (const fs::path& header : headers) {
    std::error_code ignored;
    if (!fs::is_regular_file(header, ignored)) continue;
    files.push_back({"beside/" + header.filename().string(),
                     "what the analysis read beside the recording",
                     ReadHead(header, kMostBytes)});
  }
}

}  // namespace

std::vector<BugFile> CollectBug(const BugOptions& options) {
  if (options.frames < 0) {
    throw std::invalid_argument(
        fmt::format("--pictures is {}, must be 0 or more", options.frames));
  }
  std::error_code trouble;
  if (!fs::exists(options.clip, trouble)) {
    throw core::InputError(options.clip.string() +
                           ": there is no such recording");
  }
  // command.txt holds the program's version, the command, how it ended, and
  // what it said on standard error, a part a line.
  const Run run = RunAnalyze(options);
  std::vector<BugFile> files;
  files.push_back({"command.txt", "what was asked, and how it ended",
                   fmt::format("touchdown {} ({})\n{}\n{}\n{}", Version(),
                               Commit(), run.command, run.end, run.err)});
  files.push_back(
      {"doctor.txt", "the machine", ToText(Examine(options.doctor))});
  if (!run.out.empty()) {
    files.push_back({"analysis.json", "the answer", run.out});
  }
  if (!run.log.empty()) {
    files.push_back({"log.txt", "what was done and why", run.log});
  }
  AddHeaders(options, files);
  if (options.frames > 0) AddFrames(options, run.out, files);
  return files;
}

void WriteBug(std::span<const BugFile> files, const fs::path& target) {
  ZipFile zip(target);
  for (const BugFile& file : files) zip.Add(file.name, file.bytes);
  zip.Commit();
}

}  // namespace touchdown::pipeline
