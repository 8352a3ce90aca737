/* SPDX-License-Identifier: MIT
 *
 * A target is a file fuzz_NAME.c with one function that takes any bytes and aborts when something
 * is wrong. libFuzzer calls it (tools/run-fuzz), and so does replay.c, without any fuzzer.
 */
#ifndef TEST_FUZZ_H
#define TEST_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

/** What must hold for every input, in optimised builds too. */
#define MUST(condition)                                                                            \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);         \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

#endif
