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
[ $status = 0 ] && echo "3 passed, 0 failed"
exit $status
