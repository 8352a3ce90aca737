#!/bin/sh
# SPDX-License-Identifier: MIT
# Broken off at any moment: exit 130, the saved picture is that of so many samples to the bit and opens again, nothing is left
# beside it, and until it is renamed the picture that stood there stays.
# usage: signals.sh FIRSTLIGHT
set -u
program=$1
. "$(dirname "$0")/kit.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

scene() { # OBJECT
    cat <<TEXT
firstlight 1
PerspectiveCamera { center 0 1 6 direction 0 -0.1 -1 up 0 1 0 angle 40 width 64 height 48 }
Lights { DiskLight { position 3 4 3 direction -1 -1 -1 radius 1 color 1 1 1 } }
Materials { Material { diffuseColor 0.8 0.5 0.2 reflect 0.2 } }
Group { MaterialIndex 0 Plane { normal 0 1 0 offset -1 } $1 }
TEXT
}
scene 'Sphere { center 0 0 0 radius 1 }' >ball.txt
# A mesh that takes a while to read.
awk 'BEGIN {
    n = 300
    for (y = 0; y <= n; y++) for (x = 0; x <= n; x++) print "v", x / n - 0.5, (x * 7 + y * 13) % 5 / n, y / n - 0.5
    for (y = 0; y < n; y++) for (x = 1; x <= n; x++) { a = y * (n + 1) + x; print "f", a, a + 1, a + n + 2, a + n + 1 }
}' >mesh.obj
scene 'TriangleMesh { file mesh.obj }' >mesh.txt

# Begin a render without an end; $child is its process.
begin() { # SCENE OPTIONS...
    rm -f json
    "$program" render "$@" -n 1000000000 -o picture.png --quiet --json 2>stderr >json &
    child=$!
}
threads() { ls /proc/$child/task 2>/dev/null | wc -l; }
# The second thread is that of the pool or a worker: the scene is being compiled or rendered.
until_at_work() { while [ -d /proc/$child ] && [ "$(threads)" -lt 2 ]; do :; done; }
# SIGHUP, the lowest bit of the signals caught, is the last of the three to be.
until_loading() {
    while [ -d /proc/$child ]; do
        caught=$(sed -n 's/^SigCgt:.*\(.\)$/\1/p' /proc/$child/status 2>/dev/null)
        case $caught in 1 | 3 | 5 | 7 | 9 | b | d | f) break ;; esac
    done
}

# What must hold of a render that was broken off: the new picture, or the old one and a word why.
look() { # WHAT SCENE
    check "$1: exit code" 130 "$code"
    check "$1: nothing beside it" '' "$(find . -name '.*.tmp')"
    if grep -q 'there is nothing to save' stderr; then
        check "$1: the old picture" "$old" "$(sha256sum picture.png)"
        return
    fi
    samples=$(field samples json) film=$(field film_sha256 json)
    "$program" render "$2" -n "$samples" --quiet --json >fresh 2>stderr
    check "$1: a fresh render of $samples samples" "$film" "$(field film_sha256 fresh)"
    "$program" render picture.png --quiet --json >again 2>stderr
    check "$1: opened again" "$film $samples" "$(field film_sha256 again) $(field samples again)"
}

for name in INT TERM HUP; do
    cp ball.txt picture.png # Not even a picture: what stands there is not read.
    old=$(sha256sum picture.png)
    begin ball.txt
    until_at_work
    check "$name: the old picture while rendering" "$old" "$(sha256sum picture.png)"
    kill -$name $child
    wait $child
    code=$?
    look $name ball.txt

    cp ball.txt picture.png
    begin mesh.txt
    until_loading
    kill -$name $child
    wait $child
    code=$?
    look "$name while loading" mesh.txt
done

# Before the first picture: an hour of light samples for a first pixel.
cp ball.txt picture.png
begin ball.txt --light-samples 1000000 --size 1024x1024
until_at_work
kill -INT $child
wait $child
check 'no picture yet: exit code' 130 $?
check 'no picture yet: said' 1 "$(grep -c 'interrupted before the first sample: there is nothing to save' stderr)"
check 'no picture yet: the old one' "$old" "$(sha256sum picture.png)"

# The second signal, and one that cannot be caught, end it at once: the old picture or a whole new one.
begin ball.txt --light-samples 1000000 --size 1024x1024
until_at_work
kill -INT $child
kill -INT $child 2>/dev/null
wait $child
check 'second signal: exit code' 130 $?
check 'second signal: the old picture' "$old" "$(sha256sum picture.png)"
begin ball.txt
until_at_work
kill -KILL $child
wait $child 2>/dev/null
check 'killed: exit code' 137 $?
check 'killed: the old picture' "$old" "$(sha256sum picture.png)"
check 'killed: nothing beside it' '' "$(find . -name '.*.tmp')"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
