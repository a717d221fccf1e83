// From clips and tracks to the numbers of the two-layer model and back: the
// part of the picture that a body passes, its pixels, and paths in its
// coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "layers/layer_model.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// All that the body of a track passes, and passes on beyond both ends if it
// goes straight on, with room for its blur.
core::PixelRect SweptBox(const Background& background, const Track& track,
                         const layers::Shape& shape, double blur_px);

std::vector<float> CropBackground(const Background& background,
                                  const core::PixelRect& box);

// Poses in the box's coordinates, and the frames they are of.
struct LayerPath {
  std::vector<std::int64_t> frames;
  std::vector<layers::LayerPose> poses;
};

// A track's path, frames between its poses included. `turns`: else angles are
// 0.
LayerPath PathInBox(const Track& track, const core::PixelRect& box, bool turns);

// Poses of the whole picture, so that frames between can be asked for
// (InterpolatePose); all else is as in `like`.
Track TrackInPicture(const Track& like, const LayerPath& path,
                     const core::PixelRect& box);

// So many of `count`, evenly spread, both ends among them.
std::vector<std::size_t> SpreadEvenly(std::size_t count, std::size_t most);
LayerPath Choose(const LayerPath& all, const std::vector<std::size_t>& chosen);

// The pixels of `box`, which lies within the picture, of given frames. Throws
// what Clip::Read throws.
layers::PictureStack ReadPictures(Clip& clip,
                                  std::span<const std::int64_t> frames,
                                  const core::PixelRect& box);

// Those of a path's frames. Of a clip that keeps only what changes
// (Clip::KnownChanges) the surroundings of the body are read, and `still` is
// taken to be seen outside of them. `clip` and `still` must outlive it.
class PictureReader {
 public:
  PictureReader(Clip& clip, const std::vector<float>& still,
                const layers::Shape& shape, const core::PixelRect& box);

  // Takes the place of what `stack` held; its memory is used again. Throws what
  // Clip::Read throws.
  void Read(const LayerPath& path, layers::PictureStack& stack) const;

 private:
  Clip& clip_;
  const std::vector<float>& still_;
  core::PixelRect box_;
  double reach_px_ = 0.0;
};

// The surroundings of the body alone, of poses in the whole picture. Throws
// what Clip::Read throws.
layers::PictureStack ReadAround(Clip& clip, const LayerPath& path,
                                const layers::Shape& shape);

// Those of one path.
layers::PictureStack ReadPath(Clip& clip, const std::vector<float>& still,
                              const LayerPath& path, const layers::Shape& shape,
                              const core::PixelRect& box);

}  // namespace touchdown::vision
