#include "app/measure/analyze.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <string_view>

#include "app/measure/answer_check.h"
#include "app/measure/body_size.h"
#include "app/measure/check_options.h"
#include "app/measure/clip_calibration.h"
#include "app/measure/footage.h"
#include "app/measure/journal.h"
#include "app/measure/judge.h"
#include "app/measure/left_out.h"
#include "app/measure/open_recording.h"
#include "app/measure/options_hash.h"
#include "app/measure/stop_early.h"
#include "app/measure/unfinished_analysis.h"
#include "app/text/truth_file.h"
#include "app/text/version.h"
#include "touchdown/calib/ground_lines.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/contact/supported_path.h"
#include "touchdown/vision/detection/frame_store.h"
#include "touchdown/vision/explanation/explained_change.h"
#include "touchdown/vision/footage/clip_digest.h"
#include "touchdown/vision/footage/linear_clip.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

// Wall time in seconds since `start`: what the document's timing_s holds.
double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A line that was tried as the ground, with all that follows from it.
struct Judged {
  calib::GroundLine ground;
  vision::Track track;  // refined with this ground
  vision::PlaneTrack plane;
  vision::ContactResult contacts;
};

// How well a line serves as the ground of this track; more is better.
int Merit(const vision::ContactResult& result) {
  if (!result.ground_refuted.empty()) return 0;
  if (!result.first.contact.found) return 1;
  return 2;
}

// Of vision::CameraMotion::unexplained.
constexpr std::string_view kAllMoves =
    "the scene moves in all parts of the picture";

// One clip, whose options and calibration were checked, to one Analysis: the
// track from the pixels, the ground from the still picture and the track, the
// refined track from the pixels again, and all else from the refined track.
class Analyzer {
 public:
  Analyzer(Footage footage, const ClipCalibration& camera,
           const AnalyzeOptions& options)
      : options_(options),
        footage_(std::move(footage)),
        clip_(std::move(footage_.clip)),
        camera_(camera) {
    result_.clip = footage_.info;
    result_.camera_moved_px = footage_.camera_moved_px;
  }

  Analysis Run();

 private:
  // The track as a camera without distortion would show it.
  vision::Track Seen(const vision::Track& track) const {
    return ToIdealPicture(camera_, track);
  }
  // The scale, the body's size and what hangs on them, from a track.
  void TakeSize(const vision::Track& track);
  Judged Judge(const calib::GroundLine& ground, const vision::Track& track);
  void MeasureExplained();
  void JudgeSeveralBodies();
  std::optional<Judged> JudgeBest(
      const std::vector<calib::GroundLine>& candidates,
      const vision::Track& track);
  void FindGroundAndContacts(vision::Track track);
  void DescribeScene();
  // How what need not be waited for is done.
  std::launch AsyncPolicy() const {
    return options_.decoder_threads == 1 ? std::launch::deferred
                                         : std::launch::async;
  }

  const AnalyzeOptions& options_;
  // The clip stands apart, because the last step hands it to a thread of its
  // own.
  Footage footage_;  // but for the clip
  std::unique_ptr<vision::Clip> clip_;
  Analysis result_;
  vision::Background background_;
  vision::ContactOptions contact_options_;
  std::optional<core::Estimate> aspect_;  // short over long side, measured
  const ClipCalibration& camera_;
  vision::TrackOptions track_options_;
  std::future<void> given_back_;  // the last: it uses the clip
};

// Called after each fit of the outlines: a scale that comes of the body's own
// size moves with its radius, and the contacts need the newest one.
void Analyzer::TakeSize(const vision::Track& track) {
  const vision::BodyImage body = Seen(track).body;
  result_.scale = FindScale(options_, body);
  result_.body = DetermineBody(options_, body, result_.scale);
  contact_options_ = MakeContactOptions(options_, camera_, result_.scale);
}

