// The archive table1.eln, as an electronic laboratory notebook imports it:
//
//   table1/ro-crate-metadata.json   what the files are, as JSON-LD
//   table1/table1.html, table1.csv, ...
//   table1/evidence/<trial>.html    where the report has such pages
#include "app/report/eln_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/report/evidence_page.h"
#include "app/text/json.h"
#include "app/text/text_file.h"
#include "app/text/zip_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

namespace fs = std::filesystem;

// The one folder in the archive bears its name.
constexpr std::string_view kRoot = "table1";

// By the ending of the name. The PDF is the only other kind of file here.
std::string MediaType(const fs::path& name) {
  const std::string kind = name.extension().string();
  if (kind == ".html") return "text/html";
  if (kind == ".csv") return "text/csv";
  if (kind == ".json") return "application/json";
  if (kind == ".md") return "text/markdown";
  if (kind == ".tex") return "application/x-tex";
  return "application/pdf";
}

// The files of the report as paths relative to its folder, sorted, so that the
// archive has the same order whatever the folder's own is.
std::vector<std::string> ListFiles(const ReportInput& input,
                                   const fs::path& folder) {
  std::vector<std::string> out(std::begin(kReportFiles),
                               std::end(kReportFiles));
  std::error_code ignored;
  // The PDF is there only where the user asked for it.
  if (fs::exists(folder / "table1.pdf", ignored))
    out.emplace_back("table1.pdf");
  for (const core::Trial& trial : input.trials) {
    const std::string page = EvidenceLink(input, trial);
    if (!page.empty()) out.push_back(page);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// A link to another object of the metadata, as JSON-LD has it.
Json Reference(const std::string& id) { return {{"@id", id}}; }

// A file of the archive. All are in memory at once: the metadata, which comes
// first, states their sizes.
struct Entry {
  std::string name;  // with folders, "/" between them
  std::string bytes;
};

// The text of ro-crate-metadata.json: a flat list ("@graph") of the metadata
// file itself, the report, the laboratory, the program and every file.
std::string Metadata(const ReportInput& input,
                     const std::vector<Entry>& files) {
  Json parts = Json::array();
  Json graph = Json::array();
  const std::string root = std::string(kRoot) + "/";
  // Names in the metadata are relative to the folder of the metadata file.
  for (const Entry& file : files) {
    const std::string id = "./" + file.name.substr(root.size());
    parts.push_back(Reference(id));
    graph.push_back({{"@id", id},
                     {"@type", "File"},
                     {"name", fs::path(file.name).filename().string()},
                     {"encodingFormat", MediaType(file.name)},
                     {"contentSize", std::to_string(file.bytes.size())}});
  }
  const std::string laboratory = input.details.laboratory.empty()
                                     ? "laboratory not named"
                                     : input.details.laboratory;
  Json report = {{"@id", "./"},
                 {"@type", "Dataset"},
                 {"name", input.title},
                 {"description", input.source},
                 {"datePublished", input.made_on},
                 {"author", Reference("#laboratory")},
                 {"hasPart", std::move(parts)}};
  if (!input.details.number.empty()) {
    report["identifier"] = input.details.number;
  }
  // The descriptor first, which leads to the root "./", the report, and from
  // there to its parts.
  Json head = {
      {{"@id", "ro-crate-metadata.json"},
       {"@type", "CreativeWork"},
       {"about", Reference("./")},
       {"conformsTo", Reference("https://w3id.org/ro/crate/1.1")},
       {"sdPublisher", Reference("#software")},
       {"dateCreated", input.made_on}},
      std::move(report),
      {{"@id", "#laboratory"}, {"@type", "Organization"}, {"name", laboratory}},
      {{"@id", "#software"},
       {"@type", "SoftwareApplication"},
       {"name", "touchdown"},
       {"softwareVersion", input.software_version}}};
  for (Json& one : graph) head.push_back(std::move(one));
  const Json out = {{"@context", "https://w3id.org/ro/crate/1.1/context"},
                    {"@graph", std::move(head)}};
  // Bytes that are not UTF-8 become replacement characters: a note of a trial
  // must not keep the report from being made.
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void WriteEln(const ReportInput& input, const fs::path& folder) {
  std::vector<Entry> entries;
  for (const std::string& name : ListFiles(input, folder)) {
    // A report that was moved or half deleted: the archive would promise what
    // it does not hold.
    if (!fs::exists(folder / name)) {
      throw core::InputError(fmt::format("{}: not found; make the report again",
                                         (folder / name).string()));
    }
    entries.push_back(
        {fmt::format("{}/{}", kRoot, name), ReadTextFile(folder / name)});
  }
  pipeline::ZipFile zip(folder / "table1.eln");
  zip.Add(fmt::format("{}/ro-crate-metadata.json", kRoot),
          Metadata(input, entries));
  for (const Entry& entry : entries) zip.Add(entry.name, entry.bytes);
  zip.Commit();
}

}  // namespace touchdown::report
