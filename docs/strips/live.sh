#!/bin/bash
# SPDX-License-Identifier: MIT
# A real window under Xvfb while its scene is edited: as it was, a colour changed, broken, mended.
# usage: live.sh FIRSTLIGHT ROOT, in an empty folder: makes 1.png to 4.png there.
set -euo pipefail
program=$1 root=$2
if [ -z "${FL_UNDER_XVFB:-}" ]; then
    FL_UNDER_XVFB=1 exec xvfb-run -a -s '-screen 0 640x480x24' "$0" "$@"
fi
viewer=
trap '[ -z "$viewer" ] || kill "$viewer"' EXIT
cp "$root/tests/viewer/three.txt" good.txt
sed 's/diffuseColor 0.8 0.12 0.08/diffuseColor 0.1 0.2 0.9/' good.txt >blue.txt
sed 's/radius 0.7/radios 0.7/' blue.txt >broken.txt
cp good.txt live.txt
mkfifo lines
"$program" view live.txt --samples 64 >lines &
viewer=$!
exec 3<lines
expect() { while read -r -t 60 line <&3; do case $line in "$1"*) return ;; esac; done; exit 1; }
answer() { xdotool key c; expect --camera; } # What was asked before is done.
window=$(xdotool search --sync --onlyvisible --name firstlight | head -1)
xdotool windowfocus --sync "$window"
xdotool windowsize --sync "$window" 480 300
expect 'done 64'
xdotool key F11
answer
xdotool sleep 3 # The message goes.
import -window "$window" 1.png
cp blue.txt live.txt
expect 'done 64'
import -window "$window" 2.png
cp broken.txt live.txt
xdotool sleep 2 # Nothing is printed for an error; it is looked at in the picture.
import -window "$window" 3.png
cp good.txt live.txt
expect 'done 64'
import -window "$window" 4.png
xdotool key ctrl+q
