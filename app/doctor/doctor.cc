#include "app/doctor/doctor.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/timex.h>
#include <sys/vfs.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <nlohmann/json.hpp>
#include <system_error>

#include "app/doctor/doctor_machine.h"
#include "app/measure/open_recording.h"
#include "app/trials/recordings.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// File systems over which SQLite's log does not work, by their number in
// statfs(2): NFS, SMB, SMB2.
bool IsOnNetwork(const fs::path& path) {
  constexpr std::int64_t kNfs = 0x6969, kSmb = 0x517b, kSmb2 = 0xfe534d42;
  struct statfs info {};
  if (statfs(path.c_str(), &info) != 0) return false;
  const auto type = static_cast<std::int64_t>(info.f_type) & 0xffffffff;
  return type == kNfs || type == kSmb || type == kSmb2;
}

// Opens the store and checks all of it (db::Check). Damage is told before the
// network drive: it is the more pressing of the two.
Finding StoreFinding(const DoctorOptions& options) {
  Finding finding{"store", Health::kGood, {}, {}};
  try {
    const auto store = db::Store::Open(options.store, db::OpenMode::kRead);
    const db::CheckReport report = db::Check(store);
    finding.text =
        fmt::format("{}: {} trials in {} campaigns", options.store.string(),
                    report.trials, report.campaigns);
    if (!report.problems.empty()) {
      finding.health = Health::kTrouble;
      finding.text += fmt::format("; {} problems, the first: {}",
                                  report.problems.size(), report.problems[0]);
      finding.advice = "go back to a backup, or export what can be read";
    } else if (IsOnNetwork(options.store)) {
      finding.health = Health::kTrouble;
      finding.text += "; on a network drive";
      finding.advice =
          "keep the store on a disk of this machine: two machines that write "
          "at once would damage it";
    }
  } catch (const core::StoreError& error) {
    finding.health = Health::kTrouble;
    finding.text = error.what();
  }
  return finding;
}

// Reads the calibration and says what it holds, of which camera and until when
// it is good. One that is out of date works and is a note.
Finding CameraFinding(const DoctorOptions& options) {
  Finding finding{"camera", Health::kGood, {}, {}};
  try {
    const auto camera = calib::ReadCalibration(options.calibration);
    std::string parts;
    if (camera.lens) parts += " lens";
    if (camera.scale) parts += " scale";
    if (camera.ground) parts += " ground";
    finding.text = fmt::format(
        "{}: {}, {}x{} px,{}; of {}, valid until {}",
        options.calibration.string(), camera.camera, camera.picture.width_px,
        camera.picture.height_px, parts, camera.date, camera.expires);
    if (const auto age = calib::AgeWarning(camera, options.today)) {
      finding.health = Health::kNote;
      finding.advice = *age;
    }
  } catch (const core::InputError& error) {
    finding.health = Health::kTrouble;
    finding.text = error.what();
  }
  return finding;
}

// The newest recording is read: its first and its last frame.
// Adds one finding, and a second one where the camera's clock is ahead.
void Recordings(const DoctorOptions& options, std::vector<Finding>& findings) {
  Finding finding{"recordings", Health::kGood, {}, {}};
  try {
    // The newest is the one that was written to last. A recording that vanishes
    // while it is measured counts as older than all others.
    fs::path newest;
    Extent of_newest;
    const auto all = FindRecordings(options.recordings);
    for (const fs::path& recording : all) {
      const Extent extent = MeasureExtent(recording);
      if (newest.empty() || extent.written > of_newest.written) {
        newest = recording;
        of_newest = extent;
      }
    }
    if (newest.empty()) {
      finding.health = Health::kNote;
      finding.text = options.recordings.string() + ": none is there";
      finding.advice =
          "let the camera write one, and look where it puts the file";
      findings.push_back(finding);
      return;
    }
    // Images tell no frame rate; to look at them, any will do.
    const bool tells_rate =
        !fs::is_directory(newest) && !vision::IsImageName(newest);
    vision::ClipOptions open;
    if (!tells_rate) open.fps = 1.0;
    const auto clip = OpenRecording(newest, open);
    const vision::ClipInfo& info = clip->info();
    // The first frame shows that the format is understood, the last that the
    // file is whole: one that was cut short fails there.
    clip->Read(0);
    clip->Read(info.frames - 1);
    finding.text = fmt::format(
        "{} in {}; the newest, {}: {}, {}x{} px, {} bits, {} frames, {}",
        all.size(), options.recordings.string(), newest.filename().string(),
        info.format, info.width_px, info.height_px, info.bit_depth, info.frames,
        tells_rate ? fmt::format("{:g} frames/s ({})", info.time_base.fps,
                                 vision::Name(info.time_base.source))
                   : "no frame rate");
    if (!tells_rate) {
      finding.health = Health::kNote;
      finding.advice =
          "images tell no rate: give the camera's by --fps with every analysis";
    } else if (!info.time_base.trusted) {
      finding.health = Health::kNote;
      finding.advice =
          "its rate may be that of playback: give --fps with every analysis";
    }
    // A recording dated after now shows that the camera's clock, or the file
    // server's, is ahead of this machine's. One that lags is not noticed.
    const auto ahead =
        of_newest.written - std::chrono::file_clock::from_sys(options.now);
    if (ahead > kClocksAgree) {
      findings.push_back(
          {"camera clock", Health::kNote,
           fmt::format("{} is dated {} minutes after now",
                       newest.filename().string(),
                       std::chrono::floor<std::chrono::minutes>(ahead).count()),
           "set the clocks of the camera and of this machine"});
    }
  } catch (const core::InputError& error) {
    finding.health = Health::kTrouble;
    finding.text = error.what();
  }
  findings.push_back(finding);
}

