#include "touchdown/db/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>

#include "tests/db/fixture.h"
#include "tests/support/random_trials.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/quantities.h"

namespace touchdown::db {
namespace {

using core::StoreError;
using ::testing::HasSubstr;

template <class Error, class Function>
std::string MessageOf(Function function) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

// == takes -0.0 for 0.0; the store must not.
void ExpectSameBits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b));
}

void ExpectSameBits(const core::Measured& a, const core::Measured& b) {
  ASSERT_EQ(a, b);
  if (!a) return;
  ExpectSameBits(a->value, b->value);
  ExpectSameBits(a->u, b->u);
  if (!a->interval95) return;
  ExpectSameBits(a->interval95->low, b->interval95->low);
  ExpectSameBits(a->interval95->high, b->interval95->high);
}

void ExpectSame(const core::Trial& a, const core::Trial& b) {
  EXPECT_EQ(a.campaign, b.campaign);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.clip, b.clip);
  EXPECT_EQ(a.body, b.body);
  for (const auto& q : core::kBodyQuantities) {
    ExpectSameBits(a.body.*q.member, b.body.*q.member);
  }
  EXPECT_EQ(a.angle_kind, b.angle_kind);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.later, b.later);
  for (const auto& q : core::kContactQuantities) {
    ExpectSameBits(At(a.first, q), At(b.first, q));
    for (std::size_t i = 0; i < a.later.size(); ++i) {
      ExpectSameBits(At(a.later[i], q), At(b.later[i], q));
    }
  }
  EXPECT_EQ(a.set_angle_rad, b.set_angle_rad);
  EXPECT_EQ(a.set_speed_mps, b.set_speed_mps);
  EXPECT_EQ(a.author, b.author);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.software_version, b.software_version);
  EXPECT_EQ(a.options_hash, b.options_hash);
  EXPECT_EQ(a.document_json, b.document_json);
  EXPECT_EQ(a.excluded, b.excluded);
  EXPECT_EQ(a.exclusion_reason, b.exclusion_reason);
}

// Property: what goes in comes out, bit for bit, also after closing. The texts
// include SQL injection, NUL and bytes that are not UTF-8.
TEST(LogTrial, RoundTripsEveryField) {
  Folder folder;
  testing::RandomTrials random(1);
  std::vector<core::Trial> trials;
  std::vector<std::string> ids;
  {
    Store store = OpenFixed(folder / "lab.db");
    for (int i = 0; i < 200; ++i) {
      trials.push_back(random.Trial());
      const Logged logged = store.LogTrial(trials.back());
      EXPECT_TRUE(IsUuid(logged.id));
      EXPECT_EQ(logged.revision, 1);
      EXPECT_TRUE(logged.is_new);
      ids.push_back(logged.id);
    }
  }
  const Store store = Store::Open(folder / "lab.db", OpenMode::kRead);
  const auto read = store.Trials();
  ASSERT_EQ(read.size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(read[i].id, ids[i]);
    EXPECT_EQ(read[i].revision, 1);
    EXPECT_TRUE(IsUtcStamp(read[i].recorded_at_utc));
    ExpectSame(trials[i], read[i]);
  }
}

TEST(LogTrial, MakesAFurtherRevisionOfTheSameClipInTheSameCampaign) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign("a"));
  store.AddCampaign(SphereCampaign("b"));
  const Logged first = store.LogTrial(SphereTrial(1, "a"));
  core::Trial again = SphereTrial(1, "a");
  again.first.contact.approach_angle_rad =
      core::Estimate{0.5, 0.01, std::nullopt};
  again.clip.sha256 = std::string(64, 'a');
  const Logged second = store.LogTrial(again);
  EXPECT_EQ(second.id, first.id);
  EXPECT_EQ(second.revision, 2);
  EXPECT_FALSE(second.is_new);
  // Another campaign or another clip is another trial.
  EXPECT_TRUE(store.LogTrial(SphereTrial(1, "b")).is_new);
  EXPECT_TRUE(store.LogTrial(SphereTrial(2, "a")).is_new);
  // The same cheap id with another digest is another clip.
  core::Trial other = SphereTrial(1, "a");
  other.clip.sha256 = std::string(64, 'b');
  EXPECT_TRUE(store.LogTrial(other).is_new);

  const auto history = store.History(first.id);
  ASSERT_EQ(history.size(), 2u);
  EXPECT_EQ(history[0].trial.first, SphereTrial(1).first);
  EXPECT_EQ(history[1].trial.first, again.first);
  EXPECT_EQ(store.Find(first.id)->revision, 2);
  EXPECT_THAT(Changes(history[0].trial, history[1].trial),
              ::testing::ElementsAre(Change{"approach_angle_rad",
                                            "0.101 +- 0.0005", "0.5 +- 0.01"}));
}

