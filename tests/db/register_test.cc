#include "touchdown/db/register.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>
#include <vector>

#include "tests/db/fixture.h"
#include "tests/support/random_trials.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

using core::StoreError;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

Entry Spring(const std::string& name, double stiffness_n_per_m) {
  Entry spring = NewEntry(RegisterKind::kSpring, name);
  spring.author = "Ada";
  spring.measured.insert_or_assign(
      "stiffness_n_per_m",
      core::Estimate{stiffness_n_per_m, 2.0, std::nullopt});
  return spring;
}

// The same with another stiffness, to be recorded by `who`.
Entry Stiffer(Entry spring, double stiffness_n_per_m, const std::string& who) {
  spring.measured.at("stiffness_n_per_m")->value = stiffness_n_per_m;
  spring.author = who;
  spring.reason = "measured again";
  return spring;
}

core::Conditions WithSpring(const std::string& name) {
  core::Conditions conditions;
  conditions.spring.name = name;
  conditions.temperature_k = core::Estimate{294.65, 0.5, std::nullopt};
  conditions.anomaly = core::Anomaly::kNone;
  return conditions;
}

// Everything that a field can hold comes back, in every field of every kind.
TEST(AddEntry, RoundTripsEveryField) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  testing::RandomTrials random(11);
  std::vector<Entry> all;
  for (const RegisterKind kind : kRegisterKinds) {
    for (int i = 0; i < 10; ++i) {
      Entry entry = NewEntry(kind, random.Text() + std::to_string(all.size()));
      entry.author = "a" + random.Text();
      entry.reason = random.Text();
      for (const RegisterField& field : ListFields(kind)) {
        const std::string key(field.name);
        if (field.type == FieldType::kText) {
          entry.texts[key] = random.Text() + "x";
        } else if (field.type == FieldType::kWord) {
          entry.texts[key] = i % 2 == 0 ? "other" : "not applicable";
        } else if (field.type == FieldType::kMeasured) {
          const double value = static_cast<double>(random() >> 11);
          entry.measured.insert_or_assign(
              key, i % 3 == 0
                       ? core::Measured(core::AbsentBecause(random.Text()))
                       : core::Estimate{value, value / 3, std::nullopt});
        } else if (i > 0) {
          const auto others = Entries(store, field.entry);
          entry.entries[key].name = others.at(random.Below(10)).name;
        }
      }
      const Entry recorded = AddEntry(store, entry);
      EXPECT_EQ(recorded.version, 1);
      EXPECT_TRUE(IsUuid(recorded.id));
      entry.id = recorded.id;
      entry.version = recorded.version;
      entry.recorded_at_utc = recorded.recorded_at_utc;
      for (auto& [key, other] : entry.entries) {
        EXPECT_EQ(other.name, recorded.entries.at(key).name);
        other.id = recorded.entries.at(key).id;
        EXPECT_EQ(other.id.empty(), other.name.empty());
      }
      EXPECT_EQ(recorded, entry);
      EXPECT_EQ(FindEntry(store, kind, entry.name), entry);
      all.push_back(entry);
    }
    EXPECT_THAT(Entries(store, kind), SizeIs(10));
  }
  EXPECT_THAT(AllVersions(store), ::testing::UnorderedElementsAreArray(all));
  EXPECT_EQ(Check(store).register_versions, 70);
}

TEST(ChangeEntry, IsAFurtherVersionWithFromWhatToWhat) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const Entry first = AddEntry(store, Spring("S 3", 1200));
  const Entry second = ChangeEntry(store, Stiffer(first, 1150, "Bob"));
  EXPECT_EQ(second.version, 2);
  EXPECT_EQ(FindEntry(store, RegisterKind::kSpring, "S 3"), second);
  const auto versions = ReadEntryVersions(store, RegisterKind::kSpring, "S 3");
  EXPECT_THAT(versions, ElementsAre(first, second));
  EXPECT_THAT(
      Changes(first, second),
      ElementsAre(Change{"stiffness_n_per_m", "1200 +- 2", "1150 +- 2"}));
  EXPECT_THAT(Entries(store, RegisterKind::kSpring), ElementsAre(second));
  // Whoever looked at the first version is told.
  EXPECT_THAT([&] { ChangeEntry(store, Stiffer(first, 1000, "Eve")); },
              ThrowsMessage<StoreError>(HasSubstr("changed meanwhile")));
  EXPECT_THAT([&] { ChangeEntry(store, Stiffer(second, 1150, "Eve")); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("nothing")));
  EXPECT_THAT([&] { AddEntry(store, Spring("S 3", 1)); },
              ThrowsMessage<StoreError>(HasSubstr("already")));
  EXPECT_THAT([&] { ChangeEntry(store, Stiffer(Spring("S 9", 1), 2, "Eve")); },
              ThrowsMessage<StoreError>(HasSubstr("there is no spring 'S 9'")));
  EXPECT_THAT(AllVersions(store), SizeIs(2));
}

