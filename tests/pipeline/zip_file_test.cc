#include "app/text/zip_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace touchdown::pipeline {
namespace {

// What another program (CMake's libarchive) finds in it.
TEST(ZipFile, IsReadByOthers) {
  const testing::TemporaryFolder folder;
  std::string all_bytes;
  for (int i = 0; i < 256; ++i) all_bytes += static_cast<char>(i);
  ZipFile zip(folder / "a.zip");
  zip.Add("empty", "");
  zip.Add("in/a/folder.bin", all_bytes);
  zip.Add("größe.txt", "utf-8\n");
  zip.Commit();
  const std::string command =
      "cd " + folder.path().string() + " && cmake -E tar xf a.zip";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(testing::ReadAll(folder / "in/a/folder.bin"), all_bytes);
  EXPECT_TRUE(std::filesystem::is_empty(folder / "empty"));
  EXPECT_EQ(testing::ReadAll(folder / "größe.txt"), "utf-8\n");
}

// Byte by byte as the specification has it; the CRC is the check value of the
// catalogues.
TEST(ZipFile, OneStoredFile) {
  const testing::TemporaryFolder folder;
  ZipFile file(folder / "a.zip");
  file.Add("a/b", "123456789");
  file.Commit();
  const std::string zip = testing::ReadAll(folder / "a.zip");
  constexpr std::size_t kLocal = 30 + 3 + 9;
  constexpr std::size_t kCentral = 46 + 3;
  ASSERT_EQ(zip.size(), kLocal + kCentral + 22);
  EXPECT_EQ(zip.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(zip.substr(14, 4), "\x26\x39\xf4\xcb");
  EXPECT_EQ(zip.substr(30, 12), "a/b123456789");
  EXPECT_EQ(zip.substr(kLocal, 4), "PK\x01\x02");
  EXPECT_EQ(zip.substr(kLocal + kCentral, 4), "PK\x05\x06");
  // The directory begins where the end record says.
  EXPECT_EQ(static_cast<unsigned char>(zip[kLocal + kCentral + 16]), kLocal);
}

TEST(ZipFile, SameMembersSameBytes) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"a.zip", "b.zip"}) {
    ZipFile zip(folder / name);
    zip.Add("x", "y");
    zip.Commit();
  }
  EXPECT_EQ(testing::ReadAll(folder / "a.zip"),
            testing::ReadAll(folder / "b.zip"));
}

TEST(ZipFile, IsNotThereBeforeItIsWhole) {
  const testing::TemporaryFolder folder;
  {
    ZipFile zip(folder / "a.zip");
    zip.Add("x", "y");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace touchdown::pipeline
