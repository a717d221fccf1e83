// What a person sends who got a wrong answer, or none: enough to see the same
// on another machine, and nothing that was not shown before.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/doctor/doctor.h"

namespace touchdown::pipeline {

struct BugFile {
  std::string name;  // in the archive: "frames/000080.png"
  std::string what;  // a few words for a person
  std::string bytes;
};

struct BugOptions {
  std::filesystem::path clip;
  // Of `analyze`, as they would be typed, without the clip.
  std::vector<std::string> flags;
  // Further files that the analysis read (a calibration).
  std::vector<std::filesystem::path> also;
  int frames = 8;  // of the recording, at most; 0: none
  DoctorOptions doctor;
};

// Analyses the clip in a process of its own, so that one that ends by a signal
// is in the report too, and collects, where they are to be had:
//   command.txt    what was asked, and how it ended
//   analysis.json  the touchdown.analysis/1 document
//   log.txt        what --log says of it
//   doctor.txt     the machine
//   frames/N.png   some frames, the contact's first: the samples themselves
//   the recording's .cih or .cihx, or the first bytes of one that cannot be
//   opened, and `also`
// Throws std::invalid_argument where `frames` is negative, core::OutputError
// where there is no room for temporary files, core::InputError where there is
// no such clip.
std::vector<BugFile> CollectBug(const BugOptions& options);

// Writes the archive; all or nothing. Throws core::OutputError.
void WriteBug(std::span<const BugFile> files,
              const std::filesystem::path& target);

}  // namespace touchdown::pipeline
