# Work-precision diagrams of build/bench/precision.csv.
# gnuplot -e "csv='...'; svg='...'" tests/benchmarks/precision.gp
set terminal svg size 1280,1120 font "sans,13" background rgb "white"
set output svg
set encoding utf8
set multiplot layout 2,1
set logscale xy
set format x "10^{%T}"
set format y "10^{%T}"
set grid xtics ytics lc rgb "#dddddd"
set key at screen 0.99, graph 1 right top spacing 1.15 noenhanced
set tmargin 3
set lmargin at screen 0.07
set rmargin at screen 0.66

# Columns of a method's points: frames/s, RMSE, its interval. Points with more
# than 5 % failures are drawn apart: their errors are of the easier items.
rows(stage, method) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && $5 <= 0.05 * $4 && $11 != \"\" {print $9, $11, $12, $13}' '%s'", stage, method, csv)
failing(stage) = sprintf("< awk -F, '$1 == \"%s\" && $5 > 0.05 * $4 && $11 != \"\" {print $9, $11, $12, $13}' '%s'", stage, csv)
# That part of the plot command, where there is such a point.
apart(stage) = system(failing(stage)[3:] . " | wc -l") > 0 ? \
  sprintf("failing('%s') using 1:2:3:4 with yerrorbars lc rgb '#444444' pt 6 ps 0.9 title 'more than 5 %% absent',", stage) : ""
defaults(stage) = sprintf("< awk -F, '$1 == \"%s\" && $2 !~ /told/ && $3 ~ /default/ {print $9, $11}' '%s'", stage, csv)
# Points that no other beats in both.
front(stage) = sprintf("< awk -F, '$1 == \"%s\" && $5 <= 0.05 * $4 && $11 != \"\" {print $9, $11}' '%s' | sort -k1,1gr | awk 'NR == 1 || $2 < least {print; least = $2}'", stage, csv)
cell(stage, n) = system(sprintf("awk -F, '$1 == \"%s\" {print $%d; exit}' '%s'", stage, n, csv)) + 0
shown(method) = system(sprintf("echo '%s' | tr ';' ','", method))

array chain[8] = ["touchdown", "touchdown; kind not told", "touchdown; ground told", \
  "touchdown; ground told; first fits", "MOG2; centroid; central differences", \
  "threshold; centroid; ballistic fits", "template; parabola; ballistic fits", \
  "CSRT; centre of the box; ballistic fits"]
array outline[11] = ["outline fit; iterations at most", "outline fit; tolerance", \
  "outline fit; true size held", "outline fit; background not known", \
  "threshold; centroid", "difference-weighted centroid", \
  "threshold; minEnclosingCircle", "threshold; fitEllipse", \
  "HoughCircles; gradient", "HoughCircles; gradient alt", ""]
array colour[11] = ["#0b4f9c", "#3b8bd0", "#0a8f6c", "#7cb518", "#c0392b", "#e08e0b", \
  "#8e44ad", "#7f5539", "#555555", "#999999", "#000000"]

set title "The whole chain: approach angle, clips in memory, one core" noenhanced
set xlabel "frames of the recording per second (faster to the right)" noenhanced
set ylabel "RMSE of the approach angle, deg" noenhanced
bound = cell("chain", 15)
alone = cell("chain", 9)
set yrange [0.4 * bound:*]
set xrange [*:2 * alone]
set arrow 1 from alone, graph 0 to alone, graph 1 nohead lc rgb "#888888" dt 3
set label 1 "reading alone" at alone, graph 0.97 right offset -0.5, 0 textcolor rgb "#666666"
these = apart("chain")
plot for [i = 1:8] rows("chain", chain[i]) using 1:2:3:4 with yerrorlines lc rgb colour[i] pt 7 ps 0.7 title shown(chain[i]), \
  @these \
  defaults("chain") using 1:2 with points lc rgb "black" pt 6 ps 1.7 title "default", \
  front("chain") using 1:2 with lines lc rgb "#bbbbbb" lw 4 dt 2 title "not beaten in both", \
  bound with lines lc rgb "black" dt 2 title "Cramér–Rao bound"

unset arrow 1
unset label 1
set title "One outline in one frame: a sphere of 24 px" noenhanced
set xlabel "fits per second (faster to the right)" noenhanced
set ylabel "RMSE of the centre, a coordinate, px" noenhanced
bound = cell("outline", 15)
set yrange [0.5 * bound:*]
set xrange [*:*]
these = apart("outline")
plot for [i = 1:10] rows("outline", outline[i]) using 1:2:3:4 with yerrorlines lc rgb colour[i] pt 7 ps 0.7 title shown(outline[i]), \
  @these \
  defaults("outline") using 1:2 with points lc rgb "black" pt 6 ps 1.7 title "default", \
  front("outline") using 1:2 with lines lc rgb "#bbbbbb" lw 4 dt 2 title "not beaten in both", \
  bound with lines lc rgb "black" dt 2 title "Cramér–Rao bound"
unset multiplot
