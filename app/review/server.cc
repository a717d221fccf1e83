#include "app/review/server.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/measure/journal.h"
#include "app/review/desk.h"
#include "app/review/guard.h"
#include "app/review/http_server.h"
#include "app/review/routes.h"
#include "app/text/text.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/store.h"

namespace touchdown::review {
namespace {

// Above the ports that the system gives to programs that ask for any.
constexpr int kFirstOwnPort = 61000;
constexpr int kOwnPorts = 65536 - kFirstOwnPort;

// The same for a store at every start: by a digest of its path.
int OwnPort(const std::filesystem::path& store) {
  const std::uint64_t digest =
      report::Digest(std::filesystem::weakly_canonical(store).string());
  return kFirstOwnPort + static_cast<int>(digest % kOwnPorts);
}

// A store, or a folder in which one can be made.
void RequireStoreOrPlace(const std::filesystem::path& store) {
  std::error_code none;
  if (std::filesystem::exists(store, none) &&
      (!std::filesystem::is_regular_file(store, none) ||
       std::filesystem::file_size(store, none) > 0)) {
    // It is opened for writing, so that a store that cannot be corrected is
    // refused at the start and not after a person's work.
    db::Store::Open(store, db::OpenMode::kWrite);
    return;
  }
  const auto folder = std::filesystem::absolute(store).parent_path();
  if (!std::filesystem::is_directory(folder, none)) {
    throw core::StoreError(
        fmt::format("{}: its folder {} does not exist; make it first",
                    store.string(), folder.string()));
  }
}

}  // namespace

// The order of the members matters: the guard needs the port that `http` took,
// and `http` ends before the desk that it answers from.
struct Server::Impl {
  explicit Impl(const ServerOptions& options)
      : desk(options.store, options.reports, options.reach_of,
             RecordingFolders(options.recordings)),
        http(options.http,
             {[this](const Request& request) { return Admit(request); },
              [this](const Request& request) { return Answer(request); }}),
        guard(db::SystemSources().new_uuid(), http.port()) {}

  // Sees heads only, on the thread that has the connections: it must be quick.
  std::optional<Reply> Admit(const Request& request) const {
    if (auto welcome = guard.Welcome(request)) return welcome;
    return guard.Refuse(request);
  }

  // Answers a request that was admitted, on a thread of its own.
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
  RequireStoreOrPlace(options.store);
  // The store's own port is tried first: open tabs of an earlier run find the
  // server again, and drafts, which the browser keeps by port, are found too.
  if (options.http.port == 0) {
    try {
      ServerOptions own = options;
      own.http.port = OwnPort(options.store);
      impl_ = std::make_unique<Impl>(own);
      return;
    } catch (const core::InputError&) {
      // Another program has it.
    }
  }
  impl_ = std::make_unique<Impl>(options);
}

Server::~Server() = default;

int Server::port() const { return impl_->http.port(); }
std::string Server::address() const { return impl_->guard.Address(); }
void Server::Run() { impl_->http.Run(); }
void Server::Stop() { impl_->http.Stop(); }

}  // namespace touchdown::review
