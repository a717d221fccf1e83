// What the program says beside its results: one line each on stderr.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::cli {

// Text of a file, or of a person, as it may be shown on a terminal: control
// characters, marks that turn the direction of writing and bytes that are no
// UTF-8 as \xNN.
std::string Printable(std::string_view text);

// "touchdown: `text`", made printable, and a line feed. A stderr that is full
// or closed is passed over: nothing fails for want of a listener.
void Tell(std::string_view text) noexcept;

// Bytes as they are, for a terminal.
void TellRaw(std::string_view bytes) noexcept;

// Makes stdin, stdout and stderr exist, so that no file that is opened takes
// the place of one that was closed: what is then written to stdout fails, and
// what is written to stderr goes nowhere. Once, before any file is opened.
void KeepStandardStreams();

// Flushes stdout. Throws core::OutputError where anything that was ever written
// to it did not arrive.
void RequireStdoutWritten();

}  // namespace touchdown::cli
