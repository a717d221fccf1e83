#include "app/simulate/shot_json.h"

#include "touchdown/core/units.h"

namespace touchdown::pipeline {

using nlohmann::ordered_json;

ordered_json BodyJson(const core::Body& body) {
  if (body.kind == core::BodyKind::kSphere) {
    return {{"kind", "sphere"},
            {"diameter_mm", body.diameter_m->value / core::kMillimetre}};
  }
  return {{"kind", "rectangle"},
          {"long_mm", body.long_m->value / core::kMillimetre},
          {"short_mm", body.short_m->value / core::kMillimetre}};
}

// Writes the sections that the reader of scene_file.h takes back. The state is
// written as `start` in all cases, also where it was given at touchdown.
ordered_json SceneJson(const Shot& shot) {
  ordered_json scene;
  scene["schema"] = "touchdown.scene/1";
  scene["name"] = shot.name;
  scene["body"] = BodyJson(shot.thrown.body);

  const analysis::RigidMotionProblem& thrown = shot.thrown;
  const analysis::BodyState& start = thrown.start;
  ordered_json& motion = scene["thrown"];
  motion["mu"] = thrown.mu;
  motion["restitution"] = thrown.restitution;
  motion["gravity_mps2"] = thrown.gravity_mps2;
  // 0 stands for the homogeneous body, which is the default.
  if (thrown.gyration_radius_m > 0.0) {
    motion["gyration_radius_mm"] = thrown.gyration_radius_m / core::kMillimetre;
  }
  const double gap = vision::Gap(thrown.body, {start.centre, start.angle_rad});
  motion["start"] = {
      {"x_mm", start.centre.x_m / core::kMillimetre},
      // Below the rounding of a height, the body lies on the ground.
      {"gap_mm", gap < 1e-12 ? 0.0 : gap / core::kMillimetre},
      {"vx_mps", start.vx_mps},
      {"vy_mps", start.vy_mps},
      {"angle_deg", start.angle_rad / core::kDegree},
      {"omega_rad_per_s", start.omega_rad_per_s}};

  scene["frames"] = shot.frames;
  scene["lead_in_frames"] = shot.lead_in_frames;
  scene["angle_kind"] = std::string(core::Name(shot.angle_kind));
  if (shot.set_angle_rad) {
    scene["set_angle_deg"] = *shot.set_angle_rad / core::kDegree;
  }
  if (shot.bounce_height_m) {
    scene["bounce_height_mm"] = *shot.bounce_height_m / core::kMillimetre;
  }
  const vision::SceneCamera& camera = shot.camera;
  scene["camera"] = {{"width_px", camera.width_px},
                     {"height_px", camera.height_px},
                     {"px_per_m", camera.px_per_m},
                     {"ground_x_px", camera.ground_point.x_px},
                     {"ground_y_px", camera.ground_point.y_px},
                     {"roll_deg", camera.roll_rad / core::kDegree},
                     {"travels", camera.travels_left ? "left" : "right"},
                     {"fps", camera.fps},
                     {"exposure_us", camera.exposure_s * 1e6},
                     {"psf_sigma_px", camera.psf_sigma_px},
                     {"bit_depth", camera.bit_depth}};
  if (camera.lens) {
    const calib::Lens& lens = *camera.lens;
    scene["camera"]["lens"] = {{"focal_px", lens.fx_px}, {"cx_px", lens.cx_px},
                               {"cy_px", lens.cy_px},    {"k1", lens.k1},
                               {"k2", lens.k2},          {"p1", lens.p1},
                               {"p2", lens.p2},          {"k3", lens.k3}};
  }
  // What most scenes do not have is not written.
  if (camera.yaw_rad != 0.0) {
    scene["camera"]["yaw_deg"] = camera.yaw_rad / core::kDegree;
  }
  if (camera.row_delay_s != 0.0) {
    scene["camera"]["row_delay_us"] = camera.row_delay_s * 1e6;
  }
  const vision::SceneLook& look = shot.look;
  scene["look"] = {{"body_level", look.body_level},
                   {"background_level", look.background_level},
                   {"ground_level", look.ground_level},
                   {"gradient_x", look.gradient_x},
                   {"gradient_y", look.gradient_y},
                   {"texture_amplitude", look.texture_amplitude},
                   {"texture_correlation_px", look.texture_correlation_px},
                   {"texture_seed", look.texture_seed}};
  if (look.hole > 0.0) scene["look"]["hole"] = look.hole;
  if (look.mark) {
    scene["look"]["mark"] = {{"level", look.mark->level},
                             {"distance", look.mark->distance},
                             {"radius", look.mark->radius}};
  }
  if (look.face) {
    scene["look"]["face"] = {{"amplitude", look.face->amplitude},
                             {"correlation_px", look.face->correlation_px},
                             {"seed", look.face->seed}};
  }
  // A clean scene has no section of troubles, so that a reader sees at once
  // that there are none.
  if (vision::HasTrouble(shot.trouble)) {
    const vision::SceneTrouble& t = shot.trouble;
    ordered_json& trouble = scene["trouble"];
    trouble = {{"shading_x", t.shading_x},
               {"shading_y", t.shading_y},
               {"highlight_level", t.highlight_level},
               {"highlight_x", t.highlight_x},
               {"highlight_y", t.highlight_y},
               {"highlight_sigma", t.highlight_sigma},
               {"shadow_depth", t.shadow_depth},
               {"flicker_amplitude", t.flicker_amplitude},
               {"flicker_hz", t.flicker_hz},
               {"wave_amplitude_px", t.wave_amplitude_px},
               {"wave_length_px", t.wave_length_px},
               {"specks", t.specks},
               {"speck_diameter_px", t.speck_diameter_px},
               {"speck_speed_px", t.speck_speed_px},
               {"speck_seed", t.speck_seed},
               {"obstacle_level", t.obstacle_level}};
    if (t.obstacle) {
      trouble["obstacle"] = {{"x", t.obstacle->x},
                             {"y", t.obstacle->y},
                             {"width", t.obstacle->width},
                             {"height", t.obstacle->height}};
    }
  }
  scene["noise"] = {{"read_dn", shot.noise.read_dn},
                    {"shot_dn2_per_dn", shot.noise.shot_dn2_per_dn}};
  return scene;
}

}  // namespace touchdown::pipeline
