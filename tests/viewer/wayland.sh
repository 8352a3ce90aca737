#!/bin/bash
# SPDX-License-Identifier: MIT
# A window on Wayland: a headless weston, no X server. The picture comes, nothing is said on standard error, a signal ends
# it in order and its log replays. usage: wayland.sh FIRSTLIGHT SCENE
# Exit 77: no weston, or a GLFW without Wayland (Debian 12: unpack libglfw3-wayland and name the folder of its library in
# FL_GLFW_WAYLAND). CTest knows of it where weston was there at configuring.
set -euo pipefail

command -v weston >/dev/null || { echo 'skipped: weston is not installed'; exit 77; }
[ -x "$1" ] || { echo "FAILED: no program $1"; exit 1; }
program=$(realpath "$1") scene=$(realpath "$2")
work=$(mktemp -d) compositor='' viewer=''
cleanup() {
    [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
    [ -z "$compositor" ] || kill "$compositor" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
cd "$work"
mkdir -m 700 runtime
mkfifo lines
export XDG_RUNTIME_DIR=$work/runtime WAYLAND_DISPLAY=firstlight-test
unset DISPLAY
fail() { echo "FAILED: $*"; exit 1; }
view() { LD_LIBRARY_PATH=${FL_GLFW_WAYLAND:-}:${LD_LIBRARY_PATH:-} exec "$program" view "$scene" "$@"; }

weston --backend=headless-backend.so --use-pixman --idle-time=0 --socket="$WAYLAND_DISPLAY" >weston.txt 2>&1 &
compositor=$!
for _ in $(seq 100); do
    [ ! -S "runtime/$WAYLAND_DISPLAY" ] || break
    kill -0 "$compositor" 2>/dev/null || { cat weston.txt; echo 'skipped: weston does not start'; exit 77; }
    read -r -t 0.1 <>lines || true
done

view --samples 4 --record session.log >lines 2>errors &
viewer=$!
exec 3<lines
line=
read -r -t 60 line <&3 || true
case $line in
'done 4 samples'*) ;;
*)
    code=0
    kill "$viewer" 2>/dev/null || true
    wait "$viewer" || code=$?
    viewer=
    # Neither a crash nor a hang is a reason to skip.
    [ "$code" = 4 ] || fail "no picture, exit code $code: $(cat errors)"
    echo "skipped: $(head -1 errors)"
    exit 77
    ;;
esac
kill -TERM "$viewer"
code=0
wait "$viewer" || code=$?
viewer=
[ "$code" = 130 ] || fail "a signal ends it with exit code $code: $(cat errors)"
[ ! -s errors ] || fail "standard error: $(cat errors)"
grep -q '^[0-9]* quit$' session.log || fail 'the log does not end'
"$program" replay session.log --quiet >/dev/null || fail 'the log does not replay'
echo '1 passed, 0 failed'
