#!/bin/sh
# SPDX-License-Identifier: MIT
# Wrong input, wrong usage and a hostile environment: one clear message, the right exit code, nothing half-written.
# usage: bad_input.sh FIRSTLIGHT SOURCE_DIR
set -u
program=$1
source=$2
work=$(mktemp -d)
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work"
passed=0 failed=0

# expect CODE PATTERN ARGUMENTS...: exit code, and a line of standard error that matches the pattern.
expect() {
    code=$1 pattern=$2
    shift 2
    timeout 60 "$program" "$@" >stdout 2>stderr </dev/null
    got=$?
    if [ "$got" = "$code" ] && { [ -z "$pattern" ] || grep -qE -- "$pattern" stderr; }; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL: $program $*: exit $got, expected $code and /$pattern/"
        sed 's/^/    /' stderr | head -n 8
    fi
}

# A small scene; $1 is put in place of the object.
scene() {
    cat <<TEXT
firstlight 1
PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 width 16 height 16 }
Lights { numLights 1 PointLight { position 2 3 4 color 1 1 1 } }
Materials { numMaterials 1 Material { diffuseColor 0.8 0.5 0.2 ${2:-} } }
Group { numObjects 1 MaterialIndex 0 $1 }
TEXT
}
scene 'Sphere { center 0 0 0 radius 1 }' >good.txt

# The good one is good, under an awkward name too.
expect 0 '' render good.txt -n 1 -o out.png --quiet
cp good.txt 'näme with spaces.txt'
expect 0 '' render 'näme with spaces.txt' -n 1 -o 'öut put.png' --quiet
[ -s 'öut put.png' ] || { echo "FAIL: picture with an awkward name is missing"; failed=$((failed + 1)); }

# Usage: exit 2 and the nearest right word.
expect 2 "did you mean '--samples'" render good.txt --smaples 4 --sample 4 -o out.png
expect 2 "did you mean 'render'" rendr good.txt
expect 2 'expected one scene' render -o out.png
expect 2 'nowhere to write' render good.txt
expect 2 'whole number from 1' render good.txt --samples 0 -o out.png
expect 2 'whole number' render good.txt --samples 4.5 -o out.png
expect 2 'expected bvh, octree, none' render good.txt --accel kd -o out.png
expect 2 'needs a value' render good.txt -o
expect 2 'takes no option' info good.txt --crop 0,0,1,1

# Scenes: exit 3, place and remedy.
expect 3 'missing.txt: error: .*No such file' render missing.txt -o out.png
: >empty.txt
expect 3 'empty.txt' render empty.txt -o out.png
head -c 150 good.txt >cut.txt
expect 3 'cut.txt:[0-9]+:[0-9]+: error' render cut.txt -o out.png
head -c 4096 "$program" >binary.txt
expect 3 'binary.txt' render binary.txt -o out.png
mkdir folder.txt
expect 3 'folder.txt' render folder.txt -o out.png
mkfifo pipe.txt
expect 3 'pipe.txt' render pipe.txt -o out.png
ln -s loop.txt loop.txt
expect 3 'loop.txt' render loop.txt -o out.png
scene 'Sphere { center 0 0 0 radious 1 }' >key.txt
expect 3 "key.txt:5:.*did you mean 'radius'" render key.txt -o out.png
scene 'Sphere { center 0 0 0 radius -1 }' >range.txt
expect 3 "range.txt:5:.*radius" render range.txt -o out.png
scene 'Sphere { center 0 0 nan radius 1 }' >nan.txt
expect 3 'nan.txt:5:.*nan' render nan.txt -o out.png
scene 'Sphere { center 0 0 1e30 radius 1 }' >far.txt
expect 3 'far.txt:5:' render far.txt -o out.png

# Meshes and textures: exit 3 at the place that names them, or inside them.
scene 'TriangleMesh { obj_file nowhere.obj }' >nomesh.txt
expect 3 'nomesh.txt:5:.*nowhere.obj' render nomesh.txt -o out.png
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n' >index.obj
scene 'TriangleMesh { obj_file index.obj }' >index.txt
expect 3 'index.obj:4:7: error' render index.txt -o out.png
: >empty.obj
scene 'TriangleMesh { obj_file empty.obj }' >emptymesh.txt
expect 3 'empty.obj' render emptymesh.txt -o out.png
scene 'TriangleMesh { obj_file good.xyz }' >kind.txt
: >good.xyz
expect 3 'kind.txt:5:|good.xyz' render kind.txt -o out.png
printf 'not a picture' >fake.png
scene 'Sphere { center 0 0 0 radius 1 }' 'texture fake.png' >fake.txt
expect 3 'fake.txt:4:.*fake.png' render fake.txt -o out.png
head -c 60 out.png >short.png
scene 'Sphere { center 0 0 0 radius 1 }' 'texture short.png' >short.txt
expect 3 'short.png' render short.txt -o out.png

# Output: refused before rendering, or reported; what stood there stays.
expect 2 'out.what' render good.txt -n 1 -o out.what
expect 4 'nowhere' render good.txt -n 1 -o nowhere/out.png
if [ "$(id -u)" != 0 ]; then
    mkdir readonly && chmod a-w readonly
    expect 4 'readonly' render good.txt -n 1 -o readonly/out.png
fi
if [ -c /dev/full ]; then
    ln -s /dev/full full.png
    expect 4 'full.png|/dev/full' render good.txt -n 1 -o full.png
fi
expect 4 'memory|bytes' render good.txt -n 1 --size 16384x16384 -o huge.png

# A disk that fills up while saving: the old picture stays, nothing is left beside it.
before=$(sha256sum out.png)
(
    ulimit -f 1
    exec "$program" render good.txt -n 1 --size 256x256 -o out.png --quiet 2>stderr >stdout
)
got=$?
if [ "$got" = 4 ] && [ "$before" = "$(sha256sum out.png)" ]; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL: full disk: exit $got, expected 4 and the old picture"
    cat stderr
fi
left=$(find . -name '*.tmp*' -o -name '.*.png*' | head -n 3)
[ -z "$left" ] || { failed=$((failed + 1)); echo "FAIL: left behind: $left"; }

# No display: says so, and what to do instead.
(unset DISPLAY WAYLAND_DISPLAY; timeout 60 "$program" view good.txt >stdout 2>stderr)
got=$?
if [ "$got" = 4 ] && grep -q 'firstlight render' stderr; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL: no display: exit $got"
    cat stderr
fi

# Interrupted: exit 130, what was rendered is saved.
"$program" render "$source/scenes/vase.txt" -n 1000000 --size 64x64 -o interrupted.png --quiet 2>stderr >stdout &
child=$!
# Handlers stand before the first thread is made, so a second thread says that it may begin.
while [ -d /proc/$child ] && [ "$(ls /proc/$child/task 2>/dev/null | wc -l)" -lt 2 ]; do :; done
kill -INT $child
wait $child
got=$?
if [ "$got" = 130 ] && [ -s interrupted.png ]; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL: interrupt: exit $got, expected 130 and a picture"
    cat stderr
fi

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
