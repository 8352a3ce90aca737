/* SPDX-License-Identifier: MIT
 *
 * Where the random numbers of a test begin. Tests run with the seed they were written with, so that
 * a failure comes back; FL_TEST_SEED=N in the environment makes the same test a search.
 */
#ifndef TEST_SEED_H
#define TEST_SEED_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/** 64 random bits, splitmix64 [Steele, Lea, Flood 2014]; any state will do. */
static inline uint64_t test_bits(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/** FL_TEST_SEED, or `standard`; printed, for whoever has to repeat it. */
static inline uint32_t test_seed(uint32_t standard)
{
    const char *given = getenv("FL_TEST_SEED");
    uint32_t seed = given ? (uint32_t)strtoul(given, NULL, 0) : standard;
    printf("FL_TEST_SEED=%u\n", seed);
    return seed;
}

#endif
