#include "app/report/plot_style.h"

#include <fmt/core.h>

namespace touchdown::report {

// Only two of the four borders are drawn, and the background is white also on a
// dark page: the colours are chosen for white.
std::string PlotHead(int width, int height) {
  return fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {},{} dynamic enhanced rounded "
      "font 'DejaVu Sans,Helvetica,Arial,sans-serif,13' "
      "background rgb 'white'\n"
      "set border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out scale 0.6\n"
      "set grid lw 0.5 lc rgb '#e0e0e0'\n",
      width, height);
}

}  // namespace touchdown::report
