/* SPDX-License-Identifier: MIT
 *
 * Numbers in text, against the C library's own reading of the same characters; and back to text.
 */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/number.h"
#include "fuzz/fuzz.h"

enum { TEXT_MAX = 4096 };

static void check_text(double value)
{
    char text[32];
    double back;
    size_t length = fl_number_format(value, text);
    MUST(length < sizeof text);
    MUST(fl_number_parse(text, text + length, &back) == text + length);
    MUST(memcmp(&back, &value, sizeof back) == 0 || (isnan(back) && isnan(value)));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    const char *text = (const char *)data, *end = text + bytes;
    char copy[TEXT_MAX + 1];
    double value;
    int64_t integer;
    const char *rest = fl_number_parse(text, end, &value);
    MUST(!rest || (rest > text && rest <= end));
    if (rest && rest - text <= TEXT_MAX) {
        char *stop;
        memcpy(copy, text, (size_t)(rest - text));
        copy[rest - text] = '\0';
        double expected = strtod(copy, &stop);
        MUST(*stop == '\0');
        MUST(memcmp(&expected, &value, sizeof value) == 0 || (isnan(expected) && isnan(value)));
    }
    rest = fl_integer_parse(text, end, &integer);
    MUST(!rest || (rest > text && rest <= end));
    if (rest && rest - text <= TEXT_MAX) {
        char *stop;
        memcpy(copy, text, (size_t)(rest - text));
        copy[rest - text] = '\0';
        errno = 0;
        long long expected = strtoll(copy, &stop, 10);
        MUST(errno == 0 && *stop == '\0' && expected == integer);
    }
    if (bytes >= sizeof value) { /* the same bytes as a double */
        memcpy(&value, data, sizeof value);
        check_text(value);
    }
    return 0;
}
