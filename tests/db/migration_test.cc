// Files of every released version are read for ever.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "db/src/schema.h"
#include "tests/db/fixture.h"
#include "tests/db/old_store.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"
#include "touchdown/db/seal.h"

namespace touchdown::db {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// Behind the store's back.
void Tamper(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  sqlite3_open(path.c_str(), &handle);
  char* error = nullptr;
  ASSERT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &error),
            SQLITE_OK)
      << error;
  sqlite3_close(handle);
}

// Every table, index and trigger with its text.
std::map<std::string, std::string> SchemaOf(const std::filesystem::path& path) {
  std::map<std::string, std::string> schema;
  sqlite3* handle = nullptr;
  sqlite3_open(path.c_str(), &handle);
  sqlite3_exec(
      handle, "SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL",
      [](void* map, int, char** text, char**) {
        (*static_cast<std::map<std::string, std::string>*>(map))[text[0]] =
            text[1];
        return 0;
      },
      &schema, nullptr);
  sqlite3_close(handle);
  return schema;
}

class MigrateFrom : public ::testing::TestWithParam<std::int64_t> {};

TEST_P(MigrateFrom, HoldsEveryTrialAndCanBeWritten) {
  Folder folder;
  const auto path = folder / "lab.db";
  MakeOldStore(path, GetParam());
  if (GetParam() < kSchemaVersion) {
    // Nobody writes into an old store by accident, and it says what to do.
    for (const OpenMode mode : {OpenMode::kRead, OpenMode::kCreate}) {
      EXPECT_THAT(
          [&] { Store::Open(path, mode); },
          ThrowsMessage<core::StoreError>(HasSubstr("touchdown db migrate")));
    }
  }
  const Migration migration = Migrate(path);
  EXPECT_EQ(migration.from_version, GetParam());
  EXPECT_EQ(migration.to_version, kSchemaVersion);
  EXPECT_EQ(Migrate(path).from_version, kSchemaVersion);  // nothing to do
  Store store = Store::Open(path, OpenMode::kWrite);
  EXPECT_THAT(Check(store).problems, IsEmpty());
  const auto trials = store.Trials();
  ASSERT_EQ(trials.size(), 3u);
  EXPECT_EQ(trials[0].campaign, "asphalt");
  EXPECT_EQ(trials[0].first.state.label, core::MotionState::kBounce);
  EXPECT_EQ(trials[0].first.contact.approach_angle_rad->value,
            20.0 * core::kDegree);
  EXPECT_EQ(trials[1].revision, 3);
  EXPECT_EQ(trials[1].first.state.label, core::MotionState::kRoll);
  EXPECT_TRUE(trials[1].excluded);
  EXPECT_EQ(trials[1].exclusion_reason, "the lamp failed");
  EXPECT_EQ(trials[2].body.long_m->value, 60.0 * core::kMillimetre);
  EXPECT_EQ(trials[2].first.contact.corner, core::Corner::kLeading);
  EXPECT_EQ(store.FindCampaign("asphalt")->theory_boundary_rad,
            11.8 * core::kDegree);
  const core::Measured& extrapolated = trials[0].first.state.extrapolated_gap_m;
  ASSERT_FALSE(extrapolated);
  EXPECT_EQ(extrapolated.error().reason, GetParam() < 4
                                             ? "logged before it was measured"
                                             : "not recorded by hand");
  if (GetParam() >= 3) {
    EXPECT_EQ(trials[0].conditions->spring.name, "S 3");
    const auto springs = ReadEntryVersions(store, RegisterKind::kSpring, "S 3");
    ASSERT_EQ(springs.size(), 2u);
    EXPECT_EQ(trials[0].conditions->spring.id, springs[0].id);
    EXPECT_EQ(springs[1].measured.at("stiffness_n_per_m")->value, 1150.0);
  }
  if (GetParam() >= 4) {
    const auto proposals = store.Proposals();
    ASSERT_EQ(proposals.size(), 1u);
    EXPECT_EQ(proposals[0].id, trials[1].id);
    EXPECT_EQ(proposals[0].first.state.extrapolated_gap_m->value, 2.1e-3);
  }
  if (GetParam() >= 6) {
    const auto plan = PlanEvents(store, "asphalt");
    ASSERT_EQ(plan.size(), 2u);
    EXPECT_EQ(plan[0].plan.stopping_rule, "after 40 trials");
    EXPECT_EQ(plan[0].trials, 2);
    EXPECT_EQ(plan[1].kind, PlanEventKind::kLook);
    EXPECT_THAT(Check(store).problems, ::testing::IsEmpty());
  }
  if (GetParam() >= 3) {
    const core::Conditions& conditions = *trials[0].conditions;
    if (GetParam() >= 8) {
      EXPECT_DOUBLE_EQ(conditions.elevation_rad->value, 12.5 * core::kDegree);
      EXPECT_EQ(conditions.note, "a draught");
    } else {
      EXPECT_EQ(conditions.elevation_rad.error().reason,
                "logged before it was recorded");
      EXPECT_EQ(conditions.note, "");
    }
  }
  const Seal seal = MakeSeal(store);
  store.LogTrial(SphereTrial(1));
  EXPECT_EQ(store.Trials().size(), 4u);
  EXPECT_EQ(CheckStoreSeal(store, seal).problem, "");
}

