#include "app/documents/replay.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "app/documents/analysis_json.h"
#include "app/documents/named_word.h"
#include "app/documents/options_json.h"
#include "app/measure/judge.h"
#include "app/text/json.h"
#include "app/text/json_fields.h"
#include "app/text/number_row.h"
#include "app/text/version.h"
#include "app/text/whole_number.h"
#include "touchdown/core/errors.h"

namespace touchdown::pipeline {
namespace {

using report::EstimateJson;
using report::Json;
using report::ReadEstimate;

// These are the columns of a row of "replay"/"track"/"rows", with blanks
// between: a line of text for each frame takes far fewer bytes than named
// fields.
constexpr const char* kColumns =
    "frame time_s x_px y_px u_x_px u_y_px correlation angle_rad u_angle_rad "
    "relative_size misfit";

// --- values that may be absent ----------------------------------------------

// What is absent is left out, and read back as absent.
void Put(Json& json, const char* name, const std::optional<double>& value) {
  if (value) json[name] = *value;
}
// Returns a field, nothing where it is absent or null. Throws Json::exception
// where it is of another type.
template <class T>
std::optional<T> Optional(const Json& json, const char* name) {
  if (!json.contains(name) || json.at(name).is_null()) return std::nullopt;
  return json.at(name).get<T>();
}

// --- track -------------------------------------------------------------------

// Writes the track in the image as it was recorded: positions to 1e-5 px,
// uncertainties to four digits, of which two are known.
Json TrackJson(const vision::Track& track) {
  const vision::BodyImage& body = track.body;
  Json json = {{"radius_px", EstimateJson(body.radius_px)},
               {"half_long_px", EstimateJson(body.half_long_px)},
               {"half_short_px", EstimateJson(body.half_short_px)},
               {"gamma_sides_px", {body.gamma_long_px, body.gamma_short_px}},
               {"whole_px", body.whole_px},
               {"blur_px", body.blur_px},
               {"contrast_dn", body.contrast_dn},
               {"shutter_fraction", body.shutter_fraction},
               {"u_common_px", body.u_common_px},
               {"u_common_angle_rad", body.u_common_angle_rad},
               {"u_texture_px", body.u_texture_px},
               {"frames", {track.first_frame, track.last_frame}},
               {"frame_interval_s", track.frame_interval_s},
               {"known_background", track.known_background},
               {"step", track.step},
               {"near_ground_modelled", track.near_ground_modelled},
               {"patterned", track.patterned},
               {"layered", track.layered},
               {"textured", track.textured},
               {"outlined", track.outlined},
               {"is_predicted", track.is_predicted},
               {"several_bodies", track.several_bodies},
               {"columns", kColumns}};
  Put(json, "gamma", body.gamma);
  Json rows = Json::array();
  for (const vision::Pose& p : track.poses) {
    report::NumberRow row;
    row.AddWhole(p.frame).AddShortest(p.time_s);
    row.AddFixed(p.centre.x_px, 5).AddFixed(p.centre.y_px, 5);
    row.AddGeneral(p.u_x_px, 4)
        .AddGeneral(p.u_y_px, 4)
        .AddGeneral(p.correlation_xy, 4);
    row.AddGeneral(p.angle_rad, 7).AddGeneral(p.u_angle_rad, 4);
    row.AddGeneral(p.relative_size, 6).AddGeneral(p.misfit, 4);
    rows.push_back(row.text());
  }
  json["rows"] = std::move(rows);
  return json;
}

// Reads it back. A field that an earlier document lacks gets the value that
// held for it.
vision::Track ReadTrack(const Json& json, core::BodyKind kind) {
  vision::Track track;
  track.body.kind = kind;
  track.body.radius_px = ReadEstimate(json.at("radius_px"));
  track.body.half_long_px = ReadEstimate(json.at("half_long_px"));
  track.body.half_short_px = ReadEstimate(json.at("half_short_px"));
  track.body.whole_px = json.at("whole_px");
  track.body.blur_px = json.at("blur_px");
  track.body.contrast_dn = json.at("contrast_dn");
  // Earlier documents have none.
  if (json.contains("gamma_sides_px")) {
    track.body.gamma_long_px = json["gamma_sides_px"].at(0);
    track.body.gamma_short_px = json["gamma_sides_px"].at(1);
  }
  track.body.u_common_px = json.value("u_common_px", 0.0);
  track.body.u_common_angle_rad = json.value("u_common_angle_rad", 0.0);
  track.body.u_texture_px = json.value("u_texture_px", track.body.u_common_px);
  track.body.shutter_fraction = json.value("shutter_fraction", 0.0);
  track.body.gamma = Optional<double>(json, "gamma");
  if (json.contains("step")) track.step = WholeNumber(json["step"], "step");
  track.near_ground_modelled = json.value("near_ground_modelled", false);
  track.patterned = json.value("patterned", false);
  track.layered = json.value("layered", false);
  track.textured = json.value("textured", false);
  track.outlined = json.value("outlined", true);
  track.first_frame = WholeNumber(json.at("frames").at(0), "frames");
  track.last_frame = WholeNumber(json.at("frames").at(1), "frames");
  track.frame_interval_s = json.at("frame_interval_s");
  track.known_background = json.at("known_background");
  track.is_predicted = json.value("is_predicted", false);
  track.several_bodies = json.at("several_bodies");
  for (const Json& row : json.at("rows")) {
    std::istringstream in(row.get<std::string>());
    // The decimal point is the document's, whatever the locale.
    in.imbue(std::locale::classic());
    vision::Pose p;
    in >> p.frame >> p.time_s >> p.centre.x_px >> p.centre.y_px >> p.u_x_px >>
        p.u_y_px >> p.correlation_xy >> p.angle_rad >> p.u_angle_rad >>
        p.relative_size >> p.misfit;
    if (!in) throw std::invalid_argument("a row of the track is damaged");
    track.poses.push_back(p);
  }
  return track;
}

// --- the rest of an analysis, from the document's own fields -----------------

// Restores what the document says of the file. The file is not opened: it may
// be gone.
vision::ClipInfo ReadClipInfo(const Json& json) {
  using enum vision::FpsSource;
  vision::ClipInfo clip;
  clip.path = json.at("path").get<std::string>();
  clip.format = json.at("format");
  clip.width_px = WholeNumber<std::int32_t>(json.at("width_px"), "width_px");
  clip.height_px = WholeNumber<std::int32_t>(json.at("height_px"), "height_px");
  clip.bit_depth = WholeNumber<std::int32_t>(json.at("bit_depth"), "bit_depth");
  clip.frames = WholeNumber(json.at("frames"), "frames");
  clip.first_camera_frame =
      WholeNumber(json.at("first_camera_frame"), "first_camera_frame");
  const Json& time = json.at("time_base");
  clip.time_base.fps = time.at("fps");
  clip.time_base.source =
      ReadNamed(time.at("source"), {kContainer, kHeader, kUser});
  clip.time_base.uniform = time.at("uniform");
  clip.time_base.trusted = time.at("trusted");
  return clip;
}

// As it was stored: there are no pixels to measure it anew.
core::Expected<vision::ExplainedChange> ReadExplained(const Json& document) {
  if (!document.contains("explained")) {
    return core::AbsentBecause("an earlier program did not compare the clip");
  }
  const Json& json = document["explained"];
  if (json.is_null()) {
    return core::AbsentBecause(
        document.at("absent").at("explained").get<std::string>());
  }
  vision::ExplainedChange explained;
  explained.near = json.at("near");
  const auto optional = [&](const char* field) {
    return json.contains(field) ? std::optional(json.at(field).get<double>())
                                : std::nullopt;
  };
  explained.seen = optional("seen");
  explained.near_as_disc = optional("near_as_disc");
  explained.elsewhere = json.at("elsewhere");
  explained.band_chi2 = json.at("band_chi2");
  explained.noise_dn = json.at("noise_dn");
  explained.frames =
      WholeNumber<std::int32_t>(json.at("frames"), "explained.frames");
  explained.lost = WholeNumber<std::int32_t>(json.at("lost_frames"),
                                             "explained.lost_frames");
  explained.pixels = WholeNumber(json.at("pixels"), "explained.pixels");
  return explained;
}

// Restores an analysis up to its track and ground line; contacts and angles are
// for Rejudge to find. Body, kind of angle, origin and clip id are the trial's,
// all else is the document's.
Analysis RestoreAnalysis(const core::Trial& trial, const Json& document) {
  using enum calib::ScaleSource;
  using enum vision::Channel;
  const Json& replay = document.at("replay");
  Analysis a;
  a.clip = ReadClipInfo(document.at("clip"));
  a.channel = ReadNamed(document["clip"].at("channel"),
                        {kLuma, kBlueDifference, kRedDifference});
  a.clip_id = trial.clip.id;
  a.simulated = trial.origin == core::Origin::kSimulated;
  a.options = ReadOptions(replay.at("options"));
  if (replay.contains("sensor_origin")) {
    const Json& corner = replay["sensor_origin"];
    a.clip.sensor_origin = vision::SensorOrigin{
        WholeNumber<std::int32_t>(corner.at(0), "sensor_origin"),
        WholeNumber<std::int32_t>(corner.at(1), "sensor_origin")};
  }
  if (const Json& scale = document.at("scale"); !scale.is_null()) {
    a.scale = calib::Scale{
        ReadEstimate(scale.at("px_per_m")),
        ReadNamed(scale.at("source"), {kUser, kCalibration, kBodySize})};
  } else {
    a.scale = core::AbsentBecause(document.at("absent").at("scale"));
  }
  if (replay.contains("ground")) {
    a.ground = ReadGroundLine(replay["ground"]);
  } else {
    a.ground = core::AbsentBecause(document.at("absent").at("ground"));
  }
  a.body = trial.body;
  a.angle_kind = trial.angle_kind;
  a.track = ReadTrack(replay.at("track"), trial.body.kind);
  a.scene_model.used =
      document.at("scene_model").at("used").get<std::vector<std::string>>();
  a.scene_model.left_out = document["scene_model"]
                               .at("left_out")
                               .get<std::map<std::string, std::string>>();
  a.warnings = document.at("warnings").get<std::vector<std::string>>();
  if (document.contains("stopped_at_frame")) {
    a.stopped_at =
        WholeNumber(document["stopped_at_frame"], "stopped_at_frame");
  }
  if (document.contains("camera_moved_px")) {
    a.camera_moved_px = ReadEstimate(document["camera_moved_px"]);
  }
  a.explained = ReadExplained(document);
  if (a.explained) {
    a.outlines_corrected =
        document["explained"].value("outlines_corrected", false);
  }
  if (document.contains("corrections")) {
    a.corrections = document["corrections"].get<std::vector<std::string>>();
  }
  return a;
}

}  // namespace

Json ReplayJson(const Analysis& analysis) {
  Json json = {{"options", OptionsJson(analysis.options)}};
  if (const auto& corner = analysis.clip.sensor_origin) {
    json["sensor_origin"] = {corner->x_px, corner->y_px};
  }
  if (analysis.ground) json["ground"] = GroundLineJson(*analysis.ground);
  if (analysis.track) json["track"] = TrackJson(*analysis.track);
  return json;
}

core::Trial ToTrial(const Analysis& analysis) {
  core::Trial trial;
  trial.origin =
      analysis.simulated ? core::Origin::kSimulated : core::Origin::kRecorded;
  trial.clip.path = analysis.clip.path.string();
  trial.clip.id = analysis.clip_id;
  if (analysis.body) trial.body = *analysis.body;
  trial.angle_kind = analysis.angle_kind;
  trial.first = analysis.contacts.first;
  trial.later = analysis.contacts.later;
  trial.author = "touchdown";
  trial.software_version = std::string(Version());
  trial.options_hash = analysis.options_hash;
  trial.document_json = ToJson(analysis);
  return trial;
}

core::Expected<Analysis> Replay(const core::Trial& trial) {
  if (trial.document_json.empty()) {
    return core::AbsentBecause("the trial was logged by hand");
  }
  try {
    const Json document = Json::parse(trial.document_json);
    if (!document.contains("replay")) {
      return core::AbsentBecause(
          "an earlier program analysed it and kept no track; analyse the clip "
          "again");
    }
    // What cannot be judged again is told with its cause, so that the page can
    // say why a trial has no outlines.
    if (!document["replay"].contains("track")) {
      return core::AbsentBecause("the analysis saw no body");
    }
    Analysis analysis = RestoreAnalysis(trial, document);
    if (analysis.track->several_bodies) {
      return core::AbsentBecause("several bodies move in it");
    }
    // Without a line there is nothing to judge; the track can still be shown.
    if (!analysis.ground) return analysis;
    // The correction is empty: the stored track is judged as it is, by the code
    // of this program.
    return Rejudge(std::move(analysis), {});
  } catch (const Json::exception& error) {
    return core::AbsentBecause(
        fmt::format("its document cannot be read: {}", error.what()));
  } catch (const std::invalid_argument& error) {
    return core::AbsentBecause(
        fmt::format("its document cannot be read: {}", error.what()));
  } catch (const core::InputError& error) {
    return core::AbsentBecause(error.what());
  }
}

std::optional<AnalyzeOptions> ReadCameraOptions(const core::Trial& trial) {
  // Here a document that is damaged is one that does not say: a default is
  // better than no answer.
  const Json document = Json::parse(trial.document_json, nullptr, false);
  if (!document.is_object() || !document.contains("replay")) {
    return std::nullopt;
  }
  try {
    return ReadOptions(document["replay"].at("options"), OptionScope::kCamera);
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  } catch (const core::InputError&) {
    return std::nullopt;
  }
}

core::Trial WithAnalysis(const core::Trial& seen, const Analysis& analysis) {
  core::Trial trial = seen;
  const core::Trial judged = ToTrial(analysis);
  trial.first = judged.first;
  trial.later = judged.later;
  // Author, reason and time are the store's to set; the set-points, conditions
  // and the clip are facts of the shot.
  trial.software_version = judged.software_version;
  trial.options_hash = judged.options_hash;
  trial.document_json = judged.document_json;
  return trial;
}

}  // namespace touchdown::pipeline
