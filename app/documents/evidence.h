// What a person can check: the track as numbers and the contact as a picture.
#pragma once

#include <filesystem>
#include <optional>

#include "app/measure/analyze.h"
#include "touchdown/vision/overlay/contact_sheet.h"

namespace touchdown::pipeline {

// The frames around contact with what was measured drawn in; nothing where no
// body was followed over a ground. Throws core::InputError where the clip
// cannot be read again.
std::optional<vision::ColourImage> MakeContactSheet(const Analysis& analysis);

// Writes into `folder` (made where there is none):
//   track.csv     one row a frame: image and plane coordinates with u
//   contact.png   the frames around contact with what was measured drawn in
//   analysis.json the touchdown.analysis/1 document
// Each appears under its name only when it is complete. Throws
// core::OutputError naming the file that cannot be written, core::InputError
// naming the clip that cannot be read again.
void WriteEvidence(const Analysis& analysis,
                   const std::filesystem::path& folder);

}  // namespace touchdown::pipeline