TEST(LogTrial, ManualTrialsWithoutAClipAreAlwaysNew) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  core::Trial trial = SphereTrial(1, "");
  trial.clip = {};
  trial.origin = core::Origin::kManual;
  EXPECT_TRUE(store.LogTrial(trial).is_new);
  EXPECT_TRUE(store.LogTrial(trial).is_new);
}

TEST(LogTrial, RefusesWhatCannotBeTrue) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign());
  const auto message = [&store](auto change) {
    core::Trial trial = SphereTrial(1);
    change(trial);
    return MessageOf<std::invalid_argument>([&] { store.LogTrial(trial); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      message([&](core::Trial& t) {
        t.first.motion.restitution = core::Estimate{nan, 0.1, std::nullopt};
      }),
      HasSubstr("restitution"));
  EXPECT_THAT(message([&](core::Trial& t) {
                t.first.contact.time_s = core::Estimate{1, -1e-9, std::nullopt};
              }),
              HasSubstr("u of time_s"));
  EXPECT_THAT(
      message([&](core::Trial& t) {
        t.first.contact.time_s = core::Estimate{1, 1, core::Interval{2, 1}};
      }),
      HasSubstr("interval of time_s"));
  EXPECT_THAT(message([](core::Trial& t) { t.first.state.p_bounce = 1.1; }),
              HasSubstr("p_bounce is 1.1, must be in [0, 1]"));
  EXPECT_THAT(message([](core::Trial& t) { t.clip.id = ""; }),
              HasSubstr("clip.id"));
  EXPECT_THAT(message([](core::Trial& t) { t.author = ""; }),
              HasSubstr("author"));
  EXPECT_THAT(message([](core::Trial& t) { t.id = "7"; }), HasSubstr("UUID"));
  EXPECT_THAT(message([](core::Trial& t) {
                t.body = core::Rectangle({0.1, 0, std::nullopt},
                                         {0.2, 0, std::nullopt});
              }),
              HasSubstr("campaign 'asphalt' is of a sphere"));
  EXPECT_THAT(
      message([](core::Trial& t) { t.angle_kind = core::AngleKind::kFace; }),
      HasSubstr("never"));
  EXPECT_THAT(MessageOf<StoreError>(
                  [&] { store.LogTrial(SphereTrial(1, "elsewhere")); }),
              HasSubstr("no campaign 'elsewhere'"));
  EXPECT_TRUE(store.Trials().empty());

  store.LogTrial(SphereTrial(1));
  EXPECT_THAT(
      message([](core::Trial& t) { t.origin = core::Origin::kSimulated; }),
      HasSubstr("origin"));
}

// What a program says of a clip that a person corrected is kept beside it.
TEST(LogTrial, AnAnalysisNeverTakesThePlaceOfACorrection) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign());
  core::Trial analysed = SphereTrial(1);
  analysed.document_json = "{}";
  analysed.options_hash = "a";
  const std::string id = store.LogTrial(analysed).id;
  core::Trial corrected = *store.Find(id);
  corrected.first.state.label = core::MotionState::kRoll;
  corrected.set_angle_rad = 0.4;
  store.Correct(corrected, "Ada", "seen on the contact sheet");
  EXPECT_TRUE(store.Proposals().empty());

  analysed.first.state.label = core::MotionState::kBounce;
  analysed.options_hash = "b";
  const Logged again = store.LogTrial(analysed);
  EXPECT_TRUE(again.is_proposal);
  EXPECT_EQ(again.id, id);
  EXPECT_EQ(again.revision, 3);
  const core::Trial now = *store.Find(id);
  EXPECT_EQ(now.revision, 2);
  EXPECT_EQ(now.author, "Ada");
  EXPECT_EQ(now.first.state.label, core::MotionState::kRoll);
  EXPECT_EQ(store.Trials().at(0).first.state.label, core::MotionState::kRoll);
  // It is known as analysed, and waits for a person.
  EXPECT_EQ(store.FindLogged("asphalt", analysed.clip.id)->options_hash, "b");
  const auto proposals = store.Proposals(id);
  ASSERT_EQ(proposals.size(), 1u);
  EXPECT_EQ(proposals[0].first.state.label, core::MotionState::kBounce);
  EXPECT_EQ(proposals[0].set_angle_rad, 0.4);  // an analysis is not told
  const auto history = store.History(id);
  EXPECT_EQ(RevisionInForce(history).trial.revision, 2);
  EXPECT_EQ(OpenProposal(history)->trial.revision, 3);

  // It waits also while the trial does not count.
  store.Exclude(id, "Ada", "lamp");
  EXPECT_TRUE(store.Find(id)->excluded);
  EXPECT_EQ(store.Find(id)->first.state.label, core::MotionState::kRoll);
  EXPECT_EQ(store.Proposals().size(), 1u);
  store.Include(id, "Ada", "lamp was right");
  EXPECT_EQ(store.Find(id)->first.state.label, core::MotionState::kRoll);

  // A person takes it.
  core::Trial accepted = proposals[0];
  accepted.revision = store.Find(id)->revision;
  EXPECT_EQ(store.Correct(accepted, "Ada", "it was right").revision, 6);
  EXPECT_EQ(store.Find(id)->first.state.label, core::MotionState::kBounce);
  EXPECT_TRUE(store.Proposals().empty());
  // What a person accepted is a person's.
  EXPECT_TRUE(store.LogTrial(analysed).is_proposal);
}

