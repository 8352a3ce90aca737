# SPDX-License-Identifier: MIT
# Figure of docs/performance.md: gnuplot docs/performance/growth.gp > docs/performance/growth.svg (bench/growth.sh does)
set terminal svg size 900,400 font "sans,13" background "white"
set multiplot layout 1,2
data = "docs/performance/growth.dat"
set logscale x
set format x "%.0s%c"
set xrange [0.7:2e7]
set xlabel "spheres, triangles, instances"
set border 3
set tics nomirror
set key top left reverse Left

set title "Node visits and tests of a primary ray"
set yrange [0:40]
plot data index 0 using 1:($5+$6) with linespoints lw 2 pt 7 ps 0.6 lc rgb "#2050a0" title "spheres", \
     data index 1 using 1:($5+$6) with linespoints lw 2 pt 7 ps 0.6 lc rgb "#b02020" title "triangles", \
     data index 2 using 1:($5+$6) with linespoints lw 2 pt 7 ps 0.6 lc rgb "#208040" title "instances"

set title "CPU time of a primary ray, ns"
set logscale y
set yrange [1:5000]
plot data index 0 using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc rgb "#2050a0" title "spheres", \
     data index 1 using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc rgb "#b02020" title "triangles", \
     data index 2 using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc rgb "#208040" title "instances"
unset multiplot
