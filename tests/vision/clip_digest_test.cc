#include "touchdown/vision/footage/clip_digest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>

#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"

namespace touchdown::vision {
namespace {

using touchdown::testing::TemporaryFolder;

// FIPS 180-4 examples: the digest of "abc" and of nothing.
TEST(Sha256, KnownDigests) {
  const TemporaryFolder folder;
  EXPECT_EQ(Sha256(folder.Write("a.avi", "abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256(folder.Write("b.avi", "")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

// Made with: printf 'header' > a.cih; printf 'data' > a.mraw;
//   cat a.cih a.mraw | sha256sum
//   printf 'touchdown.clip/1\n6\n4\nheaderdata' | sha256sum
TEST(ClipDigest, OfAPhotronPairIsThatOfBothFiles) {
  const TemporaryFolder folder;
  const auto header = folder.Write("a.cih", "header");
  const auto data = folder.Write("a.mraw", "data");
  EXPECT_EQ(Sha256(data),
            "1c23b1556b94e51a7a13fb54847ccb1053a9bf8829b302de301a2e0f816d9c77");
  EXPECT_EQ(Sha256(header), Sha256(data));
  EXPECT_EQ(ClipId(data),
            "c3126052013f562e2aa8a894359afe649a7456b9a9705bed66553afe086ec710");
  EXPECT_EQ(ClipId(header), ClipId(data));
  folder.Write("a.cih", "Header");
  EXPECT_NE(ClipId(data),
            "c3126052013f562e2aa8a894359afe649a7456b9a9705bed66553afe086ec710");
}

// Made with: printf 'one' > i2.png; printf 'ten' > i10.png;
//   sha256sum i2.png i10.png | sha256sum
//   printf 'touchdown.clip/1\n3 i2.png\n3 i10.png\noneten' | sha256sum
TEST(ClipDigest, OfAFolderIsThatOfNamesAndContentsInOrder) {
  const TemporaryFolder folder;
  folder.Write("i10.png", "ten");
  folder.Write("i2.png", "one");
  folder.Write("notes.txt", "left out");
  EXPECT_EQ(Sha256(folder.path()),
            "cb595c47d4c0c25640982703b0d2b63e7e10f568824a287fa8bc69e220758775");
  EXPECT_EQ(ClipId(folder.path()),
            "148e73fa3e68d9f8598db791fd3919a14e9017e2b866c650535541a0e8c1b892");
  std::filesystem::rename(folder / "i10.png", folder / "i11.png");
  EXPECT_NE(Sha256(folder.path()),
            "cb595c47d4c0c25640982703b0d2b63e7e10f568824a287fa8bc69e220758775");
  EXPECT_NE(ClipId(folder.path()),
            "148e73fa3e68d9f8598db791fd3919a14e9017e2b866c650535541a0e8c1b892");
}

// A sparse file of 70 MiB + 5: bytes in a block count, bytes between do not.
TEST(ClipId, LooksAtSixtyFourBlocks) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.avi", "");
  constexpr std::int64_t kMiB = 1 << 20;
  constexpr std::int64_t kTotal = 70 * kMiB + 5;
  std::filesystem::resize_file(path, kTotal);
  const std::string zeros = ClipId(path);
  const auto with_bytes_at = [&](std::initializer_list<std::int64_t> places) {
    const auto put = [&](char c) {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      for (const std::int64_t at : places) file.seekp(at).put(c);
    };
    put('x');
    const std::string id = ClipId(path);
    put('\0');
    return id;
  };
  const std::int64_t block_17 = 17 * (kTotal - kMiB) / 63;
  EXPECT_NE(with_bytes_at({kMiB - 1}), zeros);
  EXPECT_NE(with_bytes_at({kTotal - kMiB}), zeros);
  EXPECT_NE(with_bytes_at({block_17}), zeros);
  EXPECT_NE(with_bytes_at({block_17 + kMiB - 1}), zeros);
  EXPECT_EQ(
      with_bytes_at({kMiB, kTotal - kMiB - 1, block_17 - 1, block_17 + kMiB}),
      zeros);
  std::filesystem::resize_file(path, kTotal - 1);
  EXPECT_NE(ClipId(path), zeros);
}

TEST(ClipId, IsTheSameUnderAnotherName) {
  const TemporaryFolder folder;
  EXPECT_EQ(ClipId(folder.Write("a.avi", "abc")),
            ClipId(folder.Write("b.mp4", "abc")));
  EXPECT_EQ(ClipId(folder / "a.avi").size(), 64u);
}

TEST(ClipDigest, AFileThatIsNotThereIsNamed) {
  EXPECT_THROW(ClipId("/no/such/clip.avi"), core::InputError);
  EXPECT_THROW(Sha256("/no/such/clip.avi"), core::InputError);
  EXPECT_THROW(ClipId("/no/such/clip.mraw"), core::InputError);
}

}  // namespace
}  // namespace touchdown::vision
