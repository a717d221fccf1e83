#include "touchdown/db/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/fixture.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(RequireCampaign, AsksWhetherTheNearestNameWasMeant) {
  const Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign("asphalt, ball"));
  EXPECT_EQ(RequireCampaign(store, "asphalt, ball").name, "asphalt, ball");
  EXPECT_THAT(
      [&] { RequireCampaign(store, "asfalt, ball"); },
      ThrowsMessage<core::StoreError>(HasSubstr("mean 'asphalt, ball'?")));
  EXPECT_THAT([&] { RequireCampaign(store, "gravel"); },
              ThrowsMessage<core::StoreError>(HasSubstr("campaign list")));
  // So do those that take a name on the way.
  EXPECT_THAT([&] { store.LogTrial(SphereTrial(1, "asphalt, bal")); },
              ThrowsMessage<core::StoreError>(HasSubstr("did you mean")));
  EXPECT_THAT([&] { store.Trials({.campaign = "asphalt, bal"}); },
              ThrowsMessage<core::StoreError>(HasSubstr("did you mean")));
}

TEST(RequireEntry, AsksWhetherTheNearestNameWasMeant) {
  const Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  Entry body = NewEntry(RegisterKind::kBody, "steel ball 40");
  body.author = "Ada";
  AddEntry(store, body);
  EXPECT_EQ(RequireEntry(store, RegisterKind::kBody, "steel ball 40").name,
            "steel ball 40");
  EXPECT_THAT(
      [&] { RequireEntry(store, RegisterKind::kBody, "stel ball 40"); },
      ThrowsMessage<core::StoreError>(HasSubstr("mean 'steel ball 40'?")));
}

}  // namespace
}  // namespace touchdown::db
