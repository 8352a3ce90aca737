#!/bin/bash
# SPDX-License-Identifier: MIT
# A real window under Xvfb, driven by xdotool: picture, help, flying, snapshot, idle, quit; and no display at all.
# usage: xvfb.sh FIRSTLIGHT SCENE [FOLDER for the screenshots, kept]. Exit 77: the tools are not here.
# Nothing waits by guess: each step waits for a line that the viewer prints.
set -euo pipefail

for tool in xvfb-run xdotool import compare convert identify; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
if [ -z "${FL_UNDER_XVFB:-}" ]; then
    FL_UNDER_XVFB=1 exec xvfb-run -a -s '-screen 0 1024x768x24' "$0" "$@"
fi

here=$(realpath "$(dirname "$0")")
[ -x "$1" ] || { echo "FAILED: no program $1"; exit 1; }
program=$(realpath "$1") scene=$(realpath "$2") original=$(realpath "$2")
folder=${3:-}
work=$(mktemp -d) viewer=
cleanup() {
    [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
shots=${folder:-$work}
mkdir -p "$shots"
shots=$(realpath "$shots")
cd "$work"

fail() { echo "FAILED: $*"; exit 1; }

# Wait for a line that begins with $1; it is left in $line.
expect() {
    while read -r -t 60 line <&3; do
        case $line in "$1"*) return 0 ;; esac
    done
    fail "no line '$1...' came"
}

shoot() { import -window "$window" "$shots/$1.png"; }
differing() { compare -metric AE "$shots/$1.png" "$shots/$2.png" null: 2>&1 || true; }

# Whether the ball on the left is of the one colour more than of the other.
ball() { [ "$(convert "$shots/$1.png" -format "%[fx:p{175,145}.$2-p{175,145}.$3>0.3]" info:)" = 1 ]; }
# Two shots but for noise and a line of text.
same() { [ "$(compare -metric AE -fuzz 8% "$shots/$1.png" "$shots/$2.png" null: 2>&1 | cut -d. -f1)" -lt 2000 ]; }

# Everything sent before has been handled and drawn when the second of two answers is there.
settle() {
    for answer in 1 2; do
        xdotool key --clearmodifiers c
        expect --camera
    done
}

mkfifo lines
cp "$scene" live.txt
scene=$work/live.txt
"$program" view "$scene" --samples 16 --record session.log >lines 2>errors &
viewer=$!
exec 3<lines
window=$(xdotool search --sync --onlyvisible --name firstlight | head -1)
xdotool windowfocus --sync "$window"
expect 'done 16 samples'
xdotool windowsize --sync "$window" 640 480
expect 'done 16 samples' # again, at the new size

xdotool key F11
settle
xdotool key F11
settle
shoot picture
[ "$(identify -format '%w %h' "$shots/picture.png")" = '640 480' ] || fail 'the window was not resized'
[ "$(identify -format %k "$shots/picture.png")" -gt 1000 ] || fail 'the window shows no picture'

xdotool key F1
settle
shoot help
[ "$(differing picture help | cut -d. -f1)" -gt 50000 ] || fail 'the help does not show'
xdotool key F1 F1 F1 # the other pages, and away

xdotool keydown d
settle
xdotool keyup d
expect 'done 16 samples'
settle
shoot flown
[ "$(differing picture flown | cut -d. -f1)" -gt 50000 ] || fail 'flying does not show'

xdotool key F12
expect 'saved firstlight-001.png 16 samples'
[ "$(identify -format '%w %h' firstlight-001.png)" = '640 480' ] || fail 'the snapshot has another size'

# At rest: count clock ticks over a measured second.
ticks() { awk '{print $14 + $15}' "/proc/$viewer/stat"; }
settle
xdotool sleep 3 # the message goes
before=$(ticks)
xdotool sleep 2
used=$(($(ticks) - before))
# Instrumented code is several times slower.
most=2
! ldd "$program" | grep -qE 'lib(a|t|ub)san' || most=10
[ "$used" -le "$most" ] || fail "at rest it used $used ticks of 200"

# How often threads other than the first have slept and woken.
wakes() { cat /proc/"$viewer"/task/*/status | awk -v first="$viewer" '/^Pid:/ {id = $2}
    /^voluntary_ctxt_switches:/ && id != first {n += $2} END {print n + 0}'; }
rests() { # WHEN: neither CPU nor a single wake-up of a worker in two seconds
    local ticks_before wakes_before
    ticks_before=$(ticks) wakes_before=$(wakes)
    xdotool sleep 2
    [ "$(wakes)" = "$wakes_before" ] || fail "$1 its threads woke $(($(wakes) - wakes_before)) times"
    [ "$(($(ticks) - ticks_before))" -le "$most" ] || fail "$1 it used $(($(ticks) - ticks_before)) ticks of 200"
}
rests 'at rest'

# Paused, and as an icon (what a window manager would say), with much left to render.
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14; do xdotool key x; done
xdotool key p
settle
xdotool sleep 3
rests 'paused'
xdotool key p
settle
wm_state() { python3 "$here/wm_state.py" "$window" "$1"; }
wm_state iconic
xdotool sleep 1
rests 'as an icon'
wm_state normal
before=$(ticks)
until [ "$(($(ticks) - before))" -gt 20 ]; do xdotool sleep 0.1; done # It goes on.

# A snapshot in the middle, and off: it is of where it was asked for, whole, and nothing is done.
xdotool key d F12 keydown d
expect 'saved firstlight-002.png '
samples=${line#saved firstlight-002.png }
grep -q "snapshot firstlight-002.png ${samples% samples}\$" session.log || fail "the log has other samples than '$line'"
xdotool keyup d key c
until case $line in --camera*) ;; done*) fail "'$line' of a picture that goes on" ;; *) false ;; esac; do
    read -r -t 60 line <&3 || fail 'no camera came'
done
xdotool key r # 16 samples again
settle

# Bookmarks stand beside the scene; what the clipboard holds comes back.
settle
camera=$line
xdotool key ctrl+1
xdotool keydown d
settle
xdotool keyup d
settle
[ "$line" != "$camera" ] || fail 'flying does not move the camera'
[ -s live.txt.views ] || fail 'no bookmarks beside the scene'
xdotool key 1
settle
[ "$line" = "$camera" ] || fail 'the bookmark is not where it was set'
xdotool key ctrl+z
settle
[ "$line" != "$camera" ] || fail 'undo does nothing'
xdotool key ctrl+y
settle
[ "$line" = "$camera" ] || fail 'redo does nothing'

# A scene that is saved is read again by itself; a broken one leaves the picture and says where.
xdotool key R
until settle; shoot before; ball before r b; do :; done
sed -i 's/diffuseColor 0.8 0.12 0.08/diffuseColor 0.1 0.2 0.9/' live.txt
until settle; shoot reloaded; settle; shoot again; ball reloaded b r && same reloaded again; do :; done
cp live.txt good.txt
sed -i 's/radius 0.7/radios 0.7/' live.txt
until settle; shoot broken; [ "$(differing reloaded broken | cut -d. -f1)" -gt 20000 ]; do :; done
cp good.txt live.txt
until settle; shoot mended; same reloaded mended; do :; done

# A scene that names a mesh which is not there yet is read again when the mesh comes.
sed 's/^\( *\)Sphere.*radius 0.7.*/\1TriangleMesh { obj_file late.obj }/' good.txt >late.txt
grep -q late.obj late.txt || fail 'the scene was not changed'
mv late.txt live.txt
until settle; shoot missing; [ "$(differing mended missing | cut -d. -f1)" -gt 20000 ]; do :; done
printf 'v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >late.obj
expect 'done 16 samples'

# Who asks for a snapshot and leaves has it still.
xdotool key d F12 ctrl+q
expect 'saved firstlight-003.png '
code=0
wait "$viewer" || code=$?
viewer=
[ "$code" = 0 ] || fail "exit code $code: $(cat errors)"
[ ! -s errors ] || fail "standard error: $(cat errors)"
grep -q '^[0-9]* quit$' session.log || fail 'the log does not end'

# With the scene as it was then the record makes the snapshots again.
mkdir taken
mv firstlight-00[12].png taken
cp "$original" live.txt
"$program" replay session.log --quiet >/dev/null || fail 'the recorded log does not replay'
for taken in firstlight-00[12].png; do
    cmp "taken/$taken" "$taken" || fail "the record makes another $taken"
done

# The snapshot opens where it was taken.
"$program" render firstlight-001.png -o again.png --quiet || fail 'the snapshot does not open'
cmp -s firstlight-001.png again.png || fail 'the snapshot opened gives other bytes'

# Nor is it lost when a signal ends the viewer before the picture is whole.
rm -f firstlight-00?.png session.log
"$program" view "$scene" --light-samples 300 --size 640x480 --record session.log --quiet 2>errors &
viewer=$!
window=$(xdotool search --sync --onlyvisible --name firstlight | head -1)
xdotool windowfocus --sync "$window"
xdotool key F12
until grep -q snapshot session.log; do kill -0 "$viewer" || fail 'the viewer ended by itself'; done
kill -TERM "$viewer"
code=0
wait "$viewer" || code=$?
viewer=
[ "$code" = 130 ] || fail "exit code after SIGTERM: $code: $(cat errors)"
"$program" render firstlight-001.png -o again.png --quiet || fail 'the snapshot ordered before SIGTERM does not open'
cmp -s firstlight-001.png again.png || fail 'the snapshot ordered before SIGTERM is another picture'

code=0
env -u DISPLAY -u WAYLAND_DISPLAY "$program" view "$scene" 2>errors || code=$?
[ "$code" = 4 ] || fail "without a display the exit code is $code"
grep -q 'firstlight render' errors || fail 'no word about rendering without a display'
echo "passed; at rest $used ticks of 200"
