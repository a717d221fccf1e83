#include "touchdown/vision/overlay/contact_sheet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

using synthetic::Filming;
using synthetic::Throw;

struct Drawn {
  ColourImage sheet;
  ContactResult contacts;
};

Drawn Draw(const Throw& thrown, const Filming& filming,
           const ContactSheetOptions& options = {}, bool empty = false) {
  Scene scene;
  scene.body = thrown.kind == core::BodyKind::kSphere
                   ? core::Sphere({2 * thrown.half_long_m, 0})
                   : core::Rectangle({2 * thrown.half_long_m, 0},
                                     {2 * thrown.half_short_m, 0});
  scene.camera = filming.camera;
  scene.frames = filming.frames;
  scene.pose = [=](double t) { return thrown.At(t); };
  const auto clip = OpenScene(scene, 1);
  Track track = synthetic::FilmTrack(thrown, scene.pose, filming);
  if (empty) track.poses.clear();
  const PlaneTrack plane =
      SeenFromGround(track, synthetic::FilmGround(filming));
  Drawn drawn;
  drawn.contacts = FindContacts(plane, synthetic::WithScale(filming));
  drawn.sheet = DrawContactSheet(*clip, track, plane, drawn.contacts, options);
  return drawn;
}

// How many pixels are drawn in a hue: clear of the picture's grays.
enum class Hue { kYellow, kBlue, kGreen, kPink };
int Count(const ColourImage& sheet, Hue hue) {
  constexpr int kClear = 50;
  int count = 0;
  for (std::size_t i = 0; i + 2 < sheet.rgb.size(); i += 3) {
    const int r = sheet.rgb[i];
    const int g = sheet.rgb[i + 1];
    const int b = sheet.rgb[i + 2];
    switch (hue) {
      case Hue::kYellow:
        count += std::min(r, g) > b + kClear;
        break;
      case Hue::kBlue:
        count += b > r + kClear && g > r;
        break;
      case Hue::kGreen:
        count += g > r + kClear && g > b;
        break;
      case Hue::kPink:
        count += r > g + kClear && b > g;
        break;
    }
  }
  return count;
}

TEST(ContactSheet, ShowsOutlineGroundAndBothFlights) {
  Filming filming;
  filming.camera.width_px = 400;
  filming.camera.height_px = 260;
  filming.camera.ground_point = {150.0, 200.0};
  ContactSheetOptions options;
  options.title = "shot_017  state: bounce";
  const Drawn drawn = Draw(Throw{}, filming, options);
  ASSERT_TRUE(drawn.contacts.first.contact.found);
  const ColourImage& sheet = drawn.sheet;
  EXPECT_EQ(sheet.width_px, 3 * 360);
  EXPECT_GE(sheet.height_px, 3 * 360);
  ASSERT_EQ(sheet.rgb.size(), static_cast<std::size_t>(sheet.width_px) *
                                  static_cast<std::size_t>(sheet.height_px) *
                                  3);
  EXPECT_GT(Count(sheet, Hue::kYellow), 1000);  // outline
  EXPECT_GT(Count(sheet, Hue::kBlue), 1000);    // ground line
  EXPECT_GT(Count(sheet, Hue::kGreen), 100);    // flight before
  EXPECT_GT(Count(sheet, Hue::kPink), 100);     // flight after
}

TEST(ContactSheet, SizeIsAsAskedFor) {
  ContactSheetOptions options;
  options.columns = 2;
  options.rows = 1;
  options.panel_px = 150;
  Filming filming;
  const ColourImage sheet = Draw(Throw{}, filming, options).sheet;
  EXPECT_EQ(sheet.width_px, 300);
  EXPECT_LT(sheet.height_px, 250);
}

TEST(ContactSheet, WithoutContactOrNearTheEndsOfTheClip) {
  Throw early;
  early.contact_s = 0.0011;  // at the second frame
  Throw slides;
  slides.contact_s = -1.0;
  slides.x_m = -1.2;
  slides.after = {1.2, 0.0, 0.0};
  slides.stays = true;
  Throw block = early;
  block.kind = core::BodyKind::kRectangle;
  block.half_short_m = 0.008;
  for (const int frames : {1, 2, 8, 25, 32}) {
    for (const Throw& thrown : {Throw{}, early, slides, block}) {
      Filming filming;
      filming.frames = frames;
      const ColourImage sheet = Draw(thrown, filming).sheet;
      EXPECT_EQ(sheet.width_px, 3 * 360);
      EXPECT_GT(Count(sheet, Hue::kYellow), 100) << frames;
    }
  }
}

TEST(ContactSheet, BodyAtThePicturesBorder) {
  Filming filming;
  filming.camera.ground_point = {5.0, 395.0};
  const ColourImage sheet = Draw(Throw{}, filming).sheet;
  EXPECT_EQ(sheet.width_px, 3 * 360);
}

TEST(ContactSheet, NoTrackNoPicture) {
  Filming filming;
  const ColourImage sheet = Draw(Throw{}, filming, {}, true).sheet;
  EXPECT_EQ(sheet.width_px, 0);
  EXPECT_TRUE(sheet.rgb.empty());
}

}  // namespace
}  // namespace touchdown::vision
