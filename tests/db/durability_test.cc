// Nothing that was reported as logged is lost, whatever happens to the process,
// the disk or the power. TOUCHDOWN_LONG_TESTS=1 runs the long forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <set>

#include "tests/db/fixture.h"
#include "tests/db/power_loss_disk.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"

namespace touchdown::db {
namespace {

using core::StoreError;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool LongForm() { return std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr; }

// Runs `body` in another process, which ends without tearing down this one's
// things; a message on stderr and status 1 where it throws.
template <class Body>
pid_t InAnotherProcess(Body body) {
  const pid_t child = fork();
  if (child != 0) return child;
  int status = 0;
  try {
    body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = 1;
  }
  std::fflush(stderr);
  _exit(status);
}

int StatusOf(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::set<std::string> Ids(const Store& store) {
  std::set<std::string> ids;
  for (const auto& trial : store.Trials()) ids.insert(trial.id);
  return ids;
}

void ExpectSoundWith(const std::filesystem::path& path,
                     const std::set<std::string>& logged) {
  const Store store = Store::Open(path, OpenMode::kCreate);
  EXPECT_THAT(Check(store).problems, IsEmpty());
  const auto ids = Ids(store);
  for (const auto& id : logged) EXPECT_TRUE(ids.contains(id)) << "lost " << id;
}

// A logger tells each id through a pipe after LogTrial has returned, and is
// killed at a random instant: while creating, logging, committing, closing.
TEST(Durability, SurvivesAKillAtAnyInstant) {
  const int rounds = LongForm() ? 500 : 30;
  std::mt19937_64 engine(20260801);
  Folder folder;
  std::set<std::string> logged;
  int file = 0;
  for (int round = 0; round < rounds; ++round) {
    if (round % 10 == 0) {
      ++file;
      logged.clear();
    }
    const auto path = folder / ("lab" + std::to_string(file) + ".db");
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = InAnotherProcess([&] {
      close(pipe_ends[0]);
      for (int i = 0; true; ++i) {
        Store store = Store::Open(path, OpenMode::kCreate);
        for (int j = 0; j < 8; ++j) {
          core::Trial trial = SphereTrial(round * 100000 + i * 8 + j, "");
          const std::string id = store.LogTrial(trial).id;
          if (write(pipe_ends[1], id.data(), id.size()) < 0) _exit(2);
        }
      }
    });
    close(pipe_ends[1]);
    const auto read_id = [&] {
      std::string id(36, ' ');
      std::size_t done = 0;
      while (done < id.size()) {
        const auto n = read(pipe_ends[0], id.data() + done, id.size() - done);
        if (n <= 0) return false;
        done += static_cast<std::size_t>(n);
      }
      logged.insert(id);
      return true;
    };
    for (auto wait = engine() % 5; wait > 0; --wait) {
      ASSERT_TRUE(read_id());
    }
    // Up to about one commit later.
    const timespec pause{0, static_cast<long>(engine() % 8'000'000)};
    nanosleep(&pause, nullptr);
    kill(child, SIGKILL);
    EXPECT_EQ(StatusOf(child), 128 + SIGKILL);
    while (read_id()) {
    }
    close(pipe_ends[0]);
    ExpectSoundWith(path, logged);
    if (HasFailure()) FAIL() << "round " << round;
  }
}

// Logs until the disk is full; returns what was logged and what was said.
struct UntilFull {
  std::set<std::string> logged;
  std::string said;
};
UntilFull LogUntilFull(const std::filesystem::path& path) {
  UntilFull result;
  try {
    Store store = Store::Open(path, OpenMode::kCreate);
    for (int i = 0; i < 100000; ++i) {
      core::Trial trial = SphereTrial(i, "");
      trial.document_json = std::string(2000, 'x');
      result.logged.insert(store.LogTrial(trial).id);
    }
  } catch (const StoreError& error) {
    result.said = error.what();
  }
  return result;
}

TEST(Durability, SurvivesAFullDisk) {
  Folder folder;
  const std::string disk = folder / "disk";
  std::filesystem::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=3m") != 0) {
    GTEST_SKIP() << "no small disk can be mounted here (needs root)";
  }
  const UntilFull result = LogUntilFull(disk + "/lab.db");
  EXPECT_THAT(result.said, HasSubstr("the disk is full"));
  EXPECT_GT(result.logged.size(), 20u);
  ExpectSoundWith(disk + "/lab.db", result.logged);
  // With room again it goes on.
  EXPECT_EQ(mount("none", disk.c_str(), "tmpfs", MS_REMOUNT, "size=8m"), 0);
  Store::Open(disk + "/lab.db", OpenMode::kWrite)
      .LogTrial(SphereTrial(999999, ""));
  ExpectSoundWith(disk + "/lab.db", result.logged);
  EXPECT_EQ(umount2(disk.c_str(), MNT_DETACH), 0);
}

// The same without root: a limit on the size of files fails writes midway.
TEST(Durability, SurvivesAFileThatCannotGrow) {
  Folder folder;
  const auto path = folder / "lab.db";
  const pid_t child = InAnotherProcess([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{2 << 20, 2 << 20};
    setrlimit(RLIMIT_FSIZE, &limit);
    const UntilFull result = LogUntilFull(path);
    if (result.logged.size() < 20) throw std::runtime_error("too early");
    if (result.said.find("nothing of this") == std::string::npos &&
        result.said.find("not recorded") == std::string::npos) {
      throw std::runtime_error("said: " + result.said);
    }
    std::ofstream list(folder / "ids");
    for (const auto& id : result.logged) list << id << '\n';
  });
  ASSERT_EQ(StatusOf(child), 0);
  std::set<std::string> logged;
  std::ifstream list(folder / "ids");
  for (std::string id; list >> id;) logged.insert(id);
  ASSERT_GE(logged.size(), 20u);
  ExpectSoundWith(path, logged);
}

TEST(Durability, ReadsButDoesNotWriteAReadOnlyFile) {
  Folder folder;
  const auto path = folder / "lab.db";
  OpenFixed(path).LogTrial(SphereTrial(1, ""));
  std::filesystem::permissions(path, std::filesystem::perms(0444));
  for (const int folder_mode : {0555, 0777}) {
    SCOPED_TRACE(folder_mode);
    std::filesystem::permissions(folder.path(),
                                 std::filesystem::perms(folder_mode));
    const pid_t child = InAnotherProcess([&] {
      // Permissions do not bind root; 65534 is nobody.
      if (getuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(2);
      if (Store::Open(path, OpenMode::kRead).Trials().size() != 1) _exit(3);
      for (const auto mode : {OpenMode::kWrite, OpenMode::kCreate}) {
        try {
          Store::Open(path, mode);
          _exit(4);
        } catch (const StoreError& error) {
          if (std::string(error.what()).find("cannot be written") ==
              std::string::npos) {
            throw;
          }
        }
      }
    });
    EXPECT_EQ(StatusOf(child), 0);
  }
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
}

// Eight processes log, two read, one takes backups, from before the file
// exists; no trial is lost and nobody hears of a lock.
TEST(Concurrency, EightLogTwoReadOneBacksUp) {
  const int trials = LongForm() ? 500 : 20;
  constexpr int kWriters = 8;
  Folder folder;
  const auto path = folder / "lab.db";
  const auto total = static_cast<std::size_t>(kWriters * trials);
  std::vector<pid_t> children;
  for (int writer = 0; writer < kWriters; ++writer) {
    children.push_back(InAnotherProcess([&] {
      Store store = Store::Open(path, OpenMode::kCreate);
      for (int i = 0; i < trials; ++i) {
        store.LogTrial(SphereTrial(writer * 100000 + i, ""));
      }
      // All of them analyse one clip: revisions 1 to 8 of one trial.
      store.LogTrial(SphereTrial(99999999, ""));
    }));
  }
  for (int reader = 0; reader < 2; ++reader) {
    children.push_back(InAnotherProcess([&] {
      std::size_t seen = 0;
      while (seen < total) {
        if (!std::filesystem::exists(path)) continue;
        try {
          const Store store = Store::Open(path, OpenMode::kRead);
          const std::size_t now = store.Trials().size();
          if (now < seen) throw std::runtime_error("a trial vanished");
          seen = now;
        } catch (const StoreError& error) {
          // Just made by a writer, and empty yet.
          if (std::string(error.what()).find("nothing was ever recorded") ==
              std::string::npos) {
            throw;
          }
        }
      }
    }));
  }
  children.push_back(InAnotherProcess([&] {
    const Store store = Store::Open(path, OpenMode::kCreate);
    for (int i = 0; i < 3; ++i) {
      Backup(store, folder / ("backup" + std::to_string(i)));
    }
  }));
  for (const pid_t child : children) EXPECT_EQ(StatusOf(child), 0);
  const Store store = Store::Open(path, OpenMode::kRead);
  EXPECT_THAT(Check(store).problems, IsEmpty());
  const auto read = store.Trials({.with_documents = false});
  EXPECT_EQ(read.size(), total + 1);
  for (const auto& trial : read) {
    EXPECT_EQ(trial.revision, trial.clip.id == "clip-99999999" ? kWriters : 1);
  }
  for (int i = 0; i < 3; ++i) {
    const Store backup =
        Store::Open(folder / ("backup" + std::to_string(i)), OpenMode::kRead);
    EXPECT_THAT(Check(backup).problems, IsEmpty());
  }
}

TEST(Concurrency, AStoppedWriterIsReportedInOneLine) {
  Folder folder;
  const auto path = folder / "lab.db";
  OpenFixed(path).LogTrial(SphereTrial(1, ""));
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr),
            SQLITE_OK);
  Store store = Store::Open(path, OpenMode::kWrite, {.patience_s = 0.05});
  try {
    store.LogTrial(SphereTrial(2, ""));
    ADD_FAILURE() << "logged through a lock";
  } catch (const StoreError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another process has kept"));
    EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("locked")));
  }
  EXPECT_EQ(store.Trials().size(), 1u);  // reading never waits
  sqlite3_close(other);
  store.LogTrial(SphereTrial(2, ""));
}

