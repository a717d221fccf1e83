#include "app/review/recording_routes.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "app/measure/open_recording.h"
#include "app/review/answers.h"
#include "app/review/fields.h"
#include "app/review/logging.h"
#include "app/review/setup.h"
#include "app/text/format.h"
#include "app/text/json.h"
#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

using report::Json;

constexpr std::string_view kAnalyses = "/api/analyses/";

// --- what is there -----------------------------------------------------------

// Trials by the path of their recording.
std::multimap<std::string, core::Trial> TrialsByPath(const db::Store& store) {
  db::TrialFilter filter;
  filter.with_documents = false;
  std::multimap<std::string, core::Trial> out;
  for (core::Trial& trial : store.Trials(filter)) {
    std::string path = trial.clip.path;
    if (!path.empty()) out.emplace(std::move(path), std::move(trial));
  }
  return out;
}

// Returns the time of a file in whole seconds since 1970.
std::int64_t UnixSeconds(std::filesystem::file_time_type time) {
  const auto system = std::chrono::file_clock::to_sys(time);
  return std::chrono::duration_cast<std::chrono::seconds>(
             system.time_since_epoch())
      .count();
}

// Lists the recordings of one folder with the trials that each has. A folder
// that cannot be read (an unplugged disk) has `trouble` instead.
Json FolderJson(const RecordingFolders& folders, std::size_t place,
                const std::multimap<std::string, core::Trial>& trials) {
  const std::filesystem::path& folder = folders.folders()[place];
  Json json = {{"folder", folder.string()}, {"recordings", Json::array()}};
  try {
    for (const std::string& name : folders.Names(place)) {
      const std::filesystem::path path = (folder / name).lexically_normal();
      const pipeline::Extent extent = pipeline::MeasureExtent(path);
      Json known = Json::array();
      // Trials are found by path and not by id: an id costs reading the
      // recording.
      const auto [first, last] = trials.equal_range(path.string());
      for (auto trial = first; trial != last; ++trial) {
        known.push_back(
            {{"id", trial->second.id}, {"campaign", trial->second.campaign}});
      }
      Json one = {{"name", name},
                  {"is_folder", std::filesystem::is_directory(path)},
                  {"bytes", extent.bytes},
                  {"trials", std::move(known)}};
      if (extent.files > 0) one["written_s"] = UnixSeconds(extent.written);
      json["recordings"].push_back(std::move(one));
    }
  } catch (const core::InputError& error) {
    json["trouble"] = error.what();
  }
  return json;
}

