// The views that other programs read: every column is in the dictionary, and
// says what the store says, in degrees and millimetres.
#include "touchdown/db/views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/db/fixture.h"
#include "tests/db/forge.h"
#include "touchdown/db/register.h"

namespace touchdown::db {
namespace {

using Row = std::map<std::string, Cell>;

std::vector<Row> Rows(const Store& store, const std::string& name,
                      const std::string& campaign = "") {
  std::vector<Row> rows;
  for (const View& view : Views()) {
    if (view.name != name) continue;
    ForEachRow(store, view, campaign, [&](std::span<const Cell> cells) {
      Row row;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        row[view.columns[i].name] = cells[i];
      }
      rows.push_back(std::move(row));
    });
  }
  return rows;
}

double Real(const Row& row, const std::string& column) {
  return std::get<double>(row.at(column));
}
std::string Text(const Row& row, const std::string& column) {
  return std::get<std::string>(row.at(column));
}

class ViewsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Store store = OpenFixed(path_);
    store.AddCampaign(SphereCampaign());
    store.AddCampaign(SphereCampaign("other"));
    Entry spring = NewEntry(RegisterKind::kSpring, "S 3");
    spring.author = "Ada";
    AddEntry(store, spring);
    core::Trial trial = SphereTrial(1);
    trial.set_angle_rad = 20.0 * core::kDegree;
    trial.conditions.emplace().spring.name = "S 3";
    trial.conditions->temperature_k = core::Estimate{294.65, 0.5, {}};
    trial.conditions->elevation_rad =
        core::Estimate{12.5 * core::kDegree, 0.2 * core::kDegree, {}};
    trial.conditions->compression_m = core::Estimate{0.03025, 0.0003, {}};
    trial.conditions->note = "a draught";
    trial.document_json =
        R"({"path": {"rows": ["7 0.0035 -12.5 20.25 0.25 null",)"
        R"( "8 0.004 -10.5 20.0000 0.0000 null"]}})";
    trial.later.push_back(trial.first);
    id_ = store.LogTrial(trial).id;
    store.LogTrial(SphereTrial(2));
    store.LogTrial(SphereTrial(3, "other"));
    store.Exclude(store.Trials()[1].id, "Ada", "dust");
  }

  Folder folder_;
  fs::path path_ = folder_ / "lab.db";
  std::string id_;
};

TEST_F(ViewsTest, EveryColumnIsInTheDictionary) {
  Sqlite file(path_);
  for (const View& view : Views()) {
    std::string columns;
    for (const ViewColumn& column : view.columns) {
      columns += column.name + "|\n";
      EXPECT_FALSE(column.meaning.empty()) << column.name;
      // A number that has a unit bears it, too, in its name.
      if (!column.unit.empty()) EXPECT_EQ(column.unit, FindUnit(column.name));
    }
    EXPECT_EQ(
        file.Text("SELECT name FROM pragma_table_info('" + view.name + "')"),
        columns);
    EXPECT_EQ(
        file.Text("SELECT column_name FROM v_columns WHERE view_name = '" +
                  view.name + "'"),
        columns);
  }
}

TEST_F(ViewsTest, TrialsAreAsTheyAreInForce) {
  const Store store = Store::Open(path_, OpenMode::kRead);
  const auto rows = Rows(store, "v_trials");
  ASSERT_EQ(rows.size(), 3u);
  const Row& first = rows[0];
  EXPECT_EQ(Text(first, "trial"), id_);
  EXPECT_EQ(Text(first, "campaign"), "asphalt");
  EXPECT_EQ(Real(first, "diameter_mm"), 0.04 / core::kMillimetre);
  EXPECT_DOUBLE_EQ(Real(first, "set_angle_deg"), 20.0);
  EXPECT_DOUBLE_EQ(Real(first, "contact_angle_deg"), 0.101 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(first, "contact_angle_u_deg"), 0.0005 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(first, "temperature_c"), 21.5);
  EXPECT_DOUBLE_EQ(Real(first, "temperature_u_c"), 0.5);
  EXPECT_DOUBLE_EQ(Real(first, "elevation_deg"), 12.5);
  EXPECT_DOUBLE_EQ(Real(first, "compression_mm"), 30.25);
  EXPECT_EQ(Text(first, "muzzle_height_mm_absent"), "not recorded");
  EXPECT_EQ(Text(first, "spring"), "S 3");
  EXPECT_EQ(Text(first, "note"), "a draught");
  EXPECT_EQ(Text(first, "state"), "stays-down");
  EXPECT_EQ(std::get<std::int64_t>(first.at("excluded")), 0);
  EXPECT_EQ(std::get<std::int64_t>(rows[1].at("excluded")), 1);
  EXPECT_EQ(Text(rows[1], "exclusion_reason"), "dust");
  EXPECT_EQ(rows[1].at("spring"), Cell());
  EXPECT_EQ(Rows(store, "v_trials", "other").size(), 1u);
}

