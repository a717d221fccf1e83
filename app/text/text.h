// Small text helpers of every report: signs, escaping.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace touchdown::report {

// Text that is safe inside HTML elements and quoted attributes.
std::string HtmlEscape(std::string_view text);

// Signs as a printer sets them: the minus of a number ("-0.5" at the beginning
// or after a space or bracket) and "+-" between two. Names keep their hyphens.
std::string Typeset(std::string_view text);

// One CSV cell (RFC 4180): quoted where it must be. A cell that a spreadsheet
// would run as a formula (it starts with = + - @ or a tab, and is not a plain
// number) is prefixed with an apostrophe.
std::string CsvCell(std::string_view text);

// Text that is safe in Markdown, table cells included: markup characters are
// escaped, line breaks become spaces.
std::string MarkdownEscape(std::string_view text);

// RFC 4648, for what stands inside a page.
std::string Base64(std::string_view bytes);

// FNV-1a, 64 bits: tells two texts apart in print; no defence against forgery.
std::uint64_t Digest(std::string_view text);

// Text that is safe in LaTeX.
std::string LatexEscape(std::string_view text);

}  // namespace touchdown::report