// --- power loss --------------------------------------------------------------

struct Loss {
  int pictures = 0;
  int broken = 0;  // a trial reported as logged is gone, or the file is damaged
};

// Logs trials on a disk that may lose power at any write, takes `pictures`
// pictures of what it could leave, and opens each as a machine would that comes
// up again.
Loss LosePower(int pictures, std::uint64_t seed) {
  struct Moment {
    DiskPicture disk;
    std::set<std::string> logged;
  };
  Folder folder;
  std::vector<Moment> moments;
  std::mt19937_64 engine(seed);
  while (static_cast<int>(moments.size()) < pictures) {
    const auto path = folder / ("lab" + std::to_string(moments.size()) + ".db");
    std::set<std::string> logged;
    PowerLossDisk* disk_now = nullptr;
    const auto take = [&] {
      // About one write in 16: some dozen pictures of a life of a store.
      if (engine() % 16 != 0 || static_cast<int>(moments.size()) >= pictures) {
        return;
      }
      moments.push_back({disk_now->AfterPowerLoss(engine), logged});
    };
    PowerLossDisk disk(take);
    disk_now = &disk;
    for (int life = 0; life < 3; ++life) {  // closing checkpoints the log
      Store store = Store::Open(path, OpenMode::kCreate);
      for (int i = 0; i < 4; ++i) {
        logged.insert(store.LogTrial(SphereTrial(life * 10 + i, "")).id);
      }
    }
  }
  Loss loss;
  for (const auto& moment : moments) {
    ++loss.pictures;
    const Folder after;
    std::filesystem::path path = after / "lab.db";
    for (const auto& [name, content] : moment.disk) {
      const auto file = after / std::filesystem::path(name).filename();
      if (file.extension() == ".db") path = file;
      std::ofstream(file, std::ios::binary)
          .write(content.data(), static_cast<std::streamsize>(content.size()));
    }
    try {
      const Store store = Store::Open(path, OpenMode::kCreate);
      const auto ids = Ids(store);
      const bool lost = !std::ranges::includes(ids, moment.logged);
      if (lost || !Check(store).problems.empty()) ++loss.broken;
    } catch (const StoreError&) {
      ++loss.broken;
    }
  }
  return loss;
}

