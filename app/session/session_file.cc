#include "app/session/session_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <utility>

#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/identity.h"

namespace touchdown::session {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kSchema = "touchdown.session/1";

// All phases are listed here, so that one can be found by its name.
constexpr std::array kPhases = {Phase::kConventions, Phase::kCheck,
                                Phase::kShot, Phase::kAnalysing, Phase::kEnded};

// Returns the name of the store with `extension` appended:
// "lab.db.session.json". The store's own extension stays, so that two stores
// never share a file.
fs::path SiblingPath(const fs::path& store, const char* extension) {
  fs::path path = store;
  path += extension;
  return path;
}

}  // namespace

std::string_view Name(Phase phase) {
  switch (phase) {
    case Phase::kConventions:
      return "conventions";
    case Phase::kCheck:
      return "check";
    case Phase::kShot:
      return "shot";
    case Phase::kAnalysing:
      return "analysing";
    case Phase::kEnded:
      break;
  }
  return "ended";
}

fs::path SessionPath(const fs::path& store) {
  return SiblingPath(store, ".session.json");
}

void WriteSession(const fs::path& store, const SessionFile& session) {
  ordered_json out;
  out["schema"] = kSchema;
  out["campaign"] = session.campaign;
  out["operator"] = session.operator_name;
  out["phase"] = Name(session.phase);
  // The angle stands twice: in degrees for people and other programs, and in
  // radians so that it is read back as the same number.
  out["shot"] = ordered_json();
  if (session.planned) {
    out["shot"] = {{"trials_before", session.trials_before},
                   {"planned_at_s", session.planned_at_s},
                   {"is_check", session.is_check},
                   {"angle_deg", session.angle_rad / core::kDegree},
                   {"angle_rad", session.angle_rad},
                   {"set_points", session.set_points}};
  }
  out["last"] = session.last;
  out["written_at_utc"] = db::UtcStamp(std::chrono::system_clock::now());
  // A file's name need not be UTF-8.
  report::WriteTextFile(
      SessionPath(store),
      out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

std::optional<SessionFile> ReadSession(const fs::path& store) {
  // A missing file parses as nothing, like a damaged one. The session plans
  // set_points anew from the angle.
  std::ifstream in(SessionPath(store), std::ios::binary);
  const auto document = ordered_json::parse(in, nullptr, false);
  try {
    if (!document.is_object() || document.at("schema") != kSchema) {
      return std::nullopt;
    }
    SessionFile out;
    out.campaign = document.at("campaign");
    out.operator_name = document.at("operator");
    const std::string phase = document.at("phase");
    const auto known =
        std::ranges::find(kPhases, phase, [](Phase one) { return Name(one); });
    if (known == kPhases.end()) return std::nullopt;
    out.phase = *known;
    const auto& shot = document.at("shot");
    if (shot.is_object()) {
      out.planned = true;
      out.trials_before = shot.at("trials_before");
      out.planned_at_s = shot.at("planned_at_s");
      out.is_check = shot.at("is_check");
      out.angle_rad = shot.at("angle_rad");
      out.set_points = shot.at("set_points");
    }
    out.last = document.at("last");
    return out;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // as if it were not there
  }
}

SessionLock::SessionLock(const fs::path& store) {
  const fs::path path = SiblingPath(store, ".session.lock");
  // The file stays when the lock goes: removing it would let two sessions hold
  // locks on two files of one name. O_CLOEXEC keeps a child from holding the
  // lock on.
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) {
    throw core::StoreError(fmt::format("{}: cannot be made: {}", path.string(),
                                       std::strerror(errno)));
  }
  // The kernel lets go of the lock when the process ends, however it ends; so
  // no lock is left over from a crash.
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    close(file_);
    throw core::StoreError(
        fmt::format("{}: another session logs into this store; end it first",
                    store.string()));
  }
}

SessionLock::~SessionLock() { close(file_); }

}  // namespace touchdown::session
