#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: render.sh FIRSTLIGHT [SIZE [SCENE...]]        SCENE: bunny, vase
# CPU time to equal error, firstlight against POV-Ray, one thread each, in turns. Every program is measured against a
# converged picture of its own: linear RMSE of 16-bit pictures cut off at 1. POV-Ray with adaptive focal blur at each of
# six settings; firstlight at powers of two of samples, and what it needs for POV-Ray's error is interpolated.
# REFERENCE: lens samples of POV-Ray's converged picture (512). ADAPTIVE=on: firstlight with --adaptive on as well.
# Pictures, times and converged pictures stay in build/povray: the latter are made once a size.
set -eu
program=$(realpath "$1") size=${2:-320}
shift
[ $# -gt 0 ] && shift
here=$(dirname "$(realpath "$0")") root=$(realpath "$(dirname "$(realpath "$0")")/../..")
work=$root/build/povray/$size
mkdir -p "$work"
python3 "$here/mesh.py" "$root/assets/bunny_1k.obj" >"$work/bunny_mesh.inc"

# pov SCENE OUT LN BMIN BMAX BVAR: prints CPU seconds of tracing
pov() {
    povray "+I$here/$1.pov" "+O$work/$2.ppm" +FP16 File_Gamma=1.0 "+W$size" "+H$size" -D +WT1 "+L$here" "+L$work" \
        "+L$root/assets" "Declare=LN=$3" "Declare=BMIN=$4" "Declare=BMAX=$5" "Declare=BVAR=$6" >"$work/$2.log" 2>&1 ||
        { tail -20 "$work/$2.log" >&2; exit 1; }
    sed -n '/Trace Time/,$s/.*with \([0-9.]*\) CPU-seconds total.*/\1/p' "$work/$2.log"
}

# ours SCENE OUT SAMPLES [OPTION...]: prints CPU seconds
ours() {
    scene=$1 out=$2 samples=$3
    shift 3
    "$program" render "$root/scenes/$scene.txt" --size "${size}x$size" -n "$samples" -j 1 "$@" -o "$work/$out.exr" --quiet \
        --json | sed 's/.*"cpu_seconds":\([0-9.e-]*\).*/\1/'
    # Linear values stay as they are: only the name of their space changes.
    convert "$work/$out.exr" -set colorspace sRGB -depth 16 "$work/$out.ppm"
    rm "$work/$out.exr"
}

for scene in ${*:-bunny vase}; do
    [ -s "$work/$scene-pov.ppm" ] || pov "$scene" "$scene-pov-new" 2 "${REFERENCE:-512}" "${REFERENCE:-512}" 0 >/dev/null
    [ -s "$work/$scene-pov.ppm" ] || mv "$work/$scene-pov-new.ppm" "$work/$scene-pov.ppm"
    [ -s "$work/$scene-ours.ppm" ] || ours "$scene" "$scene-ours" 2048 >/dev/null
    : >"$work/$scene.times"
    for light in 2 4; do
        for blur in 16 37 64; do
            name=$scene-pov-$light-$blur
            echo "pov $light-$blur $(pov "$scene" "$name" $light 4 $blur 0.001)" >>"$work/$scene.times"
            for samples in 4 8 16 32 64 128; do
                name=$scene-ours-$samples
                echo "ours $samples $(ours "$scene" "$name" $samples)" >>"$work/$scene.times"
                [ "${ADAPTIVE:-off}" = on ] || continue
                echo "adaptive $samples $(ours "$scene" "$scene-adaptive-$samples" $samples --adaptive on)" \
                    >>"$work/$scene.times"
            done
        done
    done
    python3 "$here/equal_error.py" "$work" "$scene"
done
