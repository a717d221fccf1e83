// A pseudo-terminal: a serial line whose other end the test holds.
#pragma once

#include <fcntl.h>
#include <stdlib.h>  // posix_openpt
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>

namespace touchdown::testing {

class PseudoTerminal {
 public:
  // Throws where none can be had: a chroot without /dev/pts.
  PseudoTerminal() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    std::array<char, 128> name{};
    if (master_ >= 0 && grantpt(master_) == 0 && unlockpt(master_) == 0 &&
        ptsname_r(master_, name.data(), name.size()) == 0) {
      port_ = name.data();
      // Held open, so that a closed program is no hang-up of this end.
      slave_ = open(port_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    }
    if (slave_ < 0) {
      if (master_ >= 0) close(master_);
      // By these words ctest knows a test that cannot be made here.
      throw std::runtime_error(
          "no pseudo-terminal can be had here (/dev/ptmx, /dev/pts): skipped");
    }
  }
  ~PseudoTerminal() {
    HangUp();
    close(slave_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  int master() const { return master_; }  // -1 after HangUp
  int slave() const { return slave_; }
  const std::string& port() const { return port_; }  // what the program opens
  void HangUp() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }

 private:
  int master_ = -1;
  int slave_ = -1;
  std::string port_;
};

}  // namespace touchdown::testing
