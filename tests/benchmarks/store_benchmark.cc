// Speed of the trial store: bulk import, one durable log against one fsync, the
// report's query in a small and in a large store.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "tests/db/fixture.h"
#include "touchdown/core/quantities.h"
#include "touchdown/db/store.h"

namespace touchdown::db {
namespace {

// A trial as `analyze` makes it: 14 of 20 quantities present, a budget of five
// lines, a document of 3 kB.
core::Trial AnalyzedTrial(int number, const std::string& campaign) {
  core::Trial trial = SphereTrial(number, campaign);
  trial.clip.sha256 = std::string(56, 'a') + std::to_string(10000000 + number);
  for (std::size_t i = 0; i < 14; ++i) {
    At(trial.first, core::kContactQuantities.at(i)) =
        core::Estimate{0.1 + 0.001 * number, 0.001, std::nullopt};
  }
  trial.first.contact.approach_budget = {{"localisation", 0.01},
                                         {"ground", 0.02},
                                         {"scale", 0.001},
                                         {"roll", 0.005},
                                         {"time", 0.0001}};
  trial.document_json = std::string(3000, '{');
  return trial;
}

std::vector<core::Trial> AnalyzedTrials(int from, int count,
                                        const std::string& campaign) {
  std::vector<core::Trial> trials;
  trials.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    trials.push_back(AnalyzedTrial(from + i, campaign));
  }
  return trials;
}

void BulkImport(benchmark::State& state) {
  const auto trials = AnalyzedTrials(0, 10000, "asphalt");
  for (auto _ : state) {
    state.PauseTiming();
    Folder folder;
    {
      Store store = Store::Open(folder / "lab.db", OpenMode::kCreate);
      store.AddCampaign(SphereCampaign());
      state.ResumeTiming();
      benchmark::DoNotOptimize(store.LogTrials(trials));
      state.PauseTiming();
    }
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * 10000);
}
BENCHMARK(BulkImport)->Unit(benchmark::kMillisecond);

void OneDurableLog(benchmark::State& state) {
  Folder folder;
  Store store = Store::Open(folder / "lab.db", OpenMode::kCreate);
  int number = 0;
  for (auto _ : state) store.LogTrial(AnalyzedTrial(number++, ""));
}
BENCHMARK(OneDurableLog)->Unit(benchmark::kMicrosecond)->UseRealTime();

// The floor: append one page to a file and bring it to the disk.
void OneFsync(benchmark::State& state) {
  Folder folder;
  const int file =
      open((folder / "f").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  const std::array<char, 4096> page{};
  for (auto _ : state) {
    if (write(file, page.data(), page.size()) < 0 || fsync(file) != 0) {
      state.SkipWithError("fsync failed");
    }
  }
  close(file);
}
BENCHMARK(OneFsync)->Unit(benchmark::kMicrosecond)->UseRealTime();

// A store with a campaign of 1000 trials among `others` of another one. Made
// once: a million takes a minute and 2 GB of disk.
class Crowded {
 public:
  explicit Crowded(int others)
      : store_(Store::Open(folder_ / "lab.db", OpenMode::kCreate)) {
    store_.AddCampaign(SphereCampaign("others"));
    store_.AddCampaign(SphereCampaign());
    constexpr int kAtOnce = 10000;
    for (int i = 0; i < others; i += kAtOnce) {
      auto trials = AnalyzedTrials(i, std::min(kAtOnce, others - i), "others");
      for (auto& trial : trials) trial.document_json.clear();
      store_.LogTrials(trials);
    }
    store_.LogTrials(AnalyzedTrials(100000000, 1000, "asphalt"));
  }
  const Store& store() const { return store_; }

 private:
  Folder folder_;
  Store store_;
};

// The report's query of that campaign: flat, whatever else the store holds.
void ReportQuery(benchmark::State& state) {
  static std::map<std::int64_t, std::unique_ptr<Crowded>> made;
  auto& crowded = made[state.range(0)];
  if (!crowded) {
    crowded = std::make_unique<Crowded>(static_cast<int>(state.range(0)));
  }
  const TrialFilter filter{.campaign = "asphalt",
                           .origin = core::Origin::kRecorded,
                           .excluded = false,
                           .with_documents = false};
  for (auto _ : state) {
    benchmark::DoNotOptimize(crowded->store().Trials(filter));
  }
}
BENCHMARK(ReportQuery)
    ->RangeMultiplier(10)
    ->Range(1000, 1000000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchdown::db

BENCHMARK_MAIN();
