#include "app/review/guard.h"

#include <gtest/gtest.h>

namespace touchdown::review {
namespace {

constexpr const char* kToken = "0123456789abcdef";

Request Ours() {
  Request request;
  request.host = "127.0.0.1:8080";
  request.cookie = "other=1; touchdown_8080=0123456789abcdef";
  return request;
}

int StatusOf(const Request& request) {
  const auto refused = Guard(kToken, 8080).Refuse(request);
  return refused ? refused->status : 200;
}

TEST(Guard, LetsOurOwnPageIn) {
  Request request = Ours();
  EXPECT_EQ(StatusOf(request), 200);
  request.host = "localhost:8080";
  EXPECT_EQ(StatusOf(request), 200);
  request.origin = "http://localhost:8080";
  request.fetch_site = "same-origin";
  request.method = "POST";
  request.content_type = "application/json";
  EXPECT_EQ(StatusOf(request), 200);
}

TEST(Guard, LetsAProgramInByItsHeader) {
  Request request = Ours();
  request.cookie.clear();
  request.token = kToken;
  request.method = "POST";
  request.content_type = "application/json; charset=utf-8";
  EXPECT_EQ(StatusOf(request), 200);
}

TEST(Guard, RefusesOtherNamesOfThisMachine) {
  for (const char* host : {"", "evil.example", "evil.example:8080", "127.0.0.1",
                           "127.0.0.1:80", "127.0.0.1:8080.x"}) {
    Request request = Ours();
    request.host = host;
    EXPECT_EQ(StatusOf(request), 403) << host;
  }
}

TEST(Guard, RefusesOtherPages) {
  for (const char* origin :
       {"null", "http://evil.example", "http://127.0.0.1:9090",
        "https://127.0.0.1:8080", "http://localhost:8080"}) {
    Request request = Ours();
    request.origin = origin;
    EXPECT_EQ(StatusOf(request), 403) << origin;
  }
  for (const char* site : {"cross-site", "same-site"}) {
    Request request = Ours();
    request.path = "/api/trials";
    request.fetch_site = site;
    EXPECT_EQ(StatusOf(request), 403) << site;
  }
}

TEST(Guard, RefusesAnybodyWithoutTheKey) {
  for (const char* cookie :
       {"", "touchdown_8080=", "touchdown_8080=0123456789abcdeX",
        "touchdown_8081=0123456789abcdef", "xtouchdown_8080=0123456789abcdef",
        "touchdown_8080=0123456789abcdef0"}) {
    Request request = Ours();
    request.cookie = cookie;
    EXPECT_EQ(StatusOf(request), 403) << cookie;
  }
}

TEST(Guard, AsksWhoOpensThePageForTheKeyAndNobodyElse) {
  Request request = Ours();
  request.cookie.clear();
  const Guard guard(kToken, 8080);
  auto reply = guard.Refuse(request);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 403);
  EXPECT_EQ(reply->type, "text/html; charset=utf-8");
  EXPECT_NE(reply->body.find("name=\"token\""), std::string::npos);
  EXPECT_EQ(reply->body.find(kToken), std::string::npos);
  // No script, and a form that leads nowhere else.
  EXPECT_EQ(reply->headers.at(0).second,
            "default-src 'none'; base-uri 'none'; form-action 'self'; "
            "frame-ancestors 'none'");
  request.path = "/api/trials";
  EXPECT_EQ(guard.Refuse(request)->type, "application/json");
}

TEST(Guard, RefusesChangesThatAFormCouldSend) {
  Request request = Ours();
  request.method = "POST";
  request.origin = "http://127.0.0.1:8080";
  request.content_type = "application/x-www-form-urlencoded";
  EXPECT_EQ(StatusOf(request), 415);
  request.content_type = "application/json";
  request.origin.clear();  // a cookie alone does not say who sends it
  EXPECT_EQ(StatusOf(request), 403);
}

TEST(Guard, HandsTheKeyOverOnce) {
  const Guard guard(kToken, 8080);
  EXPECT_EQ(guard.Address(), "http://127.0.0.1:8080/?token=0123456789abcdef");
  Request request;
  request.host = "127.0.0.1:8080";
  request.query["token"] = kToken;
  const auto welcome = guard.Welcome(request);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->status, 200);
  EXPECT_EQ(welcome->body.find(kToken), std::string::npos);
  std::string cookie;
  for (const auto& [name, value] : welcome->headers) {
    if (name == "Set-Cookie") cookie = value;
  }
  EXPECT_EQ(cookie,
            "touchdown_8080=0123456789abcdef; Path=/; HttpOnly; "
            "SameSite=Strict");
  request.query["token"] = "wrong";
  EXPECT_EQ(guard.Welcome(request)->status, 403);
  // As a person may paste it.
  for (const std::string& pasted :
       {guard.Address(), "  " + std::string(kToken) + " "}) {
    request.query["token"] = pasted;
    EXPECT_EQ(guard.Welcome(request)->status, 200) << pasted;
  }
  request.query.clear();
  EXPECT_FALSE(guard.Welcome(request));
  request.query["token"] = kToken;
  request.host = "evil.example:8080";
  EXPECT_FALSE(guard.Welcome(request));
}

}  // namespace
}  // namespace touchdown::review