// Tries a line. Only the refined track can tell whether it serves: rough
// outlines beside a line, or behind an obstacle, refute true grounds (one of
// 153 recordings, of which the contact points then gave a line 1.3 deg off).
Judged Analyzer::Judge(const calib::GroundLine& ground,
                       const vision::Track& track) {
  clip_->cancellation().Check();
  Judged judged;
  judged.ground = ground;
  calib::GroundLine in_image = ground;
  if (camera_.lens) {
    in_image = SeenGroundLine(SeenInPlane(camera_, Seen(track), ground),
                              *camera_.lens);
  }
  judged.track =
      vision::Refine(*clip_, background_, track,
                     {in_image, aspect_, track_options_.size.has_value(),
                      options_.decoder_threads});
  // To give a large mapped file's pages back takes milliseconds: beside the
  // rest. Mostly no other line is tried.
  given_back_ =
      std::async(AsyncPolicy(), [clip = clip_.get()] { clip->HasRead(); });
  TakeSize(judged.track);
  judged.plane = SeenInPlane(
      camera_, WithStatedSize(Seen(judged.track), options_), ground);
  judged.contacts = FindPlaneContacts(judged.plane, contact_options_);
  return judged;
}

// The one that serves best as the ground of this track; nothing of none.
std::optional<Judged> Analyzer::JudgeBest(
    const std::vector<calib::GroundLine>& candidates,
    const vision::Track& track) {
  // A first judgement by the track as it is puts the likely ones first: each
  // costs to fit every outline again.
  const vision::Track seen = Seen(track);
  std::vector<std::pair<int, calib::GroundLine>> ranked;
  for (const calib::GroundLine& candidate : candidates) {
    if (!camera_.ideal_ground &&
        PassesThroughGround(SeenInPlane(camera_, seen, candidate))) {
      continue;
    }
    ranked.emplace_back(
        candidates.size() == 1
            ? 0
            : Merit(FindPlaneContacts(SeenInPlane(camera_, seen, candidate),
                                      contact_options_)),
        candidate);
  }
  std::stable_sort(
      ranked.begin(), ranked.end(),
      [](const auto& a, const auto& b) { return a.first > b.first; });
  std::optional<Judged> best;
  int best_merit = -1;
  for (const auto& merit_and_line : ranked) {
    Judged judged = Judge(merit_and_line.second, track);
    const int merit = Merit(judged.contacts);
    if (merit > best_merit) {
      best_merit = merit;
      best = std::move(judged);
    }
    if (merit == 2) break;
  }
  return best;
}

void Analyzer::FindGroundAndContacts(vision::Track track) {
  clip_->cancellation().Enter("the ground is looked for");
  std::vector<calib::GroundLine> candidates;
  if (camera_.ideal_ground) {
    candidates.push_back(*camera_.ideal_ground);
  } else {
    // The background's own noise: that of a frame over the square root of the
    // frames averaged.
    const calib::StillImage still{background_.level.data(),
                                  background_.width_px, background_.height_px,
                                  std::sqrt(background_.UsualVariance() / 8.0)};
    calib::GroundLineOptions line_options;
    line_options.lens = camera_.lens;
    line_options.threads = options_.decoder_threads;
    candidates = calib::FindGroundLines(still, line_options);
  }
  const auto merit_of = [](const std::optional<Judged>& judged) {
    return judged ? Merit(judged->contacts) : -1;
  };
  // First what the picture shows, by every few frames; then by all of them.
  std::optional<Judged> best = JudgeBest(candidates, track);
  if (!camera_.ideal_ground && track.step > 1 && merit_of(best) < 2) {
    // What else there is to try needs all of the track.
    track = vision::FitEveryFrame(*clip_, background_, track, track_options_);
    best = JudgeBest(candidates, track);
  }
  int best_merit = merit_of(best);
  const vision::Track seen = Seen(track);
  // A visible edge need not be the contact line: where none agrees with the
  // track, the lowest points at the contacts tell.
  if (!camera_.ideal_ground &&
      (best_merit < 2 || IsAtTheEnd(best->contacts.first.contact, seen))) {
    if (const auto from_path = vision::GroundFromPath(seen)) {
      Judged judged = Judge(*from_path, track);
      if (judged.contacts.first.contact.from_start) {
        result_.warnings.emplace_back(
            "no visible edge is the ground; the body moves along it all the "
            "time, and its path tells where it is");
        best = std::move(judged);
        best_merit = 2;
      }
    }
  }
  if (!camera_.ideal_ground && best_merit < 1) {
    if (const auto from_contacts = vision::GroundFromContacts(seen)) {
      Judged judged = Judge(*from_contacts, track);
      if (judged.contacts.first.contact.found) {
        if (best) {
          result_.warnings.push_back(
              fmt::format("the visible edge is not the ground ({}); the "
                          "contact points tell where it is",
                          best->contacts.ground_refuted));
        } else if (!candidates.empty()) {
          result_.warnings.emplace_back(
              "no visible edge is the ground (the body passes below each); the "
              "contact points tell where it is");
        }
        best = std::move(judged);
        best_merit = 2;
      }
    }
  }
  TakeSize(best ? best->track : track);
  if (!best) {
    result_.ground = core::AbsentBecause(
        "no straight edge was found that the body stays above, and it shows no "
        "rebound; give --ground X1,Y1,X2,Y2");
    result_.contacts.first.contact.reason = "the ground is not known";
    result_.contacts.first.state.reason = "the ground is not known";
    result_.plane = std::nullopt;
    result_.track = track;
    return;
  }
  if (best_merit == 0 && camera_.ideal_ground) {
    result_.warnings.push_back(
        "ground: " + best->contacts.ground_refuted +
        (options_.ground ? "; check --ground" : "; calibrate it again"));
  }
  if (best->ground.source == calib::GroundSource::kDetected &&
      IsAtTheEnd(best->contacts.first.contact, seen)) {
    result_.warnings.emplace_back(
        "no frame shows the body after it met the line, which was found in the "
        "picture: whether that is the ground is not known; give --ground");
  }
  result_.ground = best->ground;
  result_.track = std::move(best->track);
  result_.plane = std::move(best->plane);
  result_.contacts = std::move(best->contacts);
}

