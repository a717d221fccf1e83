// What a report shows of the recordings: the contact as it was filmed, and the
// path to it.
#pragma once

#include <cstddef>

#include "app/report/report.h"

namespace touchdown::pipeline {

// More trials than this have no strip in a report, for its size and the time
// that it takes. Pages of evidence have theirs.
inline constexpr std::size_t kMostStrips = 100;

// Fills strips, no_strip and trajectories of `input` from its trials' documents
// and recordings. However a trial was logged (analyze, batch, session, page):
// what it was judged by stands in its document. A recording that is not where
// it was, or is another by its clip.id, is a reason and not an error.
void AddPictures(report::ReportInput& input,
                 std::size_t most_strips = kMostStrips);

}  // namespace touchdown::pipeline
