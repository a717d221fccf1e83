// How the report's pages look: on a screen of any width, in light and dark, in
// print.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::report {

// The style sheet of every page.
extern const std::string_view kPageStyle;

// The rule that puts `footer` and the page's number below every printed page.
std::string PrintedFooter(std::string_view footer);

}  // namespace touchdown::report
