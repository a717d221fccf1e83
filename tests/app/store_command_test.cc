// The commands of the store as a user runs them: exits, one line per mistake,
// nothing on stdout but results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/db/fixture.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Ran {
  int status = -1;
  std::string out;
  std::string error;
};

std::string Slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class StoreCommand : public ::testing::Test {
 protected:
  Ran Run(const std::string& arguments) {
    const std::string line = "cd '" + folder_.path().string() +
                             "' && " TOUCHDOWN_BINARY " " + arguments +
                             " >out 2>error";
    const int status = std::system(line.c_str());
    return {WEXITSTATUS(status), Slurp(folder_ / "out"),
            Slurp(folder_ / "error")};
  }
  void ExpectMistake(const std::string& arguments, int status,
                     const std::string& says) {
    SCOPED_TRACE(arguments);
    const Ran ran = Run(arguments);
    EXPECT_EQ(ran.status, status);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.error, StartsWith("touchdown: "));
    EXPECT_THAT(ran.error, HasSubstr(says));
    EXPECT_EQ(std::count(ran.error.begin(), ran.error.end(), '\n'), 1);
  }
  std::string LogOne() {
    EXPECT_EQ(Run("campaign new asphalt --db lab.db --body sphere "
                  "--diameter-mm 40 --theory published "
                  "--theory-boundary-deg 11.8")
                  .status,
              0);
    const Ran ran =
        Run("log --db lab.db --campaign asphalt --angle-deg 20 --angle-u-deg "
            "0.5 --state bounce --by Ada --json");
    EXPECT_EQ(ran.status, 0) << ran.error;
    return nlohmann::json::parse(ran.out).at("id");
  }
  db::Folder folder_;
};

TEST_F(StoreCommand, TheOnlyCampaignNeedsNoName) {
  LogOne();
  const Ran one = Run("campaign show --db lab.db");
  EXPECT_EQ(one.status, 0) << one.error;
  EXPECT_EQ(one.out, Run("campaign show asphalt --db lab.db").out);
  Run("campaign new ice --db lab.db --body sphere --diameter-mm 40");
  ExpectMistake("campaign show --db lab.db", 2, "one of: asphalt, ice");
}

TEST_F(StoreCommand, RelinkSaysWhatItFoundAndWhatNot) {
  LogOne();  // by hand: it has no recording
  const Ran ran = Run("db relink . --db lab.db");
  EXPECT_EQ(ran.status, 0) << ran.error;
  EXPECT_EQ(ran.out,
            "0 recordings found, 0 not found, 0 where last seen; 0 recordings "
            "in .\n");
  ExpectMistake("db relink nowhere --db lab.db", 3, "nowhere");
}

TEST_F(StoreCommand, LogListShowCorrect) {
  const std::string id = LogOne();
  const Ran list = Run("list --db lab.db --json");
  const auto json = nlohmann::json::parse(list.out);
  EXPECT_EQ(json["schema"], "touchdown.list/1");
  ASSERT_EQ(json["trials"].size(), 1u);
  const auto& trial = json["trials"][0];
  EXPECT_EQ(trial["id"], id);
  EXPECT_EQ(trial["origin"], "manual");
  EXPECT_EQ(trial["state"], "bounce");
  EXPECT_EQ(trial["angle_kind"], "approach");
  EXPECT_DOUBLE_EQ(trial["angle_deg"]["value"], 20.0);
  EXPECT_DOUBLE_EQ(trial["angle_deg"]["u"], 0.5);
  EXPECT_THAT(Run("list --db lab.db").out, HasSubstr("20.00 +- 0.50"));
  EXPECT_EQ(Run("correct " + id.substr(0, 8) +
                " --db lab.db --state slide --by Bob --why 'seen again'")
                .status,
            0);
  EXPECT_EQ(Run("correct " + id + " --db lab.db --exclude --by Bob --why dust")
                .status,
            0);
  const Ran show = Run("show " + id + " --db lab.db --history");
  EXPECT_THAT(show.out, HasSubstr("corrected by Bob: seen again"));
  EXPECT_THAT(show.out, HasSubstr("state: bounce -> slide"));
  EXPECT_THAT(show.out, HasSubstr("excluded by Bob: dust"));
  const auto whole =
      nlohmann::json::parse(Run("show " + id + " --db lab.db --json").out);
  EXPECT_EQ(whole["schema"], "touchdown.trial/1");
  EXPECT_EQ(whole["id"], id);
  EXPECT_EQ(whole["history"].size(), 3u);
  EXPECT_EQ(whole["excluded"], true);
  EXPECT_THAT(Run("list --db lab.db").out,
              AllOf(HasSubstr("EXCLUDED: dust"), HasSubstr("1 excluded")));
  EXPECT_THAT(Run("list --db lab.db --counting").out, HasSubstr("0 trials"));
}

