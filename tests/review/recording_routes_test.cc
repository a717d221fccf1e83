// Recordings and analyses as the page asks for them, without a socket.
#include "app/review/recording_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "app/review/logging.h"
#include "app/review/routes.h"
#include "tests/review/lab.h"

namespace touchdown::review {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;
using Query = std::map<std::string, std::string>;

class RecordingRoutes : public ::testing::Test {
 protected:
  RecordingRoutes() {
    std::filesystem::create_directories(lab.folder / "films");
    pipeline::filmed::WriteSphere(lab.folder / "films/new.mraw", 25.0, 2);
  }
  Reply Get(const std::string& path, const Query& query = {}) {
    Request request;
    request.path = path;
    request.query = query;
    return Route(desk, request);
  }
  Reply Post(const std::string& path, const Json& body) {
    Request request;
    request.method = "POST";
    request.path = path;
    request.body = body.dump();
    return Route(desk, request);
  }
  Json Over(const std::string& id) {
    while (true) {
      const Json all = Json::parse(Get("/api/analyses").body);
      for (const Json& one : all["analyses"]) {
        const std::string state = one["state"];
        if (one["id"] == id && state != "waiting" && state != "running") {
          return one;
        }
      }
      std::this_thread::yield();
    }
  }

  Lab lab;
  Desk desk{lab.store,
            lab.folder / "report",
            {},
            RecordingFolders({lab.folder.path()})};
  const Json kNew = {{"folder", 0}, {"name", "films/new.mraw"}};
};

TEST_F(RecordingRoutes, ListRecordingsWithTheirTrials) {
  const Json json = Json::parse(Get("/api/recordings").body);
  EXPECT_EQ(json["schema"], "touchdown.review.recordings/1");
  const Json& recordings = json["folders"][0]["recordings"];
  ASSERT_EQ(recordings.size(), 2u);
  EXPECT_EQ(recordings[0]["name"], "films/new.mraw");
  EXPECT_TRUE(recordings[0]["trials"].empty());
  EXPECT_EQ(recordings[1]["name"], "shot.mraw");
  EXPECT_EQ(recordings[1]["trials"][0]["id"], lab.trial);
  EXPECT_EQ(json["campaigns"][0]["name"], "board");
  EXPECT_TRUE(json["campaigns"][0]["camera"].is_null());  // as the file says
}

TEST_F(RecordingRoutes, ShowARecordingBeforeItIsATrial) {
  const Query query = {{"folder", "0"}, {"name", "films/new.mraw"}};
  const Json clip = Json::parse(Get("/api/recordings/clip", query).body);
  EXPECT_EQ(clip["frames"], 115);
  EXPECT_GT(clip["time_base"]["fps"], 100.0);
  Query frame = query;
  frame["frame"] = "3";
  EXPECT_EQ(Get("/api/recordings/frame", frame).type, "image/png");
  frame["frame"] = "-3";
  EXPECT_EQ(Get("/api/recordings/frame", frame).status, 404);
  EXPECT_EQ(Get("/api/recordings/frame",
                {{"folder", "0"}, {"name", "../shot.mraw"}, {"frame", "0"}})
                .status,
            400);
  EXPECT_EQ(Get("/api/recordings/clip", {{"name", "shot.mraw"}}).status, 404);
}

TEST_F(RecordingRoutes, AnalyseAndLogARecording) {
  const Reply reply = Post("/api/analyses", {{"campaign", "board"},
                                             {"who", "Ada"},
                                             {"recording", kNew},
                                             {"set_angle_deg", "25"}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json over = Over(Json::parse(reply.body)["id"]);
  EXPECT_EQ(over["state"], "done") << over;
  EXPECT_EQ(over["name"], "films/new.mraw");
  const Json trial =
      Json::parse(Get("/api/trials/" + over["trial"].get<std::string>()).body);
  EXPECT_NEAR(trial["row"]["set_angle_deg"].get<double>(), 25.0, 1e-9);
}

TEST_F(RecordingRoutes, NameTheFieldThatIsWrong) {
  const Json good = {
      {"campaign", "board"}, {"who", "Ada"}, {"recording", kNew}};
  const auto field_of = [&](const char* field, const Json& value) {
    Json asked = good;
    asked[field] = value;
    const Reply reply = Post("/api/analyses", asked);
    EXPECT_EQ(reply.status, 400) << reply.body;
    return Json::parse(reply.body).value("field", "");
  };
  EXPECT_EQ(field_of("who", " "), "who");
  EXPECT_EQ(field_of("campaign", ""), "campaign");
  EXPECT_EQ(field_of("set_angle_deg", "95"), "set-angle-deg");
  EXPECT_EQ(field_of("conditions", Json{{"elevation_deg", "9"}}),
            "elevation_deg");
  EXPECT_EQ(field_of("recording", Json{{"folder", 0}, {"name", "/etc/passwd"}}),
            "recording");
  EXPECT_EQ(Post("/api/analyses/99/cancel", Json::object()).status, 404);
  EXPECT_TRUE(Json::parse(Get("/api/analyses").body)["analyses"].empty());
}

TEST_F(RecordingRoutes, RefuseWhatCannotBeReadAtOnce) {
  pipeline::filmed::WriteRubbish(lab.folder / "films/rubbish.mp4");
  const Reply reply =
      Post("/api/analyses",
           {{"campaign", "board"},
            {"who", "Ada"},
            {"recording", {{"folder", 0}, {"name", "films/rubbish.mp4"}}}});
  EXPECT_EQ(reply.status, 422);
  EXPECT_THAT(reply.body, HasSubstr("rubbish.mp4"));
}

// A calibration of the campaign's last recording holds for the next.
TEST_F(RecordingRoutes, TakeTheCameraOfTheLastRecording) {
  core::Trial last = lab.Now();
  Json document = Json::parse(last.document_json);
  document["replay"]["options"]["fps"] = 1234.0;
  last.document_json = document.dump();
  last.id.clear();
  last.clip.id = std::string(64, 'b');
  const std::string id =
      db::Store::Open(lab.store, db::OpenMode::kWrite).LogTrial(last).id;
  const Json json = Json::parse(Get("/api/recordings").body);
  EXPECT_EQ(json["campaigns"][0]["camera"], "1234 frames/s");
  const auto order = [&](bool other) {
    return ReadOrder(lab.store, desk.recordings(),
                     {{"campaign", "board"},
                      {"who", "Ada"},
                      {"recording", kNew},
                      {"other_camera", other}});
  };
  EXPECT_EQ(order(false).camera.fps, 1234.0);
  EXPECT_FALSE(order(true).camera.fps);
  db::Store::Open(lab.store, db::OpenMode::kWrite)
      .Exclude(id, "Ada", "the frame rate was another");
  EXPECT_FALSE(order(false).camera.fps);
}

}  // namespace
}  // namespace touchdown::review
