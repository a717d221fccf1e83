// The disk is full at a random byte: every command that writes says so with
// exit status 6 (or 4, the store), leaves no half file, and has said nothing
// that is not so.
//
// Two kinds of full disk, by turns: no file may grow beyond a random byte
// (RLIMIT_FSIZE), and a file system of our own with room for a random number of
// pages (tmpfs in a namespace; where that is not allowed the first kind alone).
// Each command once; TOUCHDOWN_LONG_TESTS=1 makes 500 runs of them in turns.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/text_file.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/program.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::ReadText;

struct Command {
  std::string arguments;
  bool writes_store = false;
};

// In a folder with lab.db, other.db, film.mraw and its header,
// shot.json, trials.csv, rig.toml. TRIAL stands for the number of a trial.
std::vector<Command> CommandsOn(const std::string& trial) {
  std::vector<Command> commands = {
      {"rig example"},
      {"rig plan --rig rig.toml --angle-deg 20 --speed-mps 1.3 --json"},
      {"theory map --kappa 2.5 --corner leading --over mu --out map"},
      {"theory regime --kappa 2.5 --alpha-deg 30 --radius-m 0.1 --mu 0.3 "
       "--corner leading --out regime.txt"},
      {"theory boundary --kappa 2.5 --radius-m 0.1 --mu 0.3 --corner leading "
       "--json --out boundary.json"},
      {"calibrate scale film.mraw --points 10,10,90,10 --length-mm 100 --out "
       "scale.json"},
      {"calibrate ground film.mraw --points 5,90,95,90 --out ground.json"},
      {"simulate shot.json --out made"},
      {"simulate shot.json --out made --format png"},
      {"simulate shot.json --out made --format mp4"},
      {"analyze film.mraw --diameter-mm 24 --out seen --json"},
      {"analyze film.mraw --diameter-mm 24 --db lab.db", true},
      {"batch films --db lab.db --campaign asphalt --out seen", true},
      {"log --db lab.db --campaign asphalt --angle-deg 20 --angle-u-deg 0.5 "
       "--state bounce --by Ada",
       true},
      {"correct TRIAL --db lab.db --state stick --by Ada --why seen-again",
       true},
      {"campaign new gravel --db lab.db --body sphere --diameter-mm 30 "
       "--bounce-height-mm 0.5",
       true},
      {"campaign plan asphalt --db lab.db --design ascending --by Ada --why "
       "asked",
       true},
      {"register add body ball --db lab.db --by Ada --shape sphere "
       "--diameter-mm 24+-0.02",
       true},
      {"session --db lab.db --campaign asphalt --rig rig.toml --watch films "
       "--operator Ada --no-check --speed-mps 1.3",
       true},
      {"export --db lab.db --out all.csv"},
      {"export --db lab.db --out all.jsonl"},
      {"export --db lab.db --format csv"},
      {"import trials.csv --db lab.db --by Ada", true},
      {"db backup copy.db --db lab.db"},
      {"db merge other.db --db lab.db", true},
      {"report --db lab.db --out report"},
      {"list --db lab.db --json"},
      {"show TRIAL --db lab.db --history"},
      {"boundary --db lab.db --campaign asphalt --json"},
      {"next --db lab.db --campaign asphalt --json"},
  };
  for (Command& command : commands) {
    constexpr std::string_view kTrial = "TRIAL";
    const std::size_t at = command.arguments.find(kTrial);
    if (at != std::string::npos) {
      command.arguments.replace(at, kTrial.size(), trial);
    }
  }
  return commands;
}

constexpr const char* kRig =
    "schema = \"touchdown.rig/1\"\n"
    "[springs]\nstiffness_n_per_m = { value = 100.0, u = 1.0 }\n"
    "[ejector]\nu_compression_mm = 0.1\n"
    "[muzzle]\nelevation_min_deg = -45\nelevation_max_deg = 45\n"
    "height_min_mm = 15\nheight_max_mm = 80\n"
    "[body]\nkind = \"sphere\"\ndiameter_mm = 24\nmass_g = 10\n";

std::vector<std::string> Words(const std::string& arguments) {
  std::vector<std::string> words = {TOUCHDOWN_BINARY};
  std::istringstream in(arguments);
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

struct Limits {
  std::optional<rlim_t> file_bytes;   // of each file
  std::optional<std::int64_t> pages;  // left on the disk
};

// Everything that lies in a folder, by name; streams of ours left out.
std::map<std::string, std::string> Content(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(folder).string()] =
        ReadText(entry.path().string());
  }
  return files;
}

