// The asking side: a process that reads one recording, and questions to it.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "footage/apart/frame_memory.h"
#include "footage/apart/messages.h"
#include "footage/apart/socket_pair.h"
#include "touchdown/core/cancellation.h"
#include "touchdown/vision/footage/clip_apart.h"

namespace touchdown::vision {

// A running reader; it is ended with this. Shared by all lines to it.
class ReaderProcess {
 public:
  // Starts this program as a reader. Throws core::InputError.
  ReaderProcess(const std::filesystem::path& path, const ReaderLimits& limits);
  ~ReaderProcess();
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  Descriptor TakeFirstLine() { return std::move(first_line_); }
  double silence_s() const { return silence_s_; }
  const std::filesystem::path& path() const { return path_; }

  // Ends the reader, and throws core::InputError that says how it ended, or
  // that we ended it because of `why`.
  [[noreturn]] void Lose(const std::string& why = "");

 private:
  // Ends it and waits; what it ended with, as waitpid gives it.
  int End();

  std::filesystem::path path_;
  double silence_s_ = 0.0;
  Descriptor life_line_;
  Descriptor first_line_;
  std::mutex mutex_;
  pid_t process_ = -1;  // -1: it has been waited for
  int status_ = 0;
};

struct Answered {
  Packed answer;
  Descriptor descriptor;
};

// One line to a reader. From any thread, one question at a time.
class ReaderLine {
 public:
  ReaderLine(std::shared_ptr<ReaderProcess> process, Descriptor socket);

  // What the reader says first: what the kernel granted it; its memory for
  // frames is the descriptor.
  Descriptor Greeting(Confinement& granted);

  // Asks, and waits for the answer. Throws what the reader says:
  // std::invalid_argument, core::InputError, also where it ended or is silent;
  // core::Cancelled where the work is to end meanwhile.
  Answered Question(Ask ask, const Packed& rest,
                    const core::Cancellation& until = {});

  // Where the reader says that work goes on; from the first answer on.
  void Watch(std::shared_ptr<const FrameMemoryView> memory) {
    memory_ = std::move(memory);
  }
  const std::shared_ptr<ReaderProcess>& process() const { return process_; }

 private:
  Answered Wait(std::uint32_t number, const core::Cancellation& until);

  std::shared_ptr<ReaderProcess> process_;
  Descriptor socket_;
  std::shared_ptr<const FrameMemoryView> memory_;
  std::mutex mutex_;
  std::uint32_t number_ = 0;
};

}  // namespace touchdown::vision
