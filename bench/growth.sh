#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: growth.sh FIRSTLIGHT [BENCH-OPTION...]      measures growth and draws docs/performance/growth.svg
set -eu
program=$(realpath "$1")
shift
cd "$(dirname "$(realpath "$0")")/.."
"$program" bench --growth --json "$@" | python3 -c '
import json, sys
before = None
print("# count  ns a ray: median least greatest  node visits  tests  rays a pixel  build ms  bytes")
for r in json.load(sys.stdin)["rows"]:
    if before not in (None, r["of"]):
        print("\n")
    if before != r["of"]:
        print("# " + r["of"])
    before = r["of"]
    print(r["count"], *("%.4g" % r[k] for k in ("ns_per_ray", "ns_min", "ns_max", "node_visits", "primitive_tests",
                                                  "rays_per_pixel", "build_ms", "bytes")))
' >docs/performance/growth.dat
gnuplot docs/performance/growth.gp >docs/performance/growth.svg