bool FillAllBut(const fs::path& folder, std::int64_t pages) {
  struct statvfs disk = {};
  if (statvfs(folder.c_str(), &disk) != 0) return false;
  const auto fill = static_cast<std::int64_t>(disk.f_bavail) - pages;
  const int file =
      open((folder / "filler").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const bool done =
      fill <= 0 ||
      posix_fallocate(file, 0, fill * static_cast<off_t>(disk.f_bsize)) == 0;
  close(file);
  return done;
}

// A new name space in which `folder` is a small disk of its own; false where
// this machine does not allow it.
bool MountSmallDisk(const fs::path& folder) {
  if (unshare(CLONE_NEWNS) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) {
    return false;
  }
  mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  return mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=24m") == 0;
}

// Runs in a copy of `prepared` under `limits`; what is left is in `result`.
// Nothing where there is no small disk here.
std::optional<int> RunIn(const fs::path& prepared, const fs::path& work,
                         const Command& command, const Limits& limits,
                         const fs::path& result, const std::string& out,
                         const std::string& err) {
  constexpr int kNoDisk = 99;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (limits.pages && !MountSmallDisk(work)) _exit(kNoDisk);
    fs::copy(prepared, work, fs::copy_options::recursive);
    fs::current_path(work);
    if (limits.pages && !FillAllBut(work, *limits.pages)) _exit(kNoDisk);
    const pid_t program = fork();
    if (program == 0) {
      auto words = Words(command.arguments);
      std::vector<char*> argv;
      for (auto& word : words) argv.push_back(word.data());
      argv.push_back(nullptr);
      if (limits.file_bytes) {
        const rlimit limit{*limits.file_bytes, *limits.file_bytes};
        setrlimit(RLIMIT_FSIZE, &limit);
      }
      dup2(open("/dev/null", O_RDONLY), 0);
      dup2(open("stdout.txt", O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
      execv(argv[0], argv.data());
      _exit(127);
    }
    int status = 0;
    waitpid(program, &status, 0);
    std::error_code ignored;
    fs::remove(work / "filler", ignored);
    fs::copy(work / "stdout.txt", out, ignored);
    fs::remove(work / "stdout.txt", ignored);
    fs::copy(work, result, fs::copy_options::recursive, ignored);
    _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 98);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const int exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 98;
  if (exit_status == kNoDisk) return std::nullopt;
  return exit_status;
}

class FullDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(prepared() / "films");
    pipeline::filmed::WriteSphere(prepared() / "film.mraw", 24.0, 1);
    pipeline::filmed::WriteSphere(prepared() / "films/a.mraw", 22.0, 2);
    report::WriteTextFile(prepared() / "rig.toml", kRig);
    const auto in = [&](const std::string& arguments, const char* out) {
      const std::string line = "cd '" + prepared().string() +
                               "' && " TOUCHDOWN_BINARY " " + arguments + " >" +
                               out + " 2>/dev/null";
      return std::system(line.c_str());
    };
    ASSERT_EQ(in("campaign new asphalt --db lab.db --body sphere "
                 "--diameter-mm 24 --bounce-height-mm 0.5",
                 "/dev/null"),
              0);
    for (int i = 0; i < 12; ++i) {
      const std::string angle = std::to_string(10 + i);
      ASSERT_EQ(in("log --db lab.db --campaign asphalt --angle-u-deg 0.5 --by "
                   "Ada --angle-deg " +
                       angle + " --state " + (i < 6 ? "slide" : "bounce"),
                   "/dev/null"),
                0);
    }
    // Trials that lab.db does not have.
    fs::copy(prepared() / "lab.db", prepared() / "other.db");
    ASSERT_EQ(in("log --db other.db --campaign asphalt --angle-u-deg 0.5 --by "
                 "Ada --angle-deg 30 --state bounce",
                 "/dev/null"),
              0);
    ASSERT_EQ(in("export --db other.db --format csv", "all.csv"), 0);
    std::istringstream all(ReadText((prepared() / "all.csv").string()));
    std::string heading;
    std::string last;
    std::getline(all, heading);
    for (std::string row; std::getline(all, row);) last = row;
    report::WriteTextFile(prepared() / "trials.csv",
                          heading + "\n" + last + "\n");
    fs::remove(prepared() / "all.csv");
    ASSERT_EQ(in("list --db lab.db --json", "list.json"), 0);
    commands_ = CommandsOn(nlohmann::json::parse(
        ReadText((prepared() / "list.json").string()))["trials"][0]["id"]);
    fs::remove(prepared() / "list.json");
    ASSERT_EQ(in("simulate --example", "shot.json"), 0);
  }
  fs::path prepared() const { return folder_ / "prepared"; }

  std::vector<Command> commands_;
  testing::TemporaryFolder folder_;
};

struct Count {
  int refused = 0;
  int done = 0;  // there was room enough
};

// What the program leaves under its working names, and nobody should meet.
bool IsWorkName(const std::string& name) {
  return name.find(".part") != std::string::npos;
}

