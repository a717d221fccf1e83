// Recordings that are damaged, lie about their size, or change while they are
// read: each is a core::InputError that names the file, and never a signal, a
// hang or gigabytes. Each is read in a process of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/clip_digest.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::ReadText;

// How a process ended that did `what`: 0 all was read, 3 core::InputError, 99
// anything else that is thrown, -N signal N (SIGALRM: it took longer than
// `longest_s`, which only a hang does).
int EndOf(const std::function<void()>& what, unsigned longest_s = 60) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    std::signal(SIGALRM, SIG_DFL);
    alarm(longest_s);
    try {
      what();
      _exit(0);
    } catch (const core::InputError&) {
      _exit(3);
    } catch (...) {
      _exit(99);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

void ReadAll(const fs::path& path, std::int32_t threads) {
  const auto clip = OpenClip(path, {.fps = 1000.0, .decoder_threads = threads});
  std::string trouble;
  for (std::int64_t i = 0; i < clip->info().frames; ++i) {
    try {
      clip->Read(i);
    } catch (const core::InputError& error) {
      trouble = error.what();
    }
  }
  if (!trouble.empty()) throw core::InputError(trouble);
}

std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(value >> shift & 0xff);
  }
  return bytes;
}

class HostileFiles : public ::testing::Test {
 protected:
  void WriteHeader(const fs::path& path, int width, int height,
                   std::int64_t frames) const {
    folder_.Write(path.string(),
                  "#Camera Information Header\r\nRecord Rate(fps) : 1000\r\n"
                  "Start Frame : 0\r\nTotal Frame : " +
                      std::to_string(frames) +
                      "\r\nImage Width : " + std::to_string(width) +
                      "\r\nImage Height : " + std::to_string(height) +
                      "\r\nColor Type : Mono\r\nColor Bit : 8\r\n"
                      "EffectiveBit Depth : 8\r\nEffectiveBit Side : Lower\r\n"
                      "File Format : MRaw\r\n");
  }
  testing::TemporaryFolder folder_;
};

// Flipped, doubled, dropped and swapped stretches of an MPEG-4 part 2 stream:
// with frame threads libavcodec ended the process in half of such files.
TEST_F(HostileFiles, DamagedMpeg4Part2EndsNoProcess) {
  const std::string whole = ReadText(std::string(TOUCHDOWN_SOURCE_DIR) +
                                     "/tests/vision/data/mpeg4_part2.avi");
  ASSERT_GT(whole.size(), 5000u);
  std::mt19937_64 random(20261127);
  const fs::path path = folder_ / "damaged.avi";
  int damaged = 0;
  for (int k = 0; k < 89; ++k) {
    SCOPED_TRACE(k);
    std::string bytes = whole;
    for (std::uint64_t i = 0; i <= random() % 12; ++i) {
      const std::size_t at = 2048 + random() % (bytes.size() - 2400);
      const std::size_t size = 1 + random() % 200;
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
          break;
        case 1:
          bytes.replace(at, size, std::string(size, '\0'));
          break;
        case 2:
          bytes.replace(at, size, bytes.substr(2048 + random() % 3000, size));
          break;
        default:
          bytes.erase(at, size);
      }
    }
    folder_.Write("damaged.avi", bytes);
    const int end = EndOf([&] { ReadAll(path, 4); });
    EXPECT_THAT(end, ::testing::AnyOf(0, 3));
    damaged += end == 3 ? 1 : 0;
    if (HasFailure()) return;
  }
  EXPECT_GT(damaged, 40);
}