// As core::ContactAngle has it: a face that came down trailing end up is as
// steep as its mirror image, and its interval lies on the same side.
TEST_F(ViewsTest, TheContactAngleOfAFaceIsAMagnitude) {
  core::Campaign campaign = SphereCampaign("faces");
  campaign.body = core::Rectangle({0.04, 0.00002, {}}, {0.02, 0.00002, {}});
  campaign.angle_kind = core::AngleKind::kFace;
  core::Trial trial = SphereTrial(4, "faces");
  trial.body = campaign.body;
  trial.angle_kind = campaign.angle_kind;
  trial.first.contact.face_angle_rad =
      core::Estimate{-0.2, 0.01, core::Interval{-0.23, -0.18}};
  Store store = Store::Open(path_, OpenMode::kWrite);
  store.AddCampaign(campaign);
  store.LogTrial(trial);
  const auto rows = Rows(store, "v_trials", "faces");
  ASSERT_EQ(rows.size(), 1u);
  const Row& last = rows.front();
  const auto angle = core::ContactAngle(trial);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_deg"),
                   angle->value / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_deg"), 0.2 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_u_deg"), 0.01 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_low_deg"), 0.18 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_high_deg"), 0.23 / core::kDegree);
  EXPECT_DOUBLE_EQ(Real(last, "contact_angle_high_deg"),
                   angle->interval95->high / core::kDegree);
  // The face angle itself keeps its sign.
  EXPECT_DOUBLE_EQ(
      Real(Rows(store, "v_contacts", "faces").front(), "face_angle_deg"),
      -0.2 / core::kDegree);
}

TEST_F(ViewsTest, ContactsTracksCampaignsAndRevisions) {
  const Store store = Store::Open(path_, OpenMode::kRead);
  const auto contacts = Rows(store, "v_contacts", "asphalt");
  ASSERT_EQ(contacts.size(), 3u);
  EXPECT_EQ(std::get<std::int64_t>(contacts[1].at("contact")), 2);
  EXPECT_DOUBLE_EQ(Real(contacts[0], "approach_angle_deg"),
                   0.101 / core::kDegree);
  const auto track = Rows(store, "v_tracks");
  ASSERT_EQ(track.size(), 2u);
  EXPECT_EQ(std::get<std::int64_t>(track[0].at("frame")), 7);
  EXPECT_EQ(Real(track[0], "x_mm"), -12.5);
  EXPECT_EQ(Real(track[1], "y_mm"), 20.0);
  EXPECT_EQ(track[0].at("face_angle_deg"), Cell());
  const auto campaigns = Rows(store, "v_campaigns");
  ASSERT_EQ(campaigns.size(), 2u);
  EXPECT_DOUBLE_EQ(Real(campaigns[0], "theory_boundary_deg"), 11.8);
  EXPECT_EQ(std::get<std::int64_t>(campaigns[0].at("trials")), 2);
  const auto revisions = Rows(store, "v_revisions");
  ASSERT_EQ(revisions.size(), 4u);
  EXPECT_EQ(Text(revisions[2], "kind"), "excluded");
  EXPECT_EQ(Text(revisions[2], "sha256").size(), 64u);
}

}  // namespace
}  // namespace touchdown::db
