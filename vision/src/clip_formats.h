// One opener for each family of formats; clip.cc chooses among them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "touchdown/vision/clip.h"

namespace touchdown::vision {

class FrameMemory;

// No camera comes near; keeps every product of sizes far from overflow.
inline constexpr std::int64_t kMaxSidePx = 1 << 16;

// A Photron recording, given its .mraw or its header.
std::unique_ptr<Clip> OpenMraw(const std::filesystem::path& path,
                               const ClipOptions& options);

// A folder of PNG, TIFF or JPEG.
std::unique_ptr<Clip> OpenImageFolder(const std::filesystem::path& folder,
                                      const ClipOptions& options);

// A TIFF of several pages.
std::unique_ptr<Clip> OpenTiffStack(const std::filesystem::path& path,
                                    const ClipOptions& options);

// The same where `path` is one whose samples lie in it plainly, so that no
// decoder is needed; else null.
std::unique_ptr<Clip> OpenPlainTiffStack(const std::filesystem::path& path,
                                         const ClipOptions& options);

// Any container that libav knows. Frames are decoded into `memory` where there
// is one, which must outlive all clips.
std::unique_ptr<Clip> OpenVideo(const std::filesystem::path& path,
                                const ClipOptions& options,
                                FrameMemory* memory = nullptr);

// OpenClip, with memory for frames.
std::unique_ptr<Clip> OpenClipWith(const std::filesystem::path& path,
                                   const ClipOptions& options,
                                   FrameMemory* memory);

// Whether a library of others would read it: a folder or a plain file that is
// no Photron recording.
bool IsForeign(const std::filesystem::path& path);

// The extension in lower case, with its dot: ".mraw".
std::string LowerExtension(const std::filesystem::path& path);

// The two files of a Photron recording, given either.
// Throws core::InputError if the other is not beside it.
struct MrawPair {
  std::filesystem::path data;
  std::filesystem::path header;
};
bool IsMrawOrHeader(const std::filesystem::path& path);
MrawPair FindMrawPair(const std::filesystem::path& path);

// The images of a folder, in natural order of their names; other files are left
// out. Throws core::InputError if there is none or if they are of mixed kinds.
std::vector<std::filesystem::path> ListImages(
    const std::filesystem::path& folder);

}  // namespace touchdown::vision
