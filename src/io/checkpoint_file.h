/* SPDX-License-Identifier: MIT
 *
 * A render that can go on later, as a file: the bytes of fl_render_checkpoint with what they belong
 * to. No state; any thread.
 */
#ifndef FL_IO_CHECKPOINT_FILE_H
#define FL_IO_CHECKPOINT_FILE_H

#include "core/firstlight.h"

/** Largest file that is read: the film of the largest picture with what else stands in it. */
#define FL_CHECKPOINT_MAX_BYTES ((size_t)40 << 30)

/** Digests of everything that decides the picture, as lines of text. Reads the scene and all files
 * that it names. False after adding an error. */
enum { FL_CHECKPOINT_KEY_BYTES = 512 };
bool fl_checkpoint_key(const fl_scene *scene, const fl_params *params,
                       char out[FL_CHECKPOINT_KEY_BYTES], fl_diags *diags);

/** Write atomically. False after adding an error; a file that stood there stays. */
bool fl_checkpoint_save(const char *path, const char *key, const void *data, size_t bytes,
                        fl_diags *diags);

/** Read a file made for the same key. True with *out_data NULL: there is none. *out_data points
 * into *out_file, from malloc, the caller's to free. False after adding an error that says what
 * differs.
 */
bool fl_checkpoint_load(const char *path, const char *key, char **out_file, const void **out_data,
                        size_t *out_bytes, fl_diags *diags);

#endif