// The copy is the store as it was, and nothing else is left.
TEST_P(MigrateFrom, KeepsTheStoreAsItWas) {
  Folder folder;
  const auto path = folder / "lab.db";
  MakeOldStore(path, GetParam());
  const auto before = SchemaOf(path);
  const Migration migration = Migrate(path);
  if (GetParam() == kSchemaVersion) {
    EXPECT_EQ(migration.old_store, "");
    return;
  }
  EXPECT_EQ(migration.old_store.string(),
            path.string() + ".version" + std::to_string(GetParam()));
  EXPECT_EQ(SchemaOf(migration.old_store), before);
  EXPECT_THAT([&] { Store::Open(migration.old_store, OpenMode::kRead); },
              ThrowsMessage<core::StoreError>(HasSubstr("has version")));
}

// What was altered before is not taken for what was recorded.
TEST(Migrate, RefusesWhatDoesNotAgreeWithItsOldDigests) {
  for (const char* act :
       {"DROP TRIGGER statements_refuse_UPDATE; UPDATE statements SET "
        "clip_path = 'x' WHERE revision_id = 1",
        "DROP TRIGGER plan_events_refuse_UPDATE; UPDATE plan_events SET "
        "trials = 0",
        "DROP TRIGGER springs_refuse_UPDATE; UPDATE springs SET note = 'x'"}) {
    SCOPED_TRACE(act);
    Folder folder;
    const auto path = folder / "lab.db";
    MakeOldStore(path, 7);
    Tamper(path, act);
    EXPECT_THAT(
        [&] { Migrate(path); },
        ThrowsMessage<core::StoreError>(HasSubstr("is not what was recorded")));
    EXPECT_THAT([&] { Store::Open(path, OpenMode::kRead); },
                ThrowsMessage<core::StoreError>(HasSubstr("has version 7")));
    EXPECT_FALSE(std::filesystem::exists(path.string() + ".version7"));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryVersion, MigrateFrom,
                         ::testing::Range<std::int64_t>(1, kSchemaVersion + 1));

// An upgraded store is like a new one in every table, index and trigger.
TEST_P(MigrateFrom, EndsWithTodaysSchema) {
  Folder folder;
  MakeOldStore(folder / "old.db", GetParam());
  Migrate(folder / "old.db");
  OpenFixed(folder / "new.db");
  EXPECT_EQ(SchemaOf(folder / "old.db"), SchemaOf(folder / "new.db"));
}

// Version 2 had tables for a register, which other programs could fill.
TEST(Migrate, KeepsTheRegisterOfVersion2) {
  Folder folder;
  const auto path = folder / "lab.db";
  MakeOldStore(path, 2);
  Tamper(path,
         "PRAGMA foreign_keys = ON;"
         "INSERT INTO rigs (id, uuid, name, note) VALUES "
         "(7, '00000000-0000-4000-8000-000000000001', 'R1', 'the old one');"
         "INSERT INTO springs (uuid, label, rig_id, coil_diameter_kind, "
         "wire_diameter_m_absent, coil_diameter_m_absent, active_coils_absent, "
         "shear_modulus_pa_absent, stiffness_n_per_m, stiffness_n_per_m_u) "
         "VALUES ('00000000-0000-4000-8000-000000000002', 'S 3', 7, 'outer', "
         "'?', '?', '?', '?', 1200.0, 2.0);"
         "INSERT INTO calibrations (uuid, name, kind, made_at_utc, "
         "document_json) VALUES ('00000000-0000-4000-8000-000000000003', "
         "'C', 'lens', '2026-08-01T09:30:00.125Z', '{}');"
         "INSERT INTO conditions (revision_id, rig_id, spring_id, surface_id, "
         "anomaly, temperature_k, temperature_k_u, relative_humidity_absent) "
         "VALUES (2, 7, 1, 1, 'light', 294.0, 0.5, 'broken')");
  Migrate(path);
  const Store store = Store::Open(path, OpenMode::kRead);
  EXPECT_THAT(Check(store).problems, IsEmpty());
  const auto spring = FindEntry(store, RegisterKind::kSpring, "S 3");
  ASSERT_TRUE(spring);
  EXPECT_EQ(spring->version, 1);
  EXPECT_EQ(spring->recorded_at_utc, "2026-11-21T08:25:00.720Z");
  EXPECT_EQ(spring->texts.at("coil_diameter_kind"), "outer");
  EXPECT_EQ(spring->measured.at("stiffness_n_per_m")->value, 1200.0);
  EXPECT_EQ(spring->entries.at("rig").name, "R1");
  const auto calibration = FindEntry(store, RegisterKind::kCalibration, "C");
  EXPECT_EQ(calibration->texts.at("contents"), "lens");
  EXPECT_EQ(calibration->texts.at("document"), "{}");
  const auto trials = store.Trials();
  EXPECT_FALSE(trials[0].conditions);
  ASSERT_TRUE(trials[1].conditions);  // stated with its first revision of three
  EXPECT_EQ(trials[1].conditions->spring.id, spring->id);
  EXPECT_EQ(trials[1].conditions->surface.name, "asphalt, dry");
  EXPECT_EQ(trials[1].conditions->anomaly, core::Anomaly::kLight);
  EXPECT_EQ(trials[1].conditions->temperature_k->value, 294.0);
}

// A step that fails half way leaves the old store.
TEST(Migrate, ADamagedStoreStaysAsItIs) {
  Folder folder;
  const auto path = folder / "lab.db";
  MakeOldStore(path, 1);
  Tamper(path,
         "PRAGMA foreign_keys = OFF; DROP TRIGGER trials_refuse_UPDATE; UPDATE "
         "trials SET campaign_id = 99");
  const auto before = SchemaOf(path);
  EXPECT_THAT([&] { Migrate(path); },
              ThrowsMessage<core::StoreError>(HasSubstr("was not upgraded")));
  EXPECT_EQ(SchemaOf(path), before);
  EXPECT_THAT([&] { Store::Open(path, OpenMode::kRead); },
              ThrowsMessage<core::StoreError>(HasSubstr("has version 1")));
}

TEST(Migrate, ANewerFileIsRefusedWithWhatToDo) {
  Folder folder;
  const auto path = folder / "lab.db";
  OpenFixed(path);
  Tamper(path, "PRAGMA user_version = " + std::to_string(kSchemaVersion + 1));
  for (const auto& act : std::vector<std::function<void()>>{
           [&] { Migrate(path); }, [&] { Store::Open(path, OpenMode::kRead); },
           [&] { Store::Open(path, OpenMode::kCreate); }}) {
    EXPECT_THAT(act, ThrowsMessage<core::StoreError>(
                         HasSubstr("use the touchdown that made it")));
  }
}

// The schema follows from a table of quantities: whoever adds one there must
// raise kSchemaVersion, write the step, and freeze a new fixture.
TEST(Migrate, TheSchemaIsThatOfTheLastFixture) {
  Folder folder;
  MakeOldStore(folder / "frozen.db", kSchemaVersion);
  OpenFixed(folder / "new.db");
  EXPECT_EQ(SchemaOf(folder / "new.db"), SchemaOf(folder / "frozen.db"));
}

}  // namespace
}  // namespace touchdown::db
