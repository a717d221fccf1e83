#include "tracking/follow_in_layers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "layers/align_pose.h"
#include "layers/disc_turn.h"
#include "layers/fit_layers.h"
#include "numbers/robust.h"
#include "outline/track_shape.h"
#include "touchdown/core/parallel.h"
#include "touchdown/vision/track/beside_body.h"
#include "track/image_size.h"
#include "tracking/fit_in_light.h"
#include "tracking/layer_evidence.h"
#include "tracking/layer_extension.h"
#include "tracking/layer_pictures.h"

namespace touchdown::vision {
namespace {

using layers::AlignPose;
using layers::FitLayers;
using layers::FitLayersOptions;
using layers::LayerFit;
using layers::LayerPose;
using layers::PictureStack;
using layers::PoseFit;
using layers::Shape;

// Of how many pictures a body is learned: a large one tells its own in fewer.
std::size_t CountPictures(const Shape& shape, std::size_t least,
                          std::size_t most) {
  // Pixels of the body, in all of them. More cost time: with 40 pictures in
  // place of 24 no errors of 82 clips became smaller. A ball of 8 px radius,
  // badly explained in a codec's clip, was lost with 24.
  constexpr double kSamples = 24e3;
  const double area = shape.disc
                          ? std::numbers::pi * shape.half_long * shape.half_long
                          : 4.0 * shape.half_long * shape.half_short;
  return static_cast<std::size_t>(std::clamp(kSamples / std::max(area, 1.0),
                                             static_cast<double>(least),
                                             static_cast<double>(most)));
}

// A body that comes nearer by more is of another size in each frame. Less is as
// often an outline that was led astray (by compression, a neighbour's edge) as
// a change of size.
constexpr double kMostGrowth = 0.02;

// Times what the normal equations leave open of the place and attitude that all
// poses share: their derivatives are to first order where layers meet, and a
// texture is no Gaussian field. Of 99 photographed scenes in two formats 0.945
// of the face angles were within 1.96 u without it, of 44 rendered balls and
// blocks with strong pictures the places had an rms of 1.9 u.
constexpr double kCommonFactor = 1.5;

// What edges that are not blurred quite as Gauss's do to all poses of a clip
// together. The errors of 198 face angles of known truth in raw clips are most
// likely with 0.001; without it the median |error| / u is 0.73 and 0.924 lie
// within 1.96 u.
constexpr double kModel_px = 0.001;

// DN over the body's reach: of shading that stays with the light.
constexpr double kShadingU_dn = 20.0;

Shape LayerShape(const BodyImage& body, const std::optional<BodySize>& size) {
  Shape shape;
  shape.disc = body.kind == core::BodyKind::kSphere;
  if (size) {
    shape.half_long = 0.5 * size->long_px.value;
    shape.half_short = 0.5 * size->short_px.value;
  } else if (shape.disc) {
    shape.half_long = body.radius_px.value;
    shape.half_short = body.radius_px.value;
  } else {
    shape.half_long = body.half_long_px.value;
    shape.half_short = body.half_short_px.value;
  }
  if (shape.disc) shape.half_short = shape.half_long;
  return shape;
}

FitLayersOptions MakeLayerOptions(const Track& track, const Shape& shape,
                                  const std::optional<BodySize>& size) {
  FitLayersOptions options;
  auto& value = options.prior.value;
  auto& u = options.prior.u;
  // px, of the first guess: a sharper one converges from nearer by only.
  constexpr double kLeastBlur = 0.7;
  // Of a frame's interval, where no blur has told one yet.
  constexpr double kUsualExposure = 0.3;
  layers::SetOptics(std::max(track.body.blur_px, kLeastBlur),
                    track.body.shutter_fraction > 0.0
                        ? track.body.shutter_fraction
                        : kUsualExposure,
                    options.prior);
  value[layers::kLong] = shape.half_long;
  value[layers::kShort] = shape.half_short;
  // px, of a half side that is stated: less would hold it where edges are not
  // of the model's shape. Not studied.
  constexpr double kLeastU = 0.02;
  constexpr double kSeenU = 1.0;  // where only the outline tells
  u[layers::kLong] = size ? std::max(0.5 * size->long_px.u, kLeastU) : kSeenU;
  u[layers::kShort] = shape.disc ? 0.0
                      : size     ? std::max(0.5 * size->short_px.u, kLeastU)
                                 : kSeenU;
  u[layers::kSlopeX] = shape.disc ? 0.0 : kShadingU_dn;
  u[layers::kSlopeY] = u[layers::kSlopeX];
  constexpr double kAnyLevel_dn = 1e4;  // as good as free
  for (std::size_t k = 0; k < layers::kTerms; ++k) {
    u[layers::kQuadratic + k] = kAnyLevel_dn;
  }
  options.turns = !shape.disc;
  return options;
}

// Poses at half the resolution and back.
LayerPose Halved(const LayerPose& pose) {
  return {0.5 * (pose.x - 0.5), 0.5 * (pose.y - 0.5), pose.angle_rad};
}
LayerPose Doubled(const LayerPose& pose) {
  return {2.0 * pose.x + 0.5, 2.0 * pose.y + 0.5, pose.angle_rad};
}

FitLayersOptions HalvedOptions(const FitLayersOptions& options) {
  FitLayersOptions half = options;
  constexpr double kHalvingsBlur = 0.3;  // of two pixels taken as one
  half.tolerance = 0.1;                  // only where to begin is wanted
  half.prior.value[layers::kBlur] =
      std::hypot(0.5 * options.prior.value[layers::kBlur], kHalvingsBlur);
  for (const std::size_t side : {layers::kLong, layers::kShort}) {
    half.prior.value[side] *= 0.5;
    half.prior.u[side] *= 0.5;
  }
  return half;
}

Pose MakePose(const PoseFit& at, const core::PixelRect& box,
              double noise_ratio) {
  Pose pose;
  pose.centre = {at.pose.x + box.x, at.pose.y + box.y};
  pose.angle_rad = at.pose.angle_rad;
  pose.u_x_px = std::sqrt(at.covariance[0][0]);
  pose.u_y_px = std::sqrt(at.covariance[1][1]);
  constexpr double kMost = 0.99;  // a covariance that can be inverted
  pose.correlation_xy = std::clamp(
      at.covariance[0][1] / (pose.u_x_px * pose.u_y_px), -kMost, kMost);
  pose.u_angle_rad = std::sqrt(std::max(at.covariance[2][2], 0.0));
  pose.misfit = std::sqrt(at.chi2) * noise_ratio;
  return pose;
}

// What a codec leaves out of a slow change along a whole edge no residual
// shows: it moves paths for tens of frames. In proportion to what the
// residuals' correlation adds to a pose's u, as a share of noise over
// steepness; the share is that of 350 clips in MJPEG and H.264 (crf 17 and 23).
double CodecDrift(const PoseFit& at, double noise_dn) {
  constexpr double kOfNoise = 0.45;  // the share
  const double steep = std::max(at.steepness[0], at.steepness[1]);
  if (at.widened <= 1.0 || steep <= 0.0) return 0.0;
  return kOfNoise * noise_dn / steep * (at.widened - 1.0);
}

// By which share the body's image changes its size over the track.
double MeasureGrowth(const Track& track) {
  const auto [least, most] = std::minmax_element(
      track.poses.begin(), track.poses.end(), [](const Pose& a, const Pose& b) {
        return a.relative_size < b.relative_size;
      });
  return most->relative_size - least->relative_size;
}

// Frames that are much worse explained than the others show something else: an
// occluder, or the body where it leaves the picture.
void DropUnexplained(std::vector<Pose>& poses) {
  // Times the median misfit. Less drops frames at the ground's edge. Not
  // studied.
  constexpr double kUsual = 2.0;
  const double most = kUsual * MedianMisfit(poses);
  std::erase_if(poses, [most](const Pose& pose) { return pose.misfit > most; });
}

// A first fit at half the resolution, from rough poses, which goes on beyond
// both ends of the path. Whether the body has a texture.
bool FitRoughly(Clip& clip, const Track& track, const Shape& shape,
                const FitLayersOptions& options, LayerEvidence& evidence) {
  FitLayersOptions coarse = HalvedOptions(options);
  // A bound on time: the fit at full resolution goes on from there.
  constexpr int kCoarseSteps = 6;
  coarse.steps = kCoarseSteps;
  // A fast ball in a film of 25 frames/s (everyday/tennis_table) still moved by
  // a pixel after six, and the frames around its blow were lost or not as the
  // last digits fell; after twelve none was, at four ends of the conjugate
  // gradients.
  coarse.steps_astray = kCoarseSteps;
  coarse.lines.clear();  // of the full resolution
  const Shape half{shape.disc, 0.5 * shape.half_long, 0.5 * shape.half_short};
  LayerPath& path = evidence.path;
  for (LayerPose& pose : path.poses) pose = Halved(pose);
  const PictureStack halved = layers::Halve(evidence.stack, options.threads);
  // Poses of the other frames are aligned with the layers of these.
  const auto chosen =
      SpreadEvenly(path.frames.size(), CountPictures(half, 32, kMostLearned));
  LayerFit fit = FitLayers(
      Choose(halved, chosen), half, Choose(path, chosen).poses,
      layers::Halve(evidence.still, evidence.box.width, evidence.box.height),
      0.5 * evidence.noise_dn, coarse);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    path.poses[chosen[i]] = fit.poses[i];
  }
  layers::AlignPoses(halved, fit.layers, options.turns, options.threads,
                     path.poses);
  fit.poses = path.poses;
  const std::size_t found = path.frames.size();
  if (clip.KnownChanges(path.frames.front()) == nullptr) {
    const LayerExtension extension(clip, evidence.box, fit, options.turns);
    extension.Extend(1, track.last_frame, path);
    extension.Extend(-1, track.first_frame - 1, path);
  }
  for (LayerPose& pose : path.poses) pose = Doubled(pose);
  if (path.frames.size() > found) {
    path = PathInBox(TrackInPicture(track, path, evidence.box), evidence.box,
                     options.turns);
    path = Choose(path, SpreadEvenly(path.frames.size(), evidence.most_frames));
    evidence.stack = ReadPath(clip, evidence.still, path, shape, evidence.box);
  }
  return !fit.layers.flat;
}

// A disc turns where its face shows it. What it shows of the light does not
// turn with it: a slope over the body, as on a block.
bool TurnWithFace(const Shape& disc, LayerEvidence& evidence,
                  FitLayersOptions& options) {
  const auto angles = layers::FindTurns(evidence.stack, disc,
                                        options.prior.value[layers::kBlur],
                                        evidence.noise_dn, evidence.path.poses);
  if (!angles) return false;
  for (std::size_t t = 0; t < angles->size(); ++t) {
    evidence.path.poses[t].angle_rad = (*angles)[t];
  }
  options.turns = true;
  options.prior.u[layers::kSlopeX] = kShadingU_dn;
  options.prior.u[layers::kSlopeY] = kShadingU_dn;
  return true;
}

// A texture costs more, and hides a block's size where it meets the outline:
// fewer pictures, which tell a texture well enough, and sides that were stated
// are held.
void PrepareForTexture(const std::optional<BodySize>& size, const Shape& shape,
                       FitLayersOptions& options, LayerEvidence& evidence) {
  options.textured = true;
  const auto chosen =
      SpreadEvenly(evidence.path.frames.size(), CountPictures(shape, 24, 40));
  if (chosen.size() < evidence.path.frames.size()) {
    evidence.path = Choose(evidence.path, chosen);
    evidence.stack = Choose(evidence.stack, chosen);
  }
  // Of a ball that is not as large as was stated nothing else would tell.
  if (size && !shape.disc) {
    options.prior.u[layers::kLong] = 0.0;
    options.prior.u[layers::kShort] = 0.0;
  }
}

// The track's body as the layers have it, and what they say of all poses.
Track WithLayers(const Track& track, const LightFit& fitted,
                 const std::optional<BodySize>& size, bool turns) {
  const LayerFit& fit = fitted.fit;
  Track out = track;
  out.poses.clear();
  out.step = 1;
  out.layered = true;
  out.textured = !fit.layers.flat;
  out.patterned = false;
  out.outlined = true;
  out.known_background = true;
  out.near_ground_modelled = true;
  out.body.blur_px = fit.layers.blur;
  out.body.shutter_fraction = fit.layers.exposure;
  const Shape& shape = fit.layers.shape;
  const double texture_px =
      kCommonFactor * std::max(fit.common.x_px, fit.common.y_px);
  const double beyond_px = size ? OutlinesBeside(fit, *size) : 0.0;
  const LayerPose& by_light = fitted.u.pose;
  out.body.u_texture_px =
      std::hypot(std::hypot(texture_px, PlaceUncertaintyBeside(beyond_px)),
                 by_light.x, by_light.y);
  out.body.u_common_px = std::hypot(kModel_px, out.body.u_texture_px);
  // Half of the sizes of raw clips of known truth were within 0.001, 0.95 of
  // them within 0.01.
  constexpr double kSizeU_px = 0.003;
  // A side that is held is as uncertain as the place of the outline.
  const auto u_side = [&](double u_px) {
    return std::hypot(kSizeU_px, kModel_px,
                      u_px > 0.0 ? kCommonFactor * u_px : texture_px);
  };
  if (turns) {
    out.body.u_common_angle_rad =
        std::hypot(kCommonFactor * fit.common.angle_rad, by_light.angle_rad,
                   std::hypot(kModel_px, PlaceUncertaintyBeside(beyond_px)) /
                       shape.half_long);
  }
  const auto side = [&](double half_px, double u_px) {
    return core::Estimate{half_px, u_side(u_px)};
  };
  if (shape.disc) {
    out.body.radius_px = side(shape.half_long, fit.common.long_px);
  } else {
    out.body.half_long_px = side(shape.half_long, fit.common.long_px);
    out.body.half_short_px = side(shape.half_short, fit.common.short_px);
  }
  out.body.gamma_long_px = fitted.u.half_long_px;
  out.body.gamma_short_px = fitted.u.half_short_px;
  return out;
}

// The contrast in light, of a body before the mean of the still picture.
double ContrastInLight(double contrast_dn, const Background& background,
                       const LightScale& scale) {
  double sum = 0.0;
  for (const float level : background.level) sum += level;
  const double behind = sum / static_cast<double>(background.level.size());
  return scale.ToLight(behind + contrast_dn) - scale.ToLight(behind);
}

// Each frame of a path with the layers held, in order, added to `out`.
void AlignFrames(Clip& clip, const LayerEvidence& evidence, const LayerFit& fit,
                 LayerPath path, const FitLayersOptions& options, Track& out) {
  const double noise_ratio = fit.layers.noise_dn / evidence.noise_dn;
  std::vector<double> drifts;
  // As many at a time as stay near the processor.
  constexpr std::size_t kAtATime = 8;
  const bool is_read = path.frames == evidence.path.frames;
  const std::size_t step = is_read ? path.frames.size() : kAtATime;
  const PictureReader reader(clip, evidence.still, fit.layers.shape,
                             evidence.box);
  PictureStack part_pictures;
  for (std::size_t from = 0; from < path.frames.size(); from += step) {
    const std::size_t to = std::min(path.frames.size(), from + step);
    LayerPath part;
    for (std::size_t t = from; t < to; ++t) {
      part.frames.push_back(path.frames[t]);
      part.poses.push_back(path.poses[t]);
    }
    if (!is_read) reader.Read(part, part_pictures);
    const PictureStack& pictures = is_read ? evidence.stack : part_pictures;
    // Where a blow lies between two learned frames, the body is not on the way
    // from one to the other, and moves otherwise.
    layers::AlignPoses(pictures, fit.layers, options.turns, options.threads,
                       part.poses);
    std::copy(part.poses.begin(), part.poses.end(),
              path.poses.begin() + static_cast<std::ptrdiff_t>(from));
    const std::vector<LayerPose> motions =
        layers::EstimateMotions(path.poses, path.frames);
    std::vector<PoseFit> aligned(part.frames.size());
    core::InParallel(static_cast<std::int64_t>(aligned.size()), options.threads,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto t = static_cast<std::size_t>(begin);
                            t < static_cast<std::size_t>(end); ++t) {
                         aligned[t] =
                             AlignPose(pictures, t, fit.layers, part.poses[t],
                                       motions[from + t], options.turns);
                       }
                     });
    for (std::size_t t = 0; t < aligned.size(); ++t) {
      if (!aligned[t].found) continue;
      drifts.push_back(CodecDrift(aligned[t], fit.layers.noise_dn));
      Pose pose = MakePose(aligned[t], evidence.box, noise_ratio);
      pose.frame = part.frames[t];
      pose.time_s = pictures.times_s[t];
      out.poses.push_back(pose);
    }
  }
  if (drifts.empty()) return;
  // Along an edge it differs: this share of it turns the body. From the clips
  // of kCommonFace (contact.cc).
  constexpr double kTurns = 0.1;
  const double drift = Median(std::move(drifts));
  BodyImage& body = out.body;
  body.u_common_px = std::hypot(body.u_common_px, drift);
  if (options.turns) {
    body.u_common_angle_rad = std::hypot(
        body.u_common_angle_rad, kTurns * drift / fit.layers.shape.half_long);
  }
}

}  // namespace