// Says how much room there is on the file system of `folder`, for an ordinary
// user (what is reserved for root is not counted).
Finding DiskFinding(const fs::path& folder) {
  Finding finding{"disk", Health::kGood, {}, {}};
  std::error_code trouble;
  const fs::path there = fs::absolute(folder, trouble);
  const fs::space_info room = fs::space(there, trouble);
  if (trouble) {
    return {"disk",
            Health::kTrouble,
            fmt::format("{}: {}", there.string(), trouble.message()),
            {}};
  }
  constexpr double kGB = 1e9;
  // One recording of 1280x800, 1000 frames of 12 bits, is 1.5 GB: room for six.
  constexpr double kFew_GB = 10.0;
  const double free_GB = static_cast<double>(room.available) / kGB;
  finding.text = fmt::format("{:.1f} GB free where {} is", free_GB,
                             there.lexically_normal().string());
  if (free_GB < kFew_GB) {
    finding.health = Health::kNote;
    finding.advice =
        "make room: a raw recording of 1000 frames takes about 1.5 GB";
  }
  return finding;
}

// Says what time it is and whether the kernel holds its clock to be set by a
// time server (STA_UNSYNC). A container may not be allowed to ask.
Finding ClockFinding(const DoctorOptions& options) {
  const std::time_t now = std::chrono::system_clock::to_time_t(options.now);
  std::tm utc{};
  gmtime_r(&now, &utc);
  timex state{};
  const bool known = adjtimex(&state) >= 0;
  const bool set = known && (state.status & STA_UNSYNC) == 0;
  Finding finding{"clock",
                  set ? Health::kGood : Health::kNote,
                  fmt::format("{:%Y-%m-%dT%H:%M:%SZ}, {}", utc,
                              set     ? "set by the network"
                              : known ? "set by nobody"
                                      : "who sets it is not known"),
                  {}};
  if (!set) {
    finding.advice =
        "compare it with a watch: trials are dated by it (systemd-timesyncd or "
        "chrony sets it)";
  }
  return finding;
}

}  // namespace

std::string_view Name(Health health) {
  switch (health) {
    case Health::kGood:
      return "good";
    case Health::kNote:
      return "note";
    case Health::kTrouble:
      break;
  }
  return "TROUBLE";
}

std::vector<Finding> Examine(const DoctorOptions& options) {
  // The machine comes first, then what was asked about; disk and clock, which
  // concern every measurement, end the list.
  std::vector<Finding> findings = ExamineMachine();
  if (!options.store.empty()) findings.push_back(StoreFinding(options));
  if (!options.calibration.empty()) findings.push_back(CameraFinding(options));
  if (!options.recordings.empty()) Recordings(options, findings);
  findings.push_back(DiskFinding(options.outputs));
  findings.push_back(ClockFinding(options));
  return findings;
}

std::string ToText(std::span<const Finding> findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += fmt::format("{:<8} {:<12} {}\n", Name(finding.health),
                        finding.subject, finding.text);
    if (!finding.advice.empty()) {
      text += fmt::format("{:<8} {:<12} -> {}\n", "", "", finding.advice);
    }
  }
  return text;
}

std::string ToJson(std::span<const Finding> findings) {
  using nlohmann::ordered_json;
  ordered_json list = ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"subject", finding.subject},
                    {"health", Name(finding.health)},
                    {"text", finding.text},
                    {"advice", finding.advice}});
  }
  return ordered_json{{"schema", "touchdown.doctor/1"}, {"findings", list}}
      .dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace touchdown::pipeline
