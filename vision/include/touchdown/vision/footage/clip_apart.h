// Clips of foreign readers (libav, libtiff, libpng, libjpeg) in a process of
// their own: what a damaged or hostile file does to them ends that process, and
// here it is an error with the file's name.
//
//   int main(int argc, char** argv) {
//     if (const auto status = vision::ServeAsReader(argc, argv)) return
//     *status;
//     ...
//     auto clip = vision::OpenClipApart("shot_017.mp4");
//
// The process is this program, started anew as a reader. It may read the
// recording and nothing else of the file system, reach no network and start
// nothing (Landlock and seccomp, where the kernel has them; limits of memory
// and open files in any case). Decoders write into memory that both share, so
// frames are not copied. Photron raw and TIFF stacks of plain samples are read
// by our own readers, in this process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {

// To be called first in main. Nothing, unless this process was started as a
// reader: then it serves until its clip is closed, and this is its exit status.
// Until it has been called OpenClipApart is OpenClip.
std::optional<int> ServeAsReader(int argc, char** argv);

struct ReaderLimits {
  // Address space of the process, bytes; less where `ulimit -v` says so. 64
  // frames of 4096x2160 at 16 bits in three planes take 3.4 GB; what asks for
  // more than this is refused as damaged.
  std::size_t memory_bytes = std::size_t{4} << 30;
  // Open files and sockets: one for each thread that reads apart, and two for
  // each file of a recording.
  std::size_t open_files = 512;
  // A reader that has neither answered nor decoded a frame nor read on for so
  // long is ended, s. A frame takes milliseconds; a disk that sleeps takes ten
  // seconds to wake.
  double silence_s = 15.0;
};

// What the kernel granted to a reader, for the log.
struct Confinement {
  bool is_apart = false;  // false: read in this process
  std::string seccomp;    // empty: in force; else why not
  std::string landlock;   // the same
};

// OpenClip, apart where the recording is a foreign reader's. Errors as
// OpenClip, and core::InputError where the reader ended.
std::unique_ptr<Clip> OpenClipApart(const std::filesystem::path& path,
                                    const ClipOptions& options = {},
                                    const ReaderLimits& limits = {},
                                    Confinement* confinement = nullptr);

// ReadImage, apart.
Image ReadImageApart(const std::filesystem::path& path,
                     const ReaderLimits& limits = {});

}  // namespace touchdown::vision
