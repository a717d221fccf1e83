// One connection of the server: what it has sent, what it is to get, and until
// when.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "app/review/http.h"

namespace touchdown::review {

using HttpClock = std::chrono::steady_clock;

struct Connection {
  enum class Stage {
    kHead,       // waits for a head, or for the rest of one
    kBody,       // the head was admitted; its body is being read
    kAnswering,  // a thread answers it
    kWriting,    // the answer is being sent
    kDraining,   // the answer is sent; what still comes is thrown away
  };

  Connection(int its_socket, std::uint64_t its_number)
      : socket(its_socket), number(its_number) {}
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int socket;
  std::uint64_t number;
  Stage stage = Stage::kHead;
  std::string in = {};
  std::string out = {};
  std::size_t written = 0;
  Head head = {};
  bool was_admitted = false;
  bool closes = false;  // after this answer
  HttpClock::time_point since = HttpClock::now();
  HttpClock::time_point deadline = {};
};

enum class Transfer { kDone, kLater, kClosed };

// Appends what has come, at most `most` bytes. kDone: something came; kLater:
// nothing has; kClosed: nothing will.
Transfer ReadSome(Connection& connection, std::size_t most);

// Sends what the socket takes. kDone: all is sent; kLater: not yet.
Transfer WriteSome(Connection& connection);

// A socket that listens on `port` of 127.0.0.1 (0: any), and does not share
// it; -1 where it cannot be had.
int ListenLocally(int port);
int BoundPort(int socket);

}  // namespace touchdown::review