// The kind of angle is the campaign's, and with it the sign that is allowed.
TEST_F(StoreCommand, LogsANegativeFaceAngleIntoAFaceCampaign) {
  ASSERT_EQ(Run("campaign new faces --db lab.db --body rectangle --sides-mm "
                "40x20 --angle-kind face")
                .status,
            0);
  const Ran ran =
      Run("log --db lab.db --campaign faces --by Ada --state bounce "
          "--angle-deg=-12 --angle-u-deg 0.5");
  ASSERT_EQ(ran.status, 0) << ran.error;
  const auto trials =
      db::Store::Open(folder_ / "lab.db", db::OpenMode::kRead).Trials();
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].angle_kind, core::AngleKind::kFace);
  EXPECT_NEAR(trials[0].first.contact.face_angle_rad->value,
              -12.0 * core::kDegree, 1e-12);
}

TEST_F(StoreCommand, ShowsAProposalAndAcceptsIt) {
  std::string id;
  {
    auto store = db::Store::Open(folder_ / "lab.db", db::OpenMode::kCreate);
    core::Trial trial = db::SphereTrial(1, "");
    trial.document_json = "{}";
    id = store.LogTrial(trial).id;
    ASSERT_EQ(
        Run("correct " + id + " --db lab.db --state roll --by Ada --why seen")
            .status,
        0);
    trial.first.state.label = core::MotionState::kBounce;
    ASSERT_TRUE(store.LogTrial(trial).is_proposal);
  }
  const Ran show = Run("show " + id + " --db lab.db");
  EXPECT_THAT(show.out,
              AllOf(HasSubstr("proposal\n"), HasSubstr("state: roll -> bounce"),
                    HasSubstr("correct " + id.substr(0, 8) + " --accept 3")));
  const auto json =
      nlohmann::json::parse(Run("show " + id + " --db lab.db --json").out);
  EXPECT_EQ(json["proposal"], 3);
  EXPECT_EQ(json["revision"], 2);
  EXPECT_EQ(json["contacts"][0]["state"], "roll");
  EXPECT_EQ(json["history"][2]["kind"], "proposed");
  ExpectMistake("correct " + id + " --db lab.db --accept 9 --by Ada --why x", 2,
                "--accept is 9, must be a revision in 1 .. 3");
  ASSERT_EQ(Run("correct " + id +
                " --db lab.db --accept 3 --by Ada --why 'it was right'")
                .status,
            0);
  const Ran after = Run("show " + id + " --db lab.db");
  EXPECT_THAT(after.out, HasSubstr("bounce"));
  EXPECT_THAT(after.out, Not(HasSubstr("proposal\n")));
}

TEST_F(StoreCommand, MistakesAreOneLineWithTheirExit) {
  ExpectMistake("list --db lab.db", 4, "no such trial store");
  ExpectMistake("show abcd --db lab.db", 4, "no such trial store");
  ExpectMistake("db check --db lab.db", 4, "no such trial store");
  ExpectMistake("export --db lab.db --out x.csv", 4, "no such trial store");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "lab.db"));
  LogOne();
  ExpectMistake("list", 2, "--db");
  ExpectMistake("list --db lab.db --state fly", 2, "--state is 'fly'");
  ExpectMistake("list --db lab.db --campaign none", 4, "no campaign 'none'");
  ExpectMistake("show abcd0000 --db lab.db", 4, "no trial 'abcd0000'");
  ExpectMistake("show ab --db lab.db", 2, "at least 4");
  const std::string log = "log --db lab.db --campaign asphalt --by Ada ";
  ExpectMistake(log + "--state bounce --angle-deg 91 --angle-u-deg 1", 2,
                "--angle-deg is 91");
  ExpectMistake(log + "--state bounce --angle-deg nan --angle-u-deg 1", 2,
                "--angle-deg is nan");
  ExpectMistake(log + "--state bounce --angle-deg 9", 2, "go together");
  ExpectMistake(log, 2, "--state is missing");
  ExpectMistake(log + "--state bounce --angle-kind face", 2, "never pooled");
  ExpectMistake("log --db lab.db --state bounce --by Ada", 2, "--body");
  ExpectMistake("log --db lab.db --state bounce --body sphere", 2, "--by");
  ExpectMistake(
      "campaign new asphalt --db lab.db --body sphere "
      "--diameter-mm 40",
      4, "already");
  ExpectMistake(
      "campaign new asphalt --db lab.db --body sphere "
      "--diameter-mm 30 --change",
      4, "fixed before the first");
  ExpectMistake("campaign new b --db lab.db --body sphere --diameter-mm 0", 2,
                "diameter");
  ExpectMistake(
      "campaign new b --db lab.db --body sphere --diameter-mm 4 "
      "--speed-mps 5",
      2, "--speed-mps is '5'");
  ExpectMistake("import none.csv --db lab.db", 3, "cannot be read");
  ExpectMistake("import none.txt --db lab.db", 2, "format");
  ExpectMistake("db backup --db lab.db lab.db", 4, "exists");
  ExpectMistake("db merge --db lab.db lab.db", 2, "itself");
}

