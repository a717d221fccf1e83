// Bodies and campaigns as they are typed.
#include "app/trials/campaign_entry.h"

#include <gtest/gtest.h>

#include "app/trials/statement.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using core::kMillimetre;

std::string FieldOf(const CampaignEntry& entry) {
  try {
    MakeCampaign(entry);
  } catch (const FieldError& error) {
    return error.field();
  }
  return "none";
}

CampaignEntry Sphere() {
  CampaignEntry entry;
  entry.name = "asphalt";
  entry.body.diameter_mm = "40";
  return entry;
}

TEST(ParseBody, TakesSizesWithAndWithoutTheirUncertainty) {
  EXPECT_FALSE(ParseBody({}));
  const auto sphere = ParseBody({"", "40", ""}).value();
  EXPECT_EQ(sphere.kind, core::BodyKind::kSphere);
  EXPECT_DOUBLE_EQ(sphere.diameter_m->value, 0.04);
  EXPECT_DOUBLE_EQ(sphere.diameter_m->u, 0.04 * 1e-3);  // 0.1 %
  const auto block = ParseBody({"", "", "20+-0.02x60+-0.05"}).value();
  EXPECT_EQ(block.kind, core::BodyKind::kRectangle);
  EXPECT_DOUBLE_EQ(block.long_m->value, 0.06);  // whichever is first
  EXPECT_DOUBLE_EQ(block.long_m->u, 0.05 * kMillimetre);
  EXPECT_FALSE(ParseBody({"sphere", "", ""})->diameter_m);
  EXPECT_FALSE(ParseBody({"rectangle", "", ""})->long_m);
}

TEST(ParseBody, NamesTheFieldThatDoesNotFit) {
  const auto field_of = [](const BodyEntry& entry) -> std::string {
    try {
      ParseBody(entry);
    } catch (const FieldError& error) {
      return error.field();
    }
    return "none";
  };
  EXPECT_EQ(field_of({"cube", "40", ""}), "body");
  EXPECT_EQ(field_of({"sphere", "", "60x20"}), "sides-mm");
  EXPECT_EQ(field_of({"rectangle", "40", ""}), "diameter-mm");
  EXPECT_EQ(field_of({"", "4O", ""}), "diameter-mm");
  EXPECT_EQ(field_of({"", "", "60"}), "sides-mm");
  EXPECT_EQ(field_of({"", "", "60x2O"}), "sides-mm");
  EXPECT_THROW(ParseBody({"", "-40", ""}), std::invalid_argument);
}

TEST(MakeCampaign, TakesTheDefaultsOfItsBody) {
  const core::Campaign sphere = MakeCampaign(Sphere());
  EXPECT_EQ(sphere.angle_kind, core::AngleKind::kApproach);
  EXPECT_DOUBLE_EQ(sphere.bounce_height_m, 0.8 * kMillimetre);  // 2 % of 40
  EXPECT_DOUBLE_EQ(sphere.margin_rad, 1.0 * kDegree);
  EXPECT_FALSE(sphere.theory_boundary_rad);
  CampaignEntry block;
  block.name = "blocks";
  block.body.sides_mm = "60x20";
  EXPECT_EQ(MakeCampaign(block).angle_kind, core::AngleKind::kRadius);
}

TEST(MakeCampaign, TakesWhatIsSaid) {
  CampaignEntry entry = Sphere();
  entry.surface = "board";
  entry.angle_kind = "approach";
  entry.bounce_height_mm = 1.5;
  entry.speed_mps = "3.5:4.5";
  entry.theory = "table 1";
  entry.theory_boundary_deg = 20.0;
  entry.theory_u_deg = 0.5;
  entry.margin_deg = 2.0;
  const core::Campaign campaign = MakeCampaign(entry);
  EXPECT_EQ(campaign.surface, "board");
  EXPECT_DOUBLE_EQ(campaign.bounce_height_m, 1.5 * kMillimetre);
  EXPECT_EQ(campaign.speed_min_mps, 3.5);
  EXPECT_EQ(campaign.speed_max_mps, 4.5);
  EXPECT_EQ(campaign.theory_name, "table 1");
  EXPECT_DOUBLE_EQ(*campaign.theory_boundary_rad, 20.0 * kDegree);
  EXPECT_DOUBLE_EQ(campaign.theory_u_rad, 0.5 * kDegree);
  EXPECT_DOUBLE_EQ(campaign.margin_rad, 2.0 * kDegree);
}

TEST(MakeCampaign, NamesTheFieldThatDoesNotFit) {
  CampaignEntry entry = Sphere();
  entry.body = {};
  EXPECT_EQ(FieldOf(entry), "body");
  entry.body.kind = "sphere";  // of no size: no default of the bounce height
  EXPECT_EQ(FieldOf(entry), "bounce-height-mm");
  entry = Sphere();
  entry.angle_kind = "steep";
  EXPECT_EQ(FieldOf(entry), "angle-kind");
  for (const char* band : {"3.5", "3.5:", ":4", "3.5-4.5", "3.5:4.5 m/s"}) {
    entry = Sphere();
    entry.speed_mps = band;
    EXPECT_EQ(FieldOf(entry), "speed-mps") << band;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
