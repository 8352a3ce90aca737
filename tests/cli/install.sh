#!/bin/sh
# SPDX-License-Identifier: MIT
# An installation under any prefix renders, and finds its gallery, from any working directory.
# usage: install.sh CMAKE BUILD_DIR
set -u
cmake=$1
build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
"$cmake" --install "$build" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
mkdir "$work/elsewhere" && cd "$work/elsewhere" || exit 1
mv ../prefix ../moved # the prefix is no part of the program
program=../moved/bin/firstlight
scenes=../moved/share/firstlight/scenes

render() { # SCENE OUT: with the hash of its film
    "$program" render "$1" -n 1 --size 16x16 -o "$2" --json --quiet 2>stderr | grep -q film_sha256 && [ -s "$2" ] || {
        echo "FAIL: render $1 -o $2"
        cat stderr
        failed=$((failed + 1))
    }
}
render "$scenes/vase.txt" vase.png
[ ! -f ../moved/share/firstlight/assets/bunny_1k.obj ] || render "$scenes/bunny.txt" bunny.exr
cat >one.stl <<'END'
solid one
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid one
END
cat >stl.txt <<'END'
firstlight 1
PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 }
Group { TriangleMesh { file one.stl } }
END
render stl.txt stl.png

# Without a word the vase opens: found, and then there is no display for it.
(unset DISPLAY WAYLAND_DISPLAY; "$program" >stdout 2>stderr)
[ $? = 4 ] && grep -q 'no display' stderr || { echo "FAIL: the default scene"; cat stderr; failed=$((failed + 1)); }

echo "4 tried, $failed failed"
[ "$failed" = 0 ]
