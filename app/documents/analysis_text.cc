#include "app/documents/analysis_text.h"

#include <fmt/format.h>

#include <cmath>

#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// Returns "20.013 +- 0.048 deg", or "absent: " and the reason. `factor` brings
// SI to `unit`. The sign is in ASCII, for terminals that lack it.
std::string MeasuredText(const core::Measured& m, double factor,
                         const char* unit) {
  if (!m) return fmt::format("absent: {}", m.error().reason);
  return report::InAscii(report::WithU(*m, 1.0 / factor)) + " " + unit;
}

// A number that has no uncertainty of its own.
std::string Convention(const core::Measured& m, double factor,
                       const char* unit) {
  return m ? fmt::format("{:.3g} {}", m->value * factor, unit)
           : "absent: " + m.error().reason;
}

// Adds "name       text". An empty name continues the line before.
void Line(std::string& out, const char* name, const std::string& text) {
  out += fmt::format("{:<10} {}\n", name, text);
}

// Where a bounce height comes from that nobody stated.
std::string SourceOfHeight(const Analysis& a) {
  if (a.options.bounce_height_m || !a.contacts.first.state.bounce_height_m) {
    return "";
  }
  // A convention that follows from a measured size differs from clip to clip,
  // which is why the line asks for a fixed one.
  const bool stated = a.options.diameter_m || a.options.long_m;
  return fmt::format(
      "taken from the body's {} size (the larger of 0.5 mm and 2 % of it): a "
      "campaign, or --bounce-height-mm, fixes it before the first trial",
      stated ? "stated" : "measured");
}

// Adds the evidence of the state: greatest gap, bounce height, and the least
// gap that this recording could have shown, all in mm.
void AddGaps(std::string& out, const Analysis& a) {
  const core::StateDecision& state = a.contacts.first.state;
  constexpr double kMm = 1.0 / core::kMillimetre;
  Line(out, "gap",
       fmt::format("greatest {}, bounce height {}, detectable from {}",
                   MeasuredText(state.max_gap_m, kMm, "mm"),
                   Convention(state.bounce_height_m, kMm, "mm"),
                   Convention(state.detectable_gap_m, kMm, "mm")));
  if (const std::string source = SourceOfHeight(a); !source.empty()) {
    Line(out, "", "bounce height " + source);
  }
  if (state.extrapolated_gap_m) {
    Line(out, "flight",
         fmt::format("would reach {} after the end of the film",
                     MeasuredText(state.extrapolated_gap_m, kMm, "mm")));
  }
}

// Adds velocities and ratios at the first touchdown, a number or its reason.
void AddMotion(std::string& out, const core::Motion& motion) {
  Line(out, "speed", MeasuredText(motion.before_speed_mps, 1.0, "m/s"));
  const auto parts = [](const core::Measured& normal,
                        const core::Measured& tangential,
                        const core::Measured& omega) {
    return fmt::format("normal {}, along the ground {}, spin {}",
                       MeasuredText(normal, 1.0, "m/s"),
                       MeasuredText(tangential, 1.0, "m/s"),
                       MeasuredText(omega, 1.0, "rad/s"));
  };
  Line(out, "before",
       parts(motion.before_normal_mps, motion.before_tangential_mps,
             motion.before_omega_rad_per_s));
  Line(out, "after",
       parts(motion.after_normal_mps, motion.after_tangential_mps,
             motion.after_omega_rad_per_s));
  Line(out, "restitut.", MeasuredText(motion.restitution, 1.0, ""));
  Line(out, "centre",
       MeasuredText(motion.centre_rebound_ratio, 1.0, "") + " (rebound ratio)");
  // The impulse ratio is what friction was used; it equals mu only where the
  // contact point slid all through the impact.
  Line(out, "impulses",
       MeasuredText(motion.impulse_ratio, 1.0, "") + " (ratio)");
  Line(out, "gravity", MeasuredText(motion.gravity_check_mps2, 1.0, "m/s2"));
}

}  // namespace

