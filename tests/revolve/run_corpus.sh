#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: run_corpus.sh BIN_DIR SHARED_DIR [all]
# Grades the certified solver of surfaces of revolution against the oracle of the shared pages. BIN_DIR holds
# revolve_solve, revolve_secondary, revolve_judge (linked with the oracle) and revolve_corpus (its generator).
# Exit 77: the shared pages are absent. `all`: a million adversarial rays and 48,000 secondary rays a case.
set -eu
bin=$1 shared=$2/revolve
[ -f "$shared/oracle.c" ] || { echo "skipped: no $shared"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "${3:-}" = all ]; then
    adversarial="311:4410 612:4410" secondary=600
else
    adversarial="311:140" secondary=100
fi

echo "== open corpus, graded by grade.py"
gzip -dc "$shared/open_cases.txt.gz" >"$work/cases"
gzip -dc "$shared/open_answers.txt.gz" >"$work/answers"
"$bin/revolve_solve" "$work/cases" >"$work/results"
python3 "$shared/grade.py" "$work/cases" "$work/answers" "$work/results" double

echo "== camera corpus: corpus cam 5 80 2500"
"$bin/revolve_corpus" cam 5 80 2500 >"$work/cam"
"$bin/revolve_judge" "$work/cam"

for seed in $adversarial; do
    echo "== adversarial corpus: corpus adv ${seed%:*} ${seed#*:} 128"
    "$bin/revolve_corpus" adv "${seed%:*}" "${seed#*:}" 128 >"$work/adv"
    "$bin/revolve_judge" "$work/adv"
done

"$bin/revolve_corpus" cam 5 80 1 >"$work/profiles"
for distance in 4 10000; do
    for type in double float; do
        echo "== rays leaving the surface, seen from $distance S, stored as $type"
        "$bin/revolve_secondary" "$work/profiles" "$distance" "$type" "$secondary" >"$work/again"
        "$bin/revolve_judge" "$work/again"
    done
done
