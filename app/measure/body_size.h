// The body's size and the scale: what a person told, and what the image tells
// of the rest.
#pragma once

#include <optional>

#include "app/measure/analyze.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/body.h"
#include "touchdown/core/estimate.h"
#include "touchdown/vision/track/track.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::pipeline {

// a / b, with u of both to first order.
core::Estimate Divide(const core::Estimate& a, const core::Estimate& b);

// What is stated is a measurement, too: the track with the size that image and
// statement tell together (core::Combined), where a scale that does not come of
// the body itself makes them comparable. Where they contradict each other by
// more than 4 of their u, outlines lie beside the body: place and angle may be
// off together by what that may do to them, and their common u say so. `seen`:
// in the ideal picture.
vision::Track WithStatedSize(vision::Track seen, const AnalyzeOptions& options);

// Where image and statement differ by more than 4 of their u: both, what would
// explain it, and the largest difference over the stated size. Nothing where
// they agree or cannot be compared.
std::optional<SizeConflict> FindSizeConflict(const vision::BodyImage& seen,
                                             const AnalyzeOptions& options);

// Pixels per metre: given, calibrated, or from the body's known size; absent
// where none of them is there. `image`: of the body in the ideal picture.
core::Expected<calib::Scale> FindScale(const AnalyzeOptions& options,
                                       const vision::BodyImage& image);

// The body's size in the picture, where both its sides and a scale of their own
// are told; else nothing.
std::optional<vision::BodySize> StatedSize(const AnalyzeOptions& options);

// The body's size: as given, or from the image and the scale.
core::Body DetermineBody(const AnalyzeOptions& options,
                         const vision::BodyImage& image,
                         const core::Expected<calib::Scale>& scale);

}  // namespace touchdown::pipeline
