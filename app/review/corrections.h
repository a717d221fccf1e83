// What a person changes about a trial: shown before it is stored, and stored as
// a revision of the one the person looked at.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

#include "touchdown/core/trial.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

// Somebody else revised the trial since the person looked.
class Conflict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The trial as it would be, and what is drawn of it. `asked` is
//   {"ground_px": [x1, y1, x2, y2], "contact_frame": n, "moved": {"n": [dx,
//    dy]}, "left_out": [n, ...], "state": word, "note": text}
// each of them optional. Throws std::invalid_argument naming the field;
// pipeline::FieldError for state and note.
nlohmann::ordered_json PreviewJson(const core::Trial& seen,
                                   const nlohmann::json& asked);

// Stores it. Besides the fields above: "revision" (the one the person looked
// at), "who" and "why", and instead of a correction "exclude": true, "include":
// true, or "restore": n (states again what revision n stated). Throws Conflict
// where the trial's last revision is another.
db::Logged Revise(db::Store& store, const std::string& id,
                  const nlohmann::json& asked);

}  // namespace touchdown::review
