/* SPDX-License-Identifier: MIT
 *
 * Input logs: what can be read can be written, and reads the same again.
 */
#define _POSIX_C_SOURCE 200809L
#include <string.h>

#include "fuzz/fuzz.h"
#include "viewer/log.h"

static char *write_log(const vw_log *log, size_t *out_bytes)
{
    char *text = NULL;
    FILE *file = open_memstream(&text, out_bytes);
    MUST(file);
    vw_log_write_header(file, log->width, log->height, log->scene);
    for (size_t i = 0; i < log->entry_count; i++) {
        const vw_log_entry *entry = &log->entries[i];
        if (entry->kind == VW_LOG_EVENT)
            vw_log_write_event(file, entry->ms, &entry->event);
        else if (entry->kind == VW_LOG_SNAPSHOT)
            vw_log_write_snapshot(file, entry->ms, entry->file, entry->samples);
        else
            vw_log_write_quit(file, entry->ms);
    }
    fclose(file);
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fl_diags diags = {0};
    vw_log log, again;
    bool ok = vw_log_parse((const char *)data, bytes, "fuzz.log", &log, &diags);
    MUST(ok == (diags.error_count == 0));
    if (ok) {
        size_t text_bytes, second_bytes;
        char *text = write_log(&log, &text_bytes);
        MUST(vw_log_parse(text, text_bytes, "written", &again, &diags));
        MUST(again.entry_count == log.entry_count && again.width == log.width &&
             again.height == log.height);
        char *second = write_log(&again, &second_bytes);
        MUST(text_bytes == second_bytes && memcmp(text, second, text_bytes) == 0);
        free(second);
        free(text);
        vw_log_deinit(&again);
    }
    vw_log_deinit(&log);
    fl_diags_deinit(&diags);
    return 0;
}
