/* SPDX-License-Identifier: MIT
 *
 * Small files in every format that other libraries read for us.
 */
#ifndef TEST_GOOD_FILES_H
#define TEST_GOOD_FILES_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Write them into a folder; false after saying why on stderr. */
bool good_pictures(const char *folder);
bool good_meshes(const char *folder);

#ifdef __cplusplus
}
#endif

#endif
