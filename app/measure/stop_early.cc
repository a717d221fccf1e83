#include "app/measure/stop_early.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "app/measure/footage.h"
#include "app/measure/options_hash.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// A clip that another owns.
class Borrowed final : public vision::Clip {
 public:
  explicit Borrowed(vision::Clip& clip) : clip_(clip) {
    set_cancellation(clip.cancellation());
  }

  const vision::ClipInfo& info() const override { return clip_.info(); }
  // All that an analysis may ask is passed on: a capability that got lost here
  // would change how frames are read, and with it the time but not the answer.
  bool views_last() const override { return clip_.views_last(); }
  bool windows_are_cheap() const override { return clip_.windows_are_cheap(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_.EntryFrame(index);
  }
  const vision::Changes* KnownChanges(std::int64_t index) const override {
    return clip_.KnownChanges(index);
  }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    return clip_.Read(index, window);
  }

  vision::Clip& clip_;
};

// No outline is fitted before enough frames show something: an analysis of an
// empty beginning would cost and say nothing.
// What the windows that differ from the still picture tell before any outline
// is fitted.
class ActivityTally {
 public:
  explicit ActivityTally(std::int64_t least_run) : least_run_(least_run) {}

  // The next frames.
  void Add(const vision::Clip& clip, std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i) {
      const vision::Changes* changes = clip.KnownChanges(i);
      if (changes == nullptr || changes->where.empty()) {
        run_ = 0;
        continue;
      }
      const core::PixelRect& now = changes->where.front();
      run_ = run_ > 0 && Overlap(now, before_) ? run_ + 1 : 1;
      before_ = now;
      if (run_ < least_run_) continue;
      frames_ += run_ == least_run_ ? least_run_ : 1;
      if (now.y + now.height <= lowest_px_) continue;
      lowest_px_ = now.y + now.height;
      lowest_from_ = i;
    }
  }

  // In which something moves.
  std::int64_t frames() const { return frames_; }
  // First one in which it reached its lowest row of the picture.
  std::int64_t lowest_from() const { return lowest_from_; }

 private:
  static bool Overlap(const core::PixelRect& a, const core::PixelRect& b) {
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
           b.y < a.y + a.height;
  }

  std::int64_t least_run_;
  core::PixelRect before_;
  std::int64_t run_ = 0;
  std::int64_t frames_ = 0;
  std::int32_t lowest_px_ = -1;
  std::int64_t lowest_from_ = 0;
};

// How far a rectangle's lowest face is from lying on the ground, px: what may
// still fall, and be thrown up again. 0 for a sphere.
double FaceLift(const vision::PlaneTrack& plane) {
  if (plane.kind == core::BodyKind::kSphere) return 0.0;
  constexpr double kFace = 0.5 * std::numbers::pi;  // from one to the next
  const double tilt = std::remainder(plane.samples.back().face_rad, kFace);
  return std::abs(std::sin(tilt)) * plane.size_px;
}

// Why a bounce is not yet beyond doubt; empty where it is. The gap only grows
// with further frames, so a rise well above the bounce height stays one.
std::string ReasonAgainstBounce(const core::StateDecision& state,
                                const StopRule& rule) {
  if (state.max_gap_m->value < rule.least_rise * state.bounce_height_m->value) {
    return "it has not risen far above the bounce height";
  }
  return {};
}

// Why a body that stays down may still rise; empty where it cannot. It has to
// be seen for several times as long as a rise to the bounce height takes, and a
// block has to lie on a face: one on its edge still falls, and may be thrown
// up.
std::string ReasonAgainstStay(const Analysis& analysis, double contact_s,
                              const StopRule& rule) {
  const core::StateDecision& state = analysis.contacts.first.state;
  const vision::PlaneTrack& plane = *analysis.plane;
  const double height_m = state.bounce_height_m->value;
  const double rise_s = std::sqrt(2.0 * height_m / core::kStandardGravity_mps2);
  const double seen_s = plane.samples.back().time_s - contact_s;
  const double least_s =
      std::max(rule.least_stay * rise_s,
               static_cast<double>(rule.least_after) * plane.frame_interval_s);
  if (seen_s < least_s) {
    return fmt::format("it was seen for {:.4f} s on the ground, needed {:.4f}",
                       seen_s, least_s);
  }
  if (FaceLift(plane) > height_m * analysis.scale->px_per_m.value) {
    return "it does not lie flat";
  }
  return {};
}

// Whether a quantity of fewer frames agrees with that of more, in the u of the
// former. Absent in both counts as agreement.
bool IsWithin(const core::Measured& fewer, const core::Measured& more,
              double most_u) {
  if (fewer.has_value() != more.has_value()) return false;
  return !more || std::abs(fewer->value - more->value) <= most_u * fewer->u;
}

}  // namespace

