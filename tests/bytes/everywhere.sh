#!/bin/sh
# SPDX-License-Identifier: MIT
# The same bytes everywhere: builds the core and `bytes` by plain compile lines, with both compilers
# and with and without optimisation, and compares
#   the hashes of the small scenes: every instruction set, structure and number of threads;
#   the films of the gallery with scenes/*.sha256: every instruction set, from 1 to 16 threads;
# both also with a C library that is told to have no AVX2 and FMA, and for AArch64 under an emulator.
# The core reads no files: FLATTEN writes the gallery's scenes with their textures and meshes.
# usage: tests/bytes/everywhere.sh FLATTEN [FOLDER]
#        tests/bytes/everywhere.sh --quick FLATTEN BYTES FOLDER
#   --quick   only the program BYTES, already built, with plain C and one thread, and of neighbours by
#             name, which are often pairs, one scene
# Exit: 0 all equal, 1 not, 77 equal, but some configuration is absent here.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
tests=$root/tests/bytes
list=$tests/hashes.txt
no_fma="GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"
equal=0 all=0 skipped=0 failed=0

fail() { # NAME WHAT
    printf '%-34s FAILED\n%s\n' "$1" "$2"
    failed=$((failed + 1))
}

skip() { # NAME
    echo "$1: not here"
    skipped=$((skipped + 1))
}

add() { # NAME EQUAL ALL
    printf '%-34s %s / %s\n' "$1" "$2" "$3"
    equal=$((equal + $2)) all=$((all + $3))
}

# The small scenes: add up what the program says.
compare() { # NAME COMMAND...
    name=$1
    shift
    said=$("$@" --all "$list" 2>&1)
    counts=$(printf '%s\n' "$said" | sed -n 's/^\([0-9]*\) hashes equal \/ \([0-9]*\)$/\1 \2/p')
    if [ -z "$counts" ]; then
        fail "$name" "$said"
        return
    fi
    add "$name" "${counts% *}" "${counts#* }"
    printf '%s\n' "$said" | grep -E ' differs |invalid' | head -n 20
}

# Make the flat scenes, and the list of the hashes that their films must have.
flatten_scenes() { # SCENE.txt ...
    rm -rf "$work/flat"
    mkdir -p "$work/flat"
    "$flatten" "$work/flat" "$@" || exit 1
    for scene in "$@"; do
        echo "$(cat "${scene%.txt}.sha256")  $(basename "$scene" .txt).film"
    done >"$work/films.sha256"
    scenes=$#
}

# The gallery, once with each instruction set and number of threads.
gallery() { # NAME 'ISA:THREADS ...' COMMAND...
    name=$1 sets=$2
    shift 2
    for set in $sets; do
        title="$name, ${set%:*}, ${set#*:} threads"
        rm -rf "$work/films"
        mkdir -p "$work/films"
        said=$("$@" --isa "${set%:*}" --threads "${set#*:}" --gallery "$work/flat" "$work/films" 2>&1)
        case $? in
        0) ;;
        77)
            skip "$title"
            continue
            ;;
        *) fail "$title" "$said" ;;
        esac
        checked=$(cd "$work/films" && sha256sum --check ../films.sha256 2>/dev/null)
        add "$title" "$(printf '%s\n' "$checked" | grep -c ': OK$')" "$scenes"
        printf '%s\n' "$checked" | grep ': FAILED' | head -n 20
    done
}

finish() {
    rm -rf "$work/flat" "$work/films"
    echo "hashes equal / all: $equal / $all, $skipped configurations skipped"
    [ "$failed" = 0 ] && [ "$equal" = "$all" ] && [ "$all" -gt 0 ] || exit 1
    [ "$skipped" = 0 ] || exit 77
    exit 0
}

if [ "${1:-}" = --quick ]; then
    flatten=$2 bytes=$3 work=$4
    place=0
    set --
    for scene in "$root"/scenes/*.txt "$root"/scenes/course/*.txt; do
        [ $((place % 2)) = 1 ] || set -- "$@" "$scene"
        place=$((place + 1))
    done
    flatten_scenes "$@"
    gallery built scalar:1 "$bytes"
    finish
fi

flatten=${1:?}
work=${2:-$(mktemp -d)}
flatten_scenes "$root"/scenes/*.txt "$root"/scenes/course/*.txt

build() { # FOLDER CC LEVEL 'ISA:WIDTH[:OPTION] ...'
    "$root/tools/compile-core" "$work/$1" "$2" "$3" "$4" \
        "$tests/bytes.c" "$tests/flat.c" "$tests/scenes.c" "$tests/world.c" &&
        "$2" -pthread -o "$work/$1/bytes" "$work/$1"/*.o -lm
}

# Instruction sets to compile, and with which numbers of threads they draw the gallery.
machine=$(uname -m)
case $machine in
x86_64) isas="scalar:1 sse2:4 avx2:8:-mavx2" corners="scalar:16 sse2:7 avx2:1" ;;
aarch64) isas="scalar:1 neon:4" corners="scalar:16 neon:1" ;;
*) isas="scalar:1" corners="scalar:1 scalar:16" ;;
esac
for cc in gcc clang; do
    for level in -O0 -O3; do
        variant="$cc $level"
        program=$work/$cc$level/bytes
        if ! command -v "$cc" >/dev/null; then
            skip "$variant"
        elif ! build "$cc$level" "$cc" "$level" "$isas"; then
            fail "$variant" "does not build"
        else
            compare "$variant" "$program"
            compare "$variant, no AVX2, FMA" env "$no_fma" "$program"
            gallery "$variant" "$corners" "$program"
            [ "$level" = -O0 ] || gallery "$variant, no AVX2, FMA" auto:3 env "$no_fma" "$program"
        fi
    done
done

# An AArch64 machine is through. Elsewhere an emulator takes eight minutes of two cores for the gallery at -O3, and at -O0
# half an hour: there the small scenes alone.
[ "$machine" != aarch64 ] || finish
cross=aarch64-linux-gnu-gcc
for level in -O0 -O3; do
    variant="aarch64 gcc $level (emulated)"
    program=$work/aarch64$level/bytes
    if ! command -v "$cross" >/dev/null || ! command -v qemu-aarch64 >/dev/null; then
        skip "$variant"
    elif ! build "aarch64$level" "$cross" "$level" "scalar:1 neon:4"; then
        fail "$variant" "does not build"
    else
        compare "$variant" qemu-aarch64 -L /usr/aarch64-linux-gnu "$program"
        [ "$level" = -O0 ] || gallery "$variant" "scalar:7 neon:16" qemu-aarch64 -L /usr/aarch64-linux-gnu "$program"
    fi
done
finish