// The clip compared with what the track says that it shows.
void Analyzer::MeasureExplained() {
  if (!result_.track) return;
  vision::ExplainedChangeOptions options;
  options.region = options_.region;
  options.still_frames = footage_.still_frames;
  options.threads = options_.decoder_threads;
  // Frames near the contact decide; without one the sample is even in time.
  const core::Contact& contact = result_.contacts.first.contact;
  if (contact.found && contact.frame) {
    options.frame_of_interest = contact.frame->value;
  }
  clip_->cancellation().Enter("the answer is checked");
  const auto begun = Clock::now();
  result_.explained =
      vision::MeasureExplainedChange(*clip_, *result_.track, options);
  result_.timing.check_s = Since(begun);
}

// Others move, too: powder, a shadow, or a second body. The answer stands where
// the one that was followed explains nearly all that changes.
void Analyzer::JudgeSeveralBodies() {
  // The same limit as of a clip in which one body moves: there a warning, here
  // a condition.
  const AnswerCheckLimits limits;
  constexpr double kMostElsewhere = 0.1;  // of all change
  if (result_.explained && result_.explained->near >= limits.usual_near &&
      result_.explained->elsewhere <= kMostElsewhere) {
    result_.track->several_bodies = false;
    result_.warnings.emplace_back(
        "other things move, too; the body that was followed explains nearly "
        "all that changes");
    return;
  }
  const std::string reason = "several bodies move; give --region X,Y,W,H";
  result_.warnings.push_back(reason);
  result_.contacts = {};
  result_.contacts.first.contact.reason = reason;
  result_.contacts.first.state.reason = reason;
}

