// HTTP/1.1 on a port of 127.0.0.1. One thread has all connections and waits for
// none of them; a request is handed to a thread of its own when it is whole. So
// a client that is slow, or many that are, keep nobody else waiting.
//
// What may be sent before a request is admitted is its head, within
// `most_head_bytes`: a body is read only of a request that `admit` let pass.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "app/review/message.h"

namespace touchdown::review {

struct HttpOptions {
  int port = 0;  // 0: any that is free
  // Requests answered at a time; further ones wait their turn. An analysis or
  // a report takes one for seconds; four browsers ask for six things at once.
  std::size_t threads = 24;
  // Connections held at a time, also bounded by half of the process's open
  // files. At the limit a new one takes the place of the one that has said
  // nothing whole for longest.
  std::size_t most_connections = 512;
  // A browser's head is 1 kB; its cookies of other ports add to it.
  std::size_t most_head_bytes = std::size_t{16} << 10;
  // A trial's correction is a few kB; a nudge of every frame of a long clip
  // less than 1 MB.
  std::size_t most_body_bytes = std::size_t{4} << 20;
  // Bodies held at a time, of all admitted requests.
  std::size_t most_bodies_bytes = std::size_t{64} << 20;
  // From a connection's first byte to the end of the request's head, and from
  // there to the end of its body.
  std::chrono::milliseconds head_time{10'000};
  std::chrono::milliseconds body_time{30'000};
  // An answer of which nothing more was taken for so long is given up.
  std::chrono::milliseconds write_time{30'000};
  // An idle connection is closed; the page asks every two seconds.
  std::chrono::milliseconds idle_time{30'000};
};

// Both are called from several threads or from the one that has the
// connections, and must not throw.
struct HttpAnswers {
  // Sees a request without its body: an answer refuses it, or is all that it
  // needs; nothing lets it pass.
  std::function<std::optional<Reply>(const Request&)> admit;
  std::function<Reply(const Request&)> answer;
};

class HttpServer {
 public:
  // Takes the port; throws core::InputError where it cannot be had.
  HttpServer(const HttpOptions& options, HttpAnswers answers);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;

  // Answers until Stop(), which may be called at any time from any thread, and
  // then waits for the requests that are being answered.
  void Run();
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchdown::review