TEST_F(StoreCommand, ExportImportMergeBackup) {
  LogOne();
  EXPECT_EQ(Run("export --db lab.db --out all.jsonl").status, 0);
  EXPECT_EQ(Run("import all.jsonl --db b.db").status, 0);
  EXPECT_EQ(Run("export --db b.db --format jsonl").out.substr(100),
            Slurp(folder_ / "all.jsonl").substr(100));
  EXPECT_THAT(Run("db merge --db b.db lab.db").out,
              HasSubstr("0 trials, 0 revisions"));
  EXPECT_EQ(Run("db backup --db lab.db copy.db").status, 0);
  EXPECT_THAT(Run("db check --db copy.db").out, HasSubstr("is sound"));
  EXPECT_THAT(Run("db migrate --db copy.db").out, HasSubstr("nothing to do"));
  // An export opened in a spreadsheet, its ids removed, is a table of new
  // trials; with its ids it is what is there already.
  EXPECT_EQ(Run("export --db lab.db --out all.csv").status, 0);
  ExpectMistake("import all.csv --db lab.db", 3, "already");
  std::ofstream(folder_ / "bad.csv")
      << "body_kind,state,campaign\nsphere,bounce,asphalt\n"
         "sphere,fly,\nsphere,slide,nowhere\n";
  const Ran none = Run("import bad.csv --db lab.db --by Ada");
  EXPECT_EQ(none.status, 3);
  EXPECT_THAT(none.error, HasSubstr("row 3, column state"));
  EXPECT_THAT(Run("list --db lab.db").out, HasSubstr("1 trial\n"));
  const Ran some = Run("import bad.csv --db lab.db --by Ada --partial");
  EXPECT_EQ(some.status, 5);
  EXPECT_EQ(some.out, "1 trials imported, 2 errors\n");
  EXPECT_THAT(some.error, HasSubstr("row 4, column campaign: 'nowhere'"));
  EXPECT_THAT(Run("list --db lab.db").out, HasSubstr("2 trials\n"));
}

TEST_F(StoreCommand, SimulatedTrialsAreMarked) {
  {
    db::Store store = db::OpenFixed(folder_ / "lab.db");
    core::Trial trial = db::SphereTrial(1, "");
    trial.origin = core::Origin::kSimulated;
    trial.first.state.reason = "\x1b[2Jescape\n";
    store.LogTrial(trial);
  }
  const Ran list = Run("list --db lab.db");
  EXPECT_THAT(list.out, HasSubstr("SIMULATED"));
  EXPECT_THAT(list.out, HasSubstr("1 simulated (no verdict"));
  const std::string id = nlohmann::json::parse(
      Run("list --db lab.db --json").out)["trials"][0]["id"];
  const Ran show = Run("show " + id + " --db lab.db");
  EXPECT_THAT(show.out, StartsWith("SIMULATED"));
  EXPECT_THAT(show.out, HasSubstr("\\x1b[2Jescape\\x0a"));
}

// --- seals -------------------------------------------------------------------

