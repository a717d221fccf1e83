// What the tests of the store share: a folder that goes away, time and names
// that repeat, trials as a lab makes them.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>

#include "touchdown/core/units.h"
#include "touchdown/db/store.h"

namespace touchdown::db {

class Folder {
 public:
  Folder() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "touchdown-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// One second passes between two looks at the clock.
inline Sources FixedSources(std::uint64_t seed) {
  const auto engine = std::make_shared<std::mt19937_64>(seed);
  const auto second = std::make_shared<int>(0);
  Sources sources;
  sources.new_uuid = [engine] { return RandomUuid(*engine); };
  sources.now_utc = [second] {
    const int now = (*second)++;
    char text[32];
    std::snprintf(text, sizeof text, "2026-08-%02dT%02d:%02d:%02d.000Z",
                  1 + now / 86400 % 28, now / 3600 % 24, now / 60 % 60,
                  now % 60);
    return std::string(text);
  };
  return sources;
}

inline Store OpenFixed(const std::filesystem::path& path,
                       std::uint64_t seed = 1,
                       OpenMode mode = OpenMode::kCreate) {
  return Store::Open(path, mode, {.sources = FixedSources(seed)});
}

inline core::Campaign SphereCampaign(const std::string& name = "asphalt") {
  core::Campaign campaign;
  campaign.name = name;
  campaign.body = core::Sphere({0.04, 0.00002, std::nullopt});
  campaign.surface = "asphalt, dry";
  campaign.bounce_height_m = 0.0008;
  campaign.speed_min_mps = 1.0;
  campaign.speed_max_mps = 5.0;
  campaign.theory_name = "published";
  campaign.theory_boundary_rad = 11.8 * core::kDegree;
  return campaign;
}

inline core::Trial SphereTrial(int number,
                               const std::string& campaign = "asphalt") {
  core::Trial trial;
  trial.campaign = campaign;
  trial.clip.id = "clip-" + std::to_string(number);
  trial.clip.path = "/lab/clips/" + std::to_string(number) + ".mraw";
  trial.clip.size_bytes = 1000 + number;
  trial.body = core::Sphere({0.04, 0.00002, std::nullopt});
  trial.first.contact.found = true;
  trial.first.contact.approach_angle_rad =
      core::Estimate{0.1 + 0.001 * number, 0.0005, std::nullopt};
  trial.first.state.label = number % 2 == 0 ? core::MotionState::kBounce
                                            : core::MotionState::kStaysDown;
  trial.author = "touchdown 0.1.0";
  return trial;
}

}  // namespace touchdown::db
