// What the program does, for who looks for the reason of something: quiet
// unless --verbose or --log was given (cli/log_setup.h).
#pragma once

#include <string_view>

namespace touchdown::pipeline {

struct Analysis;

// Whether anybody listens: what takes time to say is left out otherwise.
bool JournalIsKept();

// One line. What is no printable ASCII or UTF-8 byte stands as \xNN: names and
// lines of devices are shown as they are and cannot forge a line.
void Journal(std::string_view line);

// Each stage of an analysis with its time, what was chosen, and why.
void JournalAnalysis(const Analysis& analysis);

}  // namespace touchdown::pipeline
