#include "app/batch/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "app/text/csv_record.h"
#include "app/text/parse_number.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// A season of a lab is thousands of shots; a file of more rows is not a
// manifest.
constexpr std::size_t kMaxRows = 1'000'000;
// 256 MiB: a million rows of 256 bytes. The file is read into memory, so a long
// video that was given by mistake is refused before that.
constexpr std::uintmax_t kMaxBytes = 1u << 28;

// Reads one manifest, row by row, and stops at the first mistake. An example:
//
//   clip,campaign,set_angle_deg,fps
//   day1/shot_001.mraw,asphalt,11.5,
//   day1/shot_002.mraw,asphalt,12.0,5000
class ManifestReader {
 public:
  ManifestReader(const std::string& text, std::string name,
                 std::filesystem::path folder)
      : in_(text), name_(std::move(name)), folder_(std::move(folder)) {}

  std::vector<ManifestRow> Read() {
    report::SkipByteOrderMark(in_);
    ReadHeader();
    std::vector<ManifestRow> rows;
    // The row in which each clip first came. Two rows of one clip could state
    // two set-points for one shot.
    std::map<std::filesystem::path, std::size_t> seen;
    while (NextRecord()) {
      if (cells_.size() == 1 && cells_.front().empty()) continue;  // blank
      if (cells_.size() != header_.size()) {
        Fail(fmt::format("{} cells, {} as in the header were expected",
                         cells_.size(), header_.size()));
      }
      if (rows.size() == kMaxRows) {
        Fail(fmt::format("too many rows, at most {} were expected", kMaxRows));
      }
      rows.push_back(TakeRow());
      const auto [first, is_new] =
          seen.try_emplace(rows.back().clip.lexically_normal(), row_);
      if (!is_new) {
        Refuse("clip", rows.back().name,
               fmt::format("is already in row {}; one row a recording was "
                           "expected",
                           first->second));
      }
    }
    if (rows.empty()) {
      throw core::InputError(fmt::format(
          "{}: no recording is listed; a row for each was expected", name_));
    }
    return rows;
  }

 private:
  // Fail names the row, Refuse also the column and the cell. Both throw
  // core::InputError.
  [[noreturn]] void Fail(const std::string& what) const {
    throw core::InputError(fmt::format("{}: row {}: {}", name_, row_, what));
  }
  [[noreturn]] void Refuse(std::string_view column, std::string_view cell,
                           const std::string& what) const {
    throw core::InputError(fmt::format("{}: row {}, column {}: '{}': {}", name_,
                                       row_, column, cell, what));
  }

  // Puts the next row into cells_; false at the end of the file. `row_` counts
  // records: a quoted cell may go over several lines of the file.
  bool NextRecord() {
    ++row_;
    auto cells = report::ReadCsvRecord(in_, name_, row_);
    if (!cells) return false;
    cells_ = *std::move(cells);
    return true;
  }

  // Takes the header; refuses a column that is unknown, twice or missing. An
  // unknown column is a misspelt one, whose values would be lost silently.
  void ReadHeader() {
    if (!NextRecord()) {
      throw core::InputError(fmt::format(
          "{}: the file is empty; a header row was expected", name_));
    }
    header_ = cells_;
    for (const std::string& cell : header_) {
      const auto& columns = ManifestColumns();
      if (std::ranges::none_of(columns,
                               [&](const auto& c) { return c.name == cell; })) {
        Fail(fmt::format(
            "there is no column '{}'; see `touchdown batch --columns`", cell));
      }
      if (std::ranges::count(header_, cell) > 1) {
        Fail(fmt::format("column '{}' comes twice", cell));
      }
    }
    if (std::ranges::count(header_, "clip") == 0) {
      Fail("column 'clip' is missing, it must be there");
    }
  }

  // Returns the cell of this row in that column, nothing where the column is
  // not there or the cell is empty.
  std::optional<std::string> Text(std::string_view column) const {
    const auto at = std::ranges::find(header_, column);
    if (at == header_.end()) return std::nullopt;
    std::string cell = report::CsvCellText(
        cells_[static_cast<std::size_t>(at - header_.begin())]);
    if (cell.empty()) return std::nullopt;
    return cell;
  }

  // A number in low .. high.
  std::optional<double> Number(std::string_view column, double low, double high,
                               std::string_view range) const {
    const auto cell = Text(column);
    if (!cell) return std::nullopt;
    const auto value = report::ParseNumber<double>(*cell);
    if (!value || !(*value >= low && *value <= high)) {
      Refuse(column, *cell, fmt::format("a number {} was expected", range));
    }
    return value;
  }

  // Reads the row as a whole. Relative clips begin at the manifest's folder, so
  // that a folder with its manifest can be moved. Degrees become radians here.
  ManifestRow TakeRow() const {
    ManifestRow row;
    row.row = row_;
    const auto clip = Text("clip");
    // A path ends at a NUL byte: what follows it would be cut off silently.
    if (!clip || clip->find('\0') != std::string::npos) {
      Refuse("clip", clip.value_or(""), "the path of a recording was expected");
    }
    row.name = *clip;
    row.clip = folder_ / *clip;
    row.campaign = Text("campaign");
    constexpr double kMaxSpeed_mps = 1e4;  // beyond any ejector
    constexpr double kMaxFps = 1e9;        // beyond any camera
    if (const auto angle =
            Number("set_angle_deg", -90.0, 90.0, "from -90 to 90")) {
      row.set_angle_rad = *angle * core::kDegree;
    }
    row.set_speed_mps =
        Number("set_speed_mps", 0.0, kMaxSpeed_mps, "from 0 to 10000");
    row.fps = Number("fps", 1e-3, kMaxFps, "from 0.001 to 1e9");
    return row;
  }

  std::istringstream in_;
  std::string name_;
  std::filesystem::path folder_;
  std::size_t row_ = 0;
  std::vector<std::string> header_;
  std::vector<std::string> cells_;
};

}  // namespace

const std::vector<ManifestColumn>& ManifestColumns() {
  static const std::vector<ManifestColumn> columns = {
      {"clip",
       "must be there: a recording; a relative path begins at the manifest"},
      {"campaign", "its campaign; empty: the one of --campaign"},
      {"set_angle_deg", "set-point of the varied angle, -90 to 90"},
      {"set_speed_mps", "set-point of the launch speed"},
      {"fps",
       "frames per second of the recording; empty: that of --fps, or "
       "as the file says"},
  };
  return columns;
}

std::vector<ManifestRow> ParseManifest(const std::string& text,
                                       const std::string& name,
                                       const std::filesystem::path& folder) {
  return ManifestReader(text, name, folder).Read();
}

std::vector<ManifestRow> ReadManifest(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) {
    throw core::InputError(
        fmt::format("{}: cannot be read; a folder of recordings or a CSV "
                    "manifest was expected",
                    path.string()));
  }
  std::error_code trouble;
  const std::uintmax_t bytes = std::filesystem::file_size(path, trouble);
  if (trouble || bytes > kMaxBytes) {
    throw core::InputError(fmt::format(
        "{}: this is no manifest: a CSV file of at most {} bytes was expected",
        path.string(), kMaxBytes));
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return ParseManifest(text, path.string(), path.parent_path());
}

}  // namespace touchdown::pipeline
