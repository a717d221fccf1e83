// The views of the store (db/views.h) are written as they are: names, units and
// meanings of their columns become the schema.
#include "app/cli/store/tidy_export.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/exchange/trial_csv.h"
#include "app/text/text.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// Returns "trials.csv-metadata.json", where readers of CSV on the Web look for
// it.
fs::path SchemaPath(const fs::path& csv) {
  return csv.string() + "-metadata.json";
}

// Returns the schema of one CSV, after the W3C's "Metadata Vocabulary for
// Tabular Data". `csv` is the file's name as seen from the schema, `about` says
// what one row is.
std::string SchemaText(const std::string& csv, const std::string& about,
                       const std::vector<db::ViewColumn>& columns) {
  nlohmann::ordered_json json = {
      {"@context",
       {"http://www.w3.org/ns/csvw", {{"schema", "http://schema.org/"}}}},
      {"url", csv},
      {"dc:description", about},
      {"dialect", {{"header", true}, {"encoding", "utf-8"}}}};
  auto& list = json["tableSchema"]["columns"] = nlohmann::ordered_json::array();
  for (const db::ViewColumn& column : columns) {
    nlohmann::ordered_json one = {
        {"name", column.name},
        {"titles", column.name},
        {"datatype", column.type == db::ColumnType::kText   ? "string"
                     : column.type == db::ColumnType::kReal ? "number"
                                                            : "integer"},
        {"dc:description", column.meaning}};
    if (!column.unit.empty()) one["schema:unitText"] = column.unit;
    list.push_back(std::move(one));
  }
  return json.dump(2) + "\n";
}

// Returns a cell as CSV; NULL is empty. A real has as many digits as it needs
// to come back the same.
std::string CellText(const db::Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return report::CsvCell(*text);
  }
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return fmt::format("{}", *integer);
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return fmt::format("{}", *real);
  }
  return {};
}

// Writes a view row by row: memory does not grow with the store. CSV by RFC
// 4180 ends its lines with CR LF.
void WriteView(const db::Store& store, const db::View& view,
               std::string_view campaign, core::OutputFile& csv) {
  std::string line;
  for (const db::ViewColumn& column : view.columns) {
    line += (line.empty() ? "" : ",") + column.name;
  }
  csv.Write(line + "\r\n");
  db::ForEachRow(store, view, campaign, [&](std::span<const db::Cell> cells) {
    line.clear();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i != 0) line += ',';
      line += CellText(cells[i]);
    }
    csv.Write(line + "\r\n");
  });
}

}  // namespace

void WriteTidy(const db::Store& store, std::string_view campaign,
               const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) {
    throw core::OutputError(fmt::format("{}: cannot make this folder: {}",
                                        folder.string(), trouble.message()));
  }
  std::vector<std::unique_ptr<core::OutputFile>> files;
  for (const db::View& view : db::Views()) {
    const std::string name = view.name.substr(2) + ".csv";  // without "v_"
    files.push_back(std::make_unique<core::OutputFile>(folder / name));
    WriteView(store, view, campaign, *files.back());
    files.push_back(
        std::make_unique<core::OutputFile>(SchemaPath(folder / name)));
    files.back()->Write(
        SchemaText(name, "one row: " + view.one_row, view.columns));
  }
  // Everything is complete under temporary names. Only then do the files take
  // their names, and no signal ends the process in between.
  for (const auto& file : files) file->Finish();
  const core::AllOrNothing together;
  for (const auto& file : files) file->Commit();
}

void WriteTrialsSchema(const fs::path& csv) {
  std::vector<db::ViewColumn> columns;
  for (const report::CsvColumn& column : report::TrialCsvColumns()) {
    const std::string unit =
        column.is_number ? db::FindUnit(column.name) : std::string();
    // These two are whole numbers; the other numeric columns are real.
    const bool is_count =
        column.name == "revision" || column.name == "clip_size_bytes";
    columns.push_back({column.name,
                       is_count           ? db::ColumnType::kInteger
                       : column.is_number ? db::ColumnType::kReal
                                          : db::ColumnType::kText,
                       unit, column.meaning});
  }
  core::OutputFile file(SchemaPath(csv));
  file.Write(SchemaText(csv.filename().string(),
                        "one row: a trial, as the revision in force states it",
                        columns));
  file.Commit();
}

}  // namespace touchdown::cli
