// A laboratory for the tests of a session: a store with a campaign, a rig, and
// a folder that recordings appear in.
#pragma once

#include <filesystem>
#include <string>

#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/db/store.h"

namespace touchdown::session {

// Throws spheres of 24 mm at 1.3 m/s.
inline constexpr const char* kRig =
    "schema = \"touchdown.rig/1\"\n"
    "name = \"bench\"\n"
    "[springs]\n"
    "stiffness_n_per_m = { value = 100.0, u = 1.0 }\n"
    "[ejector]\n"
    "u_compression_mm = 0.1\n"
    "[muzzle]\n"
    "elevation_min_deg = -45\n"
    "elevation_max_deg = 45\n"
    "height_min_mm = 15\n"
    "height_max_mm = 80\n"
    "[body]\n"
    "kind = \"sphere\"\n"
    "diameter_mm = 24\n"
    "mass_g = 10\n";

class Bench {
 public:
  Bench() {
    std::filesystem::create_directory(films());
    folder_.Write("rig.toml", kRig);
    auto store = db::Store::Open(db(), db::OpenMode::kCreate);
    store.AddCampaign(campaign());
  }

  std::filesystem::path db() const { return folder_ / "lab.db"; }
  std::filesystem::path rig() const { return folder_ / "rig.toml"; }
  std::filesystem::path films() const { return folder_ / "films"; }

  static core::Campaign campaign() {
    core::Campaign campaign;
    campaign.name = "asphalt";
    campaign.body = core::Sphere({0.024, 0.00002, std::nullopt});
    campaign.bounce_height_m = 0.0005;
    campaign.speed_min_mps = 1.2;
    campaign.speed_max_mps = 1.4;
    return campaign;
  }

  // A recording of a throw; each seed is another one.
  std::filesystem::path Film(const std::string& name, double angle_deg,
                             std::uint64_t seed) const {
    pipeline::filmed::WriteSphere(films() / name, angle_deg, seed);
    return films() / name;
  }
  // Of a body dropped from `height_m`, camera and all as in Film().
  std::filesystem::path Drop(const std::string& name, double height_m) const {
    pipeline::filmed::Film film =
        pipeline::filmed::Default(core::BodyKind::kSphere);
    film.camera.roll_rad = 0.0;
    film.thrown.before = {
        0.0, -std::sqrt(2.0 * core::kStandardGravity_mps2 * height_m), 0.0};
    film.thrown.after = {0.0, 1.2, 0.0};
    film.lead_in = 60;
    pipeline::filmed::WriteFilm(films() / name, film, 77);
    return films() / name;
  }

 private:
  testing::TemporaryFolder folder_;
};

}  // namespace touchdown::session