bool IsBadlyModelled(const Track& track) {
  constexpr double kExplained = 1.2;  // median misfit
  return !track.known_background || MedianMisfit(track.poses) > kExplained;
}

bool NeedsLayers(const Track& track, double most_covered) {
  return most_covered > kUntouched || IsBadlyModelled(track);
}

bool HasPlainFace(Clip& clip, const Background& background, const Track& track,
                  int threads) {
  // Median misfit. Smaller: sides of plain faces, which layers know less well;
  // larger: faces that a texture draws aside. Of 44 photographed blocks those
  // below had one error beyond 4 u, those between this and 1.2 five; rendered
  // blocks with a highlight have 0.93 to 1.02.
  constexpr double kPlain = 1.05;
  return MedianMisfit(track.poses) <= kPlain ||
         MedianMisfit(Refine(clip, background, track,
                             {.size_is_stated = true,  // none is asked of it
                              .threads = threads})
                          .poses) <= kPlain;
}

bool ShowsMarks(Clip& clip, const Background& background, const Track& track) {
  // A dozen frames show a mark somewhere else; more cost time in every clip.
  constexpr std::size_t kLookedAt = 12;
  // Times the background's variance. Smaller: bright balls, whose noise is
  // larger, are taken for marked ones, which costs time; larger: faint marks
  // are not found. Not studied.
  constexpr double kMarked = 4.0;
  if (track.body.kind != core::BodyKind::kSphere) return false;
  LayerPath path;
  for (const std::size_t i : SpreadEvenly(track.poses.size(), kLookedAt)) {
    const Pose& pose = track.poses[i];
    path.frames.push_back(pose.frame);
    path.poses.push_back({pose.centre.x_px, pose.centre.y_px, 0.0});
  }
  const Shape disc = LayerShape(track.body, std::nullopt);
  return layers::MeasureFaceChange(ReadAround(clip, path, disc), disc,
                                   track.body.blur_px, path.poses) >
         kMarked * background.UsualVariance();
}

