// A reader that has been taken over says what it likes.
#include "footage/apart/messages.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include "footage/apart/frame_memory.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

ClipInfo Good() {
  ClipInfo info;
  info.format = "avi";
  info.width_px = 640;
  info.height_px = 400;
  info.frames = 10;
  info.sensor_origin = SensorOrigin{3, 4};
  info.time_base.fps = 2000.0;
  info.warnings = {"one", "two"};
  return info;
}

ClipInfo There(const ClipInfo& info) {
  Packed to;
  PutInfo(to, info);
  Packed from(to.bytes());
  return GetInfo(from);
}

TEST(Packed, GivesWhatWasPut) {
  Packed to;
  to.Put(3.5);
  to.PutText("text");
  to.Put<std::uint8_t>(1);
  Packed from(to.bytes());
  EXPECT_EQ(from.Get<double>(), 3.5);
  EXPECT_EQ(from.GetText(), "text");
  EXPECT_TRUE(from.GetFlag());
  EXPECT_THROW(from.GetFlag(), core::InputError);
}

TEST(Packed, BelievesNoLength) {
  Packed to;
  to.Put(std::uint32_t{0xFFFFFFFF});
  Packed from(to.bytes());
  EXPECT_THROW(from.GetText(), core::InputError);
}

TEST(GetInfo, GivesWhatWasPut) {
  const ClipInfo info = There(Good());
  EXPECT_EQ(info.format, "avi");
  EXPECT_EQ(info.width_px, 640);
  EXPECT_EQ(info.sensor_origin, (SensorOrigin{3, 4}));
  EXPECT_EQ(info.warnings, Good().warnings);
}

TEST(GetInfo, RefusesWhatNoClipIs) {
  ClipInfo info = Good();
  info.width_px = 0;
  EXPECT_THROW(There(info), core::InputError);
  info = Good();
  info.height_px = -1;
  EXPECT_THROW(There(info), core::InputError);
  info = Good();
  info.bit_depth = 17;
  EXPECT_THROW(There(info), core::InputError);
  info = Good();
  info.frames = 0;
  EXPECT_THROW(There(info), core::InputError);
  info = Good();
  info.time_base.fps = -1.0;
  EXPECT_THROW(There(info), core::InputError);
}

TEST(FrameMemoryView, SeesWhatWasWrittenAndNothingElse) {
  FrameMemory memory(std::size_t{64} << 20);
  FrameMemoryView view(dup(memory.descriptor()));
  std::byte* const piece = memory.Take(100);
  ASSERT_NE(piece, nullptr);
  piece[99] = std::byte{7};
  const auto offset = memory.FindOffset(piece);
  ASSERT_TRUE(offset);
  ASSERT_NE(view.At(*offset, 100), nullptr);
  EXPECT_EQ(view.At(*offset, 100)[99], std::byte{7});
  EXPECT_EQ(view.At(*offset, std::size_t{1} << 30), nullptr);
  EXPECT_EQ(view.At(~std::size_t{0} - 1, 100), nullptr);
  std::byte elsewhere{};
  EXPECT_FALSE(memory.FindOffset(&elsewhere));
  EXPECT_EQ(view.beats(), 1u);
}

TEST(FrameMemoryView, RefusesMemoryThatCouldShrink) {
  const int descriptor = memfd_create("test", MFD_ALLOW_SEALING);
  ASSERT_EQ(ftruncate(descriptor, 1 << 20), 0);
  EXPECT_THROW(FrameMemoryView{descriptor}, core::InputError);
}

TEST(FrameMemory, UsesPiecesAgainAndHasAnEnd) {
  FrameMemory memory(std::size_t{32} << 20);
  std::byte* const first = memory.Take(1000);
  memory.Give(first);
  EXPECT_EQ(memory.Take(900), first);
  EXPECT_NE(memory.Take(900), first);
  EXPECT_EQ(memory.Take(std::size_t{33} << 20), nullptr);
}

}  // namespace
}  // namespace touchdown::vision