TEST(PowerLoss, LosesNothingThatWasReportedAsLogged) {
  const Loss loss = LosePower(LongForm() ? 2000 : 100, 1);
  EXPECT_GE(loss.pictures, 100);
  EXPECT_EQ(loss.broken, 0);
}

int IgnoreSynchronous(void*, int action, const char* pragma, const char* value,
                      const char*, const char*) {
  const bool synchronous = action == SQLITE_PRAGMA && value != nullptr &&
                           std::string(pragma) == "synchronous";
  return synchronous ? SQLITE_IGNORE : SQLITE_OK;
}

int TurnSynchronousOff(sqlite3* handle, char**, const sqlite3_api_routines*) {
  const int code = sqlite3_exec(handle, "PRAGMA synchronous = OFF", nullptr,
                                nullptr, nullptr);
  sqlite3_set_authorizer(handle, IgnoreSynchronous, nullptr);
  return code;
}

// The test above can fail: without syncing, most pictures are broken.
TEST(PowerLoss, LosesTrialsWithoutSynchronous) {
  const auto extension = reinterpret_cast<void (*)()>(TurnSynchronousOff);
  sqlite3_auto_extension(extension);
  const Loss loss = LosePower(40, 1);
  sqlite3_cancel_auto_extension(extension);
  EXPECT_GT(loss.broken, loss.pictures / 4);
}

}  // namespace
}  // namespace touchdown::db
