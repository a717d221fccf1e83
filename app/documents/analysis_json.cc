// The touchdown.analysis/1 document. Names are a contract: add fields, never
// rename. An absent number is null, and its reason stands under "absent".
#include "app/documents/analysis_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/documents/replay.h"
#include "app/measure/analyze.h"
#include "app/measure/judge.h"
#include "app/text/json.h"
#include "app/text/json_fields.h"
#include "app/text/number_row.h"
#include "app/text/version.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using report::EstimateJson;
using report::Json;

// These factors bring SI, which the analysis holds, to the units in the names
// of the fields.
constexpr double kToDegrees = 1.0 / core::kDegree;
constexpr double kToMillimetres = 1.0 / core::kMillimetre;

// Writes numbers, and collects why some are missing.
class Writer {
 public:
  // Returns {"value", "u"} in SI times `factor`, or null; then the reason is
  // noted under `path`, the dotted name by which "absent" lists the field.
  Json Number(const std::string& path, const core::Measured& m,
              double factor = 1.0) {
    if (!m) return Missing(path, m.error().reason);
    return EstimateJson(*m, factor);
  }
  Json Missing(const std::string& path, const std::string& reason) {
    absent_[path] = reason;
    return nullptr;
  }
  // Hands over all reasons; it must be called last.
  Json TakeAbsent() { return std::move(absent_); }

 private:
  Json absent_ = Json::object();
};

// Lists the uncertainty budget of the contact angle: radius and face angle
// share one, that of the attitude. [{"source": "localisation", "u_deg": 0.01},
// ...]
Json BudgetField(const core::Contact& contact, core::AngleKind kind) {
  const core::Budget& budget = kind == core::AngleKind::kApproach
                                   ? contact.approach_budget
                                   : contact.attitude_budget;
  Json json = Json::array();
  for (const core::BudgetLine& line : budget) {
    json.push_back({{"source", line.source}, {"u_deg", line.u * kToDegrees}});
  }
  return json;
}

// Writes one touchdown. `at` is where it stands ("contact." or
// "later_contacts[0].contact."), for the reasons of what is absent.
Json ContactField(Writer& writer, const std::string& at,
                  const core::Contact& contact, core::AngleKind kind) {
  Json json;
  json["found"] = contact.found;
  if (!contact.found) json["reason"] = contact.reason;
  json["from_start"] = contact.from_start;
  json["time_s"] = writer.Number(at + "time_s", contact.time_s);
  // By the contract of the document `frame` is a bare number and not {value,
  // u}; its u stands beside it.
  if (contact.frame) {
    json["frame"] = contact.frame->value;
    json["u_frame"] = contact.frame->u;
  } else {
    json["frame"] = writer.Missing(at + "frame", contact.frame.error().reason);
  }
  json["angle_kind"] = Name(kind);
  json["angle_deg"] = writer.Number(
      at + "angle_deg", core::ContactAngle(contact, kind), kToDegrees);
  json["approach_angle_deg"] = writer.Number(
      at + "approach_angle_deg", contact.approach_angle_rad, kToDegrees);
  json["radius_angle_deg"] = writer.Number(
      at + "radius_angle_deg", contact.radius_angle_rad, kToDegrees);
  json["face_angle_deg"] =
      writer.Number(at + "face_angle_deg", contact.face_angle_rad, kToDegrees);
  if (contact.corner) {
    json["corner"] = Name(*contact.corner);
  } else {
    // What leaves the face angle open leaves the corner open, too.
    json["corner"] = writer.Missing(at + "corner",
                                    contact.found && !contact.face_angle_rad
                                        ? contact.face_angle_rad.error().reason
                                        : contact.reason);
  }
  json["duration_s"] = writer.Number(at + "duration_s", contact.duration_s);
  json["budget"] = BudgetField(contact, kind);
  return json;
}

// Writes the motion state with its evidence. Bounce height and detectable gap
// are bare numbers in mm: a convention and a limit have no u.
Json StateField(Writer& writer, const std::string& at,
                const core::StateDecision& state) {
  Json json;
  json["label"] = Name(state.label);
  if (state.p_bounce) {
    json["p_bounce"] = *state.p_bounce;
  } else {
    json["p_bounce"] = writer.Missing(at + "p_bounce", state.reason);
  }
  json["reason"] = state.reason;
  json["max_gap_mm"] =
      writer.Number(at + "max_gap_mm", state.max_gap_m, kToMillimetres);
  if (state.bounce_height_m) {
    json["bounce_height_mm"] = state.bounce_height_m->value * kToMillimetres;
  } else {
    json["bounce_height_mm"] = writer.Missing(
        at + "bounce_height_mm", state.bounce_height_m.error().reason);
  }
  if (state.detectable_gap_m) {
    json["detectable_gap_mm"] = state.detectable_gap_m->value * kToMillimetres;
  } else {
    json["detectable_gap_mm"] = writer.Missing(
        at + "detectable_gap_mm", state.detectable_gap_m.error().reason);
  }
  json["extrapolated_gap_mm"] = writer.Number(
      at + "extrapolated_gap_mm", state.extrapolated_gap_m, kToMillimetres);
  json["micro_bounce"] = state.micro_bounce;
  return json;
}

