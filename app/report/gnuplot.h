// Plots by gnuplot. Runs the program directly, without a shell: the script goes
// to its standard input and the drawing comes back from its standard output.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::report {

// What gnuplot writes to its standard output for `script`, which sets a
// terminal and leaves the output alone (data inline: `$points << EOD`). User
// and system start-up files are not read. Throws core::InputError where gnuplot
// is not installed, complains or draws nothing, with its own first line.
std::string RunGnuplot(const std::string& script);

// Text as a gnuplot string literal: single-quoted, safe for any content.
// Special signs of the enhanced text mode (_ ^ { } @ &) are escaped where
// `enhanced`.
std::string GnuplotQuote(std::string_view text, bool enhanced = false);

// The head of every script: an SVG terminal of this size in points with the
// house's fonts, lines and grid.
std::string GnuplotSvg(int width, int height);

// Colours that the colour-blind can tell apart (Okabe and Ito 2008).
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kSkyBlue = "#56B4E9";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kOrange = "#E69F00";
inline constexpr const char* kVermilion = "#D55E00";
inline constexpr const char* kPurple = "#CC79A7";
inline constexpr const char* kYellow = "#F0E442";
inline constexpr const char* kBlack = "#000000";

}  // namespace touchdown::report
