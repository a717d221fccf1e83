#include "footage/apart/socket_pair.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Bytes of one message. A datagram holds all that one side says at a time:
// texts (messages.cc) and one answer about entries are smaller. A longer
// message would be cut, and refused as not understood.
constexpr std::size_t kMaxMessageBytes = std::size_t{32} << 10;

// Room for one descriptor beside the bytes, aligned as the kernel asks for.
union Control {
  cmsghdr header;
  std::array<char, CMSG_SPACE(sizeof(int))> space;
};

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

// SOCK_SEQPACKET keeps messages apart and tells when the other end is gone.
std::pair<Descriptor, Descriptor> MakeSocketPair() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw core::InputError(std::string("no line to a reader: ") +
                           std::strerror(errno));
  }
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

bool SendMessage(int socket, const std::string& bytes, int descriptor) {
  iovec part = {const_cast<char*>(bytes.data()), bytes.size()};
  msghdr message = {};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  Control control = {};
  if (descriptor >= 0) {
    message.msg_control = &control;
    message.msg_controllen = sizeof control;
    cmsghdr* const header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
  }
  for (;;) {
    // No SIGPIPE: a reader that has died must not end the program.
    if (sendmsg(socket, &message, MSG_NOSIGNAL) >= 0) return true;
    if (errno != EINTR) return false;
  }
}

Received ReceiveMessage(int socket) {
  std::array<char, kMaxMessageBytes> buffer;
  iovec part = {buffer.data(), buffer.size()};
  Control control = {};
  msghdr message = {};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  const ssize_t n = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  Received received;
  if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
    received.what = Received::What::kNothingYet;
    return received;
  }
  for (cmsghdr* header = n >= 0 ? CMSG_FIRSTHDR(&message) : nullptr;
       header != nullptr; header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS ||
        header->cmsg_len != CMSG_LEN(sizeof(int))) {
      continue;
    }
    int descriptor = -1;
    std::memcpy(&descriptor, CMSG_DATA(header), sizeof descriptor);
    received.descriptor = Descriptor(descriptor);
  }
  // 0: the other end is closed.
  if (n <= 0) return received;
  received.what = Received::What::kMessage;
  received.bytes.assign(buffer.data(), static_cast<std::size_t>(n));
  return received;
}

// A receive that waits for longer returns with "nothing yet".
void SetPatience(int socket, std::chrono::milliseconds patience) {
  const auto count = patience.count();
  const timeval time = {static_cast<time_t>(count / 1000),
                        static_cast<suseconds_t>(count % 1000 * 1000)};
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
}

}  // namespace touchdown::vision
