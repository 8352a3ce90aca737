#!/bin/sh
# SPDX-License-Identifier: MIT
# The committed pages are what the program's tables say now (./dev docs writes them).
# usage: pages.sh FIRSTLIGHT SOURCE_DIR
set -u
status=0
page() { # PAGE TOPIC
    if ! "$1" help "$3" | cmp -s - "$2"; then
        echo "FAIL: $2 is stale: run ./dev docs"
        status=1
    fi
}
page "$1" "$2/docs/firstlight.1" man
page "$1" "$2/docs/scene-format.md" scene-markdown
page "$1" "$2/docs/controls.md" keys
# Every strip of the controls has its log or script and its picture, small enough to commit, and none is forgotten.
for source in "$2"/docs/strips/*.log "$2"/docs/strips/*.sh; do
    name=$(basename "$source" .log)
    name=${name%.sh}
    grep -q "(strips/$name.jpg)" "$2/docs/controls.md" || { echo "FAIL: docs/controls.md does not show $name"; status=1; }
    [ "$(wc -c <"$2/docs/strips/$name.jpg")" -le 60000 ] || { echo "FAIL: no strip $name of at most 60000 bytes"; status=1; }
done
[ "$(grep -c '](strips/.*jpg)' "$2/docs/controls.md")" = "$(ls "$2"/docs/strips/*.log "$2"/docs/strips/*.sh | wc -l)" ] || {
    echo "FAIL: docs/controls.md shows a strip that has no log or script"
    status=1
}
[ $status = 0 ] && echo "4 passed, 0 failed"
exit $status
