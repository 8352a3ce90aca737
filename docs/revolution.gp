# SPDX-License-Identifier: MIT
# Figure of docs/revolution.md: gnuplot docs/revolution.gp > docs/revolution.svg
set terminal svg size 900,420 font "sans,13" background "white"
set multiplot layout 1,2
x(t) = 0.40*(1-t)**3 + 4.5*t*(1-t)**2 + 0.0*t**2*(1-t) + 0.6*t**3
y(t) = 2.1*t*(1-t)**2 + 4.5*t**2*(1-t) + 2.2*t**3
c = 0.42
s(t) = x(t) > c ? sqrt(x(t)**2 - c**2) : 0/0
# The ray: d_y p - s_l y = k in the cut plane.
dy = -0.42
sl = sqrt(1 - dy**2)
k = dy*(-1.6) - sl*1.75
set parametric
set trange [0:1]
set samples 400
set size ratio -1
set key off
set border 3
set xtics nomirror 0.5
set ytics nomirror 0.5
set yrange [-0.1:2.35]

set title "Profile: pieces end where x, y or the tangent turns"
set xlabel "x, distance from the axis"
set ylabel "y"
set xrange [0:1.6]
set arrow 1 from c,-0.1 to c,2.35 nohead dashtype 2 lc rgb "#888888"
set label 1 "c" at c+0.03,0.05 tc rgb "#666666"
# Roots of x' and of the curvature of this cubic, and the ends.
array cuts[5] = [0.0, 0.2849, 0.554, 0.8215, 1.0]
do for [i=1:4] {
    ta = cuts[i]; tb = cuts[i+1]
    xl = x(ta) < x(tb) ? x(ta) : x(tb); xh = x(ta) < x(tb) ? x(tb) : x(ta)
    set object i rectangle from xl,y(ta) to xh,y(tb) fs empty border lc rgb "#d08020" lw 1
}
plot x(t), y(t) lw 2.5 lc rgb "#2050a0"

unset object
unset label
unset arrow
set title "Cut plane of a ray: a line against (+-s(t), y(t))"
set xlabel "p, along the ray's horizontal direction"
set xrange [-1.6:1.6]
set arrow 2 from -1.5,(dy*(-1.5)-k)/sl to 1.5,(dy*1.5-k)/sl lw 2 lc rgb "#b02020" front
set label 2 "ray" at -1.52,2.0 tc rgb "#b02020"
set label 3 "sigma = -1" at -1.5,0.15 tc rgb "#2050a0"
set label 4 "sigma = +1" at 0.95,0.15 tc rgb "#2050a0"
do for [i=1:4] {
    ta = cuts[i]; tb = cuts[i+1]
    xl = x(ta) < x(tb) ? x(ta) : x(tb); xh = x(ta) < x(tb) ? x(tb) : x(ta)
    l = xl > c ? sqrt(xl**2 - c**2) : 0; h = xh > c ? sqrt(xh**2 - c**2) : 0
    set object i rectangle from l,y(ta) to h,y(tb) fs empty border lc rgb "#d08020" lw 1
    set object 10+i rectangle from -h,y(ta) to -l,y(tb) fs empty border lc rgb "#d08020" lw 1
}
plot s(t), y(t) lw 2.5 lc rgb "#2050a0", -s(t), y(t) lw 2.5 lc rgb "#2050a0"
unset multiplot