core::Expected<Track> FollowInLayers(Clip& clip, const Background& background,
                                     const Track& given,
                                     const std::optional<BodySize>& size,
                                     int threads) {
  if (given.poses.size() < kLeastLayerPoses) {
    return core::AbsentBecause("fewer than five poses");
  }
  if (MeasureGrowth(given) > kMostGrowth) {
    return core::AbsentBecause("the body's image does not keep its size");
  }
  Track track = given;
  KeepSize(track);
  const core::Cancellation& until = clip.cancellation();
  until.Enter("the body's picture is learned");
  const Shape shape = LayerShape(track.body, size);
  FitLayersOptions options = MakeLayerOptions(track, shape, size);
  options.threads = threads;
  options.until = until;
  LayerEvidence evidence =
      GatherEvidence(clip, background, track, shape, options);
  options.lines = FindLines(background, evidence, shape,
                            options.prior.value[layers::kBlur]);
  until.Check();
  const bool textured = FitRoughly(clip, track, shape, options, evidence);
  const bool turning = shape.disc && TurnWithFace(shape, evidence, options);
  if (textured || turning) PrepareForTexture(size, shape, options, evidence);
  until.Check();
  const LightFit fitted =
      FitLevelsOrLight(clip, background, shape, std::move(evidence), options);
  until.Check();
  if (fitted.gamma) {
    track.body.gamma = fitted.gamma;
    track.body.contrast_dn =
        ContrastInLight(track.body.contrast_dn, background,
                        MakeLightScale(clip.info().bit_depth, *fitted.gamma));
  }
  const LayerFit& fit = fitted.fit;
  Track out = WithLayers(track, fitted, size, options.turns);
  // Frames between the learned ones begin where they are expected.
  const core::PixelRect& box = fitted.evidence.box;
  const Track learned =
      TrackInPicture(out, {fitted.evidence.path.frames, fit.poses}, box);
  AlignFrames(fitted.light ? *fitted.light : clip, fitted.evidence, fit,
              PathInBox(learned, box, options.turns), options, out);
  if (out.poses.size() < kLeastLayerPoses) {
    return core::AbsentBecause("too few frames show the body's picture");
  }
  DropUnexplained(out.poses);
  return out;
}

}  // namespace touchdown::vision
