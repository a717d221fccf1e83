// What the page asks of recordings that no trial is of yet, and of analyses.
//
//   GET  /api/recordings           touchdown.review.recordings/1: the folders,
//                                  the recordings in them with their trials,
//                                  and what is known of the camera of each
//                                  campaign
//   GET  /api/recordings/clip      size, frames, frame rate; ?folder=N&name=...
//   GET  /api/recordings/frame     a picture; ?folder=N&name=...&frame=N
//   GET  /api/analyses             touchdown.review.analyses/1
//   POST /api/analyses             a recording analysed and logged (logging.h)
//   GET  /api/analyses/ID          one of them; of a test its answer (setup.h)
//   POST /api/analyses/ID/cancel
//   POST /api/tests                settings of a new campaign tested (setup.h)
//   POST /api/lens                 a lens from pictures of a board (setup.h)
//   POST /api/analyses/ID/keep     the campaign made and its first trial
//                                  logged; {"who"}
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/review/desk.h"
#include "app/review/message.h"

namespace touchdown::review {

// Nothing where the path is none of these. They throw as routes.h says.
std::optional<Reply> GetOfRecordings(Desk& desk, const Request& request);
std::optional<Reply> PostToRecordings(Desk& desk, const std::string& path,
                                      const nlohmann::json& asked);

}  // namespace touchdown::review
