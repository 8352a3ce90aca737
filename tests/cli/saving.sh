#!/bin/sh
# SPDX-License-Identifier: MIT
# A signal in the middle of saving, at each of its system calls: after one that is caught the picture is whole and the only
# file; one that kills leaves the old picture or the whole new one. 77: programs may not be traced here.
# usage: saving.sh FIRSTLIGHT SCENE
set -u
program=$(realpath "$1")
scene=$(realpath "$2")
. "$(dirname "$0")/kit.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
strace -qqq -o /dev/null true 2>/dev/null || exit 77
# A program that is traced cannot look for its own leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

film() {
    "$program" render picture.png --quiet --json 2>stderr >json
    field film_sha256 json
}
save() { "$@" "$program" render "$scene" -n 1 --size 64x48 -o picture.png --quiet >/dev/null 2>stderr; }
beside() { find . -name '.*.tmp'; }

save env
new=$(film)
check 'the picture opens' 64 ${#new}
for call in write:1 fsync:1 rename:1 fsync:2; do
    names=TERM
    [ $call != rename:1 ] || names='INT TERM HUP'
    at="-e trace=${call%:*} -e inject=${call%:*}:when=${call#*:}:signal="
    for name in $names; do
        echo old >picture.png
        # shellcheck disable=SC2086 # a list of options
        save strace -f -qqq -o log $at$name
        check "$name at $call: exit code" 130 $?
        check "$name at $call: it came" 1 "$(grep -c "SIG$name" log)"
        check "$name at $call: the picture" "$new" "$(film)"
        check "$name at $call: nothing beside it" '' "$(beside)"
    done
    echo old >picture.png
    # shellcheck disable=SC2086
    save strace -f -qqq -o log ${at}KILL
    check "KILL at $call: it came" 0 "$(grep -q 'killed by SIGKILL' log; echo $?)"
    case $call in
    fsync:2) check "KILL at $call: the new picture" "$new" "$(film)" ;;
    *) check "KILL at $call: the old picture" old "$(head -c 3 picture.png)" ;;
    esac
    rm -f .*.tmp
done

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
