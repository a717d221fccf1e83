// Clips: one recording of one shot, whatever its container.
//
//   auto clip = OpenClip("shot_017.mraw");
//   for (int64_t i = 0; i < clip->info().frames; ++i) {
//     core::Frame frame = clip->Read(i);
//     ...
//   }
//
// Formats: video through libav (avi, mp4, mkv, mov, cine: MJPEG, H.264, FFV1,
// raw; 8 to 16 bit; gray and colour, of which the luma is read), Photron
// .mraw with its .cih or .cihx beside it (8, 12 packed, 16 bit), TIFFs of
// several pages, folders of PNG, TIFF or JPEG (8 and 16 bit) in natural order
// of their names. What each does with depth, range, rotation and time:
// docs/formats.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "touchdown/core/cancellation.h"
#include "touchdown/core/frame.h"

namespace touchdown::vision {

// Where the frame rate comes from.
enum class FpsSource { kHeader, kContainer, kUser };
std::string_view Name(FpsSource source);  // "header", "container", "user"

struct TimeBase {
  double fps = 0.0;  // recorded, not of playback; where frames are missing,
                     // of those that follow each other
  FpsSource source = FpsSource::kContainer;
  bool uniform = true;   // frames equally spaced in time
  bool trusted = false;  // false: a playback rate may have been mistaken for it
};

// Where the recorded picture lies on the camera's sensor.
struct SensorOrigin {
  std::int32_t x_px = 0;
  std::int32_t y_px = 0;

  friend bool operator==(const SensorOrigin&, const SensorOrigin&) = default;
};

struct ClipInfo {
  std::filesystem::path path;
  std::string format;  // "mraw", "avi", "mp4", "tiff-stack", ...
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;  // significant bits of a sample, 1..16
  // Whether frames are coded by what differs from others (H.264 is, MJPEG not).
  bool is_predicted = false;
  // Whether levels are light (linear_clip.h), or no power of it: a colour
  // difference.
  bool gamma_is_known = false;
  bool has_colour = false;              // colour differences can be read, too
  std::int64_t frames = 0;              // that can be read
  std::int64_t first_camera_frame = 0;  // the camera's own number of frame 0
  std::optional<SensorOrigin> sensor_origin;  // absent: the file does not say
  TimeBase time_base;
  std::vector<std::string> warnings;  // one sentence each, for the user
};

// Which gray picture is made of a colour recording.
enum class Channel { kLuma, kBlueDifference, kRedDifference };
std::string_view Name(Channel channel);  // "luma", "blue difference (Cb)", ...

struct ClipOptions {
  // The colour differences are there where ClipInfo::has_colour says so; else
  // OpenClip throws std::invalid_argument for anything but luma.
  Channel channel = Channel::kLuma;

  // Recorded frame rate, in frames per second; overrides the file's.
  std::optional<double> fps = std::nullopt;
  // Threads of a video decoder; 0: one for each core. Affects speed only.
  std::int32_t decoder_threads = 0;
};

// Where a frame differs from the still picture.
struct Changes {
  std::vector<core::PixelRect> where;  // apart from each other
  double noise = 1.0;  // of the frame's differences, over the still picture's
};

// An open recording. Not safe to share between threads.
class Clip {
 public:
  virtual ~Clip() = default;
  Clip() = default;
  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;

  virtual const ClipInfo& info() const = 0;

  // A view of `window` of frame `index`, valid until the next Read of this
  // clip. The default window is the whole picture; raw formats touch only the
  // bytes of the window. Reading in order is fast in every format; reading
  // backwards in a compressed one starts over from the nearest key frame. Rows
  // run downwards: stride_bytes of the view is positive in every format.
  //
  // Throws std::invalid_argument if `index` or `window` lies outside the clip,
  // core::InputError (file, frame) if the frame's data are damaged or missing,
  // core::Cancelled if the work is to end.
  core::Frame Read(std::int64_t index);
  core::Frame Read(std::int64_t index, const core::PixelRect& window);

  // True: the views that Read returns stay valid as long as the clip, but for
  // those of what was to be read once.
  virtual bool views_last() const { return false; }

  // True: a window costs what its own samples cost, and nothing else of the
  // frame is touched.
  virtual bool windows_are_cheap() const { return false; }

  // A hint, before many samples of a window are used: a mapped file's pages
  // are then got at once, not one by one as they are touched.
  virtual void WillRead(std::int64_t /*index*/,
                        const core::PixelRect& /*window*/) {}

  // A hint, before a window is looked at once: a mapped file's bytes are then
  // copied, which costs less than to map their pages and give them back. Views
  // of it are valid until the next hint.
  virtual void WillReadOnce(std::int64_t index, const core::PixelRect& window) {
    WillRead(index, window);
  }

  // A hint, after many samples were used: a mapped file's pages are given back.
  // Views stay valid; what is read again is got again. May be called beside
  // anything else.
  virtual void HasRead() const {}

  // Throws core::InputError where the recording's file has become shorter since
  // it was opened: what was read of it may be wrong, and so what was measured.
  // To be asked when all is read.
  virtual void RequireWhole() const {}

  // The last frame up to `index` from which reading can begin: itself where
  // each frame is stored alone, else a key frame.
  virtual std::int64_t EntryFrame(std::int64_t index) const { return index; }

  // Another reader of the same recording, for another thread; null where each
  // frame is not stored alone, so that two readers would decode the same ones.
  virtual std::unique_ptr<Clip> Another() const { return nullptr; }

  // The same, which ends when this one does.
  std::unique_ptr<Clip> OpenAnother() const;

  // What ends the work on this clip: Read asks it for every frame, and work
  // between two reads asks it where that may take long. A clip made of another
  // takes over what that one has.
  const core::Cancellation& cancellation() const { return cancellation_; }
  void set_cancellation(core::Cancellation cancellation) {
    cancellation_ = std::move(cancellation);
  }

  // Where frame `index` may differ from the still picture, if the clip has
  // looked (frame_store.h): elsewhere nothing needs to be looked at, and
  // reading there may be slow. Null: it has not.
  virtual const Changes* KnownChanges(std::int64_t /*index*/) const {
    return nullptr;
  }

  // Wall time spent inside Read so far, in seconds: decoding and waiting for
  // the disk (of memory-mapped clips the disk is waited for later, where pixels
  // are used).
  double reading_s() const { return reading_s_; }

 protected:
  // The samples of the window (data, stride, depth) and the frame's time; Read
  // adds where the window lies and which frame it is.
  virtual core::Frame ReadWindow(std::int64_t index,
                                 const core::PixelRect& window) = 0;

  // Reading that was done elsewhere than in Read.
  void AddReading(double seconds) { reading_s_ += seconds; }

 private:
  double reading_s_ = 0.0;
  core::Cancellation cancellation_;
};

// Opens a recording: a video file, an .mraw (or its .cih/.cihx), a TIFF of
// several pages, or a folder of images. Throws core::InputError naming the
// file, and what to do, if it does not exist, is damaged before its first
// frame, or is of an unknown kind; std::invalid_argument if options.fps is not
// positive and finite or options.decoder_threads is negative.
//
// A clip that ends early but whose first frames are whole opens with the frames
// that are there and a warning. A folder of images and a TIFF have no frame
// rate: without options.fps they are refused with an InputError that says so.
std::unique_ptr<Clip> OpenClip(const std::filesystem::path& path,
                               const ClipOptions& options = {});

}  // namespace touchdown::vision
