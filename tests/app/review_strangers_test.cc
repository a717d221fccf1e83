// touchdown review beside others on the machine: what another user learns of
// the trials, and what a crowd of slow and large requests does to the person
// who has the key.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/pipeline/film_file.h"
#include "tests/support/local_socket.h"
#include "tests/support/process_memory.h"
#include "tests/support/run_program.h"
#include "tests/support/running_program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;
using testing::AskLocal;
using ::testing::HasSubstr;
using testing::LocalSocket;
using testing::RunProgram;

// Words of the trial that stand in no other place.
constexpr const char* kWho = "Zerlina Quandt";
constexpr const char* kNote = "chipped-at-the-rim";

// A store with a trial of a recording and one by hand.
struct Lab {
  Lab() {
    pipeline::filmed::WriteSphere(folder / "film.mraw", 24.0, 1);
    const std::string of_store = " --db " + (folder / "lab.db").string();
    for (const std::string& arguments :
         {"campaign new board --body sphere --diameter-mm 24 "
          "--bounce-height-mm 0.5" +
              of_store,
          "analyze " + (folder / "film.mraw").string() +
              " --diameter-mm 24 --campaign board" + of_store,
          "log --campaign board --angle-deg 20 --angle-u-deg 0.5 --state "
          "bounce --by '" +
              std::string(kWho) + "' --note " + kNote + of_store}) {
      const auto ran = RunProgram(arguments);
      EXPECT_EQ(ran.status, 0) << ran.err;
    }
    const auto list = nlohmann::json::parse(
        RunProgram("list --json" + of_store).out)["trials"];
    for (const auto& trial : list) trials.push_back(trial["id"]);
  }

  std::vector<std::string> Command() const {
    return {TOUCHDOWN_BINARY, "review", "--db", (folder / "lab.db").string()};
  }

  testing::TemporaryFolder folder;
  std::vector<std::string> trials;
};

struct Place {
  // Of the line that the program prints first.
  explicit Place(const std::string& line) {
    constexpr std::string_view kHost = "127.0.0.1:";
    constexpr std::string_view kToken = "token=";
    port = std::atoi(line.c_str() + line.find(kHost) + kHost.size());
    key = line.substr(line.find(kToken) + kToken.size());
    key.pop_back();
  }
  std::string KeyField() const { return "X-Touchdown-Token: " + key + "\r\n"; }

  int port = 0;
  std::string key;
};

// --- another user of the machine ---------------------------------------------

// What can be read of a file or of a link's target; of an endless one its
// beginning.
std::string Readable(const fs::path& path) {
  std::error_code ignored;
  std::string all = fs::read_symlink(path, ignored).string();
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return all;
  std::vector<char> piece(1 << 16);
  for (int k = 0; k < 64; ++k) {
    const ssize_t n = read(file, piece.data(), piece.size());
    if (n <= 0) break;
    all.append(piece.data(), static_cast<std::size_t>(n));
  }
  close(file);
  return all;
}

std::string ReadableOfProcess(pid_t process) {
  const fs::path own = "/proc/" + std::to_string(process);
  std::string all;
  for (const char* name :
       {"cmdline", "environ", "comm", "status", "maps", "mem", "stack",
        "syscall", "io", "auxv", "cwd", "root", "exe"}) {
    all += Readable(own / name);
  }
  for (const char* name : {"fd", "map_files", "cwd"}) {
    std::error_code refused;
    for (fs::directory_iterator at(own / name, refused), end; at != end;
         at.increment(refused)) {
      all += Readable(at->path());
    }
  }
  return all;
}

std::string ReadableIn(const fs::path& folder) {
  std::string all;
  std::error_code refused;
  for (fs::recursive_directory_iterator
           at(folder, fs::directory_options::skip_permission_denied, refused),
       end;
       at != end; at.increment(refused)) {
    all += at->path().string() + "\n" + Readable(at->path());
  }
  return all;
}

// Answers to whoever has no key.
std::string AnswersWithoutKey(int port, const std::vector<std::string>& trials,
                              bool& all_refused) {
  std::string all;
  all_refused = true;
  std::vector<std::string> targets = {"/",
                                      "/?token=",
                                      "/?token=0",
                                      "/api/stamp",
                                      "/api/trials",
                                      "/api/statistics",
                                      "/report/table1.csv",
                                      "/api/plots/0",
                                      "//api/trials",
                                      "/page/../api/trials",
                                      "/nothing"};
  for (const auto& id : trials) {
    targets.push_back("/api/trials/" + id);
    targets.push_back("/api/trials/" + id + "/frames/0");
  }
  const std::string cookie = "Cookie: touchdown_" + std::to_string(port) + "=";
  for (const auto& target : targets) {
    for (const std::string& fields :
         {std::string(), std::string("X-Touchdown-Token: \r\n"),
          std::string("X-Touchdown-Token: 0\r\n"), cookie + "\r\n",
          cookie + std::string(36, '0') + "\r\n",
          std::string("X-Forwarded-For: 127.0.0.1\r\n")}) {
      for (const char* method : {"GET", "HEAD", "POST", "OPTIONS"}) {
        const bool sends = std::string_view(method) == "POST";
        const std::string answer = AskLocal(
            port, method, target,
            fields + (sends ? "Content-Type: application/json\r\n" : ""),
            sends ? "{}" : "");
        // 403 above all; 501 of a method that nobody may use.
        all_refused = all_refused && (answer.starts_with("HTTP/1.1 4") ||
                                      answer.starts_with("HTTP/1.1 501"));
        all += answer;
      }
    }
  }
  return all;
}