TEST(AddEntry, RefusesWhatCannotBeByName) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const auto refused = [&](const Entry& entry, const std::string& says) {
    EXPECT_THAT([&] { AddEntry(store, entry); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  Entry surface = NewEntry(RegisterKind::kSurface, "asphalt");
  refused(surface, "author is empty");
  surface.author = "Ada";
  Entry wrong = surface;
  wrong.name = "";
  refused(wrong, "name of the surface is empty");
  wrong = surface;
  wrong.texts["condition"] = "slippery";
  refused(wrong, "condition is 'slippery', must be dry, damp, wet, icy");
  wrong.texts["condition"] = "other";
  refused(wrong, "the note is empty");
  wrong = surface;
  wrong.measured.insert_or_assign("friction",
                                  core::Estimate{-0.1, 0.01, std::nullopt});
  refused(wrong, "friction is -0.1");
  wrong = surface;
  wrong.texts["colour"] = "grey";
  refused(wrong, "a field that no surface has");
  wrong = surface;
  wrong.texts.erase("note");
  refused(wrong, "field note of surface 'asphalt' is missing");
  Entry spring = Spring("S 3", 1200);
  spring.entries["rig"].name = "nowhere";
  refused(spring, "rig is 'nowhere', must be a rig of the register");
  EXPECT_THAT(AllVersions(store), IsEmpty());
}

// A trial keeps the spring as it was when the shot was made.
TEST(Conditions, ReferToTheVersionOfTheirTime) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign());
  const Entry spring = AddEntry(store, Spring("S 3", 1200));
  core::Trial trial = SphereTrial(1);
  trial.conditions = WithSpring("S 3");
  const std::string id = store.LogTrial(trial).id;
  const Entry changed = ChangeEntry(store, Stiffer(spring, 1150, "Bob"));
  core::Conditions expected = *trial.conditions;
  expected.spring.id = spring.id;
  EXPECT_EQ(store.Find(id)->conditions, expected);
  // An analysis knows nothing of conditions and leaves them as they are, and so
  // does an exclusion.
  store.LogTrial(SphereTrial(1));
  store.Exclude(id, "Ada", "lamp");
  EXPECT_EQ(store.Find(id)->conditions, expected);
  core::Trial corrected = *store.Find(id);
  corrected.conditions->spring = {"S 3", ""};
  store.Correct(corrected, "Ada", "it was after the measurement");
  EXPECT_EQ(store.Find(id)->conditions->spring.id, changed.id);
  const auto history = store.History(id);
  ASSERT_EQ(history.size(), 4u);
  EXPECT_THAT(Changes(history[2].trial, history[3].trial),
              ElementsAre(Change{"conditions: spring",
                                 "S 3 (" + spring.id.substr(0, 8) + ")",
                                 "S 3 (" + changed.id.substr(0, 8) + ")"}));
  EXPECT_THAT(Check(store).problems, IsEmpty());
}

