// What clients may do to a server that they have no key for.
#include "app/review/http_server.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/review/guard.h"
#include "tests/review/client.h"
#include "tests/support/local_socket.h"
#include "tests/support/process_memory.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

using Socket = testing::LocalSocket;

constexpr const char* kKey = "key";

// Echoes the body of who has the key.
struct Running {
  explicit Running(HttpOptions options = {})
      : server(options, {[](const Request& request) -> std::optional<Reply> {
                           if (request.token == kKey) return std::nullopt;
                           return Refusal(403, "no key");
                         },
                         [](const Request& request) {
                           Reply reply;
                           reply.type = "text/plain";
                           reply.body = request.body;
                           return reply;
                         }}),
        thread([this] { server.Run(); }) {}
  ~Running() {
    server.Stop();
    thread.join();
  }

  HttpServer server;
  std::thread thread;
};

// How long a client with the key waits for its answer, s; nothing where none
// came.
std::optional<double> Wait_s(int port) {
  httplib::Client client("127.0.0.1", port);
  const auto begun = std::chrono::steady_clock::now();
  const auto answer = client.Get("/", {{"X-Touchdown-Token", kKey}});
  if (!answer || answer->status != 200) return std::nullopt;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun)
      .count();
}

TEST(HttpServer, AnswersWithTheBodyThatItGot) {
  Running running;
  httplib::Client client("127.0.0.1", running.server.port());
  client.set_keep_alive(true);
  const httplib::Headers key = {{"X-Touchdown-Token", kKey}};
  for (const std::size_t size : {0, 1, 20'000, 3'000'000}) {
    const std::string body(size, 'x');
    const auto answer = client.Post("/", key, body, "text/plain");
    ASSERT_TRUE(answer) << size;
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, body);
  }
  const auto head = client.Head("/", key);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->body, "");
}

TEST(HttpServer, TakesRequestsInOnePiece) {
  Running running;
  const Socket socket(running.server.port());
  const std::string fields = "X-Touchdown-Token: key\r\n";
  EXPECT_TRUE(socket.Send("POST / HTTP/1.1\r\nContent-Length: 3\r\n" + fields +
                          "\r\nonePOST / HTTP/1.1\r\nContent-Length: 3\r\n" +
                          "Connection: close\r\n" + fields + "\r\ntwo"));
  const std::string all = socket.All();
  EXPECT_NE(all.find("\r\n\r\none"), std::string::npos);
  EXPECT_TRUE(all.ends_with("\r\n\r\ntwo"));
}

TEST(HttpServer, AsksForABodyThatAwaitsIt) {
  Running running;
  const Socket socket(running.server.port());
  EXPECT_TRUE(
      socket.Send("POST / HTTP/1.1\r\nX-Touchdown-Token: key\r\nContent-Length:"
                  " 4\r\nExpect: 100-continue\r\nConnection: close\r\n\r\n"));
  EXPECT_TRUE(socket.Send("body"));
  const std::string all = socket.All();
  EXPECT_TRUE(all.ends_with("\r\n\r\nbody")) << all;
}

// 200 connections that never end their head, and 50 that never send the body
// that they promised.
TEST(HttpServer, KeepsNobodyWaitingForSlowConnections) {
  Running running;
  const int port = running.server.port();
  std::vector<std::unique_ptr<Socket>> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(std::make_unique<Socket>(port));
    EXPECT_TRUE(slow.back()->Send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nA: "));
  }
  for (int i = 0; i < 50; ++i) {
    slow.push_back(std::make_unique<Socket>(port));
    EXPECT_TRUE(slow.back()->Send(
        "POST / HTTP/1.1\r\nX-Touchdown-Token: key\r\nContent-Length: 9\r\n\r\n"
        "begun"));
  }
  for (int i = 0; i < 5; ++i) {
    const auto wait_s = Wait_s(port);
    ASSERT_TRUE(wait_s);
    EXPECT_LT(*wait_s, 1.0);
  }
}

