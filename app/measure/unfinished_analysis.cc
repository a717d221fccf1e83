#include "app/measure/unfinished_analysis.h"

#include <fmt/format.h>

#include <utility>

#include "app/measure/options_hash.h"

namespace touchdown::pipeline {
namespace {

// What makes it shorter that was not said yet.
std::string WhatToDo(const AnalyzeOptions& options) {
  std::string todo = "give fewer frames by --frames A:B";
  if (options.region.width <= 0) todo += ", a --region X,Y,W,H";
  if (!options.diameter_m && !options.long_m) {
    todo += ", the body by --diameter-mm or --sides-mm";
  }
  return todo + ", or more time by --limit-s";
}

}  // namespace

Unfinished UnfinishedAnalysis(const vision::ClipInfo& clip,
                              const AnalyzeOptions& options,
                              const std::string& while_what) {
  // One reason in every place where a reader may look for one.
  const std::string reason =
      fmt::format("not done within {:g} s: ended {} of {}",
                  options.limit_s.value_or(0.0), while_what, clip.frames);
  Analysis so_far;
  so_far.clip = clip;
  so_far.warnings = clip.warnings;
  so_far.warnings.push_back(reason);
  const auto absent = core::AbsentBecause(reason);
  so_far.body = absent;
  so_far.track = absent;
  so_far.ground = absent;
  so_far.scale = absent;
  so_far.contacts.first.contact.reason = reason;
  so_far.contacts.first.state.reason = reason;
  // The body was not found, so that its kind is what the options say of it.
  so_far.angle_kind = options.angle_kind.value_or(core::DefaultAngleKind(
      options.long_m ? core::BodyKind::kRectangle
                     : options.body_kind.value_or(core::BodyKind::kSphere)));
  so_far.options = options;
  // Callbacks and pointers of the caller must not outlive the call.
  so_far.options.progress = nullptr;
  so_far.options.interrupted = nullptr;
  so_far.options_hash = OptionsHash(options);
  return {
      fmt::format("{}: {}; {}", clip.path.string(), reason, WhatToDo(options)),
      std::move(so_far)};
}

}  // namespace touchdown::pipeline
