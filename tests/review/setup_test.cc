// A campaign made on the page: tested without a trace, kept with its first
// trial.
#include "app/review/setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/review/routes.h"
#include "app/trials/statement.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/board_files.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::review {
namespace {

using pipeline::FieldError;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A folder with one clip and no store.
class Setup : public ::testing::Test {
 protected:
  Setup() { pipeline::filmed::WriteSphere(folder / "new.mraw", 25.0, 1); }

  AnalysisStatus Tested(const Json& asked) {
    AnalysisOrder order = ReadTestOrder(desk, asked);
    const std::string id = desk.analyses().Add(std::move(order));
    while (true) {
      const auto status = desk.analyses().Find(id).value();
      if (status.state == AnalysisState::kDone) return status;
      EXPECT_NE(status.state, AnalysisState::kFailed) << status.trouble;
      if (status.state == AnalysisState::kFailed) return status;
      std::this_thread::yield();
    }
  }
  // The field that is refused once `change` was made to what is right.
  std::string FieldOf(const std::function<void(Json&)>& change) {
    Json asked = good;
    change(asked);
    try {
      ReadTestOrder(desk, asked);
    } catch (const FieldError& error) {
      return error.field();
    }
    return "none";
  }

  testing::TemporaryFolder folder;
  std::filesystem::path db = folder / "lab.db";
  Desk desk{db, folder / "report", {}, RecordingFolders({folder.path()})};
  const Json good = {
      {"recording", {{"folder", 0}, {"name", "new.mraw"}}},
      {"campaign",
       {{"name", "asphalt"}, {"body", "sphere"}, {"diameter_mm", "24"}}},
      {"camera", Json::object()}};
};

TEST_F(Setup, LeavesNoTraceUntilItIsKept) {
  const AnalysisStatus status = Tested(good);
  EXPECT_FALSE(std::filesystem::exists(db));
  const Json json = TestJson(status);
  EXPECT_EQ(json["schema"], "touchdown.review.test/1");
  EXPECT_THAT(json["numbers"]["angle"].get<std::string>(), HasSubstr("deg"));
  EXPECT_EQ(json["settings"]["scale_source"], "body_size");
  EXPECT_EQ(json["view"]["body"]["kind"], "sphere");
  ASSERT_EQ(json["checks"].size(), 7u);
  for (const Json& check : json["checks"]) {
    EXPECT_NE(check["verdict"], "refused") << check;
  }
  const db::Logged logged = Keep(db, status, "Ada");
  EXPECT_TRUE(logged.is_new);
  const auto store = db::Store::Open(db, db::OpenMode::kRead);
  EXPECT_EQ(store.FindCampaign("asphalt")->body.diameter_m->value, 0.024);
  const auto trial = store.Find(logged.id).value();
  EXPECT_EQ(trial.campaign, "asphalt");
  EXPECT_EQ(trial.reason, "logged on the review page by Ada");
  EXPECT_NEAR(trial.first.contact.approach_angle_rad->value, 25 * core::kDegree,
              0.1 * core::kDegree);
  EXPECT_FALSE(trial.clip.sha256.empty());
}

TEST_F(Setup, MarksBecomeACalibration) {
  Json asked = good;
  asked["camera"] = {{"camera", "left"},
                     {"fps", "1000"},
                     {"scale_px", {10.0, 20.0, 60.0, 20.0}},
                     {"length_mm", "50+-0.1"},
                     {"ground_px", {5.0, 100.0, 200.0, 101.0}}};
  const AnalysisOrder order = ReadTestOrder(desk, asked);
  ASSERT_TRUE(order.camera.calibration);
  const calib::Calibration& c = *order.camera.calibration;
  EXPECT_EQ(c.camera, "left");
  EXPECT_NEAR(c.scale->px_per_m.value, 1000.0, 1e-9);
  // A click of 0.5 px at each end, along the line, beside 0.1 mm of 50.
  EXPECT_NEAR(c.scale->px_per_m.u,
              1000.0 * std::hypot(0.5 * std::sqrt(2) / 50, 0.1 / 50), 1e-6);
  EXPECT_EQ(c.ground->p2.y_px, 101.0);
  EXPECT_EQ(order.camera.fps, 1000.0);
  EXPECT_FALSE(ReadTestOrder(desk, good).camera.calibration);
}

TEST_F(Setup, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(FieldOf([](Json&) {}), "none");
  EXPECT_EQ(FieldOf([](Json& j) { j["campaign"]["name"] = " "; }), "name");
  EXPECT_EQ(FieldOf([](Json& j) { j["campaign"]["body"] = "cube"; }), "body");
  EXPECT_EQ(FieldOf([](Json& j) { j["campaign"]["diameter_mm"] = ""; }),
            "diameter-mm");
  EXPECT_EQ(FieldOf([](Json& j) { j["campaign"]["diameter_mm"] = "4O"; }),
            "diameter-mm");
  EXPECT_EQ(FieldOf([](Json& j) {
              j["campaign"] = {{"name", "a"}, {"body", "rectangle"}};
            }),
            "sides-mm");
  EXPECT_EQ(FieldOf([](Json& j) { j["campaign"]["speed_mps"] = "3-4"; }),
            "speed-mps");
  EXPECT_EQ(FieldOf([](Json& j) { j["camera"]["fps"] = "fast"; }), "fps");
  EXPECT_EQ(FieldOf([](Json& j) {
              j["camera"]["scale_px"] = {1, 2, 3, 4};
            }),
            "length-mm");
  EXPECT_EQ(FieldOf([](Json& j) { j["camera"]["length_mm"] = "5"; }),
            "length-mm");
  EXPECT_EQ(FieldOf([](Json& j) { j["recording"]["name"] = "../x.mraw"; }),
            "recording");
  EXPECT_EQ(FieldOf([](Json& j) { j.erase("camera"); }), "camera");
  Json same = good;
  same["camera"]["ground_px"] = {1, 2, 1, 2};
  EXPECT_THROW(ReadTestOrder(desk, same), std::invalid_argument);
  same["camera"]["ground_px"] = {1, 2, 3};
  EXPECT_THROW(ReadTestOrder(desk, same), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(db));
}

// A size that is off beside a scale that is known.
TEST_F(Setup, RefusesAnAnswerOfABodyThatIsNotThere) {
  Json asked = good;
  asked["campaign"]["diameter_mm"] = "29";
  const double px_per_m = Tested(good).analysis->scale->px_per_m.value;
  asked["camera"] = {{"scale_px", {10.0, 20.0, 10.0 + 0.2 * px_per_m, 20.0}},
                     {"length_mm", "200"}};
  const Json json = TestJson(Tested(asked));
  EXPECT_EQ(json["checks"][1]["name"], "size");
  EXPECT_EQ(json["checks"][1]["verdict"], "refused");
  EXPECT_TRUE(json["numbers"]["frame"].is_null());
}

TEST_F(Setup, MakesALensFromPicturesOfABoard) {
  std::filesystem::create_directories(folder / "board");
  testing::WriteBoardPictures(folder / "board", 9);
  const Json asked = {{"pictures", {{"folder", 0}, {"name", "board"}}},
                      {"board", "chessboard:7x5:20mm"},
                      {"camera", "left"}};
  const Json json = LensJson(desk.recordings(), asked);
  EXPECT_EQ(json["views"], 9);
  EXPECT_LT(json["rms_px"].get<double>(), 0.2);
  const auto file =
      calib::ParseCalibration(json["calibration"].dump(), "the answer");
  EXPECT_EQ(file.camera, "left");
  EXPECT_NEAR(file.lens->lens.fx_px, testing::SmallLens().fx_px, 5.0);
  const auto field_of = [&](const char* field, const Json& value) {
    Json other = asked;
    other[field] = value;
    try {
      LensJson(desk.recordings(), other);
    } catch (const FieldError& error) {
      return error.field();
    }
    return std::string("none");
  };
  EXPECT_EQ(field_of("board", "cheese:7x5"), "board");
  EXPECT_EQ(field_of("pictures", Json{{"folder", 0}, {"name", ".."}}),
            "pictures");
  EXPECT_THROW(field_of("board", "chessboard:9x8:20mm"), core::InputError);
  // A clip of another size is not of this lens.
  EXPECT_EQ(
      FieldOf([&](Json& j) { j["camera"]["lens"] = json["calibration"]; }),
      "pictures");
}

TEST_F(Setup, KeepsACampaignOnce) {
  const AnalysisStatus status = Tested(good);
  Keep(db, status, "Ada");
  EXPECT_THROW(Keep(db, status, "Grace"), FieldError);
  EXPECT_EQ(FieldOf([](Json&) {}), "name");  // it has trials now
  const auto store = db::Store::Open(db, db::OpenMode::kRead);
  EXPECT_EQ(store.Trials().size(), 1u);
  // One without trials takes the conventions that were tested.
  Json other = good;
  other["campaign"]["name"] = "begun";
  core::Campaign begun = *store.FindCampaign("asphalt");
  begun.name = "begun";
  begun.surface = "to be said";
  db::Store::Open(db, db::OpenMode::kWrite).AddCampaign(begun);
  other["campaign"]["surface"] = "board";
  Keep(db, Tested(other), "Ada");
  EXPECT_EQ(store.FindCampaign("begun")->surface, "board");
}

TEST_F(Setup, IsKeptByARequestWithAName) {
  const AnalysisStatus status = Tested(good);
  const auto post = [&](const std::string& path, const Json& body) {
    Request request;
    request.method = "POST";
    request.path = "/api/analyses/" + path;
    request.body = body.dump();
    return Route(desk, request);
  };
  const Reply nobody = post(status.id + "/keep", {{"who", " "}});
  EXPECT_EQ(nobody.status, 400);
  EXPECT_EQ(Json::parse(nobody.body)["field"], "who");
  EXPECT_EQ(post("99/keep", {{"who", "Ada"}}).status, 404);
  EXPECT_FALSE(std::filesystem::exists(db));
  const Reply kept = post(status.id + "/keep", {{"who", "Ada"}});
  ASSERT_EQ(kept.status, 200) << kept.body;
  // Another tab that looks at the same test gets the same trial.
  EXPECT_EQ(post(status.id + "/keep", {{"who", "Grace"}}).body, kept.body);
}

}  // namespace
}  // namespace touchdown::review
