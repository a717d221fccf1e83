// From fitted outlines to a track: the body's common shape, continuous
// attitude.
#pragma once

#include <cstdint>
#include <vector>

#include "touchdown/vision/outline/outline.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

struct Fitted {
  std::int64_t frame = 0;
  double time_s = 0.0;
  OutlineFit fit;
};

// Misfit (rms residual over noise) up to which a body is what the model says;
// beyond it residuals and sizes tell of the model's faults first. Larger
// believes sizes that the model's faults make; smaller gives up good clips for
// their compression. Not studied.
inline constexpr double kWellModelled = 1.5;
// Misfit from which on a body has parts, rims or marks: bodies of one face stay
// below it, however marred by light, blur or noise (tests/accuracy/design.h).
// Of 17 such clips with a misfit beyond 1.5, templates took 3 and made two of
// them 100 times worse: hence not 1.5.
inline constexpr double kCrude = 3.0;

// Radius, or half the long side, px.
double OutlineSize(const OutlineFit& fit);

// Whether the picture tells all of a fit's pose: no u is 0, which stands for
// what nothing was seen of, such as both ends of a block before a background
// that is not known there.
bool IsMeasured(const OutlineFit& fit);

double MedianMisfit(const std::vector<Fitted>& all);
double MedianMisfit(const std::vector<Pose>& poses);

// Mean weighted by inverse variance, robustly: values off the median by more
// than four times the scatter are left out. No value weighs more than the
// typical one: a fit's own u is small where its error made the contrast large,
// which would draw the mean to one side. u from the scatter, or from the fits'
// uncertainties where that is larger.
core::Estimate RobustMean(const std::vector<double>& values,
                          const std::vector<double>& us);

// Share of an outline that is seen from which on it counts as seen wholly: what
// it shows is then not drawn aside by an edge of the picture or of an obstacle.
// Larger loses frames beside the border; smaller takes sizes from parts. Not
// studied.
inline constexpr double kWhollySeen = 0.98;

// Share of an outline that may be hidden while it still counts as free. Larger
// lets the obstacle's edge draw the body; smaller loses frames. Not studied.
inline constexpr double kMostHidden = 0.02;

// Leaves out fits that are not of this body: other size, or far worse residuals
// than usual. Where half of them see the outline free, those go, too, in which
// something hides a part of it: its edge passes for the body's.
void DropStrangers(std::vector<Fitted>& all);

// Which fits, of a free size and by frame, are of a body that something hides
// in part: it looks smaller there than in the others, never larger. All that is
// clearly so (five standard uncertainties and 1 %), and its neighbours if they
// are so by two and 0.3 %: what hides it little already draws its place to one
// side. None where fewer than eight would remain, or where it is fewer than
// three, which noise might be, or more than half; and of a body that is crudely
// modelled.
std::vector<bool> FindHidden(const std::vector<Fitted>& all);

// How much a track jumps about: the robust scatter of third differences of the
// centre over frames of equal gaps, as the standard deviation of one position,
// px; blind to any parabola. A large number where there are too few frames to
// tell.
double Roughness(const std::vector<Fitted>& all);

// Whether the outlines go anywhere: what stays within a pixel is a part of the
// scene, or a body that nothing can be said of.
bool Moves(const std::vector<Fitted>& all);

// The shape common to all frames, from those in which the outline is wholly
// seen where there are enough of them.
BodyImage EstimateShape(const std::vector<Fitted>& all, core::BodyKind kind);

// Shape and poses; `all` by frame, at least one.
void FillTrack(const std::vector<Fitted>& all, core::BodyKind kind,
               Track& track);

// A sphere that comes nearer grows: a straight line through the sizes and a
// warning, only where the change is large against its uncertainty and matters.
void FollowSize(const std::vector<Fitted>& all, Track& track);

// Directions of a side are known up to a half turn: makes them continuous.
void Unwrap(Track& track);

Pose ToPose(const Fitted& fitted);

// The outline that a pose stands for.
Outline PlaceOutline(const BodyImage& body, const Pose& pose);

}  // namespace touchdown::vision
