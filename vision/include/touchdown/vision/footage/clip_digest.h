// What tells one recording from another.
//
// All speak of the clip's files in this order: a video file alone; of
// a Photron recording the header, then the .mraw, whichever of the two was
// given; of a folder the images that OpenClip would read, in its order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace touchdown::vision {

// A cheap name for a recording, the same wherever the file lies and (but for
// folders) whatever it is called: 64 hexadecimal digits, the SHA-256 of
//
//   "touchdown.clip/1\n"
//   for each file: its size in bytes, decimal, then " " and its name (images of
//   a folder only), then "\n"
//   blocks of the files' contents, laid end to end: all of it if the total size
//   is at most 64 MiB; else 64 blocks of 1 MiB, of which block k = 0 .. 63
//   begins at byte floor(k (total - 1 MiB) / 63).
//
// So the first MiB (headers) and the last are always in it. Two recordings of
// the same size that differ only between the blocks share an id: Sha256 tells
// them apart. Reads at most 64 MiB.
// Throws core::InputError naming the file if it cannot be read.
std::string ClipId(const std::filesystem::path& path);

// SHA-256 of everything, 64 hexadecimal digits, to be had from common tools:
//   a video file           sha256sum CLIP
//   a Photron recording    cat CLIP.cihx CLIP.mraw | sha256sum
//   a folder of images     cd FOLDER; sha256sum IMAGES | sha256sum
// (in the order above; names that sha256sum would escape are not escaped).
// Takes as long as reading all bytes.
// Throws core::InputError naming the file if it cannot be read.
std::string Sha256(const std::filesystem::path& path);

// Size of all its files together. Throws core::InputError like the above.
std::int64_t SizeBytes(const std::filesystem::path& path);

}  // namespace touchdown::vision
