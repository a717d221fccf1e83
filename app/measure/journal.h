// What the program does, for who looks for the reason of something: quiet
// unless --verbose or --log was given (cli/log_setup.h).
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace touchdown::pipeline {

struct Analysis;

// Whether anybody listens: what takes time to say is left out otherwise.
bool JournalIsKept();

// One line. What is no printable ASCII or UTF-8 byte stands as \xNN: names and
// lines of devices are shown as they are and cannot forge a line.
void Journal(std::string_view line);

// Says each stage of the analysis of a recording as it begins, and how long
// after this call; null where nobody listens. For core::Cancellation::After.
std::function<void(const char* stage)> StageJournal(
    const std::filesystem::path& recording);

// What an analysis chose, why, and how long its parts took, when it is done.
void JournalAnalysis(const Analysis& analysis);

}  // namespace touchdown::pipeline