// The document's `scene_model`: a reader of a report sees which effects the
// figures contain, and why the others were left out. Names are keys of the
// document.
void Analyzer::DescribeScene() {
  SceneModel& scene = result_.scene_model;
  if (!result_.track) return;
  const vision::Track& track = *result_.track;
  scene.used.push_back(track.known_background ? "static background"
                                              : "two levels of the frame");
  scene.used.push_back(
      track.body.kind == core::BodyKind::kSphere ? "circle" : "rectangle");
  scene.used.push_back("quadratic shading");
  if (track.layered) {
    scene.used.push_back(track.textured
                             ? "two layers, learned from the clip: the body's "
                               "picture is a texture"
                             : "two layers, learned from the clip");
  } else if (track.patterned) {
    scene.used.push_back("the body's own picture, which moves with it");
  }
  if (track.body.gamma) {
    scene.used.push_back(fmt::format(
        "gamma of {:.2f}, from the body's outlines", *track.body.gamma));
  }
  if (track.near_ground_modelled) {
    scene.used.push_back("the ground's edge, hidden by the body");
  } else {
    scene.left_out["outline near the ground"] =
        !result_.plane           ? "no ground line"
        : track.known_background ? "a shadow, a reflection or an uneven edge"
                                 : "the body never left its background";
  }
  if (footage_.light_spread) {
    scene.used.push_back(fmt::format("flicker of {:.1f} % taken out",
                                     100.0 * *footage_.light_spread));
  } else {
    scene.left_out["flicker"] =
        footage_.light_told
            ? "the light is steady to 1 %"
            : "most of the picture is at full scale: not to be told";
  }
  if (result_.camera_moved_px) {
    scene.used.push_back(
        fmt::format("motion of the camera of up to {:.2f} px taken out",
                    result_.camera_moved_px->value));
  } else if (footage_.motion_unexplained) {
    scene.left_out["motion of the camera"] =
        "no one shift, turn and zoom explains it";
  }
  if (result_.plane) {
    const bool known = result_.scale && !result_.contacts.gravity_refuted;
    scene.used.push_back(known ? "free flight with known gravity"
                               : "free flight with gravity fitted");
  }
  DescribeCalibration(result_.calibration, scene);
  DescribeDrag(result_);
  if (track.body.kind == core::BodyKind::kSphere) {
    if (result_.plane && vision::ShowsTurn(*result_.plane)) {
      scene.used.emplace_back("the ball's face, which turns");
    } else {
      scene.left_out["spin"] = "no mark on the sphere";
    }
  }
}

// A step that finds nothing leaves its part of the result absent with a reason;
// the steps after it run on what is there.
Analysis Analyzer::Run() {
  const std::optional<core::BodyKind> kind = DetermineKind(options_);
  result_.options_hash = OptionsHash(options_);
  result_.options = options_;
  result_.options.progress = nullptr;
  result_.options.interrupted = nullptr;
  result_.warnings = result_.clip.warnings;
  if (result_.camera_moved_px) {
    result_.warnings.push_back(fmt::format(
        "the camera moved by up to {:.1f} px: that was taken out, and pixels "
        "are those of frame {}; what is nearer or farther than most of the "
        "scene may have moved otherwise; use a tripod",
        result_.camera_moved_px->value, options_.first_frame));
  }
  if (footage_.motion_unexplained) {
    result_.warnings.push_back(
        std::string(kAllMoves) +
        ", and no one shift, turn and zoom explains it (parallax of a camera "
        "that is carried, or a rolling shutter): it was not taken out; use a "
        "tripod");
  }
  const std::int64_t last =
      options_.last_frame < 0 ? result_.clip.frames : options_.last_frame;

  // Two measured sides fix the shape even where no scale is known.
  if (options_.long_m) {
    const core::Body measured =
        core::Rectangle(*options_.long_m, *options_.short_m);
    aspect_ = Divide(*measured.short_m, *measured.long_m);
  }

  result_.calibration = camera_.calibration;
  result_.warnings.insert(result_.warnings.end(), camera_.warnings.begin(),
                          camera_.warnings.end());
  // Every frame is fitted once the ground is known; until then every few frames
  // are enough, and cost less.
  vision::TrackOptions& track_options = track_options_;
  track_options.every_frame = false;
  track_options.first = options_.first_frame;
  track_options.last = last;
  track_options.region = options_.region;
  track_options.kind = kind;
  track_options.measured = options_.diameter_m.has_value();
  track_options.size = StatedSize(options_);
  track_options.ground = camera_.image_ground;
  track_options.still_frames = footage_.still_frames;
  track_options.threads = options_.decoder_threads;
  track_options.progress = options_.progress;
  auto tracked = vision::TrackBody(*clip_, track_options);
  result_.timing.track_s = Since(footage_.begun);

  // From here on the time counts as that of contacts.
  const auto lap = Clock::now();
  if (!tracked) {
    result_.body = tl::unexpected(tracked.error());
    result_.track = tl::unexpected(tracked.error());
    result_.ground = core::AbsentBecause("no body was found");
    result_.scale = core::AbsentBecause("no body was found");
    result_.contacts.first.contact.reason = tracked.error().reason;
    result_.contacts.first.state.reason = tracked.error().reason;
  } else {
    const vision::Track& track = tracked->track;
    background_ = std::move(tracked->background);
    TakeSize(track);
    FindGroundAndContacts(track);
    AddLens(result_, camera_, contact_options_);
    AddYaw(result_, camera_, contact_options_);
    AddDrag(result_, contact_options_);
    // Warnings in the order of the steps: what a person reads first is what
    // spoils all that follows.
    const std::vector<std::string> of_track = Seen(*result_.track).warnings;
    result_.warnings.insert(result_.warnings.end(), of_track.begin(),
                            of_track.end());
    if (const auto& gamma = result_.track->body.gamma) {
      result_.warnings.push_back(fmt::format(
          "the outlines are those of a camera with a gamma of {:.2f}, not of a "
          "linear one: its levels were turned into light; state it with "
          "--gamma",
          *gamma));
    }
    result_.size_conflict =
        FindSizeConflict(Seen(*result_.track).body, options_);
    result_.warnings.insert(result_.warnings.end(),
                            result_.contacts.warnings.begin(),
                            result_.contacts.warnings.end());
    MeasureExplained();
    if (track.several_bodies) JudgeSeveralBodies();
    CheckAnswer(result_);
  }
  if (core::Contact& contact = result_.contacts.first.contact;
      footage_.motion_unexplained && !contact.found) {
    contact.reason += fmt::format("; {}", kAllMoves);
  }
  result_.angle_kind =
      options_.angle_kind
          ? *options_.angle_kind
          : core::DefaultAngleKind(result_.body ? result_.body->kind
                                                : core::BodyKind::kSphere);
  DescribeScene();
  // Nobody reads the clip from here on. To close it can take milliseconds, in
  // which the budget is described.
  result_.timing.decode_s = clip_->reading_s();
  const auto closing = std::async(
      AsyncPolicy(),
      [clip = std::move(clip_), given_back = std::move(given_back_)]() mutable {
        if (given_back.valid()) given_back.wait();
        clip.reset();
      });
  if (result_.contacts.first.contact.found) {
    DescribeBudget(result_, contact_options_);
  }
  result_.timing.contact_s = Since(lap);
  result_.timing.total_s = Since(footage_.begun);
  result_.timing.frames_per_s =
      static_cast<double>(last - options_.first_frame) / result_.timing.total_s;
  return result_;
}

