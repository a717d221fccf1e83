// report.toml -> Details. toml++ stays in this file. kDetailFields is the table
// of all single entries: reader, example and cover take keys and names from it.
// A line of the file, in its section [customer]: name = "Bureau of Roads".
#include "app/report/details.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "touchdown/calib/calibration_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

// Key, name in print, meaning for the example file, and place in Details. The
// order is that of the cover.
constexpr std::array kDetailFields{
    DetailField{"report.number", "report number", "unique in the laboratory",
                &Details::number},
    DetailField{"laboratory.name", "laboratory", "who made the trials",
                &Details::laboratory},
    DetailField{"laboratory.address", "its address", "street, town, country",
                &Details::address},
    DetailField{"laboratory.accreditation", "accreditation",
                "number, or \"not accredited for this test\"",
                &Details::accreditation},
    DetailField{"customer.name", "customer", "who ordered them",
                &Details::customer},
    DetailField{"customer.contact", "its contact", "address or person",
                &Details::contact},
    DetailField{"order.number", "order", "number and date of the order",
                &Details::order},
    DetailField{"order.item", "item tested", "what was handed in, its number",
                &Details::item},
    DetailField{"order.received_on", "received on",
                "date of receipt, with the item's condition",
                &Details::received_on},
    DetailField{"trials.location", "place of the trials",
                "where it is not the laboratory", &Details::location},
    DetailField{"trials.dates", "dates of the trials",
                "where the store does not know them", &Details::trials_on},
    DetailField{"trials.operator", "operator",
                "where the store does not know them", &Details::operators},
    DetailField{"trials.method", "method", "procedure, standard, edition",
                &Details::method},
    DetailField{"trials.environment", "environment",
                "what the trials do not say: temperature, humidity, light",
                &Details::environment},
    DetailField{"trials.deviations", "deviations",
                "from the method, or \"none\"", &Details::deviations},
    DetailField{"report.remarks", "remarks", "opinions, interpretations",
                &Details::remarks},
};

// The keys of one section with the texts that they fill.
using Texts = std::vector<std::pair<std::string_view, std::string*>>;

// Throws core::InputError "report.toml:12: what": every mistake in the file is
// the user's and is told with its line.
[[noreturn]] void Fail(const std::string& file, const toml::source_region& at,
                       const std::string& what) {
  throw core::InputError(fmt::format("{}:{}: {}", file, at.begin.line, what));
}

