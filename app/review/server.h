// The review page's server: HTTP on 127.0.0.1.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/report/report.h"
#include "app/review/http_server.h"

namespace touchdown::review {

struct ServerOptions {
  std::filesystem::path store;
  // The port, and what clients may do. Port 0: one that is the store's own,
  // where it is free, so that the tabs of an earlier session find the server
  // again; else any.
  HttpOptions http = {};
  // Where reports go that the page builds.
  std::filesystem::path reports;
  // What the next angle stays within; empty: no rig was given, any angle.
  report::ReachOf reach_of = {};
  // Folders that recordings are chosen from.
  std::vector<std::filesystem::path> recordings = {};
};

class Server {
 public:
  // Opens the store once to see that it can be, and takes the port. Throws
  // core::StoreError, or core::InputError where the port is taken.
  explicit Server(const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  // What a person opens; holds the key of this session.
  std::string address() const;

  // Answers until Stop(), which may be called at any time from any thread.
  void Run();
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchdown::review
