# The hard-case ladder of build/bench/ladder.csv: a panel a trouble, which gets
# worse to the right.
# gnuplot -e "csv='...'; svg='...'" tests/benchmarks/ladder.gp
set terminal svg size 1280,900 font "sans,12" background rgb "white"
set output svg
set encoding utf8
set multiplot layout 2,3 margins 0.06, 0.94, 0.13, 0.94 spacing 0.09, 0.14 title "Error over the Cramér–Rao bound (left), share of clips (right)" noenhanced
set logscale y
set yrange [0.3:3000]
set ytics nomirror
set y2range [0:1.05]
set y2tics 0.2
set format y "%g"
set xrange [-0.6:*]
set grid ytics lc rgb "#dddddd"
set style fill solid 0.35 noborder
set boxwidth 0.5
set key off
set label 1 "● approach angle" at screen 0.08, 0.02 textcolor rgb "#0b4f9c" front
set label 2 "■ contact time" at screen 0.22, 0.02 textcolor rgb "#e08e0b" front
set label 3 "- - bound" at screen 0.35, 0.02 front
set label 4 "× share of the angle's 95 % intervals that cover (right; dashed: 0.95)" at screen 0.44, 0.02 textcolor rgb "#0a8f6c" front
set label 5 "▮ share of clips without an angle (right)" at screen 0.78, 0.02 textcolor rgb "#c0392b" front

array ladder[6] = ["size (px)", "contrast over noise", "blur of the lens (px)", \
  "frames on either side", "approach angle (deg)", "hidden share of the approach"]
# Number of the rung, rung, ratio and its interval ("-" where nothing was
# measured or there is no bound), share absent, coverage.
rows(name, quantity) = sprintf("< awk -F, '$1 == \"%s\" && $3 == \"%s\" {n = $12 == \"\"; print i++, $2, n ? \"-\" : $12, n ? \"-\" : $13, n ? \"-\" : $14, $6, $16 == \"\" ? \"-\" : $16}' '%s'", name, quantity, csv)
set datafile missing "-"
do for [k = 1:6] {
  if (k == 2) { unset label }
  set xlabel ladder[k] noenhanced
  if (k % 3 == 1) { set ylabel "RMSE / bound" } else { unset ylabel }
  if (k % 3 == 0) { set y2label "share" } else { unset y2label }
  plot rows(ladder[k], "approach angle") using 1:6:xticlabels(2) axes x1y2 with boxes lc rgb "#c0392b" notitle, \
    rows(ladder[k], "approach angle") using 1:7 axes x1y2 with linespoints lc rgb "#0a8f6c" pt 2 dt 3 notitle, \
    0.95 axes x1y2 with lines lc rgb "#0a8f6c" dt 2 lw 0.5 notitle, \
    1 with lines lc rgb "black" dt 2 notitle, \
    rows(ladder[k], "contact time") using ($1 + 0.08):3:4:5 with yerrorlines lc rgb "#e08e0b" pt 5 ps 0.5 notitle, \
    rows(ladder[k], "approach angle") using 1:3:4:5 with yerrorlines lc rgb "#0b4f9c" pt 7 ps 0.6 notitle
}
unset multiplot
