#include "app/report_input/report_pictures.h"

#include <fmt/core.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/documents/replay.h"
#include "app/report_input/contact_pieces.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {
namespace {

// The path from where the contact begins; nothing without a scale or a flight.
std::optional<report::Trajectory> MakeTrajectory(const Analysis& analysis) {
  const auto& evidence = analysis.contacts.evidence;
  if (!analysis.scale || !analysis.plane || evidence.empty() ||
      !evidence.front().before) {
    return std::nullopt;
  }
  const vision::ContactEvidence& first = evidence.front();
  const double px_per_m = analysis.scale->px_per_m.value;
  const double along = first.before->At(first.time_s).along_px;
  report::Trajectory out;
  for (const vision::PlaneSample& sample : analysis.plane->samples) {
    out.centre.push_back({(sample.along_px - along) / px_per_m,
                          (sample.height_px - first.ground_px) / px_per_m});
    out.gap_m.push_back((sample.gap_px - first.ground_px) / px_per_m);
  }
  return out;
}

// Why the recording of a trial cannot be shown; empty where it can.
std::string WhyNotShown(const core::Trial& trial) {
  if (trial.clip.path.empty()) return "logged by hand";
  std::error_code ignored;
  if (!std::filesystem::exists(trial.clip.path, ignored)) {
    return "the recording is not where it was";
  }
  if (!trial.clip.id.empty() &&
      vision::ClipId(trial.clip.path) != trial.clip.id) {
    return "another recording lies where it was";
  }
  return "";
}

std::string AddStrip(const core::Trial& trial, Analysis& analysis,
                     report::ReportInput& input) {
  if (!analysis.track || analysis.track->poses.empty() || !analysis.plane ||
      analysis.plane->samples.empty()) {
    return "no body was followed over a ground";
  }
  try {
    const std::string why = WhyNotShown(trial);
    if (!why.empty()) return why;
    analysis.clip.path = trial.clip.path;  // where it was last seen
    input.strips.emplace(trial.id, TakeStrip(analysis));
  } catch (const core::InputError&) {
    return "the recording cannot be read";
  } catch (const std::invalid_argument&) {
    return "the recording has not the frames that were measured";
  }
  return "";
}

}  // namespace

void AddPictures(report::ReportInput& input, std::size_t most_strips) {
  const bool with_strips = input.trials.size() <= most_strips;
  for (const core::Trial& trial : input.trials) {
    core::Expected<Analysis> analysis = Replay(trial);
    std::string why;
    if (!analysis) {
      why = analysis.error().reason;
    } else {
      if (auto path = MakeTrajectory(*analysis)) {
        input.trajectories.emplace(trial.id, std::move(*path));
      }
      why = with_strips ? AddStrip(trial, *analysis, input)
                        : fmt::format("more than {} trials", most_strips);
    }
    if (!why.empty()) input.no_strip.emplace(trial.id, std::move(why));
  }
}

}  // namespace touchdown::pipeline