// Writes the velocities before and after in m/s and rad/s, of the plane frame,
// and the ratios that follow from them.
Json MotionField(Writer& writer, const std::string& at, const core::Motion& m) {
  const auto number = [&](const char* name, const core::Measured& value) {
    return writer.Number(at + name, value);
  };
  Json json;
  json["before"] = {
      {"speed_mps", number("before.speed_mps", m.before_speed_mps)},
      {"normal_mps", number("before.normal_mps", m.before_normal_mps)},
      {"tangential_mps",
       number("before.tangential_mps", m.before_tangential_mps)},
      {"omega_rad_per_s",
       number("before.omega_rad_per_s", m.before_omega_rad_per_s)}};
  json["after"] = {
      {"normal_mps", number("after.normal_mps", m.after_normal_mps)},
      {"tangential_mps",
       number("after.tangential_mps", m.after_tangential_mps)},
      {"omega_rad_per_s",
       number("after.omega_rad_per_s", m.after_omega_rad_per_s)}};
  json["restitution"] = number("restitution", m.restitution);
  json["unresolved_impacts"] = m.unresolved_impacts;
  json["centre_rebound_ratio"] =
      number("centre_rebound_ratio", m.centre_rebound_ratio);
  json["impulse_ratio"] = number("impulse_ratio", m.impulse_ratio);
  json["gravity_check_mps2"] =
      number("gravity_check_mps2", m.gravity_check_mps2);
  return json;
}

// Writes what the file is. The full digest is left to the store, since it takes
// as long as reading all bytes.
Json ClipField(Writer& writer, const Analysis& analysis) {
  const vision::ClipInfo& clip = analysis.clip;
  Json json;
  json["path"] = clip.path.string();
  json["id"] = analysis.clip_id.empty()
                   ? writer.Missing("clip.id", "not asked for")
                   : Json(analysis.clip_id);
  json["sha256"] =
      writer.Missing("clip.sha256", "computed when a trial is logged");
  json["format"] = clip.format;
  json["width_px"] = clip.width_px;
  json["height_px"] = clip.height_px;
  json["bit_depth"] = clip.bit_depth;
  json["channel"] = vision::Name(analysis.channel);
  json["frames"] = clip.frames;
  json["first_camera_frame"] = clip.first_camera_frame;
  json["time_base"] = {{"fps", clip.time_base.fps},
                       {"source", Name(clip.time_base.source)},
                       {"uniform", clip.time_base.uniform},
                       {"trusted", clip.time_base.trusted}};
  return json;
}

// Writes what was thrown: sizes in mm where they are known, and as seen in the
// picture, whole sides in px where the track has half ones.
Json BodyField(Writer& writer, const Analysis& analysis) {
  if (!analysis.body) {
    return writer.Missing("body", analysis.body.error().reason);
  }
  const core::Body& body = *analysis.body;
  Json json;
  json["kind"] = Name(body.kind);
  json["diameter_mm"] =
      writer.Number("body.diameter_mm", body.diameter_m, kToMillimetres);
  json["long_mm"] = writer.Number("body.long_mm", body.long_m, kToMillimetres);
  json["short_mm"] =
      writer.Number("body.short_mm", body.short_m, kToMillimetres);
  if (analysis.track) {
    const vision::BodyImage& image = analysis.track->body;
    if (body.kind == core::BodyKind::kSphere) {
      json["radius_px"] = EstimateJson(vision::HalfLong(image));
    } else {
      json["long_px"] = EstimateJson(vision::HalfLong(image), 2.0);
      json["short_px"] = EstimateJson(vision::HalfShort(image), 2.0);
    }
  }
  return json;
}