// "number, remarks": the keys that would have been right.
std::string Listed(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

// Takes the texts of one table [section]; a date of TOML is as good as one in
// quotes. Refuses keys that are not in `texts`: a typing error would else be an
// entry that is absent from the report without a word.
void Take(const std::string& file, std::string_view section,
          const toml::table& table, const Texts& texts) {
  for (const auto& [key, node] : table) {
    const auto found =
        std::find_if(texts.begin(), texts.end(),
                     [&](const auto& text) { return text.first == key.str(); });
    if (found == texts.end()) {
      std::vector<std::string> known;
      for (const auto& text : texts) known.emplace_back(text.first);
      Fail(file, key.source(),
           fmt::format("unknown key {}.{}; expected one of {}", section,
                       key.str(), Listed(known)));
    }
    // The stream writes it as YYYY-MM-DD.
    if (const auto* date = node.as_date()) {
      std::ostringstream text;
      text << date->get();
      *found->second = text.str();
    } else if (const auto* text = node.as_string()) {
      *found->second = text->get();
    } else {
      Fail(file, node.source(),
           fmt::format("{}.{} must be a text in quotes", section, key.str()));
    }
    // The cover compares these dates; other dates are printed as they are, and
    // may be a sentence.
    if (key.str().ends_with("_on") && section == "equipment" &&
        !found->second->empty() && !calib::IsDate(*found->second)) {
      Fail(file, node.source(),
           fmt::format("equipment.{} is '{}', must be a date as in 2026-08-31",
                       key.str(), *found->second));
    }
  }
}

// Calls `take` for every [[section]] of the file. Fails where it was written
// with single brackets, which can stand in the file only once.
template <class TakeOne>
void ForEach(const std::string& file, std::string_view section,
             const toml::node& node, TakeOne take) {
  const toml::array* array = node.as_array();
  if (array == nullptr || !array->is_homogeneous<toml::table>()) {
    Fail(file, node.source(),
         fmt::format("{0} must be written as [[{0}]], once for each", section));
  }
  for (const toml::node& one : *array) take(*one.as_table());
}

// "customer" of "customer.name".
std::string SectionName(std::string_view key) {
  return std::string(key.substr(0, key.find('.')));
}

// Takes one section of the file: lists of equipment and signatures entry by
// entry, all others by kDetailFields. Fails for a section that is not known.
void TakeSection(const std::string& file, std::string_view section,
                 const toml::node& node, Details& out) {
  if (section == "equipment") {
    ForEach(file, section, node, [&](const toml::table& table) {
      Equipment one;
      Take(file, section, table,
           {{"name", &one.name},
            {"number", &one.number},
            {"calibrated_on", &one.calibrated_on},
            {"due_on", &one.due_on},
            {"certificate", &one.certificate}});
      // The name is what the register and the cover know a piece by.
      if (one.name.empty()) {
        Fail(file, table.source(), "equipment.name is missing");
      }
      out.equipment.push_back(std::move(one));
    });
    return;
  }
  if (section == "signature") {
    ForEach(file, section, node, [&](const toml::table& table) {
      Signature one;
      Take(file, section, table, {{"role", &one.role}, {"name", &one.name}});
      out.signatures.push_back(std::move(one));
    });
    return;
  }
  Texts texts;
  for (const DetailField& field : kDetailFields) {
    if (SectionName(field.key) != section) continue;
    texts.emplace_back(field.key.substr(section.size() + 1),
                       &(out.*field.member));
  }
  if (texts.empty()) {
    Fail(file, node.source(),
         fmt::format("unknown section [{}]; expected report, laboratory, "
                     "customer, order, trials, [[equipment]] or [[signature]]",
                     section));
  }
  if (!node.is_table()) {
    Fail(file, node.source(),
         fmt::format("{0} must be a section, [{0}]", section));
  }
  Take(file, section, *node.as_table(), texts);
}

}  // namespace

std::span<const DetailField> DetailFields() { return kDetailFields; }

Details ReadDetails(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw core::InputError(fmt::format(
        "{}: cannot be read; `touchdown report --details-example` prints one",
        file));
  }
  Details out;
  // The report names the file, not the folder of the machine that it was made
  // on.
  out.file = path.filename().string();
  try {
    const toml::table table = toml::parse(in, file);
    for (const auto& [section, node] : table) {
      TakeSection(file, section.str(), node, out);
    }
  } catch (const toml::parse_error& error) {
    Fail(file, error.source(), std::string(error.description()));
  }
  return out;
}

std::string DetailsExample() {
  std::string out =
      "# What the cover of a report says beside what the store knows. An "
      "entry\n"
      "# that is left out, or empty, is named as absent.\n";
  // Sections in the order of their first key: TOML allows each of them only
  // once, and [report] has keys at both ends of the table.
  std::vector<std::string> sections;
  for (const DetailField& field : kDetailFields) {
    const std::string section = SectionName(field.key);
    if (std::find(sections.begin(), sections.end(), section) ==
        sections.end()) {
      sections.push_back(section);
    }
  }
  // `number = ""  # unique in the laboratory`: every entry is there and empty.
  for (const std::string& section : sections) {
    out += fmt::format("\n[{}]\n", section);
    for (const DetailField& field : kDetailFields) {
      if (SectionName(field.key) != section) continue;
      out += fmt::format("{} = \"\"  # {}\n",
                         field.key.substr(section.size() + 1), field.meaning);
    }
  }
  return out +
         "\n[[equipment]]  # once for each; a name of the store's register adds"
         " to it\n"
         "name = \"camera south\"\n"
         "number = \"\"\n"
         "calibrated_on = 2026-08-01\n"
         "due_on = 2027-08-01\n"
         "certificate = \"\"\n"
         "\n[[signature]]  # once for each line\n"
         "role = \"tested by\"\n"
         "name = \"\"\n"
         "\n[[signature]]\n"
         "role = \"authorised by\"\n"
         "name = \"\"\n";
}

}  // namespace touchdown::report
