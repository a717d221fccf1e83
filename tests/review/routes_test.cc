// What the page asks for, without a socket.
#include "app/review/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/documents/replay.h"
#include "app/review/trial_view.h"
#include "tests/review/lab.h"
#include "touchdown/db/plan.h"

namespace touchdown::review {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class Routes : public ::testing::Test {
 protected:
  Reply Get(const std::string& path, const std::string& revision = "") {
    Request request;
    request.path = path;
    if (!revision.empty()) request.query["revision"] = revision;
    return Route(desk, request);
  }
  Reply Post(const std::string& path, const Json& body) {
    Request request;
    request.method = "POST";
    request.path = path;
    request.body = body.dump();
    return Route(desk, request);
  }
  std::string Trial(const std::string& rest = "") {
    return std::string("/api/trials/").append(lab.trial).append(rest);
  }

  Lab lab;
  Desk desk{lab.store, lab.folder / "report"};
};

TEST_F(Routes, ListsTrialsWithCampaigns) {
  const Reply reply = Get("/api/trials");
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json json = Json::parse(reply.body);
  EXPECT_EQ(json["schema"], "touchdown.review.trials/1");
  ASSERT_EQ(json["trials"].size(), 1u);
  EXPECT_EQ(json["trials"][0]["id"], lab.trial);
  EXPECT_EQ(json["campaigns"][0]["name"], "board");
  EXPECT_EQ(json["campaigns"][0]["trials"], 1);
}

TEST_F(Routes, SaysWhatTheTrialsSayTogether) {
  const Json json = Json::parse(Get("/api/statistics").body);
  ASSERT_EQ(json["groups"].size(), 1u);
  const Json& group = json["groups"][0];
  EXPECT_EQ(group["campaign"], "board");
  EXPECT_TRUE(group["next"]["angle_deg"].is_number());
  EXPECT_FALSE(group["sentences"]["boundary"].get<std::string>().empty());
  EXPECT_FALSE(json["table1"].empty());
  const Reply plot = Get("/api/plots/0");
  EXPECT_EQ(plot.type, "image/svg+xml");
  EXPECT_THAT(plot.body, HasSubstr("<svg"));
  EXPECT_EQ(Get("/api/plots/1").status, 404);
  EXPECT_EQ(Get("/api/plots/x").status, 404);
  // That was one look at the answer, on record.
  const auto store = db::Store::Open(lab.store, db::OpenMode::kRead);
  const auto plan = db::PlanEvents(store, "board");
  ASSERT_EQ(plan.size(), 1u);
  EXPECT_EQ(plan[0].kind, db::PlanEventKind::kLook);
  EXPECT_EQ(plan[0].author, "review");
  EXPECT_EQ(plan[0].trials, 1);
}

TEST_F(Routes, ShowsATrialWithWhatIsDrawnOfIt) {
  const Reply reply = Get(Trial());
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json json = Json::parse(reply.body);
  EXPECT_EQ(json["clip"]["frames"], 115);
  const Json& view = json["view"];
  ASSERT_FALSE(view.contains("absent")) << view["absent"];
  EXPECT_GT(view["poses"].size(), 50u);
  EXPECT_EQ(view["flights"].size(), 2u);
  EXPECT_EQ(view["gaps"].size(), view["poses"].size());
  EXPECT_EQ(view["length_unit"], "mm");
  EXPECT_NEAR(json["numbers"]["frame"].get<double>(), 80.37, 0.2);
  // The drawn flights meet where the body touched down.
  const Json& before = view["flights"][0]["points_px"].back();
  EXPECT_NEAR(before[0].get<double>(),
              view["contact"]["centre_px"][0].get<double>(), 1e-6);
  EXPECT_EQ(json["history"].size(), 1u);
  EXPECT_EQ(Get("/api/trials/00000000").status, 404);
  EXPECT_EQ(Get(Trial(), "2").status, 404);
}

TEST_F(Routes, ShowsTheChecksOfTheAnswerAndTheBounceHeight) {
  const Json view = Json::parse(Get(Trial()).body)["view"];
  EXPECT_NEAR(view["bounce_height"].get<double>(), 0.5, 1e-9);  // campaign's
  const Json document = Json::parse(lab.Now().document_json);
  EXPECT_EQ(view["checks"], document["checks"]);
  EXPECT_GE(view["checks"].size(), 5u);
}

TEST_F(Routes, GivesTheTrajectoryOfARevisionAsAFile) {
  const Reply reply = Get(Trial("/trajectory.csv"));
  EXPECT_EQ(reply.type, "text/csv; charset=utf-8");
  EXPECT_THAT(reply.body, ::testing::StartsWith("frame,time_s,x_mm,"));
  EXPECT_THAT(reply.headers,
              Contains(::testing::Pair("Content-Disposition",
                                       "attachment; filename=trajectory-" +
                                           std::string(lab.trial).substr(0, 8) +
                                           ".csv")));
  EXPECT_EQ(Get(Trial("/trajectory.csv"), "1").body, reply.body);
  EXPECT_EQ(Get(Trial("/trajectory.csv"), "2").status, 404);
}

TEST_F(Routes, FindsAMovedRecordingAndShowsItAtOnce) {
  EXPECT_EQ(Get(Trial("/thumbnail")).type, "image/jpeg");
  std::filesystem::create_directory(lab.folder / "archive");
  for (const char* ending : {"mraw", "cihx"}) {
    std::filesystem::rename(
        std::filesystem::path(lab.clip).replace_extension(ending),
        (lab.folder / "archive" / "x").replace_extension(ending));
  }
  EXPECT_EQ(Json::parse(Post("/api/relink", {{"folder", ""}}).body)["field"],
            "folder");
  EXPECT_EQ(
      Post("/api/relink", {{"folder", (lab.folder / "none").string()}}).status,
      422);
  const Reply reply =
      Post("/api/relink", {{"folder", lab.folder.path().string()}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json found = Json::parse(reply.body)["found"];
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0]["from"], lab.clip.string());
  EXPECT_EQ(Json::parse(Get(Trial()).body)["clip"]["frames"], 115);
  EXPECT_EQ(Get(Trial("/frames/80")).status, 200);
  EXPECT_EQ(Get(Trial("/thumbnail")).status, 200);
}

TEST_F(Routes, GivesFrames) {
  const Reply reply = Get(Trial("/frames/80"));
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.type, "image/png");
  EXPECT_EQ(Get(Trial("/frames/115")).status, 400);
  EXPECT_EQ(Get(Trial("/frames/-1")).status, 404);
}