// A person who states the clip anew (an import, say) does what was asked.
TEST(LogTrial, AStatementWithoutADocumentIsNoProposal) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const std::string id = store.LogTrial(SphereTrial(1, "")).id;
  core::Trial corrected = *store.Find(id);
  corrected.first.state.label = core::MotionState::kRoll;
  store.Correct(corrected, "Ada", "seen");
  EXPECT_FALSE(store.LogTrial(SphereTrial(1, "")).is_proposal);
  EXPECT_EQ(store.Find(id)->revision, 3);
}

TEST(LogTrials, RecordsAllOrNone) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  std::vector<core::Trial> trials = {SphereTrial(1, ""), SphereTrial(2, ""),
                                     SphereTrial(3, "")};
  trials[2].author = "";
  EXPECT_THROW(store.LogTrials(trials), std::invalid_argument);
  EXPECT_TRUE(store.Trials().empty());
  trials[2].author = "somebody";
  EXPECT_EQ(store.LogTrials(trials).size(), 3u);
  EXPECT_EQ(store.Trials().size(), 3u);
}

TEST(Correct, AddsWhoWhyAndFromWhatToWhat) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const Logged logged = store.LogTrial(SphereTrial(1, ""));
  core::Trial seen = *store.Find(logged.id);
  seen.first.state.label = core::MotionState::kBounce;
  seen.first.state.reason = "seen on the film";
  EXPECT_EQ(store.Correct(seen, "Ada", "mislabelled").revision, 2);
  const auto history = store.History(logged.id);
  ASSERT_EQ(history.size(), 2u);
  EXPECT_EQ(history[1].kind, RevisionKind::kCorrected);
  EXPECT_EQ(history[1].trial.author, "Ada");
  EXPECT_EQ(history[1].trial.reason, "mislabelled");
  EXPECT_THAT(
      Changes(history[0].trial, history[1].trial),
      ::testing::ElementsAre(Change{"state", "stays-down", "bounce"},
                             Change{"state_because", "", "seen on the film"}));
  // A correction of what somebody else has changed meanwhile is refused.
  EXPECT_THAT(
      MessageOf<StoreError>([&] { store.Correct(seen, "Bob", "typing"); }),
      HasSubstr("revised meanwhile (revision 2, not 1)"));
  seen.revision = 2;
  EXPECT_THROW(store.Correct(seen, "", "why"), std::invalid_argument);
  EXPECT_THROW(store.Correct(seen, "Bob", ""), std::invalid_argument);
  seen.id = UuidFromBits(1, 2);
  EXPECT_THROW(store.Correct(seen, "Bob", "why"), StoreError);
}

