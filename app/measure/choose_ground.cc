#include "app/measure/choose_ground.h"

#include <fmt/format.h>

#include <utility>

#include "app/measure/judge.h"
#include "touchdown/vision/contact/supported_path.h"

namespace touchdown::pipeline {
namespace {

// How well a line serves as the ground of a track; more is better.
enum class Merit { kRefuted, kNotMet, kServes };

struct Candidate {
  calib::GroundLine line;
  vision::ContactResult contacts;

  Merit merit() const {
    if (!contacts.ground_refuted.empty()) return Merit::kRefuted;
    return contacts.first.contact.found ? Merit::kServes : Merit::kNotMet;
  }
};

}  // namespace

GroundChoice ChooseGround(const std::vector<calib::GroundLine>& visible,
                          const ClipCalibration& camera,
                          const vision::Track& seen,
                          const vision::ContactOptions& options) {
  // The contacts that this line would have, by the track as it is.
  const auto judge = [&](const calib::GroundLine& line) {
    return Candidate{
        line, FindPlaneContacts(SeenInPlane(camera, seen, line), options)};
  };
  std::optional<Candidate> best;
  for (const calib::GroundLine& line : visible) {
    // Nothing moves through the ground, whatever its contacts would be.
    if (PassesThroughGround(SeenInPlane(camera, seen, line))) continue;
    Candidate candidate = judge(line);
    // Of lines that serve equally well the picture's first one is taken.
    if (!best || candidate.merit() > best->merit()) best = std::move(candidate);
    if (best->merit() == Merit::kServes) break;
  }
  GroundChoice choice;
  // Past its last frame nobody knows whether the body came to rest on the line
  // or went on.
  const bool at_the_end =
      best && IsAtTheEnd(best->contacts.first.contact, seen);
  // A body that moves along the ground all the time draws it; a visible edge
  // that it meets in its last frame only may be any line that the path points
  // at.
  if (!best || best->merit() != Merit::kServes || at_the_end) {
    if (const auto line = vision::GroundFromPath(seen)) {
      if (judge(*line).contacts.first.contact.from_start) {
        choice.warnings.emplace_back(
            "no visible edge is the ground; the body moves along it all the "
            "time, and its path tells where it is");
        choice.line = line;
        choice.serves = true;
        return choice;
      }
    }
  }
  // A visible edge need not be the contact line: where none agrees with the
  // track, the lowest points at the contacts tell.
  if (!best || best->merit() == Merit::kRefuted) {
    if (const auto line = vision::GroundFromContacts(seen)) {
      if (judge(*line).contacts.first.contact.found) {
        if (best) {
          choice.warnings.push_back(
              fmt::format("the visible edge is not the ground ({}); the "
                          "contact points tell where it is",
                          best->contacts.ground_refuted));
        } else if (!visible.empty()) {
          choice.warnings.emplace_back(
              "no visible edge is the ground (the body passes below each); the "
              "contact points tell where it is");
        }
        choice.line = line;
        choice.serves = true;
        return choice;
      }
    }
  }
  if (best) {
    choice.line = best->line;
    choice.serves = best->merit() == Merit::kServes;
  }
  return choice;
}

}  // namespace touchdown::pipeline
