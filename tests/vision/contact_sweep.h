// What the tests of contacts share: a throw filmed many times, its measured
// numbers by name, and whether their uncertainties are honest.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision::synthetic {

// Every number of a record, by name, where it is present.
inline std::map<std::string, core::Estimate> Numbers(
    const core::ContactRecord& record) {
  std::map<std::string, core::Estimate> numbers;
  const auto add = [&](const char* name, const core::Measured& m) {
    if (m) {
      numbers[name] = *m;
    } else {
      EXPECT_FALSE(m.error().reason.empty()) << name;
    }
  };
  const core::Contact& c = record.contact;
  add("time", c.time_s);
  add("frame", c.frame);
  add("approach", c.approach_angle_rad);
  add("radius", c.radius_angle_rad);
  add("face", c.face_angle_rad);
  add("duration", c.duration_s);
  add("max gap", record.state.max_gap_m);
  add("bounce height", record.state.bounce_height_m);
  add("detectable gap", record.state.detectable_gap_m);
  add("extrapolated gap", record.state.extrapolated_gap_m);
  const core::Motion& m = record.motion;
  add("speed", m.before_speed_mps);
  add("vn", m.before_normal_mps);
  add("vt", m.before_tangential_mps);
  add("omega", m.before_omega_rad_per_s);
  add("vn'", m.after_normal_mps);
  add("vt'", m.after_tangential_mps);
  add("omega'", m.after_omega_rad_per_s);
  add("e", m.restitution);
  add("centre ratio", m.centre_rebound_ratio);
  add("impulse ratio", m.impulse_ratio);
  add("gravity", m.gravity_check_mps2);
  return numbers;
}

inline void ExpectFinite(const ContactResult& result) {
  std::vector<core::ContactRecord> records = {result.first};
  records.insert(records.end(), result.later.begin(), result.later.end());
  for (const core::ContactRecord& record : records) {
    for (const auto& [name, e] : Numbers(record)) {
      EXPECT_TRUE(std::isfinite(e.value)) << name;
      EXPECT_TRUE(std::isfinite(e.u)) << name;
      EXPECT_GE(e.u, 0.0) << name;
    }
    if (record.state.p_bounce) {
      EXPECT_GE(*record.state.p_bounce, 0.0);
      EXPECT_LE(*record.state.p_bounce, 1.0);
    }
    EXPECT_FALSE(record.state.reason.empty());
    EXPECT_EQ(record.contact.found, record.contact.reason.empty());
  }
}

// What is true of a throw's first contact.
inline std::map<std::string, double> ComputeTruth(const Throw& t,
                                                  const Filming& filming) {
  std::map<std::string, double> truth;
  truth["time"] = t.contact_s;
  truth["frame"] = t.contact_s * filming.camera.fps;
  truth["approach"] = t.ContactAngle();
  truth["duration"] = t.duration_s;
  truth["speed"] = std::hypot(t.before.vx, t.before.vy);
  truth["vn"] = t.before.vy;
  truth["vt"] = t.before.vx;
  truth["gravity"] = t.gravity_mps2;
  if (t.kind == core::BodyKind::kRectangle) {
    const double arm = t.Arm();
    truth["face"] = t.face_rad;
    truth["radius"] = std::atan2(t.Support(t.face_rad), std::abs(arm));
    truth["omega"] = t.before.omega;
  }
  if (!t.stays) {
    const double arm = t.Arm();
    truth["vn'"] = t.after.vy;
    truth["vt'"] = t.after.vx;
    truth["e"] = -(t.after.vy + t.after.omega * arm) /
                 (t.before.vy + t.before.omega * arm);
    truth["centre ratio"] = -t.after.vy / t.before.vy;
    truth["impulse ratio"] =
        std::abs(t.after.vx - t.before.vx) / (t.after.vy - t.before.vy);
    if (t.kind == core::BodyKind::kRectangle) truth["omega'"] = t.after.omega;
  }
  return truth;
}

struct Sweep {
  std::map<std::string, std::vector<double>> z;
  std::map<std::string, int> missing;
  std::map<core::MotionState, int> states;
  int not_found = 0;
  int later = 0;
  std::vector<double> u_approach;
};

// The same throw filmed `seeds` times, contact anywhere between two frames.
inline Sweep Shoot(Throw thrown, Filming filming, int seeds = 60) {
  Sweep sweep;
  const double contact_s = thrown.contact_s;
  for (int seed = 1; seed <= seeds; ++seed) {
    filming.seed = static_cast<std::uint64_t>(seed);
    thrown.contact_s =
        contact_s + std::fmod(0.618034 * seed, 1.0) / filming.camera.fps;
    const PlaneTrack plane = FilmPlane(thrown, filming);
    const ContactResult result = FindContacts(plane, WithScale(filming));
    ExpectFinite(result);
    if (!result.first.contact.found) {
      ++sweep.not_found;
      ADD_FAILURE() << "seed " << seed << ": " << result.first.contact.reason;
      continue;
    }
    ++sweep.states[result.first.state.label];
    sweep.later += static_cast<int>(result.later.size());
    auto measured = Numbers(result.first);
    for (const auto& [name, truth] : ComputeTruth(thrown, filming)) {
      if (!measured.contains(name)) {
        ++sweep.missing[name];
        continue;
      }
      const core::Estimate e = measured[name];
      if (name == "duration" && truth == 0.0) {
        EXPECT_LE(e.value, 4.0 * e.u);
        continue;
      }
      sweep.z[name].push_back((e.value - truth) / e.u);
    }
    sweep.u_approach.push_back(measured["approach"].u);
  }
  return sweep;
}

// Every error within 4 u, and none of the uncertainties too small; stated
// uncertainties may be too wide by a factor of two (they hold the gravity of
// the place, which the tracks here have exactly).
inline void ExpectHonest(const Sweep& sweep) {
  for (const auto& [name, z] : sweep.z) {
    EXPECT_LT(testing::Largest(z), 4.2) << name;
    EXPECT_LT(testing::Rms(z), testing::RmsBand9999(z.size()).high) << name;
    EXPECT_GT(testing::Rms(z), 0.45 * testing::RmsBand9999(z.size()).low)
        << name;
  }
}

}  // namespace touchdown::vision::synthetic
