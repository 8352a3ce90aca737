/* SPDX-License-Identifier: MIT
 *
 * Property tests: cases made from random numbers, and the smallest case that fails. A case is the
 * list of the numbers that it drew; made from a shorter list or from smaller numbers it is another,
 * simpler case, so that one loop shrinks texts, scenes and rays alike [MacIver, Donaldson 2020,
 * "Test-case reduction via test-case generation"].
 */
#ifndef TEST_PROPERTY_H
#define TEST_PROPERTY_H

#include <stdbool.h>
#include <stdint.h>

typedef struct property property;

/** Makes a case from what it draws, and checks it: false after property_fail(). May be called any
 * number of times, must do the same for the same numbers. */
typedef bool property_holds(property *p, void *data);

/** In [0, below), or any number for below 0. The simplest is 0. */
uint64_t property_below(property *p, uint64_t below);
/** In [lo, hi]. The simplest is 0 or, outside of that, lo; numbers of few bits come before others.
 */
double property_between(property *p, double lo, double hi);
/** `value` below `below`, always, but for a case that shrinks: how many pieces follow. */
uint64_t property_given(property *p, uint64_t value, uint64_t below);
/** What is drawn from here to the next mark is a piece, which a simpler case may do without. */
void property_mark(property *p);
/** Says what is wrong with the case. Always false. */
bool property_fail(property *p, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** A case found by an earlier search, made small, and kept. */
typedef struct property_case {
    const uint64_t *choices;
    uint32_t count;
} property_case;

#define PROPERTY_CASE(choices)                                                                     \
    {                                                                                              \
        choices, sizeof(choices) / sizeof *(choices)                                               \
    }

/** The kept cases, then `count` random ones, which begin at FL_TEST_SEED or `seed` (seed.h). Prints
 * the smallest failing case that it finds, and fails the test. */
void property_run(property_holds *holds, void *data, uint32_t seed, uint32_t count,
                  const property_case *kept, uint32_t kept_count);

/** One random case, its seed known; true: it holds. Otherwise `out` gets the smallest failing case
 * that was found, until the next call, and `message` what is wrong with it, until the next, too. */
bool property_check(property_holds *holds, void *data, uint64_t seed, property_case *out,
                    const char **out_message);

#endif
