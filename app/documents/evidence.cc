#include "app/documents/evidence.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "app/documents/analysis_json.h"
#include "app/measure/undistorted_clip.h"
#include "app/text/format.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/unfinished.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/footage/image_file.h"
#include "touchdown/vision/overlay/contact_sheet.h"

namespace touchdown::pipeline {
namespace {

// Makes track.csv, a row a frame; the heading alone where no body was followed.
//
//   x_px, y_px   centre in the recorded picture, pixel centres at integers
//   angle_deg    of the long side in the picture; empty for a sphere
//   misfit       normalised residual rms of the outline fit
//   along_px .. face_deg   the same pose seen from the ground line
//
// Units are px, since a scale may be absent.
std::string TrackCsv(const Analysis& analysis) {
  std::string csv =
      "frame,time_s,x_px,y_px,u_x_px,u_y_px,angle_deg,u_angle_deg,misfit,"
      "along_px,height_px,gap_px,u_gap_px,face_deg\n";
  if (!analysis.track) return csv;
  const auto& poses = analysis.track->poses;
  const bool turns = analysis.plane && vision::ShowsTurn(*analysis.plane);
  std::size_t at = 0;  // of the plane's samples: frames may be missing there
  for (const vision::Pose& p : poses) {
    csv +=
        fmt::format("{},{:.9f},{:.5f},{:.5f},{:.5f},{:.5f},", p.frame, p.time_s,
                    p.centre.x_px, p.centre.y_px, p.u_x_px, p.u_y_px);
    csv += turns ? fmt::format("{:.6f},{:.6f},", p.angle_rad / core::kDegree,
                               p.u_angle_rad / core::kDegree)
                 : std::string(",,");
    csv += fmt::format("{:.3f},", p.misfit);
    // Both lists are in the order of frames, so one index walks along.
    if (analysis.plane && at < analysis.plane->samples.size() &&
        analysis.plane->samples[at].frame == p.frame) {
      const vision::PlaneSample& s = analysis.plane->samples[at++];
      csv += fmt::format("{:.5f},{:.5f},{:.5f},{:.5f},", s.along_px,
                         s.height_px, s.gap_px, s.u_gap_px);
      if (turns) csv += fmt::format("{:.6f}", s.face_rad / core::kDegree);
    } else {
      csv += ",,,,";
    }
    csv += '\n';
  }
  return csv;
}

// Makes the heading of the contact's picture: file, state and contact angle.
// SIMULATED stands on it, since pictures travel without their document.
std::string Title(const Analysis& analysis) {
  const core::ContactRecord& first = analysis.contacts.first;
  std::string title = analysis.clip.path.filename().string();
  if (analysis.simulated) title += "  SIMULATED";
  title += fmt::format("   state: {}", Name(first.state.label));
  const core::Measured& angle = Angle(first.contact, analysis.angle_kind);
  if (angle) {
    title += fmt::format("   {} angle {} deg", Name(analysis.angle_kind),
                         report::InAscii(report::WithU(*angle, core::kDegree)));
  }
  return title;
}

}  // namespace

std::optional<vision::ColourImage> MakeContactSheet(const Analysis& analysis) {
  if (!analysis.track || !analysis.plane || analysis.track->poses.empty()) {
    return std::nullopt;
  }
  // The recording is read again, undistorted where there is a lens: drawn lines
  // and flights are straight and parabolic only there.
  const Drawable drawable = OpenToDraw(analysis);
  vision::ContactSheetOptions sheet_options;
  sheet_options.title = Title(analysis);
  return vision::DrawContactSheet(*drawable.clip, drawable.track,
                                  *analysis.plane, analysis.contacts,
                                  sheet_options);
}

void WriteEvidence(const Analysis& analysis,
                   const std::filesystem::path& folder) {
  // All of it is made before any is written: who ends the program between two
  // files leaves none.
  // The picture needs the recording a second time and may fail, so it is drawn
  // before the folder is made.
  const std::string track = TrackCsv(analysis);
  const std::string document = ToJson(analysis) + "\n";
  const std::optional<vision::ColourImage> sheet = MakeContactSheet(analysis);
  // From here on a signal waits: the three files appear together.
  const core::AllOrNothing together;
  std::error_code trouble;
  std::filesystem::create_directories(folder, trouble);
  if (trouble) {
    throw core::OutputError(fmt::format("{}: cannot make this folder: {}",
                                        folder.string(), trouble.message()));
  }
  report::WriteTextFile(folder / "track.csv", track);
  report::WriteTextFile(folder / "analysis.json", document);
  if (sheet) {
    vision::WritePngRgb(folder / "contact.png", sheet->width_px,
                        sheet->height_px, sheet->rgb);
  }
}

}  // namespace touchdown::pipeline
