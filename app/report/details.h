// What a test report must say (ISO/IEC 17025, 7.8.2) and no trial knows:
// laboratory, customer, order, calibration dates, signatures. From report.toml.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::report {

// A piece of equipment. Where the name is one of the store's register, what it
// says here is added to what stands there.
struct Equipment {
  std::string name;
  std::string number;         // serial number or the laboratory's own
  std::string calibrated_on;  // YYYY-MM-DD
  std::string due_on;         // YYYY-MM-DD: next calibration
  std::string certificate;
};

struct Signature {
  std::string role;  // "tested by"
  std::string name;
};

// An empty text is absent, and the report says so.
struct Details {
  std::string file;  // where it stands; empty: none was given
  std::string number;
  std::string laboratory;
  std::string address;
  std::string accreditation;
  std::string customer;
  std::string contact;
  std::string order;
  std::string item;
  std::string received_on;
  std::string location;
  std::string trials_on;
  std::string operators;
  std::string method;
  std::string environment;
  std::string deviations;
  std::string remarks;
  std::vector<Equipment> equipment;
  std::vector<Signature> signatures;
};

// One line of the cover: the key "section.key" of report.toml, its name in
// print, and where it goes.
struct DetailField {
  std::string_view key;
  std::string_view name;
  std::string_view meaning;
  std::string Details::*member;
};
std::span<const DetailField> DetailFields();

// Reads report.toml. Throws core::InputError naming file and line where it
// cannot be read, holds an unknown key, no text, or a date that is none.
Details ReadDetails(const std::filesystem::path& path);

// A commented report.toml with every key.
std::string DetailsExample();

}  // namespace touchdown::report