std::string ToText(const Analysis& a) {
  constexpr double kDeg = 1.0 / core::kDegree;
  constexpr double kMm = 1.0 / core::kMillimetre;
  // The lines tell from top to bottom what was filmed, the frame of reference,
  // the contact, the state, the motion, the checks, what follows, warnings.
  const core::ContactRecord& first = a.contacts.first;
  const core::Contact& contact = first.contact;
  std::string out;
  Line(out, "clip",
       fmt::format("{}  {}x{} px, {} bit, {} frames at {:.6g} fps ({}{})",
                   a.clip.path.string(), a.clip.width_px, a.clip.height_px,
                   a.clip.bit_depth, a.clip.frames, a.clip.time_base.fps,
                   vision::Name(a.clip.time_base.source),
                   a.clip.time_base.trusted ? "" : ", not trusted"));
  if (a.simulated) Line(out, "origin", "SIMULATED");
  if (a.body) {
    std::string text(core::Name(a.body->kind));
    if (a.body->kind == core::BodyKind::kSphere) {
      text += ", diameter " + MeasuredText(a.body->diameter_m, kMm, "mm");
    } else {
      text += ", " + MeasuredText(a.body->long_m, kMm, "mm") + " by " +
              MeasuredText(a.body->short_m, kMm, "mm");
    }
    Line(out, "body", text);
  } else {
    Line(out, "body", "none: " + a.body.error().reason);
  }
  Line(out, "scale",
       a.scale ? fmt::format("{} ({})",
                             MeasuredText(a.scale->px_per_m, 1.0, "px/m"),
                             calib::Name(a.scale->source))
               : "none: " + a.scale.error().reason);
  if (a.ground) {
    Line(out, "ground",
         fmt::format(
             "({:.1f}, {:.1f}) to ({:.1f}, {:.1f}) px, +- {:.3f} deg, {}",
             a.ground->p1.x_px, a.ground->p1.y_px, a.ground->p2.x_px,
             a.ground->p2.y_px, a.ground->u_angle_rad * kDeg,
             calib::Name(a.ground->source)));
  } else {
    Line(out, "ground", "none: " + a.ground.error().reason);
  }
  // A body that is down from the first frame has no instant of touchdown.
  if (!contact.found) {
    Line(out, "contact", "none: " + contact.reason);
  } else if (contact.from_start) {
    Line(out, "contact", "from the start");
  } else {
    Line(out, "contact",
         fmt::format("at {}, frame {:.3f}",
                     MeasuredText(contact.time_s, 1e3, "ms"),
                     contact.frame->value));
  }
  if (contact.found) {
    Line(out, "angle",
         MeasuredText(core::ContactAngle(contact, a.angle_kind), kDeg, "deg") +
             fmt::format(" ({} angle)", core::Name(a.angle_kind)));
    // The other kinds, where the body has them; of a face also its sign.
    if (a.angle_kind != core::AngleKind::kApproach) {
      Line(out, "approach",
           MeasuredText(contact.approach_angle_rad, kDeg, "deg"));
    }
    if (a.angle_kind != core::AngleKind::kRadius && contact.radius_angle_rad) {
      Line(out, "radius", MeasuredText(contact.radius_angle_rad, kDeg, "deg"));
    }
    const core::Measured& face = contact.face_angle_rad;
    if (face && (a.angle_kind != core::AngleKind::kFace || face->value < 0)) {
      Line(out, "face", MeasuredText(face, kDeg, "deg"));
    }
    if (contact.corner) Line(out, "corner", std::string(Name(*contact.corner)));
    Line(out, "duration", MeasuredText(contact.duration_s, 1e3, "ms"));
  }
  std::string state(core::Name(first.state.label));
  if (first.state.p_bounce) {
    state += fmt::format(", P(bounce) = {:.4f}", *first.state.p_bounce);
  }
  if (first.state.micro_bounce) state += ", micro-bounce";
  Line(out, "state", state);
  // The reason is a sentence of its own, below the label.
  Line(out, "", first.state.reason);
  AddGaps(out, a);
  // Without a flight before it there are no velocities at touchdown, only a row
  // of "absent".
  if (contact.found && !contact.from_start) {
    AddMotion(out, first.motion);
    const vision::RestitutionOfImpacts& e = a.contacts.restitution;
    // One resolved impact is the restitution above, said once.
    if (e.resolved > 1 || e.unresolved > 0) {
      Line(out, "impacts",
           fmt::format(
               "{} resolved, restitution {}; {}", e.resolved,
               MeasuredText(e.value, 1.0, ""),
               e.unresolved > 0
                   ? fmt::format("at least {} not resolved", e.unresolved)
                   : "all that were seen"));
    }
  }
  // This says how much of what changes in the clip the answer accounts for. A
  // share near 1, with little change elsewhere, speaks for the track.
  if (a.explained) {
    Line(
        out, "explained",
        fmt::format("{:.4f} of what changes near the body, by {} frames; {:.1f}"
                    " % of the change is elsewhere",
                    a.explained->near, a.explained->frames,
                    100.0 * a.explained->elsewhere));
  } else {
    Line(out, "explained", "absent: " + a.explained.error().reason);
  }
  // Later contacts are told in one line each; all numbers are in the document.
  for (const core::ContactRecord& later : a.contacts.later) {
    const core::Measured angle =
        core::ContactAngle(later.contact, a.angle_kind);
    Line(out, "later",
         fmt::format("contact at {}, {} angle {}, {}",
                     MeasuredText(later.contact.time_s, 1e3, "ms"),
                     core::Name(a.angle_kind), MeasuredText(angle, kDeg, "deg"),
                     core::Name(later.state.label)));
  }
  if (a.stopped_at) {
    Line(out, "stopped",
         fmt::format("at frame {} of {}: the state was decided, and what "
                     "follows was not looked at",
                     *a.stopped_at, a.clip.frames));
  }
  for (const std::string& warning : a.warnings) Line(out, "warning", warning);
  for (const auto& [what, why] : a.scene_model.left_out) {
    Line(out, "left out", fmt::format("{}: {}", what, why));
  }
  // The rate is that of the whole analysis, frames over wall time.
  Line(out, "time",
       fmt::format("{:.3f} s, {:.0f} frames/s", a.timing.total_s,
                   a.timing.frames_per_s));
  return out;
}

}  // namespace touchdown::pipeline