TEST_F(FullDisk, IsSaidAndLeavesNoHalfFile) {
  const bool is_long = std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr;
  // Each command once, or as many as docs/hardening.md tells of.
  const int runs = is_long ? 500 : static_cast<int>(commands_.size());
  std::mt19937_64 random(20261126);
  const fs::path work = folder_ / "work";
  const auto before = Content(prepared());
  std::map<std::size_t, std::map<std::string, std::string>> whole;
  std::map<std::size_t, std::string> whole_out;
  std::map<std::size_t, Count> counts;
  int refused = 0;
  int disks = 0;
  bool has_disk = true;
  for (int run = 0; run < runs; ++run) {
    const std::size_t index = static_cast<std::size_t>(run) % commands_.size();
    const Command& command = commands_[index];
    SCOPED_TRACE(command.arguments + ", run " + std::to_string(run));
    const auto attempt = [&](const Limits& limits, std::string& out,
                             std::string& err) {
      const fs::path result = folder_ / "result";
      fs::remove_all(result);
      fs::remove_all(work);
      fs::create_directory(work);
      const fs::path out_file = folder_ / "out.txt";
      const fs::path err_file = folder_ / "err.txt";
      fs::remove(out_file);
      const auto status = RunIn(prepared(), work, command, limits, result,
                                out_file.string(), err_file.string());
      out = ReadText(out_file.string());
      err = ReadText(err_file.string());
      return status;
    };
    std::string out;
    std::string err;
    if (!whole.contains(index)) {
      const auto status = attempt({}, out, err);
      ASSERT_EQ(status, 0) << err;
      whole[index] = Content(folder_ / "result");
      whole_out[index] = out;
    }
    // What it writes at most into one file decides what is a limit.
    std::size_t longest = std::max<std::size_t>(whole_out[index].size(), 1);
    std::size_t all = whole_out[index].size();
    for (const auto& [name, bytes] : whole[index]) {
      const auto old = before.find(name);
      if (old != before.end() && old->second == bytes) continue;
      longest = std::max(longest, bytes.size());
      all += bytes.size();
    }
    Limits limits;
    const bool small_disk = has_disk && random() % 2 == 0;
    if (small_disk) {
      limits.pages = static_cast<std::int64_t>(random() % (all / 4096 + 2));
    } else {
      limits.file_bytes = random() % longest;
    }
    auto status = attempt(limits, out, err);
    if (!status) {
      has_disk = false;
      limits = {random() % longest, std::nullopt};
      status = attempt(limits, out, err);
    }
    disks += limits.pages ? 1 : 0;
    ASSERT_TRUE(status);
    EXPECT_THAT(*status, ::testing::AnyOf(0, 4, 6)) << err;
    const auto after = Content(folder_ / "result");
    if (*status == 0) {
      ++counts[index].done;
      EXPECT_EQ(out.size() < whole_out[index].size() / 2, false) << out;
    } else {
      ++refused;
      ++counts[index].refused;
      // The file that takes the message has the same limit.
      if (!limits.file_bytes || err.size() < *limits.file_bytes) {
        EXPECT_THAT(err, ::testing::StartsWith("touchdown: "));
        EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
      }
      // Nothing is said of what is not there: of a trial, or all that is said
      // of what was done.
      const bool says_all = !out.empty() && out == whole_out[index];
      if (command.writes_store &&
          (says_all || out.find("logged") != std::string::npos)) {
        EXPECT_NE(after.at("lab.db"), before.at("lab.db")) << out;
      }
    }
    for (const auto& [name, bytes] : after) {
      EXPECT_FALSE(IsWorkName(name)) << name;
      // Stores have files of SQLite's beside them where it could not end its
      // work; the next who opens them does.
      if (name.starts_with("lab.db") || name.ends_with("-wal") ||
          name.ends_with("-shm")) {
        continue;
      }
      const auto old = before.find(name);
      if (old != before.end() && old->second == bytes) continue;
      // It is new, and whole: as long as without a limit, but for the digits
      // of times.
      const auto one = whole[index].find(name);
      if (one == whole[index].end()) {
        ADD_FAILURE() << name << " is made with a full disk only";
        continue;
      }
      EXPECT_GE(bytes.size() + 64, one->second.size()) << name;
      if (!one->second.empty() && !bytes.empty()) {
        EXPECT_EQ(bytes.back(), one->second.back()) << name;
      }
    }
    // The store is sound, whatever happened.
    if (command.writes_store && after.contains("lab.db")) {
      EXPECT_EQ(
          std::system(
              (std::string(TOUCHDOWN_BINARY) + " db check --no-clips --db " +
               (folder_ / "result/lab.db").string() + " >/dev/null 2>&1")
                  .c_str()),
          0);
    }
    if (HasFailure()) break;
  }
  std::printf("%d runs with a full disk, %d of them on a small disk\n", runs,
              disks);
  for (const auto& [index, count] : counts) {
    std::printf("%3d refused %3d had room: %s\n", count.refused, count.done,
                commands_[index].arguments.c_str());
  }
  EXPECT_GT(refused, runs / 3);
  if (!has_disk) {
    std::printf("no small disk can be mounted here: RLIMIT_FSIZE alone\n");
  }
}

