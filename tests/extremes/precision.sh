#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: precision.sh FIRSTLIGHT SCENE
# --precision double reaches the film, is named in the report, is part of what a saved picture remembers, and does not
# depend on the number of threads.
set -euo pipefail
program=$1 scene=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
say() { "$program" render "$@" --json --quiet | tail -1 | grep -o '"precision":"[a-z]*"\|"film_sha256":"[0-9a-f]*"' | cut -d'"' -f4; }
size=(-s 40x30 -n 3)
mapfile -t float < <(say "$scene" -o "$folder/float.png" "${size[@]}")
mapfile -t double < <(say "$scene" -o "$folder/double.png" "${size[@]}" --precision double --threads 1)
mapfile -t threads < <(say "$scene" -o "$folder/threads.png" "${size[@]}" --precision double --threads 3)
mapfile -t again < <(say "$folder/double.png" -o "$folder/again.png")
fail() { echo "precision: $1" >&2; exit 1; }
[ "${float[0]}" = float ] && [ "${double[0]}" = double ] || fail "the report names the wrong one: ${float[0]}, ${double[0]}"
[ "${float[1]}" != "${double[1]}" ] || fail "double gives the film of floats"
[ "${threads[1]}" = "${double[1]}" ] || fail "three threads give another film"
[ "${again[0]} ${again[1]}" = "double ${double[1]}" ] || fail "the saved picture opens as ${again[*]}"
if "$program" render "$scene" -o "$folder/no.png" --precision half 2>/dev/null; then fail "'half' was taken"; fi
