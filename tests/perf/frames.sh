#!/bin/sh
# SPDX-License-Identifier: MIT
# Two builds of the program render the same scenes in turn, on one thread: CPU nanoseconds a ray by
# stage, medians, and the median of the paired ratios new / old in brackets. Films must be equal.
# usage: frames.sh OLD NEW SAMPLES PAIRS SCENE...
set -eu
old=$1 new=$2 samples=$3 pairs=$4
shift 4
# A line "CPU STAGES... FILM" in ns a ray for one run.
run() {
    "$1" render "$2" -n "$samples" -j 1 --json --quiet | tr '{}",:' '     ' | awk '{
        for (i = 1; i < NF; i++) {
            if ($i == "cpu_seconds") cpu = $(i + 1)
            if ($i == "stage_seconds") for (k = 0; k < 9; k++) stage[k] = $(i + 2 + 2 * k)
            if ($i == "camera" || $i == "shadow" || $i == "reflect" || $i == "refract") rays += $(i + 1)
            if ($i == "film_sha256") film = $(i + 1)
        }
        printf "%g", cpu / rays * 1e9
        for (k = 0; k < 9; k++) printf " %g", stage[k] / rays * 1e9
        print "", film
    }'
}
for scene; do
    i=0
    while [ "$i" -lt "$pairs" ]; do
        echo "$(run "$old" "$scene") $(run "$new" "$scene")"
        i=$((i + 1))
    done | awk -v scene="$scene" '
        function median(a, n,    i, j, t) {
            for (i = 2; i <= n; i++)
                for (j = i; j > 1 && a[j] < a[j - 1]; j--) { t = a[j]; a[j] = a[j - 1]; a[j - 1] = t }
            return n % 2 ? a[(n + 1) / 2] : (a[n / 2] + a[n / 2 + 1]) / 2
        }
        $11 != $22 || NF != 22 { print scene ": films differ"; bad = 1; exit 1 }
        { for (k = 1; k <= 22; k++) v[k, NR] = $k }
        END {
            if (bad) exit 1
            split("all generate nearest resolve material light occlude spawn accumulate film", name)
            printf "%s\n", scene
            for (k = 1; k <= 10; k++) {
                for (r = 1; r <= NR; r++) { a[r] = v[k, r]; b[r] = v[k + 11, r]; q[r] = a[r] > 0 ? b[r] / a[r] : 0 }
                printf "  %-10s %6.1f -> %6.1f  (%.2f)\n", name[k], median(a, NR), median(b, NR), median(q, NR)
            }
        }'
done
