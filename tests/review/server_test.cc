// The server over a socket: it answers this machine alone, and with the guard's
// header fields.
#include "app/review/server.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "tests/review/client.h"
#include "tests/review/lab.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

struct Running {
  explicit Running(const ServerOptions& options) : server(options) {
    thread = std::thread([this] { server.Run(); });
    const std::string address = server.address();
    token = address.substr(address.find("token=") + 6);
  }
  ~Running() {
    server.Stop();
    thread.join();
  }

  Server server;
  std::string token;
  std::thread thread;
};

TEST(Server, AnswersWithTheKeyOnly) {
  const Lab lab;
  Running running({lab.store, {}, lab.folder / "report"});
  httplib::Client client("127.0.0.1", running.server.port());
  const auto none = client.Get("/api/trials");
  ASSERT_TRUE(none);
  EXPECT_EQ(none->status, 403);
  EXPECT_NE(none->get_header_value("Content-Security-Policy"), "");
  const auto entered = client.Get("/?token=" + running.token);
  ASSERT_TRUE(entered);
  EXPECT_EQ(entered->status, 200);
  const std::string cookie = entered->get_header_value("Set-Cookie");
  const auto page =
      client.Get("/", {{"Cookie", cookie.substr(0, cookie.find(';'))}});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  const auto list =
      client.Get("/api/trials", {{"X-Touchdown-Token", running.token}});
  ASSERT_TRUE(list);
  EXPECT_EQ(nlohmann::json::parse(list->body)["trials"].size(), 1u);
}

TEST(Server, ListensWhereItDidBeforeAndElsewhereWhileThatIsTaken) {
  const Lab lab;
  const ServerOptions options{lab.store, {}, lab.folder / "report"};
  int port = 0;
  std::string token;
  {
    const Running first(options);
    port = first.server.port();
    token = first.token;
    const Running second(options);
    EXPECT_NE(second.server.port(), port);
  }
  const Running again(options);
  EXPECT_EQ(again.server.port(), port);
  EXPECT_NE(again.token, token);
}

TEST(Server, IsNotThereForOtherMachines) {
  const Lab lab;
  Running running({lab.store, {}, lab.folder / "report"});
  // Another address of this machine's loopback.
  httplib::Client client("127.0.0.2", running.server.port());
  client.set_connection_timeout(1);
  EXPECT_FALSE(client.Get("/"));
}

TEST(Server, GivesEachSessionAKeyOfItsOwn) {
  const Lab lab;
  Running one({lab.store, {}, lab.folder / "report"});
  Running two({lab.store, {}, lab.folder / "report"});
  EXPECT_NE(one.token, two.token);
  EXPECT_NE(one.server.port(), two.server.port());
  EXPECT_GE(one.token.size(), 32u);
  ServerOptions taken{lab.store, {}, {}};
  taken.http.port = one.server.port();
  EXPECT_THROW(Server{taken}, core::InputError);
}

TEST(Server, NeedsAStoreOrAPlaceForOne) {
  const testing::TemporaryFolder folder;
  EXPECT_NO_THROW(Server({folder / "none.db", {}, {}}));
  EXPECT_FALSE(std::filesystem::exists(folder / "none.db"));
  EXPECT_THROW(Server({folder / "no folder/none.db", {}, {}}),
               core::StoreError);
  folder.Write("notes.txt", "not a store");
  EXPECT_THROW(Server({folder / "notes.txt", {}, {}}), core::StoreError);
}

}  // namespace
}  // namespace touchdown::review
