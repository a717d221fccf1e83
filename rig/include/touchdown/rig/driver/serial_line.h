// A serial port that carries lines, with deadlines and a way to shout.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace touchdown::rig {

// How time passes: the clock, and the wait for one of two file descriptors to
// become readable, or for a signal, at most so long. Replaced in tests only.
struct SerialTime {
  using Instant = std::chrono::steady_clock::time_point;
  std::function<Instant()> now;
  std::function<void(int port, int wake, std::chrono::milliseconds longest)>
      wait;

  static SerialTime Real();  // steady_clock and poll()
};

class SerialLine {
 public:
  // Opens `port` for this program alone: 8 data bits, no parity, one stop bit,
  // no flow control, `baud` of 9600, 19200, 38400, 57600 or 115200
  // (std::invalid_argument otherwise). What lay in its buffers is dropped.
  // Throws core::InputError naming the port where it cannot be opened, is no
  // serial port or is used by another program.
  SerialLine(const std::string& port, int baud, SerialTime time);
  ~SerialLine();
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  const std::string& port() const { return port_; }
  SerialTime::Instant Now() const { return time_.now(); }

  // Throws core::InputError where the port is gone. What it cannot take at once
  // is lost, as on the wire.
  void Send(std::string_view bytes);
  // The next line that is complete before `until`, without its line feed;
  // nothing at `until`, or when woken. Longer lines than kLongestLine are
  // dropped. Throws core::InputError where the port is gone.
  std::optional<std::string> Receive(SerialTime::Instant until);
  // Waits till `until`, or until woken.
  void Pause(SerialTime::Instant until);

  // Async-signal-safe. Drops what waits to be sent, sends `bytes` as far as the
  // port takes them, and ends what waits.
  void Shout(std::string_view bytes) noexcept;
  // Waits until what was sent is on the wire, at most for `longest`.
  void Drain(std::chrono::milliseconds longest) noexcept;

 private:
  // Reads what is there into read_.
  void Fill();
  bool TakeWake();
  void Wait(SerialTime::Instant until, bool for_port);

  std::string port_;
  SerialTime time_;
  int port_fd_ = -1;
  int wake_fd_ = -1;  // an eventfd
  std::string read_;
};

}  // namespace touchdown::rig
