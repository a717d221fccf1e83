#include "app/review/server.h"

#include <fmt/format.h>
#include <httplib.h>

#include "app/review/desk.h"
#include "app/review/guard.h"
#include "app/review/routes.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/store.h"

namespace touchdown::review {
namespace {

// A browser holds up to 6 connections to one server open, each of which keeps a
// thread while it is idle; so four browsers at once.
constexpr std::size_t kThreads = 24;
// An idle connection is given up after this, s: the page asks for changes more
// often.
constexpr time_t kIdle_s = 5;
// A trial's correction is a few kB; a nudge of every frame of a long clip less
// than 1 MB.
constexpr std::size_t kMostBytes = std::size_t{4} << 20;

Request RequestOf(const httplib::Request& from) {
  Request request;
  request.method = from.method;
  request.path = from.path;
  for (const auto& [name, value] : from.params) request.query[name] = value;
  request.body = from.body;
  request.host = from.get_header_value("Host");
  request.origin = from.get_header_value("Origin");
  request.fetch_site = from.get_header_value("Sec-Fetch-Site");
  request.cookie = from.get_header_value("Cookie");
  request.token = from.get_header_value("X-Touchdown-Token");
  request.content_type = from.get_header_value("Content-Type");
  request.if_none_match = from.get_header_value("If-None-Match");
  return request;
}

void Send(const Reply& reply, httplib::Response& response) {
  response.status = reply.status;
  for (const auto& [name, value] : reply.headers) {
    response.set_header(name, value);
  }
  // What an answer says of itself stands; the rest is the same for all.
  for (const auto& [name, value] : SafeHeaders()) {
    if (!response.has_header(name)) response.set_header(name, value);
  }
  if (!response.has_header("Cache-Control")) {
    response.set_header("Cache-Control", "no-store");
  }
  response.set_content(reply.body, reply.type);
}

}  // namespace

struct Server::Impl {
  explicit Impl(const ServerOptions& options)
      : desk(options.store, options.reports, options.reach_of) {}

  void Answer(const httplib::Request& from, httplib::Response& response) {
    const Request request = RequestOf(from);
    if (const auto welcome = guard->Welcome(request)) {
      Send(*welcome, response);
    } else if (const auto refused = guard->Refuse(request)) {
      Send(*refused, response);
    } else {
      Send(Route(desk, request), response);
    }
  }

  Desk desk;
  httplib::Server http;
  int port = 0;
  std::optional<Guard> guard;
};

Server::Server(const ServerOptions& options)
    : impl_(std::make_unique<Impl>(options)) {
  db::Store::Open(options.store, db::OpenMode::kWrite);
  httplib::Server& http = impl_->http;
  // The library would share the port with whoever else asks for it.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  constexpr const char* kHost = "127.0.0.1";
  if (options.port == 0) {
    impl_->port = http.bind_to_any_port(kHost);
  } else if (http.bind_to_port(kHost, options.port)) {
    impl_->port = options.port;
  }
  if (impl_->port <= 0) {
    throw core::InputError(
        fmt::format("port {} of {} cannot be had; another program has it: give "
                    "another --port, or none",
                    options.port, kHost));
  }
  const db::Sources random = db::SystemSources();
  impl_->guard.emplace(random.new_uuid(), impl_->port);
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_keep_alive_timeout(kIdle_s);
  http.set_keep_alive_max_count(10'000);
  http.set_payload_max_length(kMostBytes);
  http.set_tcp_nodelay(true);
  const auto answer = [this](const httplib::Request& request,
                             httplib::Response& response) {
    impl_->Answer(request, response);
  };
  http.Get(".*", answer);
  http.Post(".*", answer);
}

Server::~Server() { Stop(); }

int Server::port() const { return impl_->port; }
std::string Server::address() const { return impl_->guard->Address(); }
void Server::Run() { impl_->http.listen_after_bind(); }
void Server::Stop() { impl_->http.stop(); }

}  // namespace touchdown::review
