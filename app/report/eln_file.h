// A report as an .eln file: what electronic laboratory notebooks exchange, an
// RO-Crate in a zip archive (The ELN Consortium's file format; RO-Crate 1.1).
#pragma once

#include <filesystem>

#include "app/report/report.h"

namespace touchdown::report {

// Writes `folder`/table1.eln of the report's files that lie in `folder`, with
// the pages of evidence and the PDF where they are. The files must be there.
// The same files give the same bytes. Throws core::InputError where one cannot
// be read, core::OutputError where the archive cannot be written.
void WriteEln(const ReportInput& input, const std::filesystem::path& folder);

}  // namespace touchdown::report
