// The disk is full at a random byte: every command that writes says so with
// exit status 6 (or 4, the store), leaves no half file, and has said nothing
// that is not so.
//
// Two kinds of full disk, by turns: no file may grow beyond a random byte
// (RLIMIT_FSIZE), and a file system of our own with room for a random number of
// pages (tmpfs in a namespace; where that is not allowed the first kind alone).
// Limits lie below what the command writes where there is room: between the
// bytes that are there before it and those that are there after it; where one
// was enough, those after it lie below it.
// Each command once; TOUCHDOWN_LONG_TESTS=1 makes 500 runs of them in turns,
// in four parts for the time limit of one test.
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
#include <array>
#include <csignal>
#include <cstdio>
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

#include "app/text/text_file.h"
#include "tests/db/old_store.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/board_files.h"
#include "tests/support/local_socket.h"
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
  std::string store = {};  // that it writes; empty: none
  // A server, asked for this; what it answers is the result.
  std::string request = {};
  // Of several seconds and 300 MB: in the long form alone, and seldom there.
  bool is_dear = false;
};

constexpr const char* kStore = "lab.db";

// In a folder with lab.db, other.db, old.db of an older program, film.mraw and
// its header, pictures of a board, shot.json, trials.csv, force.csv, rig.toml.
// TRIAL stands for the number of a trial.
std::vector<Command> CommandsOn(const std::string& trial) {
  std::vector<Command> commands = {
      {"rig example"},
      {"rig spring --rig rig.toml --json"},
      {"rig calibrate --stiffness-n-per-m 7744 --mass-g 100 --force force.csv "
       "--json"},
      {"rig plan --rig rig.toml --angle-deg 20 --speed-mps 1.3 --json"},
      {"theory map --kappa 2.5 --corner leading --over mu --out map"},
      {"theory regime --kappa 2.5 --alpha-deg 30 --radius-m 0.1 --mu 0.3 "
       "--corner leading --out regime.txt"},
      {"theory boundary --kappa 2.5 --radius-m 0.1 --mu 0.3 --corner leading "
       "--json --out boundary.json"},
      {"calibrate scale film.mraw --points 10,10,90,10 --length-mm 100 --out "
       "scale.json"},
      {"calibrate lens board --board chessboard:7x5:20mm --date 2026-01-31 "
       "--out lens.json"},
      {"calibrate ground film.mraw --points 5,90,95,90 --out ground.json"},
      {"simulate shot.json --out made"},
      {"simulate shot.json --out made --format png"},
      {"simulate shot.json --out made --format mp4"},
      {"analyze film.mraw --diameter-mm 24 --out seen --json"},
      {"analyze film.mraw --diameter-mm 24 --db lab.db", kStore},
      {"batch films --db lab.db --campaign asphalt --out seen", kStore},
      {"log --db lab.db --campaign asphalt --angle-deg 20 --angle-u-deg 0.5 "
       "--state bounce --by Ada",
       kStore},
      {"correct TRIAL --db lab.db --state stick --by Ada --why seen-again",
       kStore},
      {"campaign new gravel --db lab.db --body sphere --diameter-mm 30 "
       "--bounce-height-mm 0.5",
       kStore},
      {"campaign plan asphalt --db lab.db --design ascending --by Ada --why "
       "asked",
       kStore},
      {"register add body ball --db lab.db --by Ada --shape sphere "
       "--diameter-mm 24+-0.02",
       kStore},
      {"register change body marble --db lab.db --by Ada --why "
       "measured-again --diameter-mm 24.1+-0.02",
       kStore},
      {"db migrate --db old.db", "old.db"},
      {"review --db lab.db --no-open", kStore,
       "POST /api/log {\"campaign\": \"asphalt\", \"who\": \"Ada\", "
       "\"angle_deg\": \"20\", \"angle_u_deg\": \"0.5\", \"state\": "
       "\"bounce\"}"},
      {"review --db lab.db --no-open", kStore,
       "POST /api/trials/TRIAL/revisions {\"revision\": 1, \"who\": \"Ada\", "
       "\"why\": \"dust\", \"exclude\": true}"},
      {"review --db lab.db --no-open", "", "POST /api/report {}"},
      {"session --db lab.db --campaign asphalt --rig rig.toml --watch films "
       "--operator Ada --no-check --speed-mps 1.3",
       kStore},
      {"export --db lab.db --out all.csv"},
      {"export --db lab.db --out all.jsonl"},
      {"export --db lab.db --format csv"},
      {"import trials.csv --db lab.db --by Ada", kStore},
      {"db backup copy.db --db lab.db"},
      {"db merge other.db --db lab.db", kStore},
      {"report --db lab.db --out report", kStore},
      {"list --db lab.db --json"},
      {"show TRIAL --db lab.db --history"},
      {"register list --db lab.db --json"},
      {"campaign show asphalt --db lab.db"},
      {"db check --db lab.db"},
      {"boundary --db lab.db --campaign asphalt --json", kStore},
      {"next --db lab.db --campaign asphalt --json", kStore},
      {"demo --out demo", "", "", true},
  };
  for (Command& command : commands) {
    constexpr std::string_view kTrial = "TRIAL";
    for (std::string* text : {&command.arguments, &command.request}) {
      const std::size_t at = text->find(kTrial);
      if (at != std::string::npos) text->replace(at, kTrial.size(), trial);
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
  return mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=400m") == 0;
}

// Asks a server, which tells its address through `from`, for "METHOD TARGET
// BODY"; its answer's body is in `out`. The exit status of a command that had
// ended so, with its line in `err`; nothing where the server did not begin.
std::optional<int> AskServer(int from, const std::string& request,
                             const std::string& out, const std::string& err) {
  FILE* const said = fdopen(from, "r");
  std::array<char, 512> line{};
  const bool begun = std::fgets(line.data(), line.size(), said) != nullptr;
  std::fclose(said);
  if (!begun) return std::nullopt;
  const std::string address = line.data();
  constexpr std::string_view kHost = "127.0.0.1:";
  constexpr std::string_view kToken = "token=";
  const std::string key = address.substr(address.find(kToken) + kToken.size());
  std::istringstream words(request);
  std::string method;
  std::string target;
  std::string body;
  words >> method >> target;
  std::getline(words >> std::ws, body);
  const std::string answer = testing::AskLocal(
      std::stoi(address.substr(address.find(kHost) + kHost.size())), method,
      target,
      "Content-Type: application/json\r\nX-Touchdown-Token: " +
          key.substr(0, key.size() - 1) + "\r\n",
      body);
  const std::size_t head = answer.find("\r\n\r\n");
  if (head == std::string::npos) return 98;
  body = answer.substr(head + 4);
  if (answer.starts_with("HTTP/1.1 200")) {
    report::WriteTextFile(out, body);
    return 0;
  }
  // One line that a person can read, as of a command.
  const auto error = nlohmann::json::parse(body, nullptr, false);
  if (!error.is_object() || !error.contains("error")) return 98;
  report::WriteTextFile(
      err, "touchdown: " + error["error"].get<std::string>() + "\n");
  if (answer.starts_with("HTTP/1.1 503")) return 4;
  return answer.starts_with("HTTP/1.1 507") ? 6 : 98;
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
    int pipe_ends[2] = {-1, -1};
    if (!command.request.empty() && pipe2(pipe_ends, O_CLOEXEC) != 0) {
      _exit(98);
    }
    const pid_t program = fork();
    if (program == 0) {
      auto words = Words(command.arguments);
      std::vector<char*> argv;
      for (auto& word : words) argv.push_back(word.data());
      argv.push_back(nullptr);
      if (limits.file_bytes) {
        // Shared memory is no disk: the reader's process may lift the limit.
        rlimit limit = {};
        getrlimit(RLIMIT_FSIZE, &limit);
        limit.rlim_cur = *limits.file_bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
      }
      dup2(open("/dev/null", O_RDONLY), 0);
      dup2(command.request.empty()
               ? open("stdout.txt", O_WRONLY | O_CREAT | O_TRUNC, 0600)
               : pipe_ends[1],
           1);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
      execv(argv[0], argv.data());
      _exit(127);
    }
    std::optional<int> answered;
    if (!command.request.empty()) {
      close(pipe_ends[1]);
      answered = AskServer(pipe_ends[0], command.request, out, err);
      kill(program, SIGTERM);
    }
    int status = 0;
    waitpid(program, &status, 0);
    // A server ends as it began: what it answered counts.
    if (answered && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
      status = *answered << 8;
    }
    std::error_code ignored;
    fs::remove(work / "filler", ignored);
    if (command.request.empty()) fs::copy(work / "stdout.txt", out, ignored);
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

// What a command adds where there is room.
struct Growth {
  std::size_t longest = 1;  // into one file, bytes
  std::size_t pages = 1;    // in all files
};

constexpr std::size_t kPage = 4096;

Growth MeasureGrowth(const std::map<std::string, std::string>& before,
                     const std::map<std::string, std::string>& after,
                     const std::string& store, std::size_t out_bytes) {
  Growth growth{std::max<std::size_t>(out_bytes, 1), out_bytes / kPage + 1};
  for (const auto& [name, bytes] : after) {
    const auto old = before.find(name);
    if (old == before.end()) {
      growth.longest = std::max(growth.longest, bytes.size());
      growth.pages += bytes.size() / kPage + 1;
    } else if (name == store) {
      // Each page that differs is first written to the log beside the store.
      std::size_t changed = 0;
      for (std::size_t at = 0; at < bytes.size(); at += kPage) {
        const bool is_new = at >= old->second.size();
        changed +=
            is_new || bytes.compare(at, kPage, old->second, at, kPage) ? 1 : 0;
      }
      constexpr std::size_t kFrameHead = 24;
      growth.longest = std::max(growth.longest, changed * (kPage + kFrameHead));
      growth.pages += changed;
    } else if (old->second != bytes) {
      growth.longest = std::max(growth.longest, bytes.size());
      growth.pages += bytes.size() / kPage + 1;
    }
  }
  return growth;
}

// Which command each run is of.
std::vector<std::size_t> Turns(const std::vector<Command>& commands, int runs) {
  constexpr int kDearEvery = 25;
  std::vector<std::size_t> cheap;
  std::vector<std::size_t> dear;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    (commands[i].is_dear ? dear : cheap).push_back(i);
  }
  std::vector<std::size_t> turns;
  std::size_t next = 0;
  for (int run = 0; run < runs; ++run) {
    const bool is_dear = !dear.empty() && run % kDearEvery == kDearEvery - 1;
    turns.push_back(is_dear ? dear[static_cast<std::size_t>(run) % dear.size()]
                            : cheap[next++ % cheap.size()]);
  }
  return turns;
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
    ASSERT_EQ(in("register add body marble --db lab.db --by Ada --shape sphere "
                 "--diameter-mm 24+-0.02",
                 "/dev/null"),
              0);
    db::MakeOldStore(prepared() / "old.db", 3);  // as of d7ea65b
    report::WriteTextFile(prepared() / "force.csv",
                          "compression_mm,force_n\n5,40.7\n10,79.4\n15,118.2\n"
                          "20,156.9\n");
    fs::create_directory(prepared() / "board");
    testing::WriteBoardPictures(prepared() / "board", 9);
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

constexpr int kParts = 4;
class FullDiskRuns : public FullDisk,
                     public ::testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(Parts, FullDiskRuns, ::testing::Range(0, kParts));

TEST_P(FullDiskRuns, AreRefusedAndLeaveNoHalfFile) {
  const bool is_long = std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr;
  std::vector<Command> commands;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    if (static_cast<int>(i % kParts) != GetParam()) continue;
    if (is_long || !commands_[i].is_dear) commands.push_back(commands_[i]);
  }
  // Each command once, or as many as docs/hardening.md tells of.
  const int runs = is_long ? 500 / kParts : static_cast<int>(commands.size());
  const std::vector<std::size_t> turns = Turns(commands, runs);
  std::mt19937_64 random(20261126 + static_cast<std::uint64_t>(GetParam()));
  const fs::path work = folder_ / "work";
  const auto before = Content(prepared());
  std::map<std::size_t, std::map<std::string, std::string>> whole;
  std::map<std::size_t, std::string> whole_out;
  std::map<std::size_t, Growth> room;  // below which limits are drawn
  std::map<std::size_t, Count> counts;
  int refused = 0;
  int disks = 0;
  bool has_disk = true;
  for (int run = 0; run < runs; ++run) {
    const std::size_t index = turns[static_cast<std::size_t>(run)];
    const Command& command = commands[index];
    SCOPED_TRACE(command.arguments + " " + command.request + ", run " +
                 std::to_string(run));
    const auto attempt = [&](const Limits& limits, std::string& out,
                             std::string& err) {
      const fs::path result = folder_ / "result";
      fs::remove_all(result);
      fs::remove_all(work);
      fs::create_directory(work);
      const fs::path out_file = folder_ / "out.txt";
      const fs::path err_file = folder_ / "err.txt";
      fs::remove(out_file);
      fs::remove(err_file);
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
    if (!room.contains(index)) {
      room[index] = MeasureGrowth(before, whole[index], command.store,
                                  whole_out[index].size());
    }
    Growth& enough = room[index];
    Limits limits;
    const bool small_disk = has_disk && random() % 2 == 0;
    if (small_disk) {
      limits.pages = static_cast<std::int64_t>(random() % enough.pages);
    } else {
      limits.file_bytes = random() % enough.longest;
    }
    auto status = attempt(limits, out, err);
    if (!status) {
      has_disk = false;
      limits = {random() % enough.longest, std::nullopt};
      status = attempt(limits, out, err);
    }
    disks += limits.pages ? 1 : 0;
    ASSERT_TRUE(status);
    EXPECT_THAT(*status, ::testing::AnyOf(0, 4, 6)) << err;
    const auto after = Content(folder_ / "result");
    // An answer is given without its look on record, and says so.
    const bool is_unrecorded =
        err.find("this look is not on record") != std::string::npos;
    if (*status == 0) {
      ++counts[index].done;
      if (limits.pages) {
        enough.pages =
            std::max<std::size_t>(1, static_cast<std::size_t>(*limits.pages));
      } else {
        enough.longest = std::max<std::size_t>(1, *limits.file_bytes);
      }
      EXPECT_EQ(out.size() < whole_out[index].size() / 2, false) << out;
      // What it says it has stored is there.
      if (!command.store.empty() && !is_unrecorded &&
          whole[index].at(command.store) != before.at(command.store)) {
        EXPECT_TRUE(after.at(command.store) != before.at(command.store) ||
                    after.contains(command.store + "-wal"))
            << out;
      }
    } else {
      ++refused;
      ++counts[index].refused;
      // The file that takes the message has the same limit.
      if (!limits.file_bytes || err.size() < *limits.file_bytes) {
        EXPECT_THAT(err, ::testing::StartsWith("touchdown: "));
        EXPECT_EQ(std::count(err.begin(), err.end(), '\n'),
                  is_unrecorded ? 2 : 1)
            << err;
      }
      // Nothing is said of what is not there: of a trial, or all that is said
      // of what was done.
      const bool says_all = !out.empty() && out == whole_out[index];
      if (!command.store.empty() && !is_unrecorded &&
          (says_all || out.find("logged") != std::string::npos)) {
        EXPECT_NE(after.at(command.store), before.at(command.store)) << out;
      }
    }
    for (const auto& [name, bytes] : after) {
      EXPECT_FALSE(IsWorkName(name)) << name;
      // Stores have files of SQLite's beside them where it could not end its
      // work; the next who opens them does.
      if (name == command.store || name.starts_with("lab.db") ||
          name.ends_with("-wal") || name.ends_with("-shm")) {
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
    // The store is sound, whatever happened; an older one is as it was, or is
    // brought to this program.
    if (!command.store.empty() && after.contains(command.store)) {
      const std::string db = " --db " +
                             (folder_ / "result" / command.store).string() +
                             " >/dev/null 2>&1";
      const std::string program = TOUCHDOWN_BINARY;
      if (command.store != kStore) {
        EXPECT_EQ(std::system((program + " db migrate" + db).c_str()), 0);
      }
      EXPECT_EQ(std::system((program + " db check --no-clips" + db).c_str()),
                0);
    }
    if (HasFailure()) break;
  }
  std::printf("%d runs with a full disk, %d of them on a small disk\n", runs,
              disks);
  for (const auto& [index, count] : counts) {
    std::printf("%3d refused %3d had room: %s %s\n", count.refused, count.done,
                commands[index].arguments.c_str(),
                commands[index].request.c_str());
  }
  std::printf("%d refused in all\n", refused);
  EXPECT_GT(refused, runs * 2 / 3);
  if (!has_disk) {
    std::printf("no small disk can be mounted here: RLIMIT_FSIZE alone\n");
  }
}

TEST_F(FullDisk, OutputThatNobodyCanTakeIsStatus6) {
  for (const Command& command : commands_) {
    if (command.arguments.find("--out") != std::string::npos ||
        !command.request.empty() ||
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
