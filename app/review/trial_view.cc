#include "app/review/trial_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "app/documents/analysis_json.h"
#include "app/measure/undistorted_clip.h"
#include "app/review/words.h"
#include "app/text/format.h"
#include "app/text/json.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"
#include "touchdown/vision/contact/flight.h"

namespace touchdown::review {
namespace {

using core::kDegree;
using report::Json;

// Pieces of a drawn curve: a flight is a parabola, a lens bends a line little.
constexpr int kPieces = 40;

Json PointJson(core::PixelPoint p) { return {p.x_px, p.y_px}; }

// Ideal points to where the camera saw them.
class ToPicture {
 public:
  explicit ToPicture(const pipeline::Analysis& analysis) {
    if (analysis.calibration && analysis.calibration->lens) {
      lens_ = analysis.calibration->lens->lens;
    }
  }
  // Returns [x, y] in px of the recorded picture. Without a lens both pictures
  // are one.
  Json operator()(core::PixelPoint ideal) const {
    return PointJson(lens_ ? calib::Distort(*lens_, ideal) : ideal);
  }

 private:
  std::optional<calib::Lens> lens_;
};

// The line across the whole picture, and the two points that a person drags.
Json GroundJson(const pipeline::Analysis& analysis, const ToPicture& seen) {
  const calib::GroundLine& g = *analysis.ground;
  const double angle = calib::ImageAngle(g);
  // The line goes through its reference point at its angle; `share` runs from
  // the left border of the picture (0) to the right one (1).
  const double from = -g.reference.x_px;
  const double to = analysis.clip.width_px - 1 - g.reference.x_px;
  const auto at = [&](double share) {
    const double x = from + share * (to - from);
    return core::PixelPoint{g.reference.x_px + x,
                            g.reference.y_px + x * std::tan(angle)};
  };
  Json line = Json::array();
  for (int i = 0; i <= kPieces; ++i) {
    line.push_back(seen(at(static_cast<double>(i) / kPieces)));
  }
  // The handles stand a tenth of the width inside, where a mouse reaches them.
  return {{"p1_px", seen(at(0.1))},
          {"p2_px", seen(at(0.9))},
          {"line_px", std::move(line)},
          {"u_offset_px", g.u_offset_px},
          {"u_angle_deg", g.u_angle_rad / kDegree},
          {"source", calib::Name(g.source)}};
}

// Returns the points of a fitted flight between two instants, for drawing.
Json FlightJson(const vision::PlaneTrack& plane, const vision::Flight& flight,
                double from_s, double to_s, const ToPicture& seen) {
  Json points = Json::array();
  for (int i = 0; i <= kPieces; ++i) {
    const auto s = flight.At(from_s + (to_s - from_s) * i / kPieces);
    points.push_back(seen(vision::ToImage(plane, s.along_px, s.height_px)));
  }
  return points;
}

// Distances of the poses from the fitted flight, along and above the ground.
void AddResiduals(const vision::PlaneTrack& plane, const vision::Flight& flight,
                  const char* which, double unit, Json& rows) {
  for (const vision::PlaneSample& s : plane.samples) {
    // A row is frame, flight, residual along and its u, residual in height and
    // its u, in mm, or in px without a scale.
    if (s.frame < flight.first_frame || s.frame > flight.last_frame) continue;
    const auto fitted = flight.At(s.time_s);
    rows.push_back({s.frame, which, (s.along_px - fitted.along_px) * unit,
                    s.u_along_px * unit,
                    (s.height_px - fitted.height_px) * unit,
                    s.u_height_px * unit});
  }
}

// Tells what is drawn of one touchdown: centre, contact point, and the
// velocity's direction. `e` must have its flight before.
Json ContactJson(const vision::PlaneTrack& plane,
                 const vision::ContactEvidence& e, const ToPicture& seen) {
  const auto s = e.before->At(e.time_s);
  // px/s; the bound only keeps a body at rest from a division by zero.
  const double speed = std::max(1e-12, std::hypot(s.v_t, s.v_n));
  const double reach = 1.6 * plane.half_long_px;  // beyond the outline
  return {{"centre_px", seen(e.centre)},
          {"touching_px", seen(e.touching)},
          // The direction of approach through the centre.
          {"approach_px",
           {seen(vision::ToImage(plane, s.along_px - reach * s.v_t / speed,
                                 s.height_px - reach * s.v_n / speed)),
            seen(vision::ToImage(plane, s.along_px + reach * s.v_t / speed,
                                 s.height_px + reach * s.v_n / speed))}}};
}

// Lists a budget in degrees.
Json BudgetJson(const core::Budget& budget) {
  Json out = Json::array();
  for (const auto& line : budget) {
    out.push_back({{"source", line.source}, {"u_deg", line.u / kDegree}});
  }
  return out;
}

// Lists every measured number of a contact in the order of words.cc, as text
// with its u in the unit of its words, or with why it is absent.
Json QuantitiesJson(const core::ContactRecord& record) {
  Json out = Json::array();
  for (const std::string_view column : ColumnsInOrder()) {
    const auto& quantity = *std::ranges::find(core::kContactQuantities, column,
                                              &core::ContactQuantity::name);
    const core::Measured& measured = core::At(record, quantity);
    const Shown shown = ShownAs(column);
    Json row = {{"name", shown.name}, {"words", Label(shown)}};
    if (measured) {
      row["text"] = report::WithU(*measured, shown.factor);
    } else {
      row["absent"] = measured.error().reason;
    }
    out.push_back(std::move(row));
  }
  return out;
}

// Tells one contact: state, numbers and budgets.
Json RecordJson(const core::ContactRecord& record) {
  const core::StateDecision& state = record.state;
  return {{"found", record.contact.found},
          {"reason", record.contact.reason},
          {"state", core::Name(state.label)},
          {"state_reason", state.reason},
          {"p_bounce", state.p_bounce ? Json(*state.p_bounce) : Json(nullptr)},
          {"micro_bounce", state.micro_bounce},
          {"corner", record.contact.corner
                         ? Json(core::Name(*record.contact.corner))
                         : Json(nullptr)},
          {"frame", record.contact.frame ? Json(record.contact.frame->value)
                                         : Json(nullptr)},
          {"quantities", QuantitiesJson(record)},
          {"approach_budget", BudgetJson(record.contact.approach_budget)},
          {"attitude_budget", BudgetJson(record.contact.attitude_budget)}};
}

}  // namespace

Json ViewJson(const pipeline::Analysis& analysis) {
  const vision::Track& track = *analysis.track;
  const vision::BodyImage& body = track.body;
  const ToPicture seen(analysis);
  Json poses = Json::array();
  for (const vision::Pose& p : track.poses) {
    // Outlines are drawn in the recorded picture, in which they were fitted:
    // they go without the lens.
    poses.push_back({p.frame, p.centre.x_px, p.centre.y_px,
                     p.angle_rad / kDegree, p.relative_size});
  }
  Json view = {{"body",
                {{"kind", core::Name(body.kind)},
                 {"radius_px", body.radius_px.value},
                 {"half_long_px", body.half_long_px.value},
                 {"half_short_px", body.half_short_px.value}}},
               {"fps", analysis.clip.time_base.fps},
               {"poses", std::move(poses)},
               {"warnings", analysis.warnings},
               {"corrections", analysis.corrections},
               {"checks", pipeline::ChecksJson(analysis)}};
  // Drawn over the frames as a camera that stood still would have seen them.
  if (const auto steady = pipeline::SteadyFrames(analysis)) {
    view["steady"] = fmt::format("{}:{}", steady->first, steady->second);
  }
  if (!analysis.plane) {
    view["ground"] = nullptr;
    return view;
  }
  const vision::PlaneTrack& plane = *analysis.plane;
  view["ground"] = GroundJson(analysis, seen);
  // Lengths of gaps and residuals are in mm where there is a scale.
  const double unit =
      analysis.scale
          ? 1.0 / (analysis.scale->px_per_m.value * core::kMillimetre)
          : 1.0;
  view["length_unit"] = analysis.scale ? "mm" : "px";
  Json gaps = Json::array();
  for (const vision::PlaneSample& s : plane.samples) {
    gaps.push_back({s.frame, s.gap_px * unit, s.u_gap_px * unit});
  }
  view["gaps"] = std::move(gaps);
  if (const auto& height = analysis.contacts.first.state.bounce_height_m;
      height && analysis.scale) {
    view["bounce_height"] = height->value / core::kMillimetre;
  }
  view["refuted"] = analysis.contacts.ground_refuted;
  Json flights = Json::array();
  Json residuals = Json::array();
  // Flights are drawn of the first contact alone; a body that is down from the
  // start has none before it.
  const auto& evidence = analysis.contacts.evidence;
  if (!evidence.empty() && evidence.front().before) {
    const vision::ContactEvidence& e = evidence.front();
    // The curve covers the frames of the flight: as many before touchdown, and
    // after release, as were fitted.
    const double dt = plane.frame_interval_s;
    const auto frames = static_cast<double>(e.before->frames);
    flights.push_back(
        {{"which", "before"},
         {"points_px", FlightJson(plane, *e.before, e.time_s - frames * dt,
                                  e.time_s, seen)}});
    AddResiduals(plane, *e.before, "before", unit, residuals);
    if (e.after) {
      flights.push_back(
          {{"which", "after"},
           {"points_px",
            FlightJson(plane, *e.after, e.release_s,
                       e.release_s + (e.after->frames - 1) * dt, seen)}});
      AddResiduals(plane, *e.after, "after", unit, residuals);
    }
    view["contact"] = ContactJson(plane, e, seen);
  }
  view["flights"] = std::move(flights);
  view["residuals"] = std::move(residuals);
  return view;
}

namespace {

// With what the shot was made, in the words of --condition; what was not
// recorded is left out.
Json ConditionsJson(const core::Trial& trial) {
  Json out = Json::array();
  if (!trial.conditions) return out;
  const core::Conditions& conditions = *trial.conditions;
  const auto add = [&out](std::string_view name, const std::string& text) {
    if (text.empty()) return;
    const Shown shown = ShownAs(name);
    out.push_back(
        {{"name", shown.name}, {"words", Label(shown)}, {"text", text}});
  };
  for (const auto& entry : db::kConditionEntries) {
    add(Name(entry.kind), (conditions.*entry.member).name);
  }
  for (const auto& quantity : db::kConditionQuantities) {
    core::Measured number = conditions.*quantity.member;
    if (!number) continue;
    const Shown shown = ShownAs(quantity.name);
    number->value -= shown.offset;
    add(quantity.name, report::WithU(*number, shown.factor));
  }
  add("note", conditions.note);
  if (conditions.anomaly != core::Anomaly::kNotRecorded) {
    add("anomaly", std::string(core::Name(conditions.anomaly)));
  }
  add("anomaly_note", conditions.anomaly_note);
  return out;
}

}  // namespace

Json NumbersJson(const core::Trial& trial) {
  Json out = RecordJson(trial.first);
  const core::Measured angle = core::ContactAngle(trial);
  out["angle_kind"] = core::Name(trial.angle_kind);
  out["angle"] = angle ? Json(report::WithU(*angle, kDegree) + " deg")
                       : Json("absent: " + angle.error().reason);
  Json later = Json::array();
  for (const auto& record : trial.later) later.push_back(RecordJson(record));
  out["later"] = std::move(later);
  out["conditions"] = ConditionsJson(trial);
  return out;
}

}  // namespace touchdown::review
