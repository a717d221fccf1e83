// The look of the house's plots.
#pragma once

#include <string>

namespace touchdown::report {

// The head of a gnuplot script: an SVG terminal of this size in points with the
// house's fonts, lines and grid.
std::string PlotHead(int width, int height);

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
