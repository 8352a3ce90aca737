/* SPDX-License-Identifier: MIT */
#include "cli/json_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of the character of UTF-8 that begins here; 0: none does (RFC 3629, table 3-7 of Unicode).
 * Reads no further than the 0 at the end. */
static size_t character_bytes(const unsigned char *at)
{
    unsigned char lead = at[0], lowest = 0x80, highest = 0xbf;
    if (lead < 0x80)
        return 1;
    if (lead < 0xc2 || lead > 0xf4)
        return 0;
    size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    lowest = lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : lowest;   /* no longer form than needed */
    highest = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : highest; /* no surrogates; up to 10FFFF */
    if (at[1] < lowest || at[1] > highest)
        return 0;
    for (size_t i = 2; i < bytes; i++)
        if ((at[i] & 0xc0) != 0x80)
            return 0;
    return bytes;
}

json_t *cli_json_text(const char *text)
{
    static const char replacement[] = "\xef\xbf\xbd";
    if (!text)
        return json_null();
    json_t *as_it_is = json_string(text);
    if (as_it_is)
        return as_it_is;
    char *clean = malloc(strlen(text) * (sizeof replacement - 1) + 1), *end = clean;
    if (!clean)
        return NULL;
    while (*text) {
        size_t bytes = character_bytes((const unsigned char *)text);
        memcpy(end, bytes ? text : replacement, bytes ? bytes : sizeof replacement - 1);
        end += bytes ? bytes : sizeof replacement - 1;
        text += bytes ? bytes : 1;
    }
    *end = 0;
    json_t *replaced = json_string(clean);
    free(clean);
    return replaced;
}

bool cli_json_print(json_t *line, unsigned digits)
{
    if (!line) {
        fputs("firstlight: error: out of memory for the line of JSON\n", stderr);
        return false;
    }
    json_dumpf(line, stdout, JSON_COMPACT | JSON_REAL_PRECISION(digits));
    putchar('\n');
    json_decref(line);
    return true;
}
