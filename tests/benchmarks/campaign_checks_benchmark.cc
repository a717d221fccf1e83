// Whether campaigns of twenty trials show a wrong frame rate, scale or size of
// the body, and how often right ones are blamed. Clips of the declared design
// (tests/accuracy/design.h) are analysed four times: told the truth, a frame
// rate 2 % too high, a scale 3 % too high, a body 5 % smaller than stated.
// Campaigns are drawn from what the checks of these say.
// Usage: touchdown_campaign_checks_benchmark [CLIPS] [CAMPAIGNS] [SEED]
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <numeric>
#include <random>
#include <vector>

#include "app/documents/analysis_json.h"
#include "app/facts/campaign_checks.h"
#include "app/measure/analyze.h"
#include "tests/accuracy/design.h"
#include "touchdown/vision/synthetic/render.h"

namespace {

using namespace touchdown;

constexpr std::size_t kTrials = 20;

struct Told {
  const char* name;
  double fps = 1.0;  // over the truth
  double scale = 1.0;
  double size = 1.0;
};
constexpr std::array kTold = {Told{"right"}, Told{"frame rate 2 % wrong", 1.02},
                              Told{"scale 3 % wrong", 1.0, 1.03},
                              Told{"body 5 % smaller", 1.0, 1.0, 1.0 / 0.95}};

// The same pictures, taken for faster ones: at a frame rate told too high all
// speeds are as much too large, and gravity by the square of it.
pipeline::filmed::Film AtRate(pipeline::filmed::Film film, double factor) {
  film.camera.fps *= factor;
  film.camera.exposure_s /= factor;
  auto& thrown = film.thrown;
  for (auto* v : {&thrown.before, &thrown.after}) {
    v->vx *= factor;
    v->vy *= factor;
    v->omega *= factor;
  }
  thrown.duration_s /= factor;
  thrown.gravity_mps2 *= factor * factor;
  return film;
}

core::Trial TrialOf(const accuracy::Case& c, const Told& told) {
  pipeline::AnalyzeOptions options;
  const auto& thrown = c.film.thrown;
  constexpr double kPlainU = 1e-3;  // as a plain number has it
  const auto size = [&](double half_m) {
    const double value = 2.0 * half_m * told.size;
    return core::Estimate{value, kPlainU * value, {}};
  };
  options.body_kind = thrown.kind;
  if (thrown.kind == core::BodyKind::kSphere) {
    options.diameter_m = size(thrown.half_long_m);
  } else {
    options.long_m = size(thrown.half_long_m);
    options.short_m = size(thrown.half_short_m);
  }
  const double scale = c.told_px_per_m * told.scale;
  options.scale_px_per_m = core::Estimate{scale, kPlainU * scale, {}};
  const pipeline::Analysis analysis = pipeline::AnalyzeClip(
      vision::OpenScene(pipeline::filmed::BuildScene(AtRate(c.film, told.fps)),
                        c.seed),
      options);
  core::Trial trial;
  trial.first = analysis.contacts.first;
  trial.document_json = pipeline::ToJson(analysis);
  return trial;
}

double Share(int count, int all) { return 100.0 * count / all; }

}  // namespace

int main(int argc, char** argv) {
  const int clips = argc > 1 ? std::atoi(argv[1]) : 400;
  const int campaigns = argc > 2 ? std::atoi(argv[2]) : 1000;
  std::mt19937_64 engine(argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
  fmt::print(
      "told,clips,gravity told by,size told by,campaigns,flagged %,by gravity "
      "%,by size %\n");
  for (const Told& told : kTold) {
    std::vector<core::Trial> trials;
    int gravity = 0;
    int size = 0;
    for (int i = 0; i < clips; ++i) {
      trials.push_back(TrialOf(accuracy::Draw(static_cast<std::uint64_t>(i),
                                              accuracy::Hardship::kNone),
                               told));
      const report::TrialRatios r = report::ReadRatios(trials.back());
      gravity += r.gravity ? 1 : 0;
      size += r.size ? 1 : 0;
    }
    int flagged = 0;
    int by_gravity = 0;
    int by_size = 0;
    std::uniform_int_distribution<std::size_t> any(0, trials.size() - 1);
    for (int k = 0; k < campaigns; ++k) {
      std::vector<std::size_t> members(kTrials);
      for (std::size_t& m : members) m = any(engine);
      const report::CampaignChecks checks =
          report::CheckCampaign(members, trials);
      flagged += checks.Failed() ? 1 : 0;
      by_gravity += checks.gravity && checks.gravity->failed ? 1 : 0;
      by_size += checks.size && checks.size->failed ? 1 : 0;
    }
    fmt::print("{},{},{},{},{},{:.1f},{:.1f},{:.1f}\n", told.name, clips,
               gravity, size, campaigns, Share(flagged, campaigns),
               Share(by_gravity, campaigns), Share(by_size, campaigns));
    std::fflush(stdout);
  }
  return 0;
}
