#include "footage/formats/video_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "footage/formats/cine_header.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

void WarnOfExposures(const CineHeader& header, std::size_t frames,
                     ClipInfo& info) {
  if (header.exposures_s.size() < frames || frames == 0) return;
  const auto [shortest, longest] = std::minmax_element(
      header.exposures_s.begin(),
      header.exposures_s.begin() + static_cast<std::ptrdiff_t>(frames));
  // Relative: exposures that differ by less are those of one setting. Not
  // studied.
  constexpr double kSameExposure = 0.02;
  constexpr double kUsPerS = 1e6;
  if (*longest <= (1.0 + kSameExposure) * *shortest) return;
  info.warnings.push_back(
      fmt::format("the exposure time changes between frames ({:.4g} to {:.4g} "
                  "us): their brightness and the middle of each exposure do, "
                  "too",
                  *shortest * kUsPerS, *longest * kUsPerS));
}

}  // namespace

bool TakeCineHeader(const std::filesystem::path& path,
                    const ClipOptions& options, VideoIndex& index,
                    ClipInfo& info) {
  CineHeader header = ReadCineHeader(path);
  info.first_camera_frame = header.first_image;
  if (!header.stamps_trouble.empty()) {
    info.warnings.push_back(fmt::format(
        "the camera's times of the frames cannot be right ({}): the frames are "
        "taken as equally spaced, and dropped ones go unnoticed",
        header.stamps_trouble));
  }
  const auto frames = static_cast<std::size_t>(index.frames);
  if (frames < 2 || header.times_s.size() < frames) return header.packed_10;
  header.times_s.resize(frames);
  index.spacing = FindSpacing(header.times_s, {header.stated_fps},
                              {.jitter_s = kCineJitterS});
  WarnOfExposures(header, frames, info);
  // Relative. FrameRate is a whole number, in truth a part in a thousand off at
  // most: beyond ten times that the header and the camera's stamps contradict
  // each other.
  constexpr double kMaxRateError = 0.01;
  const double fps = index.spacing.fps;
  if (index.spacing.even && header.stated_fps > 0.0 && !options.fps &&
      std::abs(header.stated_fps / fps - 1.0) > kMaxRateError) {
    info.warnings.push_back(fmt::format(
        "the header says {:.6g} fps, the camera's times of the frames {:.6g} "
        "fps: the times are believed; if they are wrong, give the rate with "
        "--fps",
        header.stated_fps, fps));
  }
  return header.packed_10;
}

void SetTimeBase(const VideoIndex& index, const ClipOptions& options,
                 ClipInfo& info) {
  TimeBase& time = info.time_base;
  if (!index.spacing.uniform) {
    info.warnings.push_back(
        DescribeSpacing(index.spacing) +
        (options.fps ? "; with --fps they are taken as equally spaced"
                     : "; their own times are used"));
  }
  if (options.fps) {
    time = {*options.fps, FpsSource::kUser, true, true};
    return;
  }
  if (!(index.spacing.fps > 0.0)) {
    throw core::InputError(fmt::format(
        "{}: the file tells no frame rate; give the camera's with --fps",
        info.path.string()));
  }
  const bool cine = info.format == "cine";  // has the camera's own rate
  time.fps = index.spacing.fps;
  time.source = cine ? FpsSource::kHeader : FpsSource::kContainer;
  time.uniform = index.spacing.uniform;
  const bool playback = !cine && IsPlaybackRate(time.fps);
  time.trusted = !playback && !index.coarse;
  if (index.coarse) {
    info.warnings.push_back(
        fmt::format("the file's timestamps are too coarse to tell its frames "
                    "apart (about {:.6g} fps); give the camera's rate with "
                    "--fps",
                    time.fps));
  }
  if (playback) {
    info.warnings.push_back(
        fmt::format("{:.6g} fps is a rate of playback; if the camera recorded "
                    "at another, give it with --fps",
                    time.fps));
  }
}

double FrameTime(const VideoIndex& index, const TimeBase& time,
                 std::int64_t frame) {
  const std::vector<double>& own = index.spacing.times_s;
  return time.uniform || own.empty() ? static_cast<double>(frame) / time.fps
                                     : own[static_cast<std::size_t>(frame)];
}

}  // namespace touchdown::vision