TEST_F(FullDisk, OutputThatNobodyCanTakeIsStatus6) {
  for (const Command& command : commands_) {
    if (command.arguments.find("--out") != std::string::npos ||
        command.arguments.starts_with("db backup") ||
        command.arguments.starts_with("campaign plan")) {  // says nothing
      continue;
    }
    SCOPED_TRACE(command.arguments);
    for (const char* streams : {">/dev/full", ">&-"}) {
      const fs::path work = folder_ / "work";
      fs::remove_all(work);
      fs::copy(prepared(), work, fs::copy_options::recursive);
      const fs::path err = folder_ / "err.txt";
      const std::string line =
          "cd '" + work.string() + "' && " TOUCHDOWN_BINARY " " +
          command.arguments + " " + streams + " 2>" + err.string();
      EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 6);
      EXPECT_THAT(ReadText(err.string()), HasSubstr("touchdown: stdout"));
    }
  }
}

// A message that nobody takes changes nothing.
TEST_F(FullDisk, AFullStderrChangesNoStatus) {
  for (const char* streams : {"2>/dev/full", "2>&-", "2>/dev/full >/dev/full",
                              ">&- 2>&-", "<&- >/dev/null 2>&-"}) {
    SCOPED_TRACE(streams);
    const auto status = [&](const std::string& arguments) {
      const std::string line = "cd '" + prepared().string() +
                               "' && " TOUCHDOWN_BINARY " " + arguments + " " +
                               streams;
      const int ended = std::system(line.c_str());
      return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
    };
    EXPECT_EQ(status("analyze"), 2);
    EXPECT_EQ(status("analyze nothing.mraw"), 3);
    EXPECT_EQ(status("list --db nothing.db"), 4);
    EXPECT_EQ(status("rig spring --wire-mm -1"), 2);
  }
}

TEST_F(FullDisk, OutputsAreNoLinksAndNoDevices) {
  const auto refused = [&](const std::string& arguments,
                           const std::string& why) {
    const std::string err = (folder_ / "err.txt").string();
    const std::string line = "cd '" + prepared().string() +
                             "' && timeout 20 " TOUCHDOWN_BINARY " " +
                             arguments + " >/dev/null 2>" + err;
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 6) << arguments;
    EXPECT_THAT(ReadText(err), HasSubstr(why));
  };
  const fs::path victim = prepared() / "victim.csv";
  report::WriteTextFile(victim, "mine");
  fs::create_symlink("victim.csv", prepared() / "link.csv");
  ASSERT_EQ(mkfifo((prepared() / "pipe.csv").c_str(), 0600), 0);
  refused("export --db lab.db --out link.csv", "symbolic link");
  refused("export --db lab.db --out pipe.csv", "no plain file");
  refused("export --db lab.db --format csv --out /dev/null", "no plain file");
  EXPECT_EQ(ReadText(victim.string()), "mine");
  EXPECT_TRUE(fs::is_symlink(prepared() / "link.csv"));
  EXPECT_TRUE(fs::is_fifo(prepared() / "pipe.csv"));
}

TEST_F(FullDisk, NamesInMessagesAreHarmless) {
  const std::string err = (folder_ / "err.txt").string();
  const auto said = [&](const std::string& name) {
    const std::string line =
        TOUCHDOWN_BINARY " analyze $'" + name + "' 2>" + err + " >/dev/null";
    std::system(("bash -c \"" + line + "\"").c_str());
    return ReadText(err);
  };
  EXPECT_THAT(said("a\\\\nb.mraw"), HasSubstr("a\\x0ab.mraw"));
  EXPECT_THAT(said("\\\\x1b[31mred.mraw"), HasSubstr("\\x1b[31mred"));
  EXPECT_THAT(said("\\\\xc2\\\\x9b31m.mraw"), HasSubstr("\\xc2\\x9b31m"));
  EXPECT_THAT(said("\\\\xe2\\\\x80\\\\xaegpj.mraw"),
              HasSubstr("\\xe2\\x80\\xaegpj"));
  EXPECT_THAT(said("\\\\xff.mraw"), HasSubstr("\\xff.mraw"));
  EXPECT_THAT(said("gr\\\\xc3\\\\xbcn.mraw"), HasSubstr("gr\xc3\xbcn.mraw"));
}

}  // namespace
}  // namespace touchdown
