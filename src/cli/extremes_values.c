/* SPDX-License-Identifier: MIT
 *
 * From a family and one of its values to the text of a scene.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/extremes.h"

static const double bound_default = 1e-6;

double extreme_number(const char *text)
{
    double x = 0.0;
    fl_number_parse(text, text + strlen(text), &x);
    return x;
}

void extreme_value_read(const extreme_family *f, const char *text, extreme_value *out)
{
    *out =
        (extreme_value){.off_max = f->off_max, .bound = f->bound > 0.0 ? f->bound : bound_default};
    for (; *text == '!' || *text == '='; text++) {
        out->is_slow |= *text == '!';
        out->is_same |= *text == '=';
    }
    snprintf(out->text, sizeof out->text, "%s", text);
    char *limits = strchr(out->text, '#');
    if (limits) {
        *limits++ = 0;
        out->has_limits = true;
        out->off_max = (uint32_t)strtoul(limits, &limits, 10);
        out->bound = extreme_number(limits + strspn(limits, " "));
    }
    for (char *at = out->text; at && out->count < EXTREME_FIELDS_MAX;) {
        out->fields[out->count++] = at;
        at = strchr(at, '|');
        if (at)
            *at++ = 0;
    }
}

void extreme_text(const extreme_family *f, const extreme_value *v, char out[EXTREME_TEXT_MAX])
{
    size_t length = 0;
    for (const char *text = f->text; *text && length + 1 < EXTREME_TEXT_MAX; text++) {
        uint32_t field = (uint32_t)(text[1] - '0');
        if (*text != '@' || field >= v->count) {
            out[length++] = *text;
            continue;
        }
        int written = snprintf(out + length, EXTREME_TEXT_MAX - length, "%s", v->fields[field]);
        length += (size_t)written;
        text++;
    }
    out[length < EXTREME_TEXT_MAX ? length : EXTREME_TEXT_MAX - 1] = 0;
}
