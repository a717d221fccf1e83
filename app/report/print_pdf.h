// A page of the report on paper.
#pragma once

#include <filesystem>

namespace touchdown::report {

// Prints `page`, an HTML file of ours, to `pdf`, tagged and with an outline, by
// Chromium without a window. The file appears only when it is whole. Throws
// core::InputError where no such browser is installed or it fails,
// core::OutputError where `pdf` cannot be written.
void PrintPdf(const std::filesystem::path& page,
              const std::filesystem::path& pdf);

}  // namespace touchdown::report
