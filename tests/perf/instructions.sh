#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions per primary ray on the small bunny, by callgrind: the same on every run, whatever else the machine does.
# Fails when they are more than 5 % above the number in instructions.txt, which holds for gcc 12, release, AVX2.
# usage: instructions.sh PRIMARY_RAYS SOURCE_DIR [COMPILER_VERSION]      exit 77: cannot be measured here
set -eu
program=$1 source=$2 compiler=${3:-}
command -v valgrind >/dev/null || { echo "skipped: no valgrind"; exit 77; }
grep -qw avx2 /proc/cpuinfo || { echo "skipped: no AVX2"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What TIMES times cost; prints the instructions.
count() {
    valgrind --tool=callgrind --callgrind-out-file="$work/out" "$program" "$source/assets/bunny_1k.obj" 128 "$1" \
        >"$work/rays" 2>"$work/log"
    sed -n 's/^summary: //p' "$work/out"
}
once=$(count 1)
thrice=$(count 3)
rays=$(cat "$work/rays")
measured=$(awk "BEGIN { printf \"%.1f\", ($thrice - $once) / (2 * $rays) }")
expected=$(sed -n 's/^gcc-12 //p' "$source/tests/perf/instructions.txt")
echo "$measured instructions per primary ray ($expected expected of gcc 12)"
case $compiler in
12*) awk "BEGIN { exit !($measured <= 1.05 * $expected) }" || { echo "more than 5 % above"; exit 1; } ;;
*) echo "not checked: compiler version '$compiler'" ;;
esac
