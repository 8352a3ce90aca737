#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: said.sh FIRSTLIGHT
# What floats cannot do is said: samples that overflow are counted in the summary and in the report, and do not reach the
# picture; an object that floats cannot place is warned of where it stands in the text, until --precision double is asked for.
set -euo pipefail
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "said: $1" >&2; exit 1; }
size=(-s 24x18 -n 2 --threads 1)

scene() { # FILE DIFFUSE LIGHT X
  cat >"$1" <<END
firstlight 1
PerspectiveCamera { center $4 1 5 direction 0 -0.2 -1 up 0 1 0 angle 40 }
Lights { PointLight { position $4 5 4 color $3 $3 $3 } }
Materials { Material { diffuseColor $2 $2 $2 } }
Group { MaterialIndex 0
Sphere { center $4 0 0 radius 1 }
Sphere { center -$4 -9 0 radius 2 } }
END
}

scene "$folder/huge.scene" 1e20 1e20 2
said=$("$program" render "$folder/huge.scene" -o "$folder/huge.png" "${size[@]}")
report=$("$program" render "$folder/huge.scene" -o "$folder/huge.exr" "${size[@]}" --json --quiet)
count=$(grep -o '"invalid_samples":[0-9]*' <<<"$report" | cut -d: -f2)
[ "$count" -gt 0 ] || fail "nothing is counted: $report"
grep -q ", $count INVALID samples dropped" <<<"$said" || fail "$count dropped, but the summary says: $said"

scene "$folder/far.scene" 0.7 1 1e6
warning=$("$program" render "$folder/far.scene" -o "$folder/far.png" "${size[@]}" 2>&1 >/dev/null)
grep -q "far.scene:6:1: warning: .* floats .* --precision double renders it right" <<<"$warning" || fail "no warning, but: $warning"
warning=$("$program" render "$folder/far.scene" -o "$folder/far.png" "${size[@]}" --precision double 2>&1 >/dev/null)
[ -z "$warning" ] || fail "in double: $warning"
warning=$("$program" render "$folder/far.png" -o "$folder/again.png" 2>&1 >/dev/null)
[ -z "$warning" ] || fail "reopened in double: $warning"
