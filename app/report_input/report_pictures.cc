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

// The centre's path and the gap in metres, x from where the first contact
// begins and heights above the ground that was found at that contact. Nothing
// without a scale, or without a flight before the contact.
std::optional<report::Trajectory> MakeTrajectory(const Analysis& analysis) {
  const auto& evidence = analysis.contacts.evidence;
  if (!analysis.scale || !analysis.plane || evidence.empty() ||
      !evidence.front().before) {
    return std::nullopt;
  }
  const vision::ContactEvidence& first = evidence.front();
  const double px_per_m = analysis.scale->px_per_m.value;
  // Position of the centre along the ground at touchdown, from the fitted
  // flight: touchdown lies between two frames.
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
  // A file of the same name may be another shot. Its digest tells: outlines
  // drawn into the wrong film would look like a wrong measurement.
  if (!trial.clip.id.empty() &&
      vision::ClipId(trial.clip.path) != trial.clip.id) {
    return "another recording lies where it was";
  }
  return "";
}

// Adds the strip of a trial to `input`, and returns why there is none; empty
// where it was added. A recording that is missing or damaged must not stop a
// report whose numbers are all in the store.
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
  // The limit is on the report, not on the trial: a strip for some trials and
  // not for others of one group would look like a choice.
  const bool with_strips = input.trials.size() <= most_strips;
  for (const core::Trial& trial : input.trials) {
    // The track comes out of the stored document; the clip is read only for
    // pictures.
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
