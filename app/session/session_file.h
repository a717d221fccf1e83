// What a session leaves beside its store, lab.db.session.json: what the next
// shot is to be, for the session that goes on after an interruption. Trials are
// in the store alone; a lost or damaged file costs the set-points of the shot
// that was waited for, and no trial.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace touchdown::session {

// What a session waits for or does.
enum class Phase {
  kConventions,  // for a person to accept the campaign's conventions
  kCheck,        // for a recording of the check shot
  kShot,         // for a recording of the planned shot
  kAnalysing,    // for the analysis of a recording
  kEnded         // nobody is there
};
std::string_view Name(Phase phase);

struct SessionFile {
  std::string campaign;
  std::string operator_name;
  Phase phase = Phase::kConventions;

  // The planned shot. It was shown at `planned_at_s` (seconds since 1970), when
  // the campaign had `trials_before` trials: what is recorded later, and is the
  // next, was thrown so.
  bool planned = false;
  std::size_t trials_before = 0;
  double planned_at_s = 0.0;
  double angle_rad = 0.0;
  bool is_check = false;              // it is a check shot
  nlohmann::ordered_json set_points;  // SetPointsJson()

  nlohmann::ordered_json last;  // trial: its id; null before the first
};

// FILE.session.json
std::filesystem::path SessionPath(const std::filesystem::path& store);

// touchdown.session/1; appears whole. Throws core::OutputError.
void WriteSession(const std::filesystem::path& store,
                  const SessionFile& session);
// Nothing where there is none, or it cannot be understood.
std::optional<SessionFile> ReadSession(const std::filesystem::path& store);

// One session for each store: held until this goes, or the process ends however
// it ends. Throws core::StoreError where another session has it.
class SessionLock {
 public:
  explicit SessionLock(const std::filesystem::path& store);
  ~SessionLock();
  SessionLock(const SessionLock&) = delete;
  SessionLock& operator=(const SessionLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace touchdown::session
