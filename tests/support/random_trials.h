// Trials that nobody would make by hand: every field filled with what a field
// can hold, to see that it comes back bit for bit.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"

namespace touchdown::testing {

class RandomTrials {
 public:
  explicit RandomTrials(std::uint64_t seed) : engine_(seed) {}

  core::Trial Trial() {
    core::Trial trial;
    trial.origin = static_cast<core::Origin>(Below(3));
    if (Below(4) != 0) {
      trial.clip.id = "clip-" + std::to_string(engine_());
      trial.clip.path = Text();
      trial.clip.sha256 = Below(2) == 0 ? "" : Hex(64);
      trial.clip.size_bytes = static_cast<std::int64_t>(engine_() >> 1);
    }
    trial.body.kind = static_cast<core::BodyKind>(Below(2));
    trial.body.diameter_m = Measured();
    trial.body.long_m = Measured();
    trial.body.short_m = Measured();
    trial.angle_kind = static_cast<core::AngleKind>(Below(3));
    trial.first = Contact();
    trial.later.resize(Below(3));
    for (auto& later : trial.later) later = Contact();
    if (Below(2) == 0) trial.set_angle_rad = Number();
    if (Below(2) == 0) trial.set_speed_mps = Number();
    if (Below(2) == 0) trial.conditions = Conditions();
    trial.author = "a" + Text();
    trial.reason = Text();
    trial.software_version = Text();
    trial.options_hash = Text();
    trial.document_json = Text();
    trial.excluded = Below(4) == 0;
    if (trial.excluded) trial.exclusion_reason = Text();
    return trial;
  }

  // Without names of a register, which a store would have to know.
  core::Conditions Conditions() {
    core::Conditions conditions;
    const double share = static_cast<double>(engine_() >> 11) * 0x1p-53;
    if (Below(2) == 0) {
      conditions.temperature_k =
          core::Estimate{250.0 + 60.0 * share, share, std::nullopt};
    } else {
      conditions.temperature_k = core::AbsentBecause(Text());
    }
    if (Below(2) == 0) {
      conditions.relative_humidity =
          core::Estimate{share, 0.0, core::Interval{0.0, share}};
    }
    conditions.anomaly = static_cast<core::Anomaly>(Below(10));
    conditions.anomaly_note = "n" + Text();
    if (Below(2) == 0) {
      conditions.elevation_rad =
          core::Estimate{share - 0.5, share, std::nullopt};
      conditions.compression_m = core::Estimate{share, 0.0, std::nullopt};
      conditions.muzzle_height_m = core::AbsentBecause(Text());
      conditions.note = Text();
    }
    return conditions;
  }

  core::Measured Measured() {
    if (Below(3) == 0) return core::AbsentBecause(Text());
    core::Estimate estimate{Number(), std::abs(Number()), std::nullopt};
    if (Below(3) == 0) {
      const double a = Number();
      const double b = Number();
      estimate.interval95 = core::Interval{std::fmin(a, b), std::fmax(a, b)};
    }
    return estimate;
  }

  // Any double but NaN: signed zeros, denormals, infinities, whole numbers and
  // random bit patterns.
  double Number() {
    switch (Below(8)) {
      case 0:
        return Below(2) == 0 ? 0.0 : -0.0;
      case 1:
        return std::numeric_limits<double>::denorm_min();
      case 2:
        return Below(2) == 0 ? -std::numeric_limits<double>::infinity()
                             : std::numeric_limits<double>::max();
      case 3:
        return static_cast<double>(static_cast<std::int64_t>(engine_()) >> 40);
      default:
        break;
    }
    while (true) {
      const std::uint64_t bits = engine_();
      double value = 0.0;
      static_assert(sizeof bits == sizeof value);
      __builtin_memcpy(&value, &bits, sizeof value);
      if (!std::isnan(value)) return value;
    }
  }

  // Anything a string can hold: SQL, quotes, newlines, NUL, bytes that are not
  // UTF-8.
  std::string Text() {
    static const std::vector<std::string> kinds = {
        "",
        "plain",
        "'; DROP TABLE trials; --",
        "\" OR 1=1 --",
        "Robert'); DELETE FROM revisions;--",
        "%s%n ? ?1 :name @x $y",
        "two\nlines\r\n\tand a tab",
        "\xc3\x9c"
        "berma\xc3\x9f \xe6\x92\x9e\xe5\x87\xbb \xf0\x9f\x92\xa5",
        std::string("nul\0inside", 10),
        "\xff\xfe not utf-8 \x80",
        "=HYPERLINK(\"http://x\")",
        "<script>alert(1)</script>",
        "NULL",
        "x'00'",
    };
    return kinds[Below(kinds.size())];
  }

  std::uint64_t operator()() { return engine_(); }
  std::size_t Below(std::size_t n) { return engine_() % n; }

 private:
  std::string Hex(std::size_t digits) {
    std::string text;
    while (text.size() < digits) text += "0123456789abcdef"[Below(16)];
    return text;
  }

  core::Budget Budget() {
    core::Budget budget(Below(4));
    for (auto& line : budget) line = {Text(), std::abs(Number())};
    return budget;
  }

  core::ContactRecord Contact() {
    core::ContactRecord record;
    core::Contact& contact = record.contact;
    contact.found = Below(2) == 0;
    contact.reason = Text();
    contact.from_start = Below(2) == 0;
    for (auto* measured : {&contact.time_s,
                           &contact.frame,
                           &contact.approach_angle_rad,
                           &contact.radius_angle_rad,
                           &contact.face_angle_rad,
                           &contact.duration_s,
                           &record.state.max_gap_m,
                           &record.state.bounce_height_m,
                           &record.state.detectable_gap_m,
                           &record.motion.before_speed_mps,
                           &record.motion.before_normal_mps,
                           &record.motion.before_tangential_mps,
                           &record.motion.before_omega_rad_per_s,
                           &record.motion.after_normal_mps,
                           &record.motion.after_tangential_mps,
                           &record.motion.after_omega_rad_per_s,
                           &record.motion.restitution,
                           &record.motion.centre_rebound_ratio,
                           &record.motion.impulse_ratio,
                           &record.motion.gravity_check_mps2,
                           &record.state.extrapolated_gap_m}) {
      *measured = Measured();
    }
    if (Below(2) == 0) contact.corner = static_cast<core::Corner>(Below(3));
    contact.approach_budget = Budget();
    contact.attitude_budget = Budget();
    record.state.label = static_cast<core::MotionState>(Below(7));
    if (Below(2) == 0) {
      record.state.p_bounce = static_cast<double>(engine_() >> 11) * 0x1p-53;
    }
    record.state.reason = Text();
    record.state.micro_bounce = Below(2) == 0;
    return record;
  }

  std::mt19937_64 engine_;
};

}  // namespace touchdown::testing
