// Stops an analysis once the first contact's state is decided beyond doubt.
// Frames are decoded in order, piece by piece, but for what lies between key
// frames that show nothing (FrameStoreOptions::most_between_keys), and what is
// there is analysed like a recording that ends there; an answer counts only if
// a later piece says the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "app/measure/analyze.h"
#include "app/measure/clip_calibration.h"
#include "app/measure/footage.h"
#include "touchdown/vision/detection/frame_store.h"

namespace touchdown::pipeline {

struct StopRule {
  // P(bounce) is nearer to 0 or 1 than this. 1e-6: 4.8 standard uncertainties
  // from the bounce height; one wrong stop in a million contacts, were u all
  // that is wrong.
  double most_doubt = 1e-6;

  // What u does not hold, such as a ground line that is off: a bounce is so
  // many bounce heights high.
  double least_rise = 2.0;

  // The ground found at the contact lies within so many bounce heights of the
  // line: then what u does not hold cannot change the state.
  double most_off = 0.1;

  // Frames that are decoded from the touchdown on, so that the flight after it
  // says when it was. More: touchdown and rebound are known better; fewer:
  // sooner. 48: answers are within 2 u of those of the whole flight
  // (StopEarlyTest).
  std::int64_t least_after = 48;

  // What stays down was seen for so many times as long as a body needs to rise
  // to the bounce height. 4: two whole flights.
  double least_stay = 4.0;

  // Two analyses in a row, of fewer and of more frames, agree within so many u
  // of the first about time and angles. 2: what is only noise parts them in one
  // of twenty; what was taken for something else differs by far more.
  double most_apart = 2.0;

  // Frames are decoded in so many pieces, each of at least so many frames: the
  // stop comes up to two pieces late.
  std::int64_t pieces = 32;
  std::int64_t least_piece = 16;
  // The first analysis waits until what moves has been lowest in the picture
  // least_after frames ago; until one decides, the next waits for so many times
  // as many frames that show anything: together they cost at most five times
  // the last.
  double growth = 1.25;
  // Where analyses look where so many windows are not kept (no outline fits,
  // and whole pictures are tried), decoding in pieces does not pay: all is
  // decoded. Share of the range.
  double most_decoded_again = 0.05;
  // Something moves where the strongest windows of so many frames in a row
  // overlap: noise of the compression is here and there.
  std::int64_t least_run = 8;
};

// Why an analysis of the frames up to `end` is no reason to stop, in a
// sentence; empty where it is one. `known_warnings`: so many of its warnings
// are of the file and of the calibration, and no reason.
std::string ReasonToContinue(const Analysis& analysis, std::int64_t end,
                             std::size_t known_warnings,
                             const StopRule& rule = {});

// Whether two analyses say the same of the first contact.
bool SayTheSame(const Analysis& fewer, const Analysis& more,
                const StopRule& rule = {});

// The analysis of as many frames as it needs; of all, as without the option,
// where nothing is decided before, where a frame is damaged, or where the
// pictures are too large to be kept or so few that they are kept whole. Which
// were not looked at stands in its scene model and in stopped_at. `options` fit
// the clip, which is not raw; `most_bytes` of its frames are kept
// (frame_store.h).
Analysis AnalyzeUntilDecided(
    Footage footage, const ClipCalibration& camera,
    const AnalyzeOptions& options, const StopRule& rule = {},
    std::size_t most_bytes = vision::FrameStoreOptions{}.most_bytes);

}  // namespace touchdown::pipeline