// What an analysis is told of the camera, in words; null where nothing: then
// all is as each file says.
Json CameraText(const pipeline::AnalyzeOptions& camera) {
  std::vector<std::string> parts;
  if (camera.calibration) {
    const calib::Calibration& c = *camera.calibration;
    parts.push_back(fmt::format(
        "{} of {}", c.camera.empty() ? "a calibration" : c.camera, c.date));
    if (c.lens) parts.emplace_back("lens undone");
    if (c.scale) {
      parts.push_back(
          fmt::format("scale {} px/m", report::WithU(c.scale->px_per_m, 1.0)));
    }
    if (c.ground) parts.emplace_back("ground as marked");
  }
  if (camera.scale_px_per_m) {
    parts.push_back(
        fmt::format("scale {} px/m", report::WithU(*camera.scale_px_per_m, 1)));
  }
  if (camera.fps) {
    parts.push_back(fmt::format("{} frames/s", report::Plain(*camera.fps)));
  }
  if (camera.gamma) {
    parts.push_back(fmt::format("gamma {}", report::Plain(*camera.gamma)));
  }
  if (parts.empty()) return nullptr;
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Lists the campaigns with what is known of their cameras; camera is null where
// nothing is.
Json CampaignCamerasJson(const db::Store& store) {
  Json campaigns = Json::array();
  for (const core::Campaign& campaign : store.Campaigns()) {
    const auto camera = LastCamera(store, campaign.name);
    campaigns.push_back(
        {{"name", campaign.name},
         {"camera", camera ? CameraText(*camera) : Json(nullptr)}});
  }
  return campaigns;
}

// Answers GET /api/recordings. Without a store all recordings are new.
Json RecordingsJson(Desk& desk) {
  std::optional<db::Store> store;
  if (desk.HasStore()) store = desk.Open(db::OpenMode::kRead);
  std::multimap<std::string, core::Trial> trials;
  if (store) trials = TrialsByPath(*store);
  Json folders = Json::array();
  for (std::size_t i = 0; i < desk.recordings().folders().size(); ++i) {
    folders.push_back(FolderJson(desk.recordings(), i, trials));
  }
  return {{"schema", "touchdown.review.recordings/1"},
          {"store", desk.store().string()},
          {"store_missing", !store.has_value()},
          {"folders", std::move(folders)},
          {"campaigns", store ? CampaignCamerasJson(*store) : Json::array()}};
}

// --- one recording -----------------------------------------------------------

// Returns a field of the query; empty where it is not there.
std::string Asked(const Request& request, const char* field) {
  const auto found = request.query.find(field);
  return found == request.query.end() ? "" : found->second;
}

// Returns the recording of ?folder=N&name=...; Require refuses what lies
// outside of the folders.
std::filesystem::path PathAsked(Desk& desk, const Request& request) {
  const Recording recording{static_cast<std::size_t>(ParsePathNumber(
                                Asked(request, "folder"), request.path)),
                            Asked(request, "name")};
  return desk.recordings().Require(recording);
}

// The shelf opens everything with a rate of its own, so the rate is asked for
// by opening the recording once more.
Json RecordingJson(Desk& desk, const std::filesystem::path& path) {
  Json json = ClipJson(desk.shelf().Info({path}));
  try {
    const vision::TimeBase time =
        pipeline::OpenRecording(path)->info().time_base;
    json["time_base"] = {{"fps", time.fps}, {"trusted", time.trusted}};
  } catch (const core::InputError&) {
    json["time_base"] = nullptr;  // pictures tell none
  }
  return json;
}

Reply RecordingFrameReply(Desk& desk, const Request& request) {
  const auto path = PathAsked(desk, request);
  return PictureReply(desk.shelf().Frame(
      {path, AskedSteady(request)},
      ParsePathNumber(Asked(request, "frame"), request.path)));
}

// --- analyses ----------------------------------------------------------------

// Tells one analysis as the page lists it.
Json StatusJson(const AnalysisStatus& status) {
  const AnalysisOrder& order = status.order;
  return {{"id", status.id},
          {"folder", order.recording.folder},
          {"name", order.recording.name},
          {"campaign", order.campaign.name},
          {"is_test", order.is_test},
          {"who", order.who},
          {"state", Name(status.state)},
          {"frames", order.frames},
          {"frames_done", status.frames_done},
          {"ahead", status.ahead},
          {"trouble", status.trouble},
          {"trial", status.trial_id},
          {"said", status.said}};
}

Json AnalysesJson(Desk& desk) {
  Json analyses = Json::array();
  for (const AnalysisStatus& status : desk.analyses().List()) {
    analyses.push_back(StatusJson(status));
  }
  return {{"schema", "touchdown.review.analyses/1"},
          {"analyses", std::move(analyses)}};
}

// The trial that a test became.
std::string Kept(Desk& desk, const AnalysisStatus& status,
                 const nlohmann::json& asked) {
  const std::string who = RequiredText(asked, "who", "your name");
  if (!status.trial_id.empty()) return status.trial_id;  // by another tab
  std::string id = Keep(desk.store(), status, who).id;
  desk.analyses().SetTrial(status.id, id);
  return id;
}

// Queues an analysis and returns its id.
std::string QueueOrder(Desk& desk, AnalysisOrder order) {
  // What cannot be read is refused now, by whoever asked.
  order.frames = desk.shelf().Info({order.path}).frames;
  return desk.analyses().Add(std::move(order));
}

}  // namespace

std::optional<Reply> GetOfRecordings(Desk& desk, const Request& request) {
  const std::string& path = request.path;
  if (path == "/api/recordings") return JsonReply(RecordingsJson(desk));
  if (path == "/api/recordings/clip") {
    return JsonReply(RecordingJson(desk, PathAsked(desk, request)));
  }
  if (path == "/api/recordings/frame") {
    return RecordingFrameReply(desk, request);
  }
  if (path == "/api/analyses") return JsonReply(AnalysesJson(desk));
  if (path.starts_with(kAnalyses)) {
    // /api/analyses/ID
    const auto status = desk.analyses().Find(path.substr(kAnalyses.size()));
    if (!status) throw NotThere(path);
    Json json = StatusJson(*status);
    if (status->analysis) json["test"] = TestJson(*status);
    return JsonReply(json);
  }
  return std::nullopt;
}

std::optional<Reply> PostToRecordings(Desk& desk, const std::string& path,
                                      const nlohmann::json& asked) {
  if (path == "/api/analyses") {
    const std::string id =
        QueueOrder(desk, ReadOrder(desk.store(), desk.recordings(), asked));
    return JsonReply({{"id", id}});
  }
  if (path == "/api/tests") {
    return JsonReply({{"id", QueueOrder(desk, ReadTestOrder(desk, asked))}});
  }
  if (path == "/api/lens") {
    return JsonReply(LensJson(desk.recordings(), asked));
  }
  if (!path.starts_with(kAnalyses)) return std::nullopt;
  // /api/analyses/ID/cancel and /api/analyses/ID/keep
  const std::string rest = path.substr(kAnalyses.size());
  const std::size_t slash = rest.find('/');
  const std::string id = rest.substr(0, slash);
  const std::string what =
      slash == std::string::npos ? "" : rest.substr(slash + 1);
  if (what == "cancel" && desk.analyses().Cancel(id)) {
    return JsonReply(Json::object());
  }
  if (const auto status = desk.analyses().Find(id);
      status && what == "keep" && status->order.is_test) {
    return JsonReply({{"id", Kept(desk, *status, asked)}});
  }
  throw NotThere(path);
}

}  // namespace touchdown::review
