#!/bin/sh
# SPDX-License-Identifier: MIT
# The intersection kernels of two source trees on the same rays in one process (kernels.c says why), AVX2, linked with the
# libraries of BUILD. Run it from the root of the tree.
# usage: kernels.sh OLD_TREE NEW_TREE BUILD ROUNDS MESH...      a mesh: a file, or sphere:N
set -eu
old=$1 new=$2 build=$3 rounds=$4
shift 4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=c11 -D_POSIX_C_SOURCE=200809L -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math"
for name in old new; do
    eval "tree=\$$name"
    cc $flags -mavx2 -DFL_W=8 -DFL_ISA=$name -Dfl_resolve_$name=fl_resolve_avx2 -I"$tree/src" \
        -c "$tree/src/core/kernel_isect.c" -o "$work/$name.o"
done
cc $flags -Isrc -c tests/perf/kernels.c -o "$work/main.o"
for source in bench_mesh bench_rays; do
    cc $flags -Isrc -c "src/cli/$source.c" -o "$work/$source.o"
done
c++ "$work"/*.o "$build/src/io/libfl_io.a" "$build/src/core/libfl_core.a" -lpthread -lm -o "$work/kernels" 2>"$work/log" ||
    { cat "$work/log"; exit 1; }
for mesh; do
    "$work/kernels" "$mesh" "$rounds"
done
