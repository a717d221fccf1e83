// A connection to a port of this machine, byte by byte.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace touchdown::testing {

class LocalSocket {
 public:
  explicit LocalSocket(int port)
      : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<in_port_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address),
                sizeof address) != 0) {
      ADD_FAILURE() << "no connection to port " << port;
    }
  }
  ~LocalSocket() { close(socket_); }
  LocalSocket(const LocalSocket&) = delete;
  LocalSocket& operator=(const LocalSocket&) = delete;

  // Whether all of it was taken.
  bool Send(const std::string& bytes) const {
    return send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  // All that comes until the other side closes.
  std::string All() const {
    std::string all;
    std::array<char, 4096> piece{};
    for (;;) {
      const ssize_t n = recv(socket_, piece.data(), piece.size(), 0);
      if (n <= 0) return all;
      all.append(piece.data(), static_cast<std::size_t>(n));
    }
  }

 private:
  int socket_;
};

// The whole answer to one request, head and body; empty where none came.
// `fields` end with a line feed each.
inline std::string AskLocal(int port, const std::string& method,
                            const std::string& target,
                            const std::string& fields,
                            const std::string& body = "") {
  const LocalSocket socket(port);
  socket.Send(method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" +
              std::to_string(port) + "\r\nConnection: close\r\n" + fields +
              (body.empty() ? ""
                            : "Content-Length: " + std::to_string(body.size()) +
                                  "\r\n") +
              "\r\n" + body);
  return socket.All();
}

}  // namespace touchdown::testing
