// Reading a clip's frames on several threads, with a reader for each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "touchdown/core/parallel.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// Whether threads can have a reader each, of what they look at and no more.
inline bool CanReadApart(const Clip& clip) {
  return clip.windows_are_cheap() && clip.Another() != nullptr;
}

// Calls look(reader, i) for each i < count, on several threads. Throws what the
// first failing part throws.
template <class Look>
void ReadApart(const Clip& clip, std::size_t count, int threads,
               const Look& look) {
  core::InParallel(static_cast<std::int64_t>(count), threads,
                   [&](std::int64_t from, std::int64_t to) {
                     const std::unique_ptr<Clip> own = clip.OpenAnother();
                     for (auto i = static_cast<std::size_t>(from);
                          i < static_cast<std::size_t>(to); ++i) {
                       look(*own, i);
                     }
                   });
}

}  // namespace touchdown::vision
