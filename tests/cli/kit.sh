# SPDX-License-Identifier: MIT
# What the tests of commands share; read by them, not run.
passed=0 failed=0

check() { # WHAT EXPECTED GOT
    if [ "$2" = "$3" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL: $1: expected $2, got $3"
        cat stderr
    fi
}
