// Datagrams between a reader and who asks it.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

namespace touchdown::vision {

// A descriptor that is closed with its owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept
      : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();

  int get() const { return number_; }
  int Release() { return std::exchange(number_, -1); }
  explicit operator bool() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

// Two ends of one line, which no program started later gets. Throws
// core::InputError where there is none.
std::pair<Descriptor, Descriptor> MakeSocketPair();

// One message, with a descriptor (-1: none); false where the other end is gone.
bool SendMessage(int socket, const std::string& bytes, int descriptor = -1);

struct Received {
  enum class What { kMessage, kNothingYet, kEnd };
  What what = What::kEnd;
  std::string bytes;
  Descriptor descriptor;
};
// Waits for the next message, as long as SetPatience says.
Received ReceiveMessage(int socket);

// How long ReceiveMessage waits; without it, until there is something.
void SetPatience(int socket, std::chrono::milliseconds patience);

}  // namespace touchdown::vision
