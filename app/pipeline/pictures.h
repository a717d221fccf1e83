// Finds the pictures that analyses left behind.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "touchdown/core/trial.h"

namespace touchdown::pipeline {

// The contact.png of every trial's analysis in `folder` and below it, by trial
// id: beside an analysis.json of the same recording (clip id) with the same
// options. Where several fit, the first by path. What is no evidence is passed
// over. Throws core::InputError where the folder cannot be read.
std::map<std::string, std::filesystem::path> FindPictures(
    const std::filesystem::path& folder, std::span<const core::Trial> trials);

}  // namespace touchdown::pipeline
