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

# The number or hash of that name in a line of JSON.
field() { # NAME FILE
    sed -n 's/.*"'"$1"'":"\{0,1\}\([0-9a-f]*\).*/\1/p' "$2"
}
