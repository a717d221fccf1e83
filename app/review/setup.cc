#include "app/review/setup.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/documents/analysis_json.h"
#include "app/documents/log_analysis.h"
#include "app/documents/pictures.h"
#include "app/documents/replay.h"
#include "app/measure/board_pictures.h"
#include "app/measure/judge.h"
#include "app/measure/new_calibration.h"
#include "app/review/fields.h"
#include "app/review/trial_view.h"
#include "app/text/dates.h"
#include "app/text/format.h"
#include "app/text/json.h"
#include "app/trials/campaign_entry.h"
#include "app/trials/statement.h"
#include "app/trials/typed_values.h"
#include "touchdown/calib/references.h"
#include "touchdown/core/units.h"

namespace touchdown::review {
namespace {

using pipeline::FieldError;
using report::Json;

// Returns an object inside what the page sends. Throws FieldError.
const nlohmann::json& Part(const nlohmann::json& asked, const char* name) {
  const auto part = asked.find(name);
  if (part == asked.end() || !part->is_object()) {
    throw FieldError(name, "is missing");
  }
  return *part;
}

// Makes the campaign as `touchdown campaign new` does, from the same fields.
// Throws FieldError, and std::invalid_argument where the store would refuse it:
// that is better known before the test than after it.
core::Campaign MakeCampaign(const nlohmann::json& asked) {
  pipeline::CampaignEntry entry;
  entry.name = RequiredText(asked, "name", "a name for the campaign");
  entry.body.kind = ReadTextField(asked, "body");
  // Without the size there is no scale of it, and nothing to check it by.
  entry.body.diameter_mm = ReadTextField(asked, "diameter_mm");
  entry.body.sides_mm = ReadTextField(asked, "sides_mm");
  if (entry.body.diameter_mm.empty() && entry.body.sides_mm.empty()) {
    const bool is_block = entry.body.kind == "rectangle";
    throw FieldError(is_block ? "sides-mm" : "diameter-mm",
                     is_block ? "is missing, must be like 60x20"
                              : "is missing, must be like 40 or 40+-0.02");
  }
  entry.surface = ReadTextField(asked, "surface");
  entry.angle_kind = ReadTextField(asked, "angle_kind");
  entry.bounce_height_mm = ReadNumberField(asked, "bounce_height_mm");
  entry.speed_mps = ReadTextField(asked, "speed_mps");
  entry.theory = ReadTextField(asked, "theory");
  entry.theory_boundary_deg = ReadNumberField(asked, "theory_boundary_deg");
  entry.theory_u_deg = ReadNumberField(asked, "theory_u_deg");
  entry.margin_deg =
      ReadNumberField(asked, "margin_deg").value_or(entry.margin_deg);
  core::Campaign campaign = pipeline::MakeCampaign(entry);
  db::RequireStorable(campaign);
  return campaign;
}

// Two points of the picture; nothing where they were not marked.
std::optional<calib::MarkedPair> ReadPair(const nlohmann::json& asked,
                                          const char* field) {
  const auto points = ReadTwoPoints(asked, field);
  if (!points) return std::nullopt;
  const calib::MarkedPair pair{points->first, points->second,
                               pipeline::kByHand_px};
  if (pair.p1 == pair.p2) {
    throw std::invalid_argument(
        fmt::format("{}: both points are the same, must be two", field));
  }
  return pair;
}

// Returns size of the picture and, where the file says it, its place on the
// sensor: a calibration fits one window of a camera.
calib::Picture DescribePicture(const vision::ClipInfo& clip) {
  calib::Picture picture{clip.width_px, clip.height_px, std::nullopt};
  if (const auto& corner = clip.sensor_origin) {
    picture.corner = calib::SensorCorner{corner->x_px, corner->y_px};
  }
  return picture;
}

// Makes the options of the camera from what was marked on the recording. Where
// nothing was marked there is no calibration, and all is found in the clip.
pipeline::AnalyzeOptions ReadCameraOptions(const nlohmann::json& asked,
                                           const vision::ClipInfo& clip) {
  pipeline::AnalyzeOptions options;
  options.fps = ReadNumberField(asked, "fps");
  // A lens of other pictures (another size, another window) is refused; one
  // that fits brings its calibration, to which scale and ground are added.
  const std::string camera = ReadTextField(asked, "camera");
  calib::Calibration calibration =
      pipeline::NewCalibration(camera, DescribePicture(clip));
  if (const auto lens = asked.find("lens");
      lens != asked.end() && !lens->is_null()) {
    auto fitted = calib::AdaptToPicture(
        calib::ParseCalibration(lens->dump(), "the lens of the page"),
        DescribePicture(clip));
    if (!fitted) {
      throw FieldError("pictures", "gave a lens of other pictures: " +
                                       fitted.error().reason);
    }
    calibration = *std::move(fitted);
    if (!camera.empty()) calibration.camera = camera;
  }
  // The scale is measured in the undistorted picture where there is a lens.
  std::optional<calib::Lens> lens;
  if (calibration.lens) lens = calibration.lens->lens;
  const auto scale = ReadPair(asked, "scale_px");
  const std::string length = ReadTextField(asked, "length_mm");
  if (scale) {
    if (length.empty()) {
      throw FieldError("length-mm",
                       "is missing, must be the distance of the two points");
    }
    calibration.scale = calib::MeasureScale(
        *scale,
        pipeline::ParseEstimateField("length-mm", length, core::kMillimetre,
                                     pipeline::kPlainSize),
        lens);
  } else if (!length.empty()) {
    throw FieldError("length-mm",
                     "is given, but its two points are not marked");
  }
  // The line is kept as it was clicked, in the recorded picture.
  if (const auto ground = ReadPair(asked, "ground_px")) {
    calibration.ground = calib::GroundRecord{
        ground->p1, ground->p2, ground->u_point_px, std::nullopt, std::nullopt};
  }
  if (calibration.lens || calibration.scale || calibration.ground) {
    options.calibration = std::move(calibration);
    // The day is asked for because a calibration has an age.
    options.today = pipeline::Today();
  }
  return options;
}

// A campaign's conventions are fixed by its first trial.
void RequireWithoutTrials(const db::Store& store, const std::string& name) {
  db::TrialFilter filter;
  filter.campaign = name;
  filter.with_documents = false;
  if (store.Trials(filter).empty()) return;
  throw FieldError("name", fmt::format("is '{}', a campaign that has trials "
                                       "already; give another name",
                                       name));
}

// --- the answer --------------------------------------------------------------

// Tells what the analysis used of the camera and where it came from, so that a
// person sees whether a mark was taken or something else was found.
Json SettingsJson(const pipeline::Analysis& analysis) {
  const auto source = [](const auto& part) {
    return part ? std::string(calib::Name(part->source))
                : "none: " + part.error().reason;
  };
  return {{"fps", analysis.clip.time_base.fps},
          {"fps_trusted", analysis.clip.time_base.trusted},
          {"scale",
           analysis.scale
               ? Json(report::WithU(analysis.scale->px_per_m, 1.0) + " px/m")
               : Json(nullptr)},
          {"scale_source", source(analysis.scale)},
          {"ground_source", source(analysis.ground)}};
}

}  // namespace

AnalysisOrder ReadTestOrder(Desk& desk, const nlohmann::json& asked) {
  AnalysisOrder order;
  order.is_test = true;
  order.recording = ReadRecording(Part(asked, "recording"));
  order.path = desk.recordings().Require(order.recording);
  order.campaign = MakeCampaign(Part(asked, "campaign"));
  if (desk.HasStore()) {
    RequireWithoutTrials(desk.Open(db::OpenMode::kRead), order.campaign.name);
  }
  // The shelf has looked at the recording already: the person marked points on
  // it.
  order.camera =
      ReadCameraOptions(Part(asked, "camera"), desk.shelf().Info({order.path}));
  return order;
}

Json LensJson(const RecordingFolders& folders, const nlohmann::json& asked) {
  const auto pictures =
      folders.RequirePictures(ReadRecording(Part(asked, "pictures")));
  const std::string typed =
      RequiredText(asked, "board", "like chessboard:9x6:25mm");
  calib::Board board;
  // ParseBoard speaks of a flag; the page wants the field.
  try {
    board = calib::ParseBoard(typed);
  } catch (const std::invalid_argument& error) {
    throw FieldError("board",
                     fmt::format("is not understood: {}", error.what()));
  }
  const pipeline::BoardPictures found = pipeline::FindBoards(pictures, board);
  const calib::LensCalibration lens =
      pipeline::CalibrateBoardLens(found, board);
  calib::Calibration file =
      pipeline::NewCalibration(ReadTextField(asked, "camera"), found.picture);
  // The page gets the whole calibration and sends it back with the test: the
  // server keeps nothing between the two.
  file.lens = pipeline::MakeLensRecord(lens, board);
  return {
      {"schema", "touchdown.review.lens/1"},
      {"views", found.views.size()},
      {"without_board", found.without},
      {"rms_px", lens.rms_px},
      {"bends_px", calib::LargestDisplacement(lens.lens, found.picture.width_px,
                                              found.picture.height_px)},
      {"coverage", lens.coverage},
      {"warnings", lens.warnings},
      {"calibration", Json::parse(calib::CalibrationText(file))}};
}

Json TestJson(const AnalysisStatus& status) {
  Json json = {{"schema", "touchdown.review.test/1"}};
  if (!status.analysis) return json;
  const pipeline::Analysis& analysis = *status.analysis;
  // The numbers and pictures are those of a stored trial, so that a person
  // judges the test by what the trial will show.
  json["numbers"] = NumbersJson(pipeline::ToTrial(analysis));
  json["view"] = analysis.track
                     ? ViewJson(analysis)
                     : Json{{"absent", analysis.track.error().reason}};
  json["warnings"] = analysis.warnings;
  json["settings"] = SettingsJson(analysis);
  json["checks"] = pipeline::ChecksJson(analysis);
  return json;
}

db::Logged Keep(const std::filesystem::path& store,
                const AnalysisStatus& status, const std::string& who) {
  if (!status.analysis) {
    throw std::invalid_argument(
        "there is nothing to keep: the analysis is not done");
  }
  const core::Campaign& campaign = status.order.campaign;
  // The clip is read before the store is opened: what cannot be read makes
  // none.
  core::Trial trial = pipeline::LoggableTrial(*status.analysis, &campaign);
  trial.reason = "logged on the review page by " + who;
  db::Store open = db::Store::Open(store, db::OpenMode::kCreate);
  // A campaign without trials may have been made before, by hand or by an
  // earlier try; its conventions are still free.
  if (open.FindCampaign(campaign.name)) {
    RequireWithoutTrials(open, campaign.name);
    open.ChangeCampaign(campaign);
  } else {
    open.AddCampaign(campaign);
  }
  db::Logged logged = open.LogTrial(trial);
  pipeline::KeepPicture(store, trial);
  return logged;
}

}  // namespace touchdown::review
