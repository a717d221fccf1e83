#include "app/review/server.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <string>

#include "app/pipeline/journal.h"
#include "app/review/desk.h"
#include "app/review/guard.h"
#include "app/review/http_server.h"
#include "app/review/routes.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/store.h"

namespace touchdown::review {
struct Server::Impl {
  explicit Impl(const ServerOptions& options)
      : desk(options.store, options.reports, options.reach_of),
        http(options.http,
             {[this](const Request& request) { return Admit(request); },
              [this](const Request& request) { return Answer(request); }}),
        guard(db::SystemSources().new_uuid(), http.port()) {}

  std::optional<Reply> Admit(const Request& request) const {
    if (auto welcome = guard.Welcome(request)) return welcome;
    return guard.Refuse(request);
  }

  Reply Answer(const Request& request) {
    const auto begun = std::chrono::steady_clock::now();
    Reply reply = Route(desk, request);
    if (pipeline::JournalIsKept()) {
      // Without the query: it may hold the key.
      pipeline::Journal(fmt::format(
          "{} {}: {}, {} bytes, {:.3f} s", request.method, request.path,
          reply.status, reply.body.size(),
          std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                        begun)
              .count()));
    }
    return reply;
  }

  Desk desk;
  HttpServer http;
  Guard guard;
};

Server::Server(const ServerOptions& options) {
  db::Store::Open(options.store, db::OpenMode::kWrite);
  impl_ = std::make_unique<Impl>(options);
}

Server::~Server() = default;

int Server::port() const { return impl_->http.port(); }
std::string Server::address() const { return impl_->guard.Address(); }
void Server::Run() { impl_->http.Run(); }
void Server::Stop() { impl_->http.Stop(); }

}  // namespace touchdown::review