TEST(Conditions, OfWhatDoesNotExistAreRefused) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const auto refused = [&](const core::Conditions& conditions,
                           const std::string& says) {
    core::Trial trial = SphereTrial(1, "");
    trial.conditions = conditions;
    EXPECT_THAT([&] { store.LogTrial(trial); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  refused(WithSpring("S 9"), "conditions: spring is 'S 9', must be a spring");
  core::Conditions conditions;
  conditions.temperature_k = core::Estimate{-3.0, 0.5, std::nullopt};
  refused(conditions, "temperature_k is -3, must be above 0");
  conditions = {};
  conditions.relative_humidity = core::Estimate{45.0, 1.0, std::nullopt};
  refused(conditions, "relative_humidity is 45, must be in 0 .. 1");
  conditions = {};
  conditions.anomaly = core::Anomaly::kOther;
  refused(conditions, "its note is empty");
  EXPECT_THAT(store.Trials(), IsEmpty());
}

// Both stores changed the same entry: whichever is merged first, both versions
// are kept in both, the same one is in force, and trials refer to what they
// referred to.
TEST(Merge, RegistersAgreeWhicheverIsMergedFirst) {
  for (const bool a_first : {true, false}) {
    SCOPED_TRACE(a_first);
    Folder folder;
    {
      Store a = OpenFixed(folder / "a.db", 1);
      AddEntry(a, Spring("S 3", 1200));
      Backup(a, folder / "b.db");
    }
    Store a = OpenFixed(folder / "a.db", 10);
    Store b = OpenFixed(folder / "b.db", 20);
    const Entry first = *FindEntry(a, RegisterKind::kSpring, "S 3");
    for (int i = 0; i < 60; ++i) b.sources().now_utc();  // b is the later one
    ChangeEntry(a, Stiffer(first, 1150, "Ada"));
    const Entry bobs = ChangeEntry(b, Stiffer(first, 1160, "Bob"));
    AddEntry(b, Spring("S 4", 900));
    core::Trial trial = SphereTrial(1, "");
    trial.conditions = WithSpring("S 3");
    const std::string id = b.LogTrial(trial).id;
    MergeReport report = a_first ? Merge(a, b) : Merge(b, a);
    EXPECT_EQ(report.register_versions_added, a_first ? 2 : 1);
    EXPECT_THAT(report.conflicts,
                ElementsAre(AllOf(HasSubstr("spring 'S 3' is described here"),
                                  HasSubstr("both are kept"),
                                  HasSubstr(a_first ? "the one there is"
                                                    : "the one here is"))));
    a_first ? Merge(b, a) : Merge(a, b);
    EXPECT_EQ(AllVersions(a), AllVersions(b));
    EXPECT_THAT(AllVersions(a), SizeIs(4));
    EXPECT_EQ(FindEntry(a, RegisterKind::kSpring, "S 3"), bobs);
    EXPECT_EQ(a.Find(id)->conditions, b.Find(id)->conditions);
    EXPECT_EQ(a.Find(id)->conditions->spring.id, bobs.id);
    report = Merge(a, b);
    EXPECT_EQ(report.register_versions_added, 0);
    EXPECT_THAT(report.conflicts, IsEmpty());
    EXPECT_THAT(Check(a).problems, IsEmpty());
    EXPECT_THAT(Check(b).problems, IsEmpty());
  }
}

// A change that goes on from what the other store knows is no conflict.
TEST(Merge, ANewerVersionOfTheSameEntryIsNoConflict) {
  Folder folder;
  Store a = OpenFixed(folder / "a.db", 1);
  AddEntry(a, Spring("S 3", 1200));
  Store b = OpenFixed(folder / "b.db", 2);
  Merge(b, a);
  const Entry theirs = *FindEntry(b, RegisterKind::kSpring, "S 3");
  const Entry changed = ChangeEntry(b, Stiffer(theirs, 1150, "Bob"));
  EXPECT_THAT(Merge(a, b).conflicts, IsEmpty());
  EXPECT_EQ(FindEntry(a, RegisterKind::kSpring, "S 3"), changed);
  EXPECT_THAT(Merge(b, a).conflicts, IsEmpty());
}

// Other programs cannot change or remove an entry either.
TEST(AppendOnly, GuardsTheRegister) {
  Folder folder;
  {
    Store store = OpenFixed(folder / "lab.db");
    for (const RegisterKind kind : kRegisterKinds) {
      Entry entry = NewEntry(kind, "one");
      entry.author = "Ada";
      AddEntry(store, entry);
    }
  }
  sqlite3* handle = nullptr;
  sqlite3_open((folder / "lab.db").c_str(), &handle);
  for (const std::string table : {"rigs", "springs", "cameras", "calibrations",
                                  "bodies", "surfaces", "operators"}) {
    for (const std::string& sql :
         {"UPDATE " + table + " SET note = 'x'", "DELETE FROM " + table,
          "INSERT OR REPLACE INTO " + table + " SELECT * FROM " + table}) {
      char* text = nullptr;
      sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &text);
      EXPECT_EQ(text == nullptr ? "" : std::string(text),
                table + " are kept: add a version");
      sqlite3_free(text);
    }
  }
  sqlite3_close(handle);
}

}  // namespace
}  // namespace touchdown::db
