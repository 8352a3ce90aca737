/* SPDX-License-Identifier: MIT
 *
 * Layer 0: a clock cheap enough to read between the stages of 512 rays. Its unit is the machine's
 * own: good for shares of a time that another clock has measured, and for nothing else.
 */
#ifndef FL_TICKS_H
#define FL_TICKS_H

#include <stdint.h>
#include <time.h>

/** Never goes back on one thread. Some 10 to 30 ns. */
static inline uint64_t fl_ticks(void)
{
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
#endif
}

#endif