TEST_F(StoreCommand, ASealIsPrintedWrittenSignedAndChecked) {
  LogOne();
  const Ran head = Run("db seal --db lab.db");
  ASSERT_EQ(head.status, 0) << head.error;
  const std::string line = head.out.substr(0, head.out.find('\n'));
  const Ran written = Run("db seal --db lab.db --out lab.seal");
  EXPECT_THAT(written.out, StartsWith(line + "\nlab.seal: "));
  ExpectMistake("db seal --db lab.db --out lab.seal", 6, "seals are kept");
  ExpectMistake("db seal --db lab.db --key k", 2, "give --out");
  Run("log --db lab.db --campaign asphalt --state slide --by Ada");
  for (const std::string& seal : {line, std::string("lab.seal")}) {
    const Ran ran = Run("db check --db lab.db --against " + seal);
    EXPECT_EQ(ran.status, 0) << ran.error;
    EXPECT_THAT(ran.out, HasSubstr("links that were sealed"));
    EXPECT_THAT(ran.out, HasSubstr("are as they were, 1 since"));
  }
  EXPECT_EQ(Run("db check --db lab.db --against nowhere").status, 2);
  std::ofstream(folder_ / "no.seal") << "touchdown seal 1\n";
  EXPECT_EQ(Run("db check --db lab.db --against no.seal").status, 3);
  // Another store is not this one.
  Run("log --db other.db --body sphere --state slide --by Ada");
  const Ran other = Run("db check --db other.db --against lab.seal");
  EXPECT_EQ(other.status, 4);
  EXPECT_THAT(other.error, HasSubstr("another store"));
}

// With whatever of the three is here; each is verified by the tool itself.
TEST_F(StoreCommand, ASealIsSignedWithWhatIsThere) {
  LogOne();
  const auto shell = [this](const std::string& command) {
    return std::system(("cd '" + folder_.path().string() + "' && (" + command +
                        ") >sh.out 2>&1")
                           .c_str()) == 0;
  };
  int signed_by = 0;
  const auto expect_signed = [&](const std::string& tool,
                                 const std::string& verify) {
    SCOPED_TRACE(tool);
    ++signed_by;
    const Ran ran = Run("db seal --db lab.db --out " + tool + ".seal --key " +
                        tool + ".key");
    EXPECT_EQ(ran.status, 0) << ran.error;
    EXPECT_THAT(ran.out, HasSubstr("verify with `" + tool));
    EXPECT_TRUE(shell(verify)) << Slurp(folder_ / "sh.out");
    EXPECT_FALSE(shell("echo >>" + tool + ".seal && " + verify));
  };
  if (shell("ssh-keygen -q -t ed25519 -N '' -f ssh-keygen.key")) {
    expect_signed("ssh-keygen",
                  "(printf 'lab ' && cat ssh-keygen.key.pub) >signers && "
                  "ssh-keygen -Y verify -f signers -I lab -n touchdown -s "
                  "ssh-keygen.seal.sig <ssh-keygen.seal");
  }
  if (shell("openssl genpkey -algorithm ed25519 -out openssl.key && openssl "
            "pkey -in openssl.key -pubout -out openssl.pub")) {
    expect_signed("openssl",
                  "openssl pkeyutl -verify -rawin -pubin -inkey openssl.pub "
                  "-in openssl.seal -sigfile openssl.seal.sig");
  }
  if (shell("minisign -G -W -p minisign.pub -s minisign.key")) {
    expect_signed("minisign", "minisign -V -p minisign.pub -m minisign.seal");
  }
  std::ofstream(folder_ / "no.key") << "no key";
  ExpectMistake("db seal --db lab.db --out x.seal --key no.key", 2,
                "no private key");
  // A signer that fails half-way.
  std::filesystem::create_directory(folder_ / "bin");
  std::ofstream(folder_ / "bin" / "minisign")
      << "#!/bin/sh\necho half >broken.seal.minisig\nexit 1\n";
  std::filesystem::permissions(folder_ / "bin" / "minisign",
                               std::filesystem::perms::owner_all);
  std::ofstream(folder_ / "broken.key") << "untrusted comment: a key\n";
  EXPECT_TRUE(shell("PATH=$PWD/bin:$PATH " TOUCHDOWN_BINARY
                    " db seal --db lab.db --out broken.seal --key broken.key; "
                    "test $? = 6"));
  EXPECT_THAT(Slurp(folder_ / "sh.out"), HasSubstr("nothing was written"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "broken.seal"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "broken.seal.minisig"));
  if (signed_by == 0) GTEST_SKIP() << "no ssh-keygen, openssl or minisign here";
}

}  // namespace
}  // namespace touchdown
