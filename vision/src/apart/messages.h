// What a reader and who asks it say to each other: one datagram a question, one
// an answer. Neither believes a length that the other states.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "apart/socket_pair.h"
#include "touchdown/vision/clip.h"

namespace touchdown::vision {

enum class Ask : std::uint32_t {
  kOpen,          // path and options: the first question
  kRead,          // a window of a frame
  kAnother,       // another reader of the same recording, for another thread
  kEntries,       // from which frames reading can begin
  kRequireWhole,  // whether the file is as long as it was
  kImage,         // a single picture
};

enum class Said : std::uint32_t {
  kDone,
  kInputError,
  kInvalidArgument,
  kOther,  // no memory, a defect
};

// Numbers and texts one behind the other. Reading past the end, or a text that
// is longer than what is there, throws core::InputError.
class Packed {
 public:
  Packed() = default;
  explicit Packed(std::string bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::array<char, sizeof value> raw;
    std::memcpy(raw.data(), &value, sizeof value);
    bytes_.append(raw.data(), raw.size());
  }
  void PutText(std::string_view text);

  template <class T>
  T Get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, Need(sizeof value), sizeof value);
    return value;
  }
  bool GetFlag() { return Get<std::uint8_t>() != 0; }
  std::string GetText();

  const std::string& bytes() const { return bytes_; }

 private:
  const char* Need(std::size_t bytes);

  std::string bytes_;
  std::size_t at_ = 0;
};

void PutOptions(Packed& to, const ClipOptions& options);
ClipOptions GetOptions(Packed& from);

// All of it but the path.
void PutInfo(Packed& to, const ClipInfo& info);
// Throws core::InputError where it says what no clip can.
ClipInfo GetInfo(Packed& from);

// Beyond any camera (video_source.cc bounds what is decoded).
inline constexpr std::int32_t kMostSide_px = 1 << 20;

// Where the samples of a window lie in the shared memory.
struct SharedFrame {
  std::uint64_t offset = 0;
  std::int64_t stride_bytes = 0;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;
  std::int32_t padding = 0;
  double time_s = 0.0;
};

}  // namespace touchdown::vision
