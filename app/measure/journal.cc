#include "app/measure/journal.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <string>
#include <utility>

#include "app/measure/analyze.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// Control characters as \xNN; bytes from 0x80 on pass, so that UTF-8 does.
std::string OnOneLine(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  return out;
}

// What the file said of itself, and where the frame rate comes from.
void JournalClip(const Analysis& analysis) {
  const vision::ClipInfo& clip = analysis.clip;
  Journal(fmt::format(
      "opened in {:.3f} s: {}, {}x{}, {} bits, {} frames, {:g} frames/s ({}{})",
      analysis.timing.open_s, clip.format, clip.width_px, clip.height_px,
      clip.bit_depth, clip.frames, clip.time_base.fps,
      vision::Name(clip.time_base.source),
      clip.time_base.trusted ? "" : ", not trusted"));
}

// Wall times; the digest runs beside the rest and is not part of the sum.
void JournalTimes(const Timing& timing) {
  Journal(fmt::format(
      "times: decoding {:.3f} s, tracking with it {:.3f} s, contacts {:.3f} s, "
      "check of the answer {:.3f} s, digest beside it {:.3f} s, all {:.3f} s",
      timing.decode_s, timing.track_s, timing.contact_s, timing.check_s,
      timing.digest_s, timing.total_s));
}

}  // namespace

bool JournalIsKept() { return spdlog::should_log(spdlog::level::debug); }

void Journal(std::string_view line) {
  if (JournalIsKept()) spdlog::debug("{}", OnOneLine(line));
}

std::function<void(const char* stage)> StageJournal(
    const std::filesystem::path& recording) {
  if (!JournalIsKept()) return {};
  using Clock = std::chrono::steady_clock;
  // The name alone: jobs of a batch run beside each other, and each line has to
  // say whose it is.
  return [name = recording.filename().string(),
          begun = Clock::now()](const char* stage) {
    const std::chrono::duration<double> passed = Clock::now() - begun;
    Journal(
        fmt::format("{}: {}, from {:.3f} s on", name, stage, passed.count()));
  };
}

void JournalAnalysis(const Analysis& analysis) {
  if (!JournalIsKept()) return;
  JournalClip(analysis);
  for (const std::string& used : analysis.scene_model.used) {
    Journal("used: " + used);
  }
  for (const auto& [what, why] : analysis.scene_model.left_out) {
    Journal(fmt::format("left out: {}, because: {}", what, why));
  }
  const auto journal_absence = [](const char* what, const auto& part) {
    if (part) return;
    Journal(fmt::format("no {}, because: {}", what, part.error().reason));
  };
  journal_absence("scale", analysis.scale);
  journal_absence("ground", analysis.ground);
  journal_absence("body", analysis.body);
  const core::StateDecision& state = analysis.contacts.first.state;
  Journal(fmt::format("state: {}, because: {}; {} later contacts",
                      core::Name(state.label), state.reason,
                      analysis.contacts.later.size()));
  for (const std::string& warning : analysis.warnings) {
    Journal("warning: " + warning);
  }
  JournalTimes(analysis.timing);
}

}  // namespace touchdown::pipeline
