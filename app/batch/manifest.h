// A list of recordings with what is known of each beforehand: a CSV file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::pipeline {

struct ManifestRow {
  std::size_t row = 0;         // in the file; the header is row 1
  std::filesystem::path clip;  // relative ones begin at the manifest's folder
  std::string name;            // as it stands in the file
  std::optional<std::string> campaign;  // nothing: the batch's
  std::optional<double> set_angle_rad;
  std::optional<double> set_speed_mps;
  std::optional<double> fps;
};

// The columns, with the unit in each name; `touchdown batch --columns` prints
// them. Only `clip` must be there; an empty cell says nothing.
struct ManifestColumn {
  std::string_view name;
  std::string_view meaning;
};
const std::vector<ManifestColumn>& ManifestColumns();

// Reads a manifest (RFC 4180, UTF-8, one header row). Throws core::InputError
// naming file, row and column of the first mistake: an unknown or repeated
// column, a number that is none or out of range, a clip that comes twice, more
// than a million rows.
std::vector<ManifestRow> ReadManifest(const std::filesystem::path& path);

// The same from text; `folder` is where relative clips begin, `name` what
// messages call the file.
std::vector<ManifestRow> ParseManifest(const std::string& text,
                                       const std::string& name,
                                       const std::filesystem::path& folder);

}  // namespace touchdown::pipeline
