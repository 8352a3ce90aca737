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

outputs=$(i=0; while [ $i -lt 17 ]; do printf -- '-o o%d.png ' $i; i=$((i + 1)); done)
expect 2 'at most 16 pictures are written at once' render good.txt $outputs
expect 0 '' render good.txt -n 1 --quiet ${outputs% -o *}

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
mkdir deep
expect 0 '' render deep/../deep/../good.txt -n 1 -o deep/../above.png --quiet
[ -s above.png ] || { echo "FAIL: picture by a path with .. is missing"; failed=$((failed + 1)); }
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
ln -s loop.obj loop.obj
scene 'TriangleMesh { obj_file loop.obj }' >loopmesh.txt
expect 3 "loopmesh.txt:5:.*'loop.obj'" render loopmesh.txt -o out.png
for kind in obj ply stl glb; do # devices and pipes are not waited for
    ln -s /dev/zero "zero.$kind"
    mkfifo "pipe.$kind"
    for file in zero pipe; do
        scene "TriangleMesh { obj_file $file.$kind }" >device.txt
        expect 3 'device.txt:5:.*it is not a regular file' render device.txt -o out.png
    done
done
for uri in pipe.obj zero.obj deep gone.bin; do # nor where a mesh names them
    cat >inside.gltf <<TEXT
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "$uri"}]}
TEXT
    scene 'TriangleMesh { obj_file inside.gltf }' >inside.txt
    expect 3 "inside.txt:5:.*could not open referenced file \"$uri\"" render inside.txt -o out.png
done
ln -s loop.png loop.png
scene 'Sphere { center 0 0 0 radius 1 }' 'texture loop.png' >looptexture.txt
expect 3 "looptexture.txt:4:.*'loop.png'" render looptexture.txt -o out.png
mkfifo pipe.png
scene 'Sphere { center 0 0 0 radius 1 }' 'texture pipe.png' >pipetexture.txt
expect 3 "pipetexture.txt:4:.*it is not a regular file" render pipetexture.txt -o out.png
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
expect 4 'rendering 16384 x 16384 pixels needs [0-9]+ bytes.*the memory limit is 8589934592' \
    render good.txt -n 1 --size 16384x16384 -o huge.png
expect 4 "pipe.png': it is not a regular file" render good.txt -n 1 -o pipe.png
expect 4 "loop.png': Too many levels of symbolic links" render good.txt -n 1 -o loop.png
[ -L loop.png ] || { echo "FAIL: the link was replaced"; failed=$((failed + 1)); }
ln -s deep/behind.png link.png
expect 0 '' render good.txt -n 1 -o link.png --quiet
[ -L link.png ] && [ -s deep/behind.png ] ||
    { echo "FAIL: what a link leads to was not made"; failed=$((failed + 1)); }

# Standard output that takes nothing.
expect_full() { # ARGUMENTS...
    timeout 60 "$program" "$@" >/dev/full 2>stderr </dev/null
    got=$?
    if [ "$got" = 4 ] && grep -q 'cannot write to standard output: No space left on device' stderr; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL: $program $* into /dev/full: exit $got, expected 4 and a reason"
        cat stderr
    fi
}
if [ -c /dev/full ]; then
    expect_full render good.txt -n 1 --json --quiet
    expect_full render good.txt -n 1 -o out.png
    expect_full info good.txt --json
    expect_full convert good.txt -
    expect_full --help
    expect_full help scene
    expect_full --version
fi

# Checkpoints, logs and keys of another kind or beyond their largest size, without taking room on the disk.
expect 3 'pipe.obj.*it is not a regular file' render good.txt -n 1 --checkpoint pipe.obj -o out.png
expect 4 'deep.*it is a folder' render good.txt -n 1 --checkpoint deep -o out.png
expect 3 '/dev/null.*it is not a regular file' render good.txt -n 1 --checkpoint /dev/null -o out.png
truncate -s 67108865 large.log
expect 3 "large.log' is too large: 67108865 bytes, at most 67108864 are read" replay large.log
truncate -s 67108864 large.log
expect 3 'large.log:1:' replay large.log
printf 'firstlight-log 1 16x16 good.txt\n0 snapshot many.png 1048577\n1 quit\n' >many.log
expect 3 'many.log:2:.*1048576' replay many.log
printf 'firstlight-log 1 16x16 good.txt\n0 quit\n' >quit.log
truncate -s 1048577 large.keys
expect 3 "large.keys' is too large: 1048577 bytes, at most 1048576 are read" replay quit.log --keys large.keys --platform osmesa

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
