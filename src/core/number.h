/* SPDX-License-Identifier: MIT
 *
 * Layer 1: numbers in text, independent of the locale and bounded by an end pointer.
 */
#ifndef FL_NUMBER_H
#define FL_NUMBER_H

#include "core/base.h"

/** Read the longest prefix of [text, end) that is a decimal number: sign, digits, point, exponent;
 *  `-.16`, `1.`, `1e-3` count, hexadecimal does not. "inf" and "nan" are read as C does, so that the
 *  caller can refuse them by name. Correctly rounded. Returns the first byte not read, or NULL when there
 *  is no number at `text`. Overflow gives +-inf, underflow a denormal or 0. */
const char *fl_number_parse(const char *text, const char *end, double *out_value);

/** The same for a decimal integer. NULL also when it does not fit into int64_t. */
const char *fl_integer_parse(const char *text, const char *end, int64_t *out_value);

/** Shortest decimal text that reads back as exactly `value`; returns its length. `out` holds 32 bytes. */
size_t fl_number_format(double value, char out[32]);

#endif
