#!/bin/sh
# SPDX-License-Identifier: MIT
# A file system that is full: exit 4 with the reason, what stood there stays, nothing is left beside it. Needs a user namespace
# to mount a small one; skipped (77) where there is none.
# usage: full_disk.sh FIRSTLIGHT
set -u
if [ "$1" != --inside ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    unshare -rm sh -c 'mount -t tmpfs -o size=64k tmpfs "$1"' - "$work" 2>/dev/null || {
        echo 'skipped: no user namespace that may mount'
        exit 77
    }
    unshare -rm "$0" --inside "$1" "$work"
    exit
fi
program=$2 work=$3
mount -t tmpfs -o size=4m tmpfs "$work" && mkdir "$work/disk" && mount -t tmpfs -o size=64k tmpfs "$work/disk" || exit 77
cd "$work"
passed=0 failed=0

cat >good.txt <<'TEXT'
firstlight 1
PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 width 64 height 64 }
Lights { DiskLight { position 2 3 4 direction -1 -1 -1 radius 1 color 1 1 1 } }
Materials { Material { diffuseColor 0.8 0.5 0.2 } }
Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }
TEXT
i=0
while [ $i -lt 200 ]; do
    echo "# line $i of a long comment that takes some room in the scene as it is written again"
    i=$((i + 1))
done >>good.txt
printf 'firstlight-log 1 64x64 good.txt\n0 snapshot disk/snapshot.png 1\n1 quit\n' >log.txt

"$program" render good.txt -n 1 --size 24x24 --checkpoint state --json --quiet >stdout || exit 1

names='out.png out.exr out.tif out.txt snapshot.png'
fill() { # Leave one page, so that writing begins and then fails.
    rm -rf disk/* && mkdir disk/study
    for name in $names; do echo old >"disk/$name"; done
    cp state disk/state
    printf '%4096s' ' ' >disk/page
    cat /dev/zero >disk/filler 2>/dev/null
    rm disk/page
}
content() { (cd disk && find . -name study -prune -o -type f -print | sort | xargs cksum); }

full() { # WHAT ARGUMENTS...
    what=$1
    shift
    fill
    before=$(content)
    timeout 60 "$program" "$@" >stdout 2>stderr </dev/null
    code=$?
    if [ $code = 4 ] && grep -q 'No space left on device' stderr && [ "$before" = "$(content)" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL: $what: exit $code, expected 4, a reason and the old files"
        head -n 5 stderr
        content
    fi
}
full 'a PNG' render good.txt -n 1 -o disk/out.png --quiet
full 'an EXR' render good.txt -n 1 -o disk/out.exr --quiet
full 'a TIFF' render good.txt -n 1 -o disk/out.tif --quiet
full 'a map' render good.txt -n 1 --size 256x256 -o disk/out.png --aov depth --quiet
full 'a checkpoint' render good.txt -n 2 --size 24x24 --checkpoint disk/state --json --quiet
full 'a first checkpoint' render good.txt -n 2 --size 24x24 --checkpoint disk/new --json --quiet
full 'a scene' convert good.txt disk/out.txt
full 'a study' study good.txt --size 8x8 --samples 2 --out disk/study --quiet
full 'a snapshot' replay log.txt --quiet --platform osmesa

# Rendered to memory that is there all the same: the picture is saved although the checkpoint is not.
fill
timeout 60 "$program" render good.txt -n 2 --size 24x24 --checkpoint disk/new -o kept.png --quiet 2>stderr
if [ $? = 4 ] && [ -s kept.png ]; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL: the picture goes with the checkpoint"
fi

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