TEST(HttpServer, GivesThePlaceOfTheSlowestToANewOne) {
  HttpOptions options;
  options.most_connections = 8;
  Running running(options);
  std::vector<std::unique_ptr<Socket>> slow;
  for (int i = 0; i < 50; ++i) {
    slow.push_back(std::make_unique<Socket>(running.server.port()));
    slow.back()->Send("GET / HTTP/1.1\r\n");
  }
  EXPECT_TRUE(Wait_s(running.server.port()));
  EXPECT_EQ(slow.front()->All(), "");  // it was closed
}

TEST(HttpServer, ClosesWhatIsLateWithItsHead) {
  HttpOptions options;
  options.head_time = std::chrono::milliseconds(1);
  options.idle_time = std::chrono::milliseconds(1);
  Running running(options);
  const Socket socket(running.server.port());
  socket.Send("GET / HTTP/1.1\r\n");
  EXPECT_EQ(socket.All(), "");
}

// What is sent without the key, and how much of it: it is refused by its head,
// and nothing of 1 GB is kept.
TEST(HttpServer, KeepsNothingOfLargeBodies) {
  // The sanitizer keeps memory that was given back, to see who uses it still.
#ifdef __SANITIZE_ADDRESS__
  constexpr double kQuarantine_MB = 256.0;
#else
  constexpr double kQuarantine_MB = 0.0;
#endif
  Running running;
  const int port = running.server.port();
  const std::string piece(std::size_t{1} << 20, 'x');
  ASSERT_TRUE(Wait_s(port));
  const double before_MB = testing::Memory_MB(getpid(), "VmRSS");
  const struct {
    const char* fields;
    const char* status;
  } cases[] = {
      {"Content-Length: 1073741824\r\n", "403"},
      {"Transfer-Encoding: chunked\r\n", "411"},
      {"Content-Encoding: gzip\r\nContent-Length: 1073741824\r\n", "415"},
      {"X-Touchdown-Token: key\r\nContent-Length: 1073741824\r\n", "413"},
      {"X-Touchdown-Token: key\r\nTransfer-Encoding: chunked\r\n", "411"}};
  for (const auto& [fields, status] : cases) {
    const Socket socket(port);
    ASSERT_TRUE(
        socket.Send("POST / HTTP/1.1\r\n" + std::string(fields) + "\r\n"));
    int sent_MB = 0;
    // A client that reads nothing goes on until the server closes.
    while (sent_MB < 1024 && socket.Send(piece)) ++sent_MB;
    EXPECT_LT(testing::Memory_MB(getpid(), "VmRSS") - before_MB,
              100.0 + kQuarantine_MB)
        << fields;
    EXPECT_TRUE(Wait_s(port)) << fields;
    // The answer itself, of a client that sends nothing more.
    const Socket polite(port);
    ASSERT_TRUE(
        polite.Send("POST / HTTP/1.1\r\n" + std::string(fields) + "\r\n"));
    EXPECT_TRUE(polite.All().starts_with("HTTP/1.1 " + std::string(status)));
  }
}

TEST(HttpServer, BoundsHeads) {
  Running running;
  const Socket socket(running.server.port());
  const std::string line = "A: " + std::string(1000, 'x') + "\r\n";
  socket.Send("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 1000 && socket.Send(line); ++i) {
  }
  EXPECT_TRUE(Wait_s(running.server.port()));
  const Socket polite(running.server.port());
  EXPECT_TRUE(polite.Send("GET / HTTP/1.1\r\n" + std::string(16'400, 'x')));
  EXPECT_TRUE(polite.All().starts_with("HTTP/1.1 431"));
}

TEST(HttpServer, EndsThoughItHasNotBegun) {
  HttpServer server({}, {});
  server.Stop();
  server.Run();
}

TEST(HttpServer, DoesNotShareItsPort) {
  Running running;
  HttpOptions options;
  options.port = running.server.port();
  EXPECT_THROW(HttpServer(options, {}), core::InputError);
}

}  // namespace
}  // namespace touchdown::review
