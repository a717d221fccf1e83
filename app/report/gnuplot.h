// Runs gnuplot: the one place where plots leave the program.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::report {

// Gives `script` to gnuplot on its standard input and returns what it writes to
// its standard output (an SVG where the script says `set terminal svg`). No
// start-up file of the user is read and the locale is C, so that the same
// script gives the same bytes. Throws core::InputError, with what to do, where
// gnuplot is missing or refuses the script.
std::string RunGnuplot(const std::string& script);

// An SVG of gnuplot as an element of a page. gnuplot writes a whole XML file
// and gives its parts the same identifiers in each; they get `id` before them,
// so that several can stand in one page.
std::string InlineSvg(std::string svg, const std::string& id);

// Text as a gnuplot string constant: in single quotes, in which gnuplot
// substitutes nothing; an apostrophe becomes a typographic one, control
// characters become spaces.
std::string GnuplotQuote(std::string_view text);

}  // namespace touchdown::report
