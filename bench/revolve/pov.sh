#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: pov.sh BENCH_REVOLVE [ROUNDS]
# CPU time of the primary rays of one 640x640 view of a vase: POV-Ray's lathe, and the frame of bench_revolve, in
# turns on one thread. POV-Ray shades nothing (ambient only); the time of the same picture of an empty scene is
# taken off, so that what remains is the lathe.
set -eu
bench=$1 rounds=${2:-9}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/empty.pov" <<'SCENE'
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 1 }
camera { perspective location <0, 2.2, -6.2> up y right x angle 28 look_at <0, 1.1, 0> }
SCENE
cp "$work/empty.pov" "$work/vase.pov"
# The vase of bench_revolve.c, from B-spline to Bezier points.
python3 >>"$work/vase.pov" <<'POINTS'
p = [(0.00, -0.12), (0.52, 0.04), (0.58, 0.22), (1.00, 0.72), (0.62, 1.38), (0.24, 1.72), (0.52, 2.16), (0.56, 2.30)]
weights = ((1 / 6, 4 / 6, 1 / 6, 0), (0, 2 / 3, 1 / 3, 0), (0, 1 / 3, 2 / 3, 0), (0, 1 / 6, 4 / 6, 1 / 6))
bezier = [tuple(sum(w * p[i + j][k] for j, w in enumerate(row)) for k in (0, 1))
          for i in range(len(p) - 3) for row in weights]
print("lathe { bezier_spline %d, %s\n pigment { rgb 1 } finish { ambient 1 diffuse 0 } }"
      % (len(bezier), ", ".join("<%.17g, %.17g>" % q for q in bezier)))
POINTS
# CPU seconds of tracing alone, from POV-Ray's own report.
trace() {
    povray "+I$work/$1.pov" "+O$work/$1.ppm" +FP +W640 +H640 -D -A +Q2 +WT1 +BS640 >"$work/$1.log" 2>&1
    sed -n '/Trace Time/,$s/.*with \([0-9.]*\) CPU-seconds total.*/\1/p' "$work/$1.log"
}
: >"$work/times"
for _ in $(seq "$rounds"); do
    vase=$(trace vase) empty=$(trace empty)
    ours=$("$bench" frame 3 | sed -n 's/^frame:.*hits, \([0-9.]*\) ms.*/\1/p')
    echo "$vase $empty $ours" >>"$work/times"
done
grep -i lathe "$work/vase.log" || true
"$bench" frame 3
python3 - "$work/times" <<'SUM'
import statistics, sys
vase, empty, ours = (statistics.median(c) for c in zip(*[map(float, l.split()) for l in open(sys.argv[1])]))
lathe = 1e3 * (vase - empty)
print("POV-Ray: %.0f ms, empty scene %.0f ms, lathe %.0f ms; firstlight %.2f ms: x%.1f (x%.1f with its frame)"
      % (1e3 * vase, 1e3 * empty, lathe, ours, lathe / ours, 1e3 * vase / ours))
SUM