// Names the calibration that was used. The file itself stands in full under
// "replay", in the options.
Json CalibrationField(Writer& writer, const Analysis& analysis) {
  if (!analysis.calibration) {
    return writer.Missing("calibration", "no --calibration");
  }
  const calib::Calibration& c = *analysis.calibration;
  Json json;
  json["camera"] = c.camera;
  json["date"] = c.date;
  json["expires"] = c.expires;
  json["lens_rms_px"] = c.lens ? Json(c.lens->rms_px)
                               : writer.Missing("calibration.lens_rms_px",
                                                "the calibration has no lens");
  return json;
}

// The check by synthesis (explained_change.h).
Json ExplainedField(Writer& writer, const Analysis& analysis) {
  if (!analysis.explained) {
    return writer.Missing("explained", analysis.explained.error().reason);
  }
  const vision::ExplainedChange& explained = *analysis.explained;
  Json json = {
      {"near", explained.near},           {"elsewhere", explained.elsewhere},
      {"band_chi2", explained.band_chi2}, {"noise_dn", explained.noise_dn},
      {"frames", explained.frames},       {"lost_frames", explained.lost},
      {"pixels", explained.pixels}};
  if (explained.seen) json["seen"] = *explained.seen;
  if (explained.near_as_disc) json["near_as_disc"] = *explained.near_as_disc;
  if (analysis.outlines_corrected) json["outlines_corrected"] = true;
  return json;
}

// The ground line through two points at which the camera sees it.
calib::GroundLine InImage(const Analysis& analysis,
                          const calib::GroundLine& ground) {
  if (!analysis.calibration || !analysis.calibration->lens) return ground;
  return calib::Distorted(ground, analysis.calibration->lens->lens, ground.p1,
                          ground.p2);
}

// Where and how fast the body is over the whole track, in image coordinates: a
// straight line through the centres.
Json TrackField(Writer& writer, const Analysis& analysis) {
  if (!analysis.track) {
    return writer.Missing("track", analysis.track.error().reason);
  }
  const auto& poses = analysis.track->poses;
  if (poses.size() < 2) {
    return writer.Missing("track", "only one frame shows the body");
  }
  Json json;
  json["frames"] = poses.size();
  json["first_frame"] = poses.front().frame;
  json["last_frame"] = poses.back().frame;
  json["first_px"] = {poses.front().centre.x_px, poses.front().centre.y_px};
  json["last_px"] = {poses.back().centre.x_px, poses.back().centre.y_px};
  double n = 0, sf = 0, sx = 0, sy = 0, sff = 0, sfx = 0, sfy = 0;
  for (const vision::Pose& p : poses) {
    const auto f = static_cast<double>(p.frame - poses.front().frame);
    n += 1;
    sf += f;
    sx += p.centre.x_px;
    sy += p.centre.y_px;
    sff += f * f;
    sfx += f * p.centre.x_px;
    sfy += f * p.centre.y_px;
  }
  // x and y are fitted by least squares over the frame number, which is counted
  // from the first pose so that the sums stay small. Two different frames make
  // the determinant positive.
  const double determinant = n * sff - sf * sf;
  json["mean_velocity_px_per_frame"] = {(n * sfx - sf * sx) / determinant,
                                        (n * sfy - sf * sy) / determinant};
  return json;
}

// Where the body was, for people and other programs (the view v_tracks of the
// store): a line of text for each frame.
Json PathField(const Analysis& analysis) {
  const vision::PlaneTrack& plane = *analysis.plane;
  // These are millimetres for a pixel of the plane, which differ from the
  // image's scale where the plane of travel is turned.
  const double mm =
      1.0 / PxPerMetre(plane, *analysis.scale).value / core::kMillimetre;
  Json rows = Json::array();
  for (const vision::PlaneSample& s : plane.samples) {
    constexpr int kDecimals = 4;  // a tenth of a micrometre, 2 microradian
    report::NumberRow row;
    row.AddWhole(s.frame).AddShortest(s.time_s);
    for (const double px : {s.along_px, s.height_px, s.gap_px}) {
      row.AddFixed(px * mm, kDecimals);
    }
    if (plane.kind == core::BodyKind::kRectangle) {
      row.AddFixed(s.face_rad / core::kDegree, kDecimals);
    } else {
      // A sphere has no face angle; the column stays, so that all rows are
      // alike.
      row.AddWord("null");
    }
    rows.push_back(row.text());
  }
  return {{"columns", "frame time_s x_mm y_mm gap_mm face_angle_deg"},
          {"rows", std::move(rows)}};
}

}  // namespace

Json ChecksJson(const Analysis& analysis) {
  Json json = Json::array();
  for (const AnswerCheck& check : analysis.checks) {
    json.push_back({{"name", check.name},
                    {"verdict", Name(check.verdict)},
                    {"reason", check.reason}});
  }
  return json;
}

