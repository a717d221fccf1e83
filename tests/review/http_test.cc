#include "app/review/http.h"

#include <gtest/gtest.h>

#include <string>

namespace touchdown::review {
namespace {

int StatusOf(const std::string& bytes) {
  const auto head = ReadHead(bytes);
  return head ? 200 : head.error().status;
}

std::string With(const std::string& fields) {
  return "POST /api/log HTTP/1.1\r\nHost: here\r\n" + fields + "\r\n";
}

TEST(HeadLength, IsThereWithTheEmptyLine) {
  EXPECT_FALSE(HeadLength("GET / HTTP/1.1\r\nHost: here\r\n"));
  EXPECT_EQ(HeadLength("GET / HTTP/1.1\r\n\r\nbody"), 18u);
}

TEST(ReadHead, FindsWhatTheAnswerDependsOn) {
  const auto head = ReadHead(
      "POST /api/trials/a%20b?revision=2&note=a+b%2Bc HTTP/1.1\r\n"
      "host:127.0.0.1:80\r\nCookie: a=1; b=2\r\nX-TOUCHDOWN-TOKEN:  key \r\n"
      "Content-Type: application/json\r\nContent-Length: 12\r\n"
      "Expect: 100-continue\r\nConnection: close\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->request.method, "POST");
  EXPECT_EQ(head->request.path, "/api/trials/a b");
  EXPECT_EQ(head->request.query.at("revision"), "2");
  EXPECT_EQ(head->request.query.at("note"), "a b+c");
  EXPECT_EQ(head->request.host, "127.0.0.1:80");
  EXPECT_EQ(head->request.cookie, "a=1; b=2");
  EXPECT_EQ(head->request.token, "key");
  EXPECT_EQ(head->request.content_type, "application/json");
  EXPECT_EQ(head->body_bytes, 12u);
  EXPECT_TRUE(head->awaits_continue);
  EXPECT_FALSE(head->keeps_alive);
}

TEST(ReadHead, KeepsAConnectionOfHttp11) {
  EXPECT_TRUE(ReadHead("GET / HTTP/1.1\r\n\r\n")->keeps_alive);
  EXPECT_FALSE(ReadHead("GET / HTTP/1.0\r\n\r\n")->keeps_alive);
}

TEST(ReadHead, RefusesWhatItIsNotSureOf) {
  EXPECT_EQ(StatusOf("\r\n\r\n"), 400);
  EXPECT_EQ(StatusOf("GET /\r\n\r\n"), 400);
  EXPECT_EQ(StatusOf("GET / HTTP/2\r\n\r\n"), 400);
  EXPECT_EQ(StatusOf("GET http://other/ HTTP/1.1\r\n\r\n"), 400);
  EXPECT_EQ(StatusOf("PUT / HTTP/1.1\r\n\r\n"), 501);
  EXPECT_EQ(StatusOf(With("no colon\r\n")), 400);
  EXPECT_EQ(StatusOf(With("a name: 1\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Host: there\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Content-Length: -1\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Content-Length: 1x\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Content-Length: 99999999999999999999\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Content-Length: 1\r\nContent-Length: 2\r\n")), 400);
  EXPECT_EQ(StatusOf(With("Transfer-Encoding: chunked\r\n")), 411);
  EXPECT_EQ(StatusOf(With("Content-Encoding: gzip\r\n")), 415);
  EXPECT_EQ(StatusOf(With("Content-Length: 1\r\n")), 200);
}

TEST(ReadHead, BoundsTheNumberOfFields) {
  std::string fields;
  for (int i = 0; i < 60; ++i) fields += "A: 1\r\n";
  EXPECT_EQ(StatusOf(With(fields)), 200);
  for (int i = 0; i < 10; ++i) fields += "A: 1\r\n";
  EXPECT_EQ(StatusOf(With(fields)), 431);
}

TEST(Decoded, LeavesWhatIsNoCode) {
  EXPECT_EQ(Decoded("a%4", false), "a%4");
  EXPECT_EQ(Decoded("%", false), "%");
  EXPECT_EQ(Decoded("%zz%41", false), "%zzA");
  EXPECT_EQ(Decoded("a+b", false), "a+b");
  EXPECT_EQ(Decoded("a+b", true), "a b");
}

TEST(WriteReply, SaysItsLengthAndWhatIsForbidden) {
  Reply reply;
  reply.body = "{}";
  reply.headers = {{"Cache-Control", "private"}};
  const std::string bytes = WriteReply(reply, {});
  EXPECT_TRUE(bytes.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(bytes.ends_with("\r\n\r\n{}"));
  EXPECT_NE(bytes.find("Content-Length: 2\r\n"), std::string::npos);
  EXPECT_NE(bytes.find("Cache-Control: private\r\n"), std::string::npos);
  EXPECT_EQ(bytes.find("no-store"), std::string::npos);
  EXPECT_NE(bytes.find("Content-Security-Policy: "), std::string::npos);
  const std::string head = WriteReply(reply, {false, false});
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
  EXPECT_NE(head.find("Connection: close\r\n"), std::string::npos);
}

}  // namespace
}  // namespace touchdown::review
