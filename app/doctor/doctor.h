// What of this machine, its store and its camera would stand in the way of a
// measurement: looked at before anything fails.
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace touchdown::pipeline {

enum class Health {
  kGood,
  kNote,    // works; a person should know
  kTrouble  // something that was asked for will not work
};
std::string_view Name(Health health);  // "good", "note", "TROUBLE"

struct Finding {
  std::string subject;  // "program", "video", "store" ...
  Health health = Health::kGood;
  std::string text;    // one line
  std::string advice;  // what to do; empty where nothing is
};

struct DoctorOptions {
  // Each is looked at where it is given.
  std::filesystem::path store;
  std::filesystem::path calibration;
  std::filesystem::path recordings;     // a folder: its newest one is opened
  std::filesystem::path outputs = ".";  // where there must be room
  std::string today;                    // YYYY-MM-DD, of the local clock
  std::chrono::system_clock::time_point now;
};

// Throws nothing that it can say as a finding.
std::vector<Finding> Examine(const DoctorOptions& options);

// "good     program  0.1.0 (...)" a line, with what to do below it; control
// characters of names as \xNN are the caller's to print.
std::string ToText(std::span<const Finding> findings);
// touchdown.doctor/1
std::string ToJson(std::span<const Finding> findings);

}  // namespace touchdown::pipeline
