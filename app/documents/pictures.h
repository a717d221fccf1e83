// Finds the pictures that analyses left behind.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "touchdown/core/trial.h"

namespace touchdown::pipeline {

// Where a store keeps the pictures of its trials' contacts: "lab.db.evidence".
std::filesystem::path PictureFolder(const std::filesystem::path& store);

// Draws the contact of `trial` from its recording and what the trial holds of
// the analysis, however it was logged, and keeps it beside the store. Nothing
// is thrown: false where there is nothing to draw (no analysis, no body), the
// recording is not where it was, or the picture cannot be written, with the
// reason in the journal.
bool KeepPicture(const std::filesystem::path& store, const core::Trial& trial);

// The kept pictures of `trials`, by trial id.
std::map<std::string, std::filesystem::path> KeptPictures(
    const std::filesystem::path& store, std::span<const core::Trial> trials);

// The contact.png of every trial's analysis in `folder` and below it, by trial
// id: beside an analysis.json of the same recording (clip id) with the same
// options. Where several fit, the first by path. What is no evidence is passed
// over. Throws core::InputError where the folder cannot be read.
std::map<std::string, std::filesystem::path> FindPictures(
    const std::filesystem::path& folder, std::span<const core::Trial> trials);

}  // namespace touchdown::pipeline
