#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds the core and `bytes` by plain compile lines, with every compiler and level at hand, and
# compares the hashes of the small scenes: instruction sets, threads, structures, a C library that
# is told to have no AVX2 and FMA, and AArch64 under an emulator.
# usage: tests/bytes/everywhere.sh [--quick BYTES] [BUILD_FOLDER]
#   --quick BYTES   only the program BYTES, already built: no compiling
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
list=$root/tests/bytes/hashes.txt
no_fma="GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"
equal=0 all=0 skipped=0 failed=0

# Run one program and add up what it says.
compare() { # NAME COMMAND...
    name=$1
    shift
    said=$("$@" 2>&1)
    counts=$(printf '%s\n' "$said" | sed -n 's/^\([0-9]*\) hashes equal \/ \([0-9]*\)$/\1 \2/p')
    if [ -z "$counts" ]; then
        printf '%-34s FAILED\n%s\n' "$name" "$said"
        failed=$((failed + 1))
        return
    fi
    equal=$((equal + ${counts% *})) all=$((all + ${counts#* }))
    printf '%-34s %s\n' "$name" "${counts% *} / ${counts#* }"
    printf '%s\n' "$said" | grep ' differs ' | head -n 20
}

run_all() { # NAME PROGRAM
    compare "$1" "$2" --all "$list"
    compare "$1, no AVX2, FMA" env "$no_fma" "$2" --all "$list"
}

finish() {
    echo "hashes equal / all: $equal / $all, $skipped configurations skipped"
    [ "$failed" = 0 ] && [ "$equal" = "$all" ] && [ "$all" -gt 0 ]
    exit
}

if [ "${1:-}" = --quick ]; then
    run_all built "$2"
    finish
fi

work=${1:-$(mktemp -d)}
mkdir -p "$work" || exit 2
tests=$root/tests/bytes

build() { # FOLDER CC LEVEL 'ISA:WIDTH[:OPTION] ...'
    "$root/tools/compile-core" "$work/$1" "$2" "$3" "$4" "$tests/bytes.c" "$tests/scenes.c" "$tests/world.c" &&
        "$2" -pthread -o "$work/$1/bytes" "$work/$1"/*.o -lm
}

x86="scalar:1 sse2:4 avx2:8:-mavx2"
case $(uname -m) in
x86_64) sets=$x86 ;;
aarch64) sets="scalar:1 neon:4" ;;
*) sets="scalar:1" ;;
esac
for cc in gcc clang; do
    for level in -O0 -O3; do
        name="$cc $level"
        if ! command -v "$cc" >/dev/null; then
            echo "$name: not here"
            skipped=$((skipped + 1))
        elif build "$cc$level" "$cc" "$level" "$sets"; then
            run_all "$name" "$work/$cc$level/bytes"
        else
            echo "$name: does not build"
            failed=$((failed + 1))
        fi
    done
done

cross=aarch64-linux-gnu-gcc
for level in -O0 -O3; do
    name="aarch64 gcc $level (emulated)"
    if ! command -v "$cross" >/dev/null || ! command -v qemu-aarch64 >/dev/null; then
        echo "$name: not here"
        skipped=$((skipped + 1))
    elif build "aarch64$level" "$cross" "$level" "scalar:1 neon:4"; then
        compare "$name" qemu-aarch64 -L /usr/aarch64-linux-gnu "$work/aarch64$level/bytes" --all "$list"
    else
        echo "$name: does not build"
        failed=$((failed + 1))
    fi
done
finish
