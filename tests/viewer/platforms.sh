#!/bin/sh
# SPDX-License-Identifier: MIT
# The same log on OSMesa, on EGL and again on OSMesa: the same film behind every snapshot.
# usage: platforms.sh FIRSTLIGHT SCENE. Exit 77: one of the two platforms is not here.
set -eu
program=$(realpath "$1") scene=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >session.log <<TEXT
firstlight-log 1 96x64 $scene
0 snapshot first.png 2
100 key W press
400 key W release
500 scroll 0 2
600 snapshot second.png 3
700 quit
TEXT

films() { # PLATFORM
    "$program" replay session.log --platform "$1" --json >out 2>err || { cat err; return 1; }
    grep -o '"film_sha256":"[0-9a-f]*"' out >"$1.films"
    [ "$(wc -l <"$1.films")" = 2 ] || { echo "FAILED: $1 made not two snapshots"; cat out; exit 1; }
}
films osmesa || exit 77
mv osmesa.films once.films
films osmesa
films egl || exit 77
cmp once.films osmesa.films && cmp osmesa.films egl.films || { echo "FAILED: films differ"; exit 1; }
sort -u egl.films | wc -l | grep -qx 2 || { echo "FAILED: both snapshots are the same picture"; exit 1; }
echo "1 passed, 0 failed"
