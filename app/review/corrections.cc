#include "app/review/corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/documents/pictures.h"
#include "app/documents/replay.h"
#include "app/measure/judge.h"
#include "app/review/changes.h"
#include "app/review/fields.h"
#include "app/review/trial_view.h"
#include "app/text/json.h"
#include "app/text/parse_number.h"
#include "app/text/whole_number.h"
#include "app/trials/statement.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

using report::Json;

// Reads what the page sends. Points are of the recorded picture, in px. Throws
// std::invalid_argument naming the field, nlohmann's exceptions for values of
// another type.
pipeline::Correction ReadCorrection(const nlohmann::json& asked) {
  pipeline::Correction correction;
  if (const auto ground = ReadTwoPoints(asked, "ground_px")) {
    correction.ground =
        // u of the line follows from how well a hand places its two points.
        calib::MakeGroundLine(ground->first, ground->second,
                              pipeline::kByHand_px);
  }
  if (const auto frame = asked.find("contact_frame");
      frame != asked.end() && !frame->is_null()) {
    correction.contact_frame = pipeline::WholeNumber(*frame, "contact_frame");
  }
  if (const auto moved = asked.find("moved"); moved != asked.end()) {
    // Frames are the names of an object, since JSON has no numbers there.
    for (const auto& [name, by] : moved->items()) {
      const auto frame = report::ParseNumber<std::int64_t>(name);
      if (!frame) {
        throw std::invalid_argument(
            fmt::format("moved.{} is no frame, must be its number", name));
      }
      correction.moved[*frame] = {by.at(0).get<double>(),
                                  by.at(1).get<double>()};
    }
  }
  if (const auto out = asked.find("left_out"); out != asked.end()) {
    for (const auto& frame : *out) {
      correction.left_out.push_back(pipeline::WholeNumber(frame, "left_out"));
    }
  }
  return correction;
}

// Holds the trial with its correction, and the analysis that is drawn of it.
struct Corrected {
  core::Trial trial;
  core::Expected<pipeline::Analysis> analysis;
};

// Applies a correction, without storing it. What is measured anew comes first,
// then what a person states: a stated label wins over the judged one.
Corrected MakeCorrected(const core::Trial& seen, const nlohmann::json& asked) {
  Corrected out{seen, pipeline::Replay(seen)};
  const pipeline::Correction correction = ReadCorrection(asked);
  // A note or a label needs no track; a moved outline does.
  if (!correction.empty()) {
    if (!out.analysis) {
      throw std::invalid_argument("there is no track to correct: " +
                                  out.analysis.error().reason);
    }
    out.analysis = pipeline::Rejudge(*std::move(out.analysis), correction);
    out.trial = pipeline::WithAnalysis(seen, *out.analysis);
  }
  pipeline::Statement statement;
  statement.state = ReadTextField(asked, "state");
  statement.note = ReadTextField(asked, "note");
  pipeline::Apply(statement, out.trial);
  return out;
}

// Returns "corrected by A. Lee: ground was the mat", for whoever came too late.
std::string RevisionText(const db::Revision& last) {
  return fmt::format("{} by {}{}{}", db::Name(last.kind), last.trial.author,
                     last.trial.reason.empty() ? "" : ": ", last.trial.reason);
}

}  // namespace

Json PreviewJson(const core::Trial& seen, const nlohmann::json& asked) {
  const Corrected corrected = MakeCorrected(seen, asked);
  Json json = {{"numbers", NumbersJson(corrected.trial)},
               {"changes", ChangesJson(seen, corrected.trial)}};
  if (corrected.analysis) {
    json["view"] = ViewJson(*corrected.analysis);
  } else {
    json["view"] = {{"absent", corrected.analysis.error().reason}};
  }
  return json;
}

db::Logged Revise(db::Store& store, const std::string& id,
                  const nlohmann::json& asked) {
  const std::string who = RequiredText(asked, "who", "your name");
  const std::string why = RequiredText(asked, "why", "the reason");
  const auto expected = pipeline::WholeNumber(asked.at("revision"), "revision");
  const auto history = store.History(id);
  if (history.empty()) {
    throw core::StoreError(fmt::format("there is no trial {}", id));
  }
  const db::Revision& in_force = db::RevisionInForce(history);
  const core::Trial& last = in_force.trial;
  const auto require_last = [&] {
    if (last.revision == expected) return;
    throw Conflict(fmt::format(
        "revision {} was made meanwhile ({}); look at it and correct again",
        last.revision, RevisionText(in_force)));
  };
  // This is asked before anything is computed: the person may have looked at an
  // older revision.
  require_last();
  // One of the three is done, and the correction is not looked at.
  if (asked.value("exclude", false)) {
    return store.Exclude(id, who, why, expected);
  }
  if (asked.value("include", false)) {
    return store.Include(id, who, why, expected);
  }
  core::Trial trial;
  if (asked.contains("restore")) {
    trial =
        pipeline::Restated("restore", history, last,
                           pipeline::WholeNumber(asked["restore"], "restore"));
  } else {
    trial = MakeCorrected(last, asked).trial;
  }
  // A revision that says nothing new would only hide the one before it.
  if (db::Changes(last, trial).empty()) {
    throw std::invalid_argument("nothing would change; correct something");
  }
  try {
    const db::Logged logged = store.Correct(trial, who, why);
    // The kept picture shows what is in force.
    pipeline::KeepPicture(store.path(), trial);
    return logged;
  } catch (const core::StoreError&) {
    // Between looking and writing somebody else may have been quicker.
    const auto now = store.Find(id);
    if (now && now->revision != expected) {
      throw Conflict(fmt::format(
          "revision {} was made meanwhile; look at it and correct again",
          now->revision));
    }
    throw;
  }
}

}  // namespace touchdown::review