TEST(Exclude, IsARevisionAndSurvivesAReanalysis) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign());
  const Logged logged = store.LogTrial(SphereTrial(1));
  store.LogTrial(SphereTrial(2));
  store.Exclude(logged.id, "Ada", "the lamp failed");
  EXPECT_TRUE(store.Find(logged.id)->excluded);
  EXPECT_EQ(store.Find(logged.id)->exclusion_reason, "the lamp failed");
  EXPECT_EQ(store.Find(logged.id)->first, SphereTrial(1).first);
  EXPECT_EQ(store.Trials({.excluded = false}).size(), 1u);
  EXPECT_EQ(store.Trials({.excluded = true}).size(), 1u);
  EXPECT_THROW(store.Exclude(logged.id, "Ada", "again"), std::invalid_argument);
  EXPECT_EQ(store.LogTrial(SphereTrial(1)).revision, 3);
  EXPECT_TRUE(store.Find(logged.id)->excluded);
  store.Include(logged.id, "Ada", "it was another trial");
  EXPECT_FALSE(store.Find(logged.id)->excluded);
  EXPECT_THROW(store.Include(logged.id, "Ada", "again"), std::invalid_argument);
  const auto history = store.History(logged.id);
  ASSERT_EQ(history.size(), 4u);
  EXPECT_FALSE(history[0].trial.excluded);
  EXPECT_EQ(history[1].kind, RevisionKind::kExcluded);
  EXPECT_TRUE(history[2].trial.excluded);
  EXPECT_EQ(history[3].kind, RevisionKind::kIncluded);
}

TEST(Trials, AreFilteredByEveryField) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(SphereCampaign());
  for (int i = 0; i < 10; ++i) store.LogTrial(SphereTrial(i));
  core::Trial block;
  block.body =
      core::Rectangle({0.06, 0, std::nullopt}, {0.02, 0, std::nullopt});
  block.origin = core::Origin::kSimulated;
  block.author = "x";
  block.document_json = "{}";
  store.LogTrial(block);
  EXPECT_EQ(store.Trials().size(), 11u);
  EXPECT_EQ(store.Trials({.campaign = "asphalt"}).size(), 10u);
  EXPECT_EQ(store.Trials({.campaign = ""}).size(), 1u);
  EXPECT_EQ(store.Trials({.origin = core::Origin::kSimulated}).size(), 1u);
  EXPECT_EQ(store.Trials({.body = core::BodyKind::kSphere}).size(), 10u);
  EXPECT_EQ(store.Trials({.state = core::MotionState::kBounce}).size(), 5u);
  EXPECT_EQ(store
                .Trials({.campaign = "asphalt",
                         .state = core::MotionState::kStaysDown,
                         .excluded = false})
                .size(),
            5u);
  const std::string third = store.Trials()[2].recorded_at_utc;
  EXPECT_EQ(store.Trials({.from_utc = third}).size(), 9u);
  EXPECT_EQ(store.Trials({.until_utc = third}).size(), 2u);
  EXPECT_EQ(
      store.Trials({.from_utc = "2026-08", .until_utc = "2026-09"}).size(),
      11u);
  EXPECT_EQ(store.Trials({.until_utc = "2026-07"}).size(), 0u);
  EXPECT_EQ(
      store.Trials({.campaign = "", .with_documents = false})[0].document_json,
      "");
  EXPECT_THROW(store.Trials({.campaign = "none"}), StoreError);
}

TEST(Find, TakesAUniquePrefix) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  core::Trial trial = SphereTrial(1, "");
  trial.clip = {};
  trial.id = "aaaa0000-0000-4000-8000-000000000001";
  store.LogTrial(trial);
  trial.id = "aaaa1000-0000-4000-8000-000000000002";
  store.LogTrial(trial);
  EXPECT_EQ(store.Find("aaaa1")->id, trial.id);
  EXPECT_EQ(store.Find("AAAA1")->id, trial.id);
  EXPECT_EQ(store.Find(trial.id)->id, trial.id);
  EXPECT_EQ(store.Find("aaab"), std::nullopt);
  EXPECT_EQ(store.Find("' OR 1=1"), std::nullopt);
  EXPECT_THAT(MessageOf<StoreError>([&] { store.Find("aaaa"); }),
              HasSubstr("several trials begin with 'aaaa'"));
  EXPECT_THROW(store.Find("aaa"), std::invalid_argument);
  EXPECT_TRUE(store.History("aaaa").empty());
}

