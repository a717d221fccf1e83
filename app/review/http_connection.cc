#include "app/review/http_connection.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace touchdown::review {
namespace {

// Says whether a call that failed is to be tried again later: nothing has come,
// the buffer is full, or a signal came in between.
bool IsPassing(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

Connection::~Connection() { close(socket); }

Transfer ReadSome(Connection& connection, std::size_t most) {
  // A call takes one piece: one fast client does not keep the thread from the
  // others.
  std::array<char, std::size_t{16} << 10> piece;
  const ssize_t n = recv(connection.socket, piece.data(),
                         std::min(piece.size(), most), MSG_DONTWAIT);
  if (n > 0) {
    connection.in.append(piece.data(), static_cast<std::size_t>(n));
    return Transfer::kDone;
  }
  // 0 bytes mean that the client has closed its side.
  return n < 0 && IsPassing(errno) ? Transfer::kLater : Transfer::kClosed;
}

Transfer WriteSome(Connection& connection) {
  while (connection.written < connection.out.size()) {
    const ssize_t n =
        send(connection.socket, connection.out.data() + connection.written,
             connection.out.size() - connection.written,
             MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0) return IsPassing(errno) ? Transfer::kLater : Transfer::kClosed;
    connection.written += static_cast<std::size_t>(n);
  }
  return Transfer::kDone;
}

int ListenLocally(int port) {
  const int listener =
      socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (listener < 0) return -1;
  const int yes = 1;
  // The port can be taken again at once after the server ended. It is not
  // shared: SO_REUSEPORT is not set.
  setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<in_port_t>(port));
  // No other machine reaches 127.0.0.1.
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(listener, reinterpret_cast<const sockaddr*>(&address),
           sizeof address) != 0 ||
      listen(listener, SOMAXCONN) != 0) {
    close(listener);
    return -1;
  }
  return listener;
}

// It is asked for where the system chose the port.
int BoundPort(int socket) {
  sockaddr_in address = {};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace touchdown::review