std::string ReasonToContinue(const Analysis& analysis, std::int64_t end,
                             std::size_t known_warnings, const StopRule& rule) {
  const core::ContactRecord& first = analysis.contacts.first;
  const core::Contact& contact = first.contact;
  const core::StateDecision& state = first.state;
  if (!analysis.track || !analysis.plane) return "no body on a known ground";
  if (analysis.track->several_bodies) return "several bodies move";
  if (!analysis.track->known_background) return "the background is not known";
  if (!contact.found) return "no contact was seen";
  if (contact.from_start || !contact.time_s || !contact.frame) {
    return "it was on the ground from the start";
  }
  // A warning of any other kind may turn into an answer with more frames.
  // Those of contacts are of a ground that is off, which is looked at below.
  if (analysis.warnings.size() >
      known_warnings + analysis.contacts.warnings.size()) {
    return "there are warnings";
  }
  if (!analysis.contacts.ground_refuted.empty()) {
    return analysis.contacts.ground_refuted;
  }
  if (state.label == core::MotionState::kUndecided || !state.p_bounce) {
    return "the state is undecided";
  }
  if (std::min(*state.p_bounce, 1.0 - *state.p_bounce) >= rule.most_doubt) {
    return "the state is in doubt";
  }
  if (!analysis.scale || !state.max_gap_m || !state.bounce_height_m) {
    return "there is no scale";
  }
  // A line that lies off by a share of the bounce height shifts every gap by as
  // much, and so the label.
  const double height_px =
      state.bounce_height_m->value * analysis.scale->px_per_m.value;
  if (analysis.contacts.evidence.empty() ||
      std::abs(analysis.contacts.evidence.front().ground_px) >
          rule.most_off * height_px) {
    return "the ground line is off";
  }
  if (static_cast<double>(end) <
      contact.frame->value + static_cast<double>(rule.least_after)) {
    return "the touchdown was a moment ago";
  }
  return state.label == core::MotionState::kBounce
             ? ReasonAgainstBounce(state, rule)
             : ReasonAgainstStay(analysis, contact.time_s->value, rule);
}

bool SayTheSame(const Analysis& fewer, const Analysis& more,
                const StopRule& rule) {
  const core::ContactRecord& a = fewer.contacts.first;
  const core::ContactRecord& b = more.contacts.first;
  const auto alike = [&rule](const core::Measured& one,
                             const core::Measured& other) {
    return IsWithin(one, other, rule.most_apart);
  };
  return a.state.label == b.state.label && fewer.body && more.body &&
         fewer.body->kind == more.body->kind &&
         alike(a.contact.time_s, b.contact.time_s) &&
         alike(a.contact.approach_angle_rad, b.contact.approach_angle_rad) &&
         alike(a.contact.face_angle_rad, b.contact.face_angle_rad) &&
         alike(a.contact.radius_angle_rad, b.contact.radius_angle_rad);
}

Analysis AnalyzeUntilDecided(Footage footage, const ClipCalibration& camera,
                             const AnalyzeOptions& options,
                             const StopRule& rule, std::size_t most_bytes) {
  // Those of file and camera are there from the first frame on and do not speak
  // against stopping.
  const std::size_t known_warnings =
      footage.info.warnings.size() + camera.warnings.size() +
      (footage.camera_moved_px || footage.motion_unexplained ? 1 : 0);
  vision::FrameStoreOptions keep = MakeKeepOptions(options, footage.info);
  keep.most_bytes = most_bytes;
  const auto frames = vision::GrowFrames(std::move(footage.clip), keep);
  // The same analysis as of a whole clip, over frames that are decoded already.
  const auto analyze = [&](const AnalyzeOptions& of) {
    Footage part;
    part.info = footage.info;
    part.clip = std::make_unique<Borrowed>(*frames);
    part.light_spread = footage.light_spread;
    part.light_told = footage.light_told;
    part.camera_moved_px = footage.camera_moved_px;
    part.motion_unexplained = footage.motion_unexplained;
    part.still_frames = frames->StillFrames();
    part.begun = footage.begun;
    Analysis analysis = AnalyzeFootage(std::move(part), camera, of);
    analysis.timing.decode_s = frames->reading_s();
    return analysis;
  };

  // Pieces of frames are decoded, each followed by an analysis where it can
  // have changed the answer. Two in a row must say the same.
  const std::int64_t range = keep.last - keep.first;
  const std::int64_t piece = std::max(rule.least_piece, range / rule.pieces);
  ActivityTally seen(rule.least_run);
  std::int64_t looked_at = 0;  // of the frames that show anything
  std::optional<Analysis> decided;
  for (std::int64_t end = keep.first + piece; end < keep.last; end += piece) {
    // Frames that have to be decoded twice, because the store has no room for
    // them, cost more than an early end saves.
    if (static_cast<double>(frames->DecodedAgain()) >
            rule.most_decoded_again * static_cast<double>(range) ||
        !frames->ExtendDecoding(end)) {
      break;
    }
    seen.Add(*frames, end - piece, end);
    if (options.progress) {
      options.progress(static_cast<double>(end - keep.first) /
                       static_cast<double>(range));
    }
    const bool more = static_cast<double>(seen.frames()) >=
                      rule.growth * static_cast<double>(looked_at);
    if (seen.frames() < rule.least_after ||
        end < seen.lowest_from() + rule.least_after || !(decided || more)) {
      continue;
    }
    looked_at = seen.frames();
    if (!frames->HoldsAllChanges()) continue;
    // The range ends here as if the user had said so; progress is told by this
    // loop.
    AnalyzeOptions so_far = options;
    so_far.last_frame = end;
    so_far.progress = nullptr;
    Analysis analysis = analyze(so_far);
    // An answer that becomes doubtful again was never decided.
    if (!ReasonToContinue(analysis, end, known_warnings, rule).empty()) {
      decided.reset();
      continue;
    }
    if (!decided || !SayTheSame(*decided, analysis, rule)) {
      decided = std::move(analysis);
      continue;
    }
    analysis.options = options;
    analysis.options.progress = nullptr;
    analysis.options_hash = OptionsHash(options);
    analysis.stopped_at = end;
    analysis.scene_model.left_out[fmt::format("frames {}:{}", end, keep.last)] =
        fmt::format("stopped early: by frame {} the state was decided", end);
    // Frames that were passed over are named, so that nobody takes them for
    // measured ones.
    for (const auto& [from, to] : frames->LeftOut()) {
      analysis.scene_model.left_out[fmt::format("frames {}:{}", from, to)] =
          "their key frames show nothing";
    }
    return analysis;
  }
  // Never decided: the clip as a whole.
  frames->ExtendDecoding(keep.last);
  return analyze(options);
}

}  // namespace touchdown::pipeline