TEST_F(HostileFiles, AFifoIsNotWaitedFor) {
  folder_.Write("a.mraw", std::string(64 * 64, 'x'));
  ASSERT_EQ(mkfifo((folder_ / "a.cih").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((folder_ / "b.avi").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((folder_ / "c.png").c_str(), 0600), 0);
  for (const char* name : {"a.mraw", "a.cih", "b.avi", "c.png"}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(EndOf([&] { ReadAll(folder_ / name, 1); }, 20), 3);
    EXPECT_EQ(EndOf([&] { ClipId(folder_ / name); }, 20), 3);
  }
}

// A few bytes that ask for gigabytes.
TEST_F(HostileFiles, AHeaderThatLiesCostsNoMemory) {
  constexpr std::uint32_t kSide = 16384;  // 2^28 pixels
  const std::string png = std::string("\x89PNG\r\n\x1a\n", 8) + BigEndian(13) +
                          "IHDR" + BigEndian(kSide) + BigEndian(kSide) +
                          std::string("\x10\x00\x00\x00\x00", 5) +
                          BigEndian(0) + BigEndian(0) + "IDAT";
  folder_.Write("bomb.png", png);
  const auto in_200_mb = [](const std::function<void()>& what) {
    return EndOf([&] {
      rlimit limit{};
      getrlimit(RLIMIT_DATA, &limit);
      limit.rlim_cur = rlim_t{200} << 20;
      setrlimit(RLIMIT_DATA, &limit);
      what();
    });
  };
  EXPECT_EQ(in_200_mb([&] { ReadImage(folder_ / "bomb.png"); }), 3);
  // An image file directory of a picture in one tile of 2^28 pixels.
  std::string tiff = std::string("II\x2a\x00\x08\x00\x00\x00", 8);
  const auto entry = [&](std::uint16_t tag, std::uint16_t type,
                         std::uint32_t value) {
    for (const std::uint32_t part : {std::uint32_t{tag}, std::uint32_t{type}}) {
      tiff += static_cast<char>(part & 0xff);
      tiff += static_cast<char>(part >> 8);
    }
    for (const std::uint32_t word : {std::uint32_t{1}, value}) {
      for (int shift = 0; shift < 32; shift += 8) {
        tiff += static_cast<char>(word >> shift & 0xff);
      }
    }
  };
  tiff += std::string("\x0a\x00", 2);
  entry(256, 4, 64);     // width
  entry(257, 4, 64);     // height
  entry(258, 3, 8);      // bits
  entry(259, 3, 1);      // no compression
  entry(262, 3, 1);      // black is zero
  entry(277, 3, 1);      // samples
  entry(322, 4, kSide);  // tile width
  entry(323, 4, kSide);  // tile height
  entry(324, 4, 200);    // where
  entry(325, 4, 4096);   // how much
  tiff += std::string(2000, '\0');
  folder_.Write("bomb.tif", tiff);
  EXPECT_EQ(in_200_mb([&] { ReadImage(folder_ / "bomb.tif"); }), 3);
}

// Where the lost part is touched the kernel raises SIGBUS.
TEST_F(HostileFiles, AShortenedRawClipIsAnErrorAndNoSignal) {
  constexpr int kSide = 256;
  constexpr std::int64_t kFrames = 60;
  const fs::path data = folder_ / "a.mraw";
  const auto open = [&] {
    folder_.Write("a.mraw", std::string(kSide * kSide * kFrames, 'x'));
    WriteHeader("a.cih", kSide, kSide, kFrames);
    return OpenClip(data);
  };
  // Volatile: each pixel is touched.
  const auto sum = [](const core::Frame& frame) {
    volatile std::int64_t total = 0;
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      for (std::int32_t x = 0; x < frame.width_px; ++x) {
        total = total + frame.at(x, y);
      }
    }
    return std::int64_t{total};
  };
  // Before it is read.
  EXPECT_EQ(EndOf([&] {
              const auto clip = open();
              fs::resize_file(data, kSide * kSide * 10);
              for (std::int64_t i = 0; i < kFrames; ++i) sum(clip->Read(i));
            }),
            3);
  // While a view of it is looked at, which is the last that is read.
  EXPECT_EQ(EndOf([&] {
              const auto clip = open();
              const core::Frame last = clip->Read(kFrames - 1);
              fs::resize_file(data, 0);
              if (sum(last) != 0) _exit(98);
              clip->RequireWhole();
            }),
            3);
  // Shortened and written again, as a copying program does: what was read in
  // between were zeros.
  EXPECT_EQ(EndOf([&] {
              const auto clip = open();
              const auto witness = clip->Another();
              const core::Frame last = clip->Read(kFrames - 1);
              fs::resize_file(data, 0);
              sum(last);
              fs::resize_file(data, kSide * kSide * kFrames);
              witness->RequireWhole();
            }),
            3);
  // Of other memory it stays what it is.
  EXPECT_EQ(EndOf([&] {
              const auto clip = open();
              folder_.Write("other", "x");
              std::FILE* const file =
                  std::fopen((folder_ / "other").c_str(), "r");
              auto* const map = static_cast<volatile char*>(
                  mmap(nullptr, 4096, PROT_READ, MAP_SHARED, fileno(file), 0));
              fs::resize_file(folder_ / "other", 0);
              if (map[0] != 0) _exit(98);
            }),
            -SIGBUS);
  // And an honest one is read to its end.
  EXPECT_EQ(EndOf([&] {
              const auto clip = open();
              for (std::int64_t i = 0; i < kFrames; ++i) sum(clip->Read(i));
              clip->RequireWhole();
            }),
            0);
}

TEST_F(HostileFiles, TinyPicturesAreNoDivisionByZero) {
  for (int width = 1; width <= 9; ++width) {
    for (const int height : {1, 7, 64}) {
      WriteHeader("t.cih", width, height, 30);
      folder_.Write(
          "t.mraw",
          std::string(static_cast<std::size_t>(width * height * 30), 'x'));
      EXPECT_THAT(EndOf([&] { ReadAll(folder_ / "t.mraw", 1); }),
                  ::testing::AnyOf(0, 3));
    }
  }
}

}  // namespace
}  // namespace touchdown::vision
