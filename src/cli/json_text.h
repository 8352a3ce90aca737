/* SPDX-License-Identifier: MIT
 *
 * JSON of whatever the world holds: names of files and texts are bytes, JSON is UTF-8.
 */
#ifndef CLI_JSON_TEXT_H
#define CLI_JSON_TEXT_H

#include <jansson.h>
#include <stdbool.h>

/** The text as a JSON string, U+FFFD in place of every byte that is not part of UTF-8; NULL gives
 * null. A new reference, for "o" of json_pack. */
json_t *cli_json_text(const char *text);

/** Print on one line of standard output and let go of `line`. False after saying so on standard
 * error: `line` is NULL, for want of memory. */
bool cli_json_print(json_t *line, unsigned digits);

#endif