// The share of all that changes in the clip that a single body explains: 1 is
// all. A body whose share was not measured has 1.
double ShareExplained(const Analysis& analysis) {
  if (!analysis.body || analysis.track->several_bodies) return 0.0;
  if (!analysis.explained) return 1.0;
  return analysis.explained->OfAll();
}

// One clip of one channel: options are checked before the first frame is
// decoded, so that a user's mistake costs no time. `motion`: the recording's,
// measured where it is not known yet. Ends by the limit with Unfinished; a
// user's interruption passes as core::Cancelled.
Analysis AnalyzeOpenClip(std::unique_ptr<vision::Clip> clip,
                         const AnalyzeOptions& options,
                         const core::Cancellation& until,
                         std::optional<vision::CameraMotion>& motion) {
  const vision::ClipInfo info = clip->info();
  CheckOptions(options, info);
  if (options.gamma) {
    clip = vision::MakeLinear(std::move(clip), *options.gamma);
  }
  clip->set_cancellation(until);
  try {
    const ClipCalibration camera = FitToClip(options, info);
    until.Enter("light and camera are looked at");
    Footage footage = MakeSteady(std::move(clip), options, motion);
    if (options.stop_early && info.format != kRawFormat) {
      return AnalyzeUntilDecided(std::move(footage), camera, options);
    }
    until.Enter("the clip is decoded");
    footage.clip = vision::KeepFrames(std::move(footage.clip),
                                      MakeKeepOptions(options, info));
    return AnalyzeFootage(std::move(footage), camera, options);
  } catch (const core::Cancelled& ended) {
    if (options.interrupted != nullptr && *options.interrupted) throw;
    throw UnfinishedAnalysis(info, options, ended.what());
  }
}

