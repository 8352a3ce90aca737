/* SPDX-License-Identifier: MIT */
#ifndef TEST_ROUNDED_H
#define TEST_ROUNDED_H

/** The nearest float. Through memory: gcc 12 makes vectors of neighbours and then drops the way
 * through floats. */
static inline double rounded(double x)
{
    volatile float f = (float)x;
    return (double)f;
}

#endif