// As a camera that stood still in these frames would have shown it. This one
// did.
TEST_F(Routes, GivesFramesThatArePutBack) {
  const auto get = [&](const std::string& steady) {
    Request request;
    request.path = Trial("/frames/80");
    request.query["steady"] = steady;
    return Route(desk, request);
  };
  const Reply still = get("0:115");
  EXPECT_EQ(still.status, 200);
  EXPECT_EQ(still.body, Get(Trial("/frames/80")).body);
  for (const char* wrong : {"", "0", ":", "0:", "a:b", "-1:115"}) {
    EXPECT_EQ(get(wrong).status, 404) << wrong;
  }
  EXPECT_EQ(get("0:116").status, 400);
  EXPECT_EQ(get("5:5").status, 400);
  pipeline::Analysis moved = *pipeline::Replay(lab.Now());
  EXPECT_FALSE(ViewJson(moved).contains("steady"));
  moved.camera_moved_px = core::Estimate{7.0, 0.1};
  EXPECT_EQ(ViewJson(moved)["steady"], "0:115");
}

TEST_F(Routes, JudgesACorrectionAndStoresNothing) {
  const Json json = Json::parse(Get(Trial()).body);
  Json ground = json["view"]["ground"]["p1_px"];
  for (const auto& n : json["view"]["ground"]["p2_px"]) ground.push_back(n);
  ground[1] = ground[1].get<double>() + 5.0;
  const Reply reply = Post(Trial("/preview"), {{"ground_px", ground}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json preview = Json::parse(reply.body);
  std::vector<std::string> fields;
  for (const auto& change : preview["changes"]) {
    fields.push_back(change["field"].get<std::string>());
  }
  EXPECT_THAT(fields, Contains("approach_angle_deg"));
  EXPECT_EQ(lab.Now().revision, 1);
}

TEST_F(Routes, StoresACorrectionAsARevisionOfWhatWasLookedAt) {
  const Json asked = {{"revision", 1},
                      {"who", "Ada"},
                      {"why", "seen by eye"},
                      {"state", "slide"}};
  ASSERT_EQ(Post(Trial("/revisions"), asked).status, 200);
  const core::Trial now = lab.Now();
  EXPECT_EQ(now.revision, 2);
  EXPECT_EQ(now.author, "Ada");
  EXPECT_EQ(now.first.state.label, core::MotionState::kSlide);
  // Who still looks at revision 1 is told what happened.
  const Reply late = Post(Trial("/revisions"), asked);
  EXPECT_EQ(late.status, 409);
  EXPECT_THAT(late.body, HasSubstr("Ada: seen by eye"));
  for (const char* act : {"exclude", "include"}) {
    const Reply reply =
        Post(Trial("/revisions"),
             {{"revision", 1}, {"who", "Ada"}, {"why", "late"}, {act, true}});
    EXPECT_EQ(reply.status, 409) << act;
  }
  EXPECT_EQ(lab.Now().revision, 2);
}

TEST_F(Routes, StatesAnEarlierRevisionAgain) {
  const core::Trial first = lab.Now();
  ASSERT_EQ(Post(Trial("/revisions"), {{"revision", 1},
                                       {"who", "Ada"},
                                       {"why", "seen by eye"},
                                       {"state", "slide"}})
                .status,
            200);
  ASSERT_EQ(Post(Trial("/revisions"), {{"revision", 2},
                                       {"who", "Ada"},
                                       {"why", "it was right"},
                                       {"restore", 1}})
                .status,
            200);
  const core::Trial now = lab.Now();
  EXPECT_EQ(now.revision, 3);
  EXPECT_EQ(now.first, first.first);
  EXPECT_EQ(now.document_json, first.document_json);
}

// A new analysis of a corrected trial waits for a person.
TEST_F(Routes, ShowsAProposalAndTakesItWhenToldTo) {
  const core::Trial first = lab.Now();
  ASSERT_EQ(Post(Trial("/revisions"), {{"revision", 1},
                                       {"who", "Ada"},
                                       {"why", "seen by eye"},
                                       {"state", "slide"}})
                .status,
            200);
  EXPECT_TRUE(Json::parse(Get(Trial()).body)["proposal"].is_null());
  {
    core::Trial again = first;
    again.id.clear();
    db::Store::Open(lab.store, db::OpenMode::kWrite).LogTrial(again);
  }
  const Json shown = Json::parse(Get(Trial()).body);
  EXPECT_EQ(shown["row"]["state"], "slide");
  EXPECT_EQ(shown["last_revision"], 2);
  EXPECT_EQ(shown["proposal"], 3);
  EXPECT_EQ(shown["history"][2]["kind"], "proposed");
  EXPECT_EQ(shown["history"][2]["changes"][0]["field"], "state");
  const Json list = Json::parse(Get("/api/trials").body);
  EXPECT_EQ(list["trials"][0]["attention"], "proposed");
  EXPECT_THAT(list["trials"][0]["why"].get<std::string>(),
              HasSubstr("proposes bounce"));
  ASSERT_EQ(Post(Trial("/revisions"), {{"revision", 2},
                                       {"who", "Ada"},
                                       {"why", "it was right"},
                                       {"restore", 3}})
                .status,
            200);
  EXPECT_EQ(lab.Now().first, first.first);
  EXPECT_TRUE(Json::parse(Get(Trial()).body)["proposal"].is_null());
}

TEST_F(Routes, AsksForANameAndAReason) {
  const Reply nameless =
      Post(Trial("/revisions"),
           {{"revision", 1}, {"why", "so"}, {"state", "slide"}});
  EXPECT_EQ(nameless.status, 400);
  EXPECT_EQ(Json::parse(nameless.body)["field"], "who");
  const Reply blank = Post(
      Trial("/revisions"),
      {{"revision", 1}, {"who", "Ada"}, {"why", "  "}, {"state", "slide"}});
  EXPECT_EQ(Json::parse(blank.body)["field"], "why");
  const Reply nothing =
      Post(Trial("/revisions"), {{"revision", 1}, {"who", "A"}, {"why", "b"}});
  EXPECT_EQ(nothing.status, 400);
  EXPECT_THAT(nothing.body, HasSubstr("nothing would change"));
}

TEST_F(Routes, RefusesCorrectionsThatCannotBe) {
  for (const Json& asked :
       {Json{{"ground_px", {1, 2, 3}}}, Json{{"ground_px", {1, 2, 1, 2}}},
        Json{{"contact_frame", 100000}}, Json{{"moved", {{"x", {1, 2}}}}},
        Json{{"moved", {{"3", {1, 2}}}}}, Json{{"left_out", {3}}},
        Json{{"state", "hop"}}, Json{{"ground_px", "line"}}}) {
    const Reply reply = Post(Trial("/preview"), asked);
    EXPECT_EQ(reply.status, 400) << asked << reply.body;
  }
}

TEST_F(Routes, LogsByHandWithTheTroubleOfAField) {
  Json asked = {{"campaign", "board"},
                {"who", "Ada"},
                {"state", "bounce"},
                {"angle_deg", "95"},
                {"angle_u_deg", "0.5"}};
  const Reply wrong = Post("/api/log", asked);
  EXPECT_EQ(wrong.status, 400);
  EXPECT_EQ(Json::parse(wrong.body)["field"], "angle-deg");
  asked["angle_deg"] = "3l";
  EXPECT_EQ(Json::parse(Post("/api/log", asked).body)["field"], "angle-deg");
  asked["angle_deg"] = "31.5";
  asked["conditions"] = {{"elevation_deg", "12.5"}, {"note", "a draught"}};
  EXPECT_EQ(Json::parse(Post("/api/log", asked).body)["field"],
            "elevation_deg");
  asked["conditions"]["elevation_deg"] = "12.5+-0.2";
  asked["conditions"]["temperature_c"] = "";
  const Reply right = Post("/api/log", asked);
  ASSERT_EQ(right.status, 200) << right.body;
  const Json logged = Json::parse(right.body);
  EXPECT_TRUE(logged["is_new"].get<bool>());
  const auto store = db::Store::Open(lab.store, db::OpenMode::kRead);
  const auto trial = store.Find(logged["id"].get<std::string>());
  ASSERT_TRUE(trial && trial->conditions);
  EXPECT_DOUBLE_EQ(trial->conditions->elevation_rad->value,
                   12.5 * core::kDegree);
  EXPECT_EQ(trial->conditions->note, "a draught");
  EXPECT_FALSE(trial->conditions->temperature_k);
}

TEST_F(Routes, BuildsAReportAndGivesItsFilesOnly) {
  EXPECT_EQ(Get("/report/table1.html").status, 404);
  ASSERT_EQ(Post("/api/report", Json::object()).status, 200);
  EXPECT_THAT(Get("/report/table1.html").body, HasSubstr("<html"));
  lab.folder.Write("report/secret.txt", "x");
  EXPECT_EQ(Get("/report/secret.txt").status, 404);
  EXPECT_EQ(Get("/report/../lab.db").status, 404);
}

TEST_F(Routes, GivesThePageAndNoOtherFile) {
  EXPECT_THAT(Get("/").body, HasSubstr("<!DOCTYPE html>"));
  EXPECT_EQ(Get("/page/app.js").type, "text/javascript; charset=utf-8");
  EXPECT_EQ(Get("/page/../routes.cc").status, 404);
  EXPECT_EQ(Get("/page/").status, 404);
}

TEST_F(Routes, ToldOfRubbishSaysSo) {
  Request request;
  request.method = "POST";
  request.path = "/api/log";
  request.body = "{";
  EXPECT_EQ(Route(desk, request).status, 400);
}

}  // namespace
}  // namespace touchdown::review