// What every loop over frames asks. Without limit, interruption and journal it
// is empty and asking costs nothing.
core::Cancellation MakeCancellation(const std::filesystem::path& path,
                                    const AnalyzeOptions& options) {
  auto on_stage = StageJournal(path);
  if (!options.limit_s && options.interrupted == nullptr && !on_stage) {
    return {};
  }
  return core::Cancellation::After(
      options.limit_s.value_or(std::numeric_limits<double>::infinity()),
      options.interrupted, std::move(on_stage));
}

}  // namespace

Unfinished::Unfinished(const std::string& what, Analysis so_far)
    : core::InputError(what),
      so_far_(std::make_shared<const Analysis>(std::move(so_far))) {}

Analysis Analyze(const std::filesystem::path& path,
                 const AnalyzeOptions& options) {
  const auto start = Clock::now();
  const core::Cancellation until = MakeCancellation(path, options);
  vision::ClipOptions clip_options;
  clip_options.fps = options.fps;
  clip_options.decoder_threads = options.decoder_threads;
  auto clip = OpenRecording(path, clip_options);
  const double open_s = Since(start);
  // A copy over a network may still run while its beginning is analysed.
  // Of a file that is read in place: whether it was whole to the end.
  const std::unique_ptr<vision::Clip> witness = clip->Another();
  // Beside the analysis, where more than one thread is allowed.
  double digest_s = 0.0;
  auto id = std::async(
      options.decoder_threads == 1 ? std::launch::deferred : std::launch::async,
      [&path, &digest_s, wanted = options.digest] {
        if (!wanted) return std::string();
        const auto begun = Clock::now();
        std::string digest = vision::ClipId(path);
        digest_s = Since(begun);
        return digest;
      });
  // Linear light has 12 or 16 bits: the document names those of the recording.
  const std::int32_t bit_depth = clip->info().bit_depth;  // of the file
  // What is known of the file and not of its frames, also where the analysis
  // was ended by its limit.
  const auto complete = [&, bit_depth](Analysis& analysis) {
    analysis.clip.bit_depth = bit_depth;
    analysis.clip_id = id.get();
    analysis.timing.digest_s = digest_s;
    analysis.simulated = HasTruthFile(path);
    analysis.timing.open_s = open_s;
    analysis.timing.total_s = Since(start);
    JournalAnalysis(analysis);
  };
  try {
    std::optional<vision::CameraMotion> motion;
    Analysis analysis =
        AnalyzeOpenClip(std::move(clip), options, until, motion);
    if (analysis.clip.has_colour) {
      // A shadow is dark in luma and has no colour: in a colour difference it
      // is not there; a ball of one colour may be all that is there. The first
      // channel that shows one body with a contact, or little else than one
      // body, is taken, or the one that does so best.
      constexpr double kStandsOut = 0.5;  // more than all else together
      for (const vision::Channel channel : {vision::Channel::kRedDifference,
                                            vision::Channel::kBlueDifference}) {
        if (analysis.contacts.first.contact.found ||
            ShareExplained(analysis) >= kStandsOut) {
          break;
        }
        vision::ClipOptions in_channel = clip_options;
        in_channel.channel = channel;
        Analysis other = AnalyzeOpenClip(OpenRecording(path, in_channel),
                                         options, until, motion);
        if (!(ShareExplained(other) > ShareExplained(analysis))) continue;
        clip_options = in_channel;
        other.channel = channel;
        other.scene_model.used.push_back(std::string(vision::Name(channel)));
        other.warnings.push_back(
            fmt::format("in luma no single body stands out; the {} was used",
                        vision::Name(channel)));
        analysis = std::move(other);
      }
    }
    if (witness) witness->RequireWhole();
    complete(analysis);
    return analysis;
  } catch (const Unfinished& unfinished) {
    Analysis so_far = unfinished.so_far();
    complete(so_far);
    throw Unfinished(unfinished.what(), std::move(so_far));
  }
}

Analysis AnalyzeFootage(Footage footage, const ClipCalibration& camera,
                        const AnalyzeOptions& options) {
  return Analyzer(std::move(footage), camera, options).Run();
}

Analysis AnalyzeClip(std::unique_ptr<vision::Clip> clip,
                     const AnalyzeOptions& options) {
  const core::Cancellation until = MakeCancellation(clip->info().path, options);
  std::optional<vision::CameraMotion> motion;
  return AnalyzeOpenClip(std::move(clip), options, until, motion);
}

}  // namespace touchdown::pipeline
