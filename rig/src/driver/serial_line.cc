#include "touchdown/rig/driver/serial_line.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/rig/driver/line_protocol.h"

namespace touchdown::rig {
namespace {

speed_t BaudCode(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    default:
      throw std::invalid_argument(fmt::format(
          "baud is {}, must be 9600, 19200, 38400, 57600 or 115200", baud));
  }
}

[[noreturn]] void Fail(const std::string& port, const std::string& what) {
  throw core::InputError(fmt::format("{}: {}", port, what));
}

[[noreturn]] void Gone(const std::string& port) {
  Fail(port,
       "the rig's controller is gone; look at its cable and power, and keep "
       "clear of the springs: they may be latched");
}

// Raw bytes, whole at once or not at all.
void SetUp(int fd, const std::string& port, speed_t speed) {
  termios line{};
  if (tcgetattr(fd, &line) != 0) {
    Fail(port, "this is no serial port; give one like /dev/ttyUSB0");
  }
  cfmakeraw(&line);
  line.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD);
  // The line's DTR falls when the last program closes it, however that ends: a
  // controller takes that for an emergency stop.
  line.c_cflag |= static_cast<tcflag_t>(HUPCL);
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  line.c_cc[VMIN] = 1;  // no bytes is then not an end of file
  line.c_cc[VTIME] = 0;
  cfsetispeed(&line, speed);
  cfsetospeed(&line, speed);
  if (tcsetattr(fd, TCSANOW, &line) != 0) {
    Fail(port, std::string("cannot be set up: ") + std::strerror(errno));
  }
  tcflush(fd, TCIOFLUSH);
}

}  // namespace

SerialTime SerialTime::Real() {
  SerialTime time;
  time.now = [] { return std::chrono::steady_clock::now(); };
  time.wait = [](int port, int wake, std::chrono::milliseconds longest) {
    std::array<pollfd, 2> ends{pollfd{port, POLLIN, 0},
                               pollfd{wake, POLLIN, 0}};
    poll(ends.data(), ends.size(), static_cast<int>(longest.count()));
  };
  return time;
}

SerialLine::SerialLine(const std::string& port, int baud, SerialTime time)
    : port_(port), time_(std::move(time)) {
  const speed_t speed = BaudCode(baud);
  port_fd_ = open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (port_fd_ < 0) {
    Fail(port_, fmt::format("cannot be opened: {}", std::strerror(errno)));
  }
  try {
    if (flock(port_fd_, LOCK_EX | LOCK_NB) != 0) {
      Fail(port_, "another program uses this port; end it first");
    }
    SetUp(port_fd_, port_, speed);
    wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (wake_fd_ < 0) Fail(port_, "no eventfd is left; close other programs");
  } catch (...) {
    close(port_fd_);
    throw;
  }
}

SerialLine::~SerialLine() {
  close(wake_fd_);
  close(port_fd_);
}

void SerialLine::Send(std::string_view bytes) {
  const ssize_t n = write(port_fd_, bytes.data(), bytes.size());
  if (n < 0 && errno != EAGAIN && errno != EINTR) Gone(port_);
}

void SerialLine::Fill() {
  std::array<char, 512> bytes{};
  while (true) {
    const ssize_t n = read(port_fd_, bytes.data(), bytes.size());
    if (n > 0) {
      read_.append(bytes.data(), static_cast<std::size_t>(n));
    } else if (n < 0 && errno == EINTR) {
      continue;
    } else if (n < 0 && errno == EAGAIN) {
      return;
    } else {
      Gone(port_);
    }
    // Noise without a line feed takes no memory.
    if (read_.size() > 64 * kLongestLine) read_.clear();
  }
}

bool SerialLine::TakeWake() {
  std::uint64_t count = 0;
  return read(wake_fd_, &count, sizeof count) == sizeof count;
}

void SerialLine::Wait(SerialTime::Instant until, bool for_port) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(until - time_.now());
  time_.wait(for_port ? port_fd_ : -1, wake_fd_,
             std::max(left, std::chrono::milliseconds(0)));
}

std::optional<std::string> SerialLine::Receive(SerialTime::Instant until) {
  while (true) {
    Fill();
    if (TakeWake()) return std::nullopt;
    const std::size_t end = read_.find('\n');
    if (end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.size() <= kLongestLine) return line;
      continue;
    }
    if (time_.now() >= until) return std::nullopt;
    Wait(until, true);
  }
}

void SerialLine::Pause(SerialTime::Instant until) {
  while (time_.now() < until && !TakeWake()) Wait(until, false);
}

void SerialLine::Shout(std::string_view bytes) noexcept {
  const int error = errno;  // of whom a signal interrupted
  tcflush(port_fd_, TCOFLUSH);
  [[maybe_unused]] ssize_t done = write(port_fd_, bytes.data(), bytes.size());
  const std::uint64_t one = 1;
  done = write(wake_fd_, &one, sizeof one);
  errno = error;
}

void SerialLine::Drain(std::chrono::milliseconds longest) noexcept {
  // Two bytes at the slowest baud.
  constexpr timespec kLook{0, 2'000'000};
  const auto until = std::chrono::steady_clock::now() + longest;
  int waiting = 0;
  while (ioctl(port_fd_, TIOCOUTQ, &waiting) == 0 && waiting > 0 &&
         std::chrono::steady_clock::now() < until) {
    nanosleep(&kLook, nullptr);
  }
}

}  // namespace touchdown::rig