std::string ToJson(const Analysis& analysis) {
  // The fields stand in this order: what was filmed, in which frame of
  // reference, the body, the answer, how far it can be trusted, and what the
  // program itself needs.
  Writer writer;
  Json json;
  json["schema"] = "touchdown.analysis/1";
  json["clip"] = ClipField(writer, analysis);
  json["origin"] = Name(analysis.simulated ? core::Origin::kSimulated
                                           : core::Origin::kRecorded);
  if (analysis.scale) {
    json["scale"] = {{"px_per_m", EstimateJson(analysis.scale->px_per_m)},
                     {"source", calib::Name(analysis.scale->source)}};
  } else {
    json["scale"] = writer.Missing("scale", analysis.scale.error().reason);
  }
  json["calibration"] = CalibrationField(writer, analysis);
  if (analysis.ground) {
    const calib::GroundLine g = InImage(analysis, *analysis.ground);
    json["ground"] = {{"x1_px", g.p1.x_px},
                      {"y1_px", g.p1.y_px},
                      {"x2_px", g.p2.x_px},
                      {"y2_px", g.p2.y_px},
                      {"u_offset_px", g.u_offset_px},
                      {"u_angle_deg", g.u_angle_rad * kToDegrees},
                      {"source", calib::Name(g.source)}};
    // The line through two points at which the camera sees it is what people
    // draw; the ideal line, on which all angles are based, is given beside it.
    if (analysis.calibration && analysis.calibration->lens) {
      const calib::GroundLine& ideal = *analysis.ground;
      json["ground"]["ideal_px"] = {ideal.p1.x_px, ideal.p1.y_px, ideal.p2.x_px,
                                    ideal.p2.y_px};
    }
  } else {
    json["ground"] = writer.Missing("ground", analysis.ground.error().reason);
  }
  json["body"] = BodyField(writer, analysis);
  json["track"] = TrackField(writer, analysis);
  const core::ContactRecord& first = analysis.contacts.first;
  json["contact"] =
      ContactField(writer, "contact.", first.contact, analysis.angle_kind);
  json["state"] = StateField(writer, "state.", first.state);
  json["later_contacts"] = Json::array();
  for (std::size_t i = 0; i < analysis.contacts.later.size(); ++i) {
    const core::ContactRecord& later = analysis.contacts.later[i];
    const std::string at = "later_contacts[" + std::to_string(i) + "].";
    json["later_contacts"].push_back(
        {{"contact", ContactField(writer, at + "contact.", later.contact,
                                  analysis.angle_kind)},
         {"state", StateField(writer, at + "state.", later.state)},
         {"motion", MotionField(writer, at + "motion.", later.motion)}});
  }
  json["motion"] = MotionField(writer, "motion.", first.motion);
  const vision::RestitutionOfImpacts& e = analysis.contacts.restitution;
  // It is that of all impacts of the clip; "motion" has that of the first
  // impact alone.
  json["restitution_of_impacts"] = {
      {"restitution",
       writer.Number("restitution_of_impacts.restitution", e.value)},
      {"resolved", e.resolved},
      {"unresolved", e.unresolved}};
  json["explained"] = ExplainedField(writer, analysis);
  json["checks"] = ChecksJson(analysis);
  json["scene_model"] = {{"used", analysis.scene_model.used},
                         {"left_out", analysis.scene_model.left_out}};
  if (analysis.stopped_at) json["stopped_at_frame"] = *analysis.stopped_at;
  if (analysis.camera_moved_px) {
    json["camera_moved_px"] = EstimateJson(*analysis.camera_moved_px);
  }
  json["warnings"] = analysis.warnings;
  json["timing_s"] = {{"total", analysis.timing.total_s},
                      {"open", analysis.timing.open_s},
                      {"decode", analysis.timing.decode_s},
                      {"track", analysis.timing.track_s},
                      {"contact", analysis.timing.contact_s},
                      {"check", analysis.timing.check_s},
                      {"digest", analysis.timing.digest_s},
                      {"frames_per_s", analysis.timing.frames_per_s}};
  // Every field that may be missing has been written by now.
  json["absent"] = writer.TakeAbsent();
  if (!analysis.corrections.empty()) {
    json["corrections"] = analysis.corrections;
  }
  if (analysis.plane && analysis.scale) json["path"] = PathField(analysis);
  json["replay"] = ReplayJson(analysis);
  json["software"] = {{"version", std::string(Version())},
                      {"options_hash", analysis.options_hash}};
  // A path may hold bytes that are no UTF-8: they are replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace touchdown::pipeline
