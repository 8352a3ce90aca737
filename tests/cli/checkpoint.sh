#!/bin/sh
# SPDX-License-Identifier: MIT
# A render that was broken off goes on to the same bytes; a checkpoint of something else is refused and left alone.
# usage: checkpoint.sh FIRSTLIGHT SOURCE_DIR
set -u
program=$1
scene=$2/scenes/shadow-soft.txt
. "$(dirname "$0")/kit.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# film ARGUMENTS...: hash, error estimate and rays of a 64 x 64 render
film() {
    "$program" render "$scene" --size 64x64 --json --quiet "$@" 2>stderr |
        sed -n 's/.*\("rays":.*"invalid_samples\).*\("film_sha256":"[0-9a-f]*"\).*/\1\2/p'
}

whole=$(film -n 70)
check 'a whole render has a hash' 1 "$(echo "$whole" | grep -c film_sha256)"

# In steps, with other numbers of threads.
for n in 1 16 17 64 70; do last=$(film -n $n -j $((n % 3 + 1)) --checkpoint steps); done
check 'in steps' "$whole" "$last"
check 'nothing left to do' "$whole" "$(film -n 70 --checkpoint steps)"

# Broken off by each signal as soon as it renders; what was done may be nothing.
for name in INT TERM HUP; do
    rm -f broken
    "$program" render "$scene" --size 64x64 -n 1000000000 --checkpoint broken -o broken.png --quiet 2>stderr &
    child=$!
    while [ -d /proc/$child ] && [ "$(ls /proc/$child/task 2>/dev/null | wc -l)" -lt 2 ]; do :; done
    kill -$name $child
    wait $child
    check "$name: exit code" 130 $?
    check "$name: picture" yes "$([ -s broken.png ] && echo yes)"
    got=$(film -n 70 --checkpoint broken)
    # Broken off beyond 70 samples: the same many of a whole render then.
    n=$("$program" render "$scene" --size 64x64 -n 70 --checkpoint broken --json --quiet | sed 's/.*"samples":\([0-9]*\).*/\1/')
    check "$name: goes on" "$(film -n "$n")" "$got"
done

# Of another picture, damaged, or no checkpoint at all: exit 3, the file stays as it is.
refuse() { # WHAT PATTERN FILE ARGUMENTS...
    what=$1 pattern=$2 file=$3
    shift 3
    before=$(sha256sum "$file")
    "$program" render "$@" --checkpoint "$file" --quiet --json >stdout 2>stderr
    check "$what: exit code" 3 $?
    check "$what: message" 1 "$(grep -cE "$pattern" stderr)"
    check "$what: file" "$before" "$(sha256sum "$file")"
}
refuse 'other settings' 'other settings' steps "$scene" --size 64x64 --seed 3
refuse 'other camera' 'another camera' steps "$scene" --size 64x64 --focus 9
sed 's/radius 0.75/radius 0.7/' "$scene" >other.txt
refuse 'other scene' 'another scene' steps other.txt --size 64x64
cp steps damaged
printf 'x' | dd of=damaged bs=1 seek=5000 conv=notrunc 2>dd
refuse 'damaged' 'damaged' damaged "$scene" --size 64x64
head -c 300 steps >short
refuse 'short' 'cut off|damaged' short "$scene" --size 64x64
echo 'my notes' >notes
refuse 'no checkpoint' 'no checkpoint of firstlight' notes "$scene" --size 64x64

before=$(sha256sum steps)
"$program" render "$scene" --size 64x64 --adaptive on --checkpoint steps --quiet --json >stdout 2>stderr
check 'adaptive: exit code' 2 $?
check 'adaptive: file' "$before" "$(sha256sum steps)"

# Exposure decides no sample.
check 'exposure' "$(film -n 70 -e 2)" "$(film -n 70 -e 2 --checkpoint steps)"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