// What another user gathers; his process tells it through a pipe.
std::string AsAnotherUser(const std::vector<pid_t>& processes,
                          const fs::path& shared_folder, int port,
                          const std::vector<std::string>& trials) {
  constexpr unsigned kNobody = 65534;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return "";
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 ||
        setuid(kNobody) != 0) {
      _exit(1);
    }
    std::string all;
    for (const pid_t process : processes) all += ReadableOfProcess(process);
    all += ReadableIn(shared_folder);
    all += ReadableIn("/dev/shm");
    bool all_refused = false;
    all += AnswersWithoutKey(port, trials, all_refused);
    all += all_refused ? "\nEVERY REQUEST WAS REFUSED" : "";
    const char* at = all.data();
    for (std::size_t left = all.size(); left > 0;) {
      const ssize_t n = write(ends[1], at, left);
      if (n <= 0) _exit(1);
      at += n;
      left -= static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(ends[1]);
  std::string all;
  std::vector<char> piece(1 << 16);
  for (ssize_t n = 0; (n = read(ends[0], piece.data(), piece.size())) > 0;) {
    all.append(piece.data(), static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  return all;
}

TEST(ReviewStrangers, AnotherUserOfTheMachineGetsNothing) {
  if (geteuid() != 0) {
    GTEST_SKIP() << "only root can become another user";
  }
  const Lab lab;
  ASSERT_EQ(lab.trials.size(), 2u);
  // A folder for temporary files as all share it, and no folder of the user's
  // own; the trials themselves lie where he alone may look.
  const testing::TemporaryFolder shared;
  fs::permissions(shared.path(), fs::perms::all | fs::perms::sticky_bit);
  const std::string place = shared.path().string();
  // What opens the browser tells that it runs, and then stays for a while.
  ASSERT_EQ(mkfifo((lab.folder / "runs").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((lab.folder / "ends").c_str(), 0600), 0);
  fs::create_directory(lab.folder / "bin");
  const fs::path opener = lab.folder.Write(
      "bin/xdg-open", "#!/bin/sh\necho $$ > '" +
                          (lab.folder / "runs").string() + "'\nread x < '" +
                          (lab.folder / "ends").string() + "'\n");
  fs::permissions(opener, fs::perms::owner_all);
  std::vector<std::string> command = {
      "/usr/bin/env",
      "-u",
      "XDG_RUNTIME_DIR",
      "TMPDIR=" + place,
      "DISPLAY=:0",
      "PATH=" + (lab.folder / "bin").string() + ":/usr/bin:/bin"};
  for (const auto& word : lab.Command()) command.push_back(word);
  testing::RunningProgram program(command);
  const Place server(program.Line());
  ASSERT_GE(server.key.size(), 32u);
  const pid_t runs = std::stoi(testing::ReadAll(lab.folder / "runs"));

  // The person who has the key sees what is looked for below.
  const std::string seen =
      AskLocal(server.port, "GET", "/api/trials/" + lab.trials[0],
               server.KeyField()) +
      AskLocal(server.port, "GET", "/api/trials/" + lab.trials[1],
               server.KeyField());
  EXPECT_THAT(seen, HasSubstr(kWho));
  EXPECT_THAT(seen, HasSubstr(kNote));
  EXPECT_THAT(seen, HasSubstr("\"view\""));
  // And the file of the browser is there to be found.
  const std::string files = ReadableIn(shared.path());
  EXPECT_THAT(files, HasSubstr(server.key));

  const std::string got =
      AsAnotherUser({program.pid(), runs}, shared.path(), server.port,
                    {lab.trials[0], lab.trials[1]});
  const auto has = [&](std::string_view what, std::size_t from = 0) {
    return got.find(what, from) != std::string::npos;
  };
  // He was there: he sees the names of what he may not read.
  EXPECT_TRUE(has("review"));
  EXPECT_TRUE(has(place + "/touchdown-"));
  EXPECT_TRUE(has("EVERY REQUEST WAS REFUSED"));
  EXPECT_FALSE(has(server.key));
  EXPECT_FALSE(has(kWho));
  EXPECT_FALSE(has(kNote));
  const std::size_t answers = got.find("HTTP/1.1");
  EXPECT_FALSE(has("\"trials\"", answers));
  EXPECT_FALSE(has("\"view\"", answers));
  EXPECT_FALSE(has("\x89PNG", answers));
  std::printf("%zu bytes gathered by another user, none of them of a trial\n",
              got.size());
  std::ofstream(lab.folder / "ends") << "end\n";
  EXPECT_EQ(program.End(SIGTERM), 0);
  EXPECT_TRUE(fs::is_empty(shared.path()));
}

// --- a crowd -----------------------------------------------------------------

TEST(ReviewStrangers, ACrowdKeepsNobodyWaitingAndTakesNoMemory) {
  // The sanitizer keeps memory that was given back, to see who uses it still,
  // and a map of all memory.
#ifdef __SANITIZE_ADDRESS__
  constexpr double kSanitizer_MB = 700.0;
#else
  constexpr double kSanitizer_MB = 0.0;
#endif
  constexpr int kSlow = 200;
  constexpr int kAsked = 40;
  constexpr int kBodies = 8;
  const Lab lab;
  ASSERT_EQ(lab.trials.size(), 2u);
  auto command = lab.Command();
  command.emplace_back("--no-open");
  testing::RunningProgram program(command);
  const Place server(program.Line());
  // Heads without an end, and bodies that were promised by the user's own.
  std::vector<std::unique_ptr<LocalSocket>> slow;
  for (int i = 0; i < kSlow; ++i) {
    slow.push_back(std::make_unique<LocalSocket>(server.port));
    EXPECT_TRUE(slow.back()->Send(
        i % 2 == 0
            ? "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nA: "
            : "POST /api/log HTTP/1.1\r\nHost: 127.0.0.1:" +
                  std::to_string(server.port) + "\r\n" + server.KeyField() +
                  "Content-Type: application/json\r\n"
                  "Content-Length: 100000\r\n\r\n{"));
  }
  // Bodies of 1 GB, one after the other, each until the server closes.
  std::atomic<bool> is_done = false;
  std::atomic<std::int64_t> bodies = 0;  // refused, or sent to the end
  std::atomic<std::int64_t> sent_MiB = 0;
  const std::vector<std::string> kinds = {
      "Content-Length: 1073741824\r\n", "Transfer-Encoding: chunked\r\n",
      "Content-Encoding: gzip\r\nContent-Length: 1073741824\r\n",
      server.KeyField() +
          "Content-Type: application/json\r\nContent-Length: 1073741824\r\n"};
  std::vector<std::thread> large;
  large.reserve(kinds.size());
  for (const auto& kind : kinds) {
    large.emplace_back([&, kind] {
      const std::string piece(std::size_t{1} << 20, 'x');
      while (!is_done) {
        const LocalSocket socket(server.port);
        socket.Send("POST /api/log HTTP/1.1\r\nHost: 127.0.0.1:" +
                    std::to_string(server.port) + "\r\n" + kind + "\r\n");
        for (int k = 0; k < 1024 && !is_done && socket.Send(piece); ++k) {
          ++sent_MiB;
        }
        if (!is_done) ++bodies;
      }
    });
  }
  // The person who has the key goes on working.
  double longest_s = 0.0;
  const std::vector<std::string> targets = {
      "/api/trials", "/api/stamp", "/api/trials/" + lab.trials[0],
      "/api/trials/" + lab.trials[0] + "/frames/0", "/"};
  int asked = 0;
  for (; asked < kAsked || bodies < kBodies; ++asked) {
    // Each slow one says a byte more, so that none is idle.
    for (const auto& one : slow) one->Send("x");
    const auto begun = std::chrono::steady_clock::now();
    const std::string answer =
        AskLocal(server.port, "GET",
                 targets[static_cast<std::size_t>(asked) % targets.size()],
                 server.KeyField());
    longest_s = std::max(
        longest_s,
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun)
            .count());
    EXPECT_THAT(answer, ::testing::StartsWith("HTTP/1.1 200")) << asked;
  }
  is_done = true;
  for (auto& thread : large) thread.join();
  const double memory_MB = testing::Memory_MB(program.pid(), "VmHWM");
  std::printf(
      "%d answers, the longest after %.3f s, beside %d slow connections and "
      "%lld bodies of 1 GB (%lld MiB of them taken); memory at most %.0f MB\n",
      asked, longest_s, kSlow, static_cast<long long>(bodies.load()),
      static_cast<long long>(sent_MiB.load()), memory_MB);
  EXPECT_LT(longest_s, 1.0);
  EXPECT_GT(memory_MB, 1.0);
  EXPECT_LT(memory_MB, 300.0 + kSanitizer_MB);
  EXPECT_EQ(program.End(SIGTERM), 0);
}

// An address that nobody learns is no success.
TEST(ReviewStrangers, AnAddressThatCannotBePrintedIsStatus6) {
  const Lab lab;
  for (const char* streams : {">/dev/full", ">&-"}) {
    const auto ran =
        RunProgram("review --no-open --db " + (lab.folder / "lab.db").string() +
                   " " + streams);
    EXPECT_EQ(ran.status, 6) << streams;
    EXPECT_THAT(ran.err, HasSubstr("touchdown: stdout"));
  }
}

}  // namespace
}  // namespace touchdown::cli