TEST(AddCampaign, KeepsItsConventions) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  core::Campaign campaign = SphereCampaign("it's; DROP TABLE campaigns;--");
  store.AddCampaign(campaign);
  const auto read = store.FindCampaign(campaign.name);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, campaign.name);
  EXPECT_EQ(read->body, campaign.body);
  EXPECT_EQ(read->surface, campaign.surface);
  EXPECT_EQ(read->angle_kind, campaign.angle_kind);
  EXPECT_EQ(read->bounce_height_m, campaign.bounce_height_m);
  EXPECT_EQ(read->speed_max_mps, campaign.speed_max_mps);
  EXPECT_EQ(read->theory_boundary_rad, campaign.theory_boundary_rad);
  EXPECT_EQ(read->margin_rad, campaign.margin_rad);
  EXPECT_EQ(store.FindCampaign("other"), std::nullopt);
  EXPECT_THAT(MessageOf<StoreError>([&] { store.AddCampaign(campaign); }),
              HasSubstr("already"));

  campaign.surface = "";
  campaign.theory_boundary_rad.reset();
  store.ChangeCampaign(campaign);
  EXPECT_EQ(store.FindCampaign(campaign.name)->surface, "");
  EXPECT_EQ(store.FindCampaign(campaign.name)->theory_boundary_rad,
            std::nullopt);
  store.LogTrial(SphereTrial(1, campaign.name));
  campaign.margin_rad *= 2;
  EXPECT_THAT(MessageOf<StoreError>([&] { store.ChangeCampaign(campaign); }),
              HasSubstr("has 1 trials"));
  EXPECT_EQ(store.Campaigns().size(), 1u);
  campaign.name = "nowhere";
  EXPECT_THROW(store.ChangeCampaign(campaign), StoreError);
}

TEST(AddCampaign, RefusesImpossibleConventionsByName) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  const auto message = [&store](auto change) {
    core::Campaign campaign = SphereCampaign();
    change(campaign);
    return MessageOf<std::invalid_argument>(
        [&] { store.AddCampaign(campaign); });
  };
  using C = core::Campaign;
  EXPECT_THAT(message([](C& c) { c.name = ""; }), HasSubstr("name"));
  EXPECT_THAT(message([](C& c) { c.bounce_height_m = 0; }),
              HasSubstr("bounce_height_m is 0"));
  EXPECT_THAT(message([](C& c) { c.speed_max_mps = 0.5; }),
              HasSubstr("speed_max_mps is 0.5"));
  EXPECT_THAT(message([](C& c) { c.margin_rad = NAN; }),
              HasSubstr("margin_rad"));
  EXPECT_THAT(message([](C& c) { c.theory_name = ""; }),
              HasSubstr("theory_name"));
}

TEST(Open, NeverCreatesWhatIsOnlyRead) {
  Folder folder;
  for (const auto mode : {OpenMode::kRead, OpenMode::kWrite}) {
    EXPECT_THAT(
        MessageOf<StoreError>([&] { Store::Open(folder / "lab.db", mode); }),
        HasSubstr("there is no such trial store"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THAT(MessageOf<StoreError>([&] {
                Store::Open(folder / "no/lab.db", OpenMode::kCreate);
              }),
              HasSubstr("does not exist"));
  EXPECT_THAT(MessageOf<StoreError>(
                  [&] { Store::Open(folder.path(), OpenMode::kCreate); }),
              HasSubstr("folder"));
}

TEST(Open, LeavesOneFileBehind) {
  Folder folder;
  OpenFixed(folder / "lab.db").LogTrial(SphereTrial(1, ""));
  Store::Open(folder / "lab.db", OpenMode::kRead).Trials();
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename(), "lab.db");
    ++files;
  }
  EXPECT_EQ(files, 1);
}

TEST(Open, RefusesWhatIsNotATrialStore) {
  Folder folder;
  std::ofstream(folder / "text.db") << std::string(5000, 'x');
  EXPECT_THAT(MessageOf<StoreError>(
                  [&] { Store::Open(folder / "text.db", OpenMode::kCreate); }),
              HasSubstr("not a trial store"));
  std::ofstream(folder / "empty.db").close();
  EXPECT_THAT(MessageOf<StoreError>(
                  [&] { Store::Open(folder / "empty.db", OpenMode::kRead); }),
              HasSubstr("nothing was ever recorded"));
  // What a process left that was killed while making a store can be taken up.
  OpenFixed(folder / "empty.db").LogTrial(SphereTrial(1, ""));
}

TEST(Open, TakesOddPaths) {
  Folder folder;
  for (const std::string name :
       {"with space.db", "it's \"quoted\".db", "file:x?mode=memory.db",
        ":memory:", "new\nline.db", "\xc3\xa4\xe6\x92\x9e.db", "100%25.db"}) {
    SCOPED_TRACE(name);
    OpenFixed(folder / name).LogTrial(SphereTrial(1, ""));
    EXPECT_TRUE(std::filesystem::exists(folder / name));
    EXPECT_EQ(Store::Open(folder / name, OpenMode::kRead).Trials().size(), 1u);
  }
}

}  // namespace
}  // namespace touchdown::db
