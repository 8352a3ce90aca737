/* SPDX-License-Identifier: MIT */
#include "viewer/bookmarks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/files.h"
#include "io/state_text.h"

enum { PATH_BYTES = 1200, SLOT_BYTES = FL_STATE_TEXT_MAX + FL_LIGHT_TEXT_MAX + 32 };

static const char header[] =
    "firstlight 1\n"
    "# Bookmarks: key 1 to 9 goes there, Ctrl with it writes that view here.\n";

static bool path_of(const char *scene_path, char out[PATH_BYTES])
{
    return (size_t)snprintf(out, PATH_BYTES, "%s.views", scene_path) < PATH_BYTES;
}

/* Slot from 0 that the name says; VW_SLOT_COUNT: none. */
static uint32_t slot_of(const char *name)
{
    bool is_digit = name[0] >= '1' && name[0] <= '0' + VW_SLOT_COUNT && name[1] == 0;
    return is_digit ? (uint32_t)(name[0] - '1') : VW_SLOT_COUNT;
}

static void put(vw_bookmarks *bookmarks, uint32_t slot, const fl_camera *camera, bool is_scene)
{
    bookmarks->cameras[slot] = *camera;
    bookmarks->is_set[slot] = !is_scene;
    bookmarks->is_scene[slot] = is_scene;
}

static char *load_text(const char *path, fl_diags *diags, size_t *out_bytes)
{
    return fl_file_load(path, "bookmarks", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = path}, diags,
                        out_bytes);
}

static bool is_empty(const vw_bookmarks *bookmarks, uint32_t slot)
{
    return !bookmarks->is_set[slot] && !bookmarks->is_scene[slot];
}

static void take_scene_views(vw_bookmarks *bookmarks, const fl_scene *scene)
{
    for (uint32_t i = 0; i < scene->view_count; i++) {
        uint32_t slot = slot_of(scene->views[i].name);
        if (slot < VW_SLOT_COUNT && is_empty(bookmarks, slot))
            put(bookmarks, slot, &scene->views[i].camera, true);
    }
    for (uint32_t i = 0, slot = 0; i < scene->view_count; i++) {
        if (slot_of(scene->views[i].name) < VW_SLOT_COUNT)
            continue;
        while (slot < VW_SLOT_COUNT && !is_empty(bookmarks, slot))
            slot++;
        if (slot < VW_SLOT_COUNT)
            put(bookmarks, slot, &scene->views[i].camera, true);
    }
}

void vw_bookmarks_take_scene(vw_bookmarks *bookmarks, const fl_scene *scene)
{
    memset(bookmarks->is_scene, 0, sizeof bookmarks->is_scene);
    if (scene)
        take_scene_views(bookmarks, scene);
}

/* --- Text ------------------------------------------------------------------------------------ */

typedef struct span {
    const char *begin, *end;
} span;

/* The block of the view of that name, in text without errors. */
static bool find_view(const char *text, const char *name, span *out)
{
    bool is_view = false, is_ours = false;
    int depth = 0;
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, strlen(text));
    for (fl_token token; (token = fl_lexer_next(&lexer)).kind != FL_TOKEN_END;) {
        bool is_end = token.kind == FL_TOKEN_CLOSE_BRACE;
        depth += token.kind == FL_TOKEN_OPEN_BRACE ? 1 : is_end ? -1 : 0;
        out->end = token.text + token.bytes;
        if (is_ours && depth == 0 && is_end)
            return true;
        if (depth > 0 || token.kind == FL_TOKEN_COMMENT)
            continue;
        is_ours = is_view && fl_token_is(&token, name);
        is_view = fl_token_is(&token, "View");
        if (is_view)
            out->begin = token.text;
    }
    return false;
}

/* The comment that holds a slot's lights, to the end of its line. */
static bool find_lights(const char *text, const char *name, span *out)
{
    char mark[16];
    int length = snprintf(mark, sizeof mark, "# lights %s ", name);
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, strlen(text));
    for (fl_token token; (token = fl_lexer_next(&lexer)).kind != FL_TOKEN_END;) {
        if (token.kind != FL_TOKEN_COMMENT || strncmp(token.text, mark, (size_t)length) != 0)
            continue;
        *out = (span){token.text, token.text + strcspn(token.text, "\n")};
        return true;
    }
    return false;
}

/* Take what the file's text holds, but for slots that were stored since. */
static bool read_text(vw_bookmarks *bookmarks, const char *text, size_t bytes, const char *path,
                      fl_diags *diags)
{
    fl_scene *scene = fl_scene_parse(text, bytes, path, &(fl_parse_options){0}, NULL,
                                     diags); /* cameras are no reason to open files */
    for (uint32_t slot = 0; scene && slot < VW_SLOT_COUNT; slot++) {
        const char name[2] = {(char)('1' + slot), 0};
        char *lights = bookmarks->lights[slot];
        span line;
        if (bookmarks->is_unsaved[slot])
            continue;
        bookmarks->is_set[slot] = false;
        lights[0] = 0;
        if (find_lights(text, name, &line))
            snprintf(lights, FL_LIGHT_TEXT_MAX, "%.*s",
                     (int)strcspn(line.begin + sizeof "# lights N", "\r\n"),
                     line.begin + sizeof "# lights N");
    }
    for (uint32_t i = 0; scene && i < scene->view_count; i++) {
        uint32_t slot = slot_of(scene->views[i].name);
        if (slot < VW_SLOT_COUNT && !bookmarks->is_unsaved[slot])
            put(bookmarks, slot, &scene->views[i].camera, false);
    }
    fl_scene_destroy(scene);
    return scene != NULL;
}

bool vw_bookmarks_load(vw_bookmarks *bookmarks, const char *scene_path, const fl_scene *scene,
                       fl_diags *diags)
{
    char path[PATH_BYTES];
    size_t bytes;
    *bookmarks = (vw_bookmarks){0};
    bool is_fine = true;
    if (path_of(scene_path, path) && access(path, F_OK) == 0) {
        char *text = load_text(path, diags, &bytes);
        is_fine = text && read_text(bookmarks, text, bytes, path, diags);
        free(text);
    }
    vw_bookmarks_take_scene(bookmarks, scene);
    return is_fine;
}

/* The text with a slot's camera and lights where they stood, or at its end; the rest as it was.
 * From malloc; `text` is freed. NULL: there is no memory, or no text. */
static char *with_slot(const vw_bookmarks *bookmarks, uint32_t slot, char *text)
{
    const char name[2] = {(char)('1' + slot), 0}, *lights = bookmarks->lights[slot];
    span old = {NULL, NULL};
    while (text && find_lights(text, name, &old)) {
        bool is_line = old.begin == text || old.begin[-1] == '\n';
        const char *rest = old.end + (is_line && *old.end == '\n');
        memmove(text + (old.begin - text), rest, strlen(rest) + 1);
    }
    size_t most = text ? strlen(text) + SLOT_BYTES : 0;
    char *out = most ? malloc(most) : NULL;
    if (out) {
        if (!find_view(text, name, &old))
            old.begin = old.end = text + strlen(text);
        size_t length = (size_t)(old.begin - text);
        memcpy(out, text, length);
        if (old.begin == old.end && length > 0 && out[length - 1] != '\n')
            out[length++] = '\n';
        length +=
            fl_camera_scene_text(&bookmarks->cameras[slot], name, out + length, most - length);
        if (lights[0])
            length +=
                (size_t)snprintf(out + length, most - length, "# lights %s %s\n", name, lights);
        FL_ASSERT(length + strlen(old.end) < most);
        snprintf(out + length, most - length, "%s", old.end + (*old.end == '\n'));
    }
    free(text);
    return out;
}

/* Put the slots that are not in the file there: into its text as it is now. Others may have
 * written it, and what is in it besides is theirs. */
static bool write_slots(vw_bookmarks *bookmarks, const char *path, uint32_t slot, fl_diags *diags)
{
    size_t bytes = sizeof header - 1;
    bool is_there = access(path, F_OK) == 0;
    fl_diags unsaid = {0};
    char *text = is_there ? load_text(path, &unsaid, &bytes) : calloc(1, sizeof header);
    if (text && !is_there)
        memcpy(text, header, sizeof header);
    bool is_fine = text && read_text(bookmarks, text, bytes, path, &unsaid);
    fl_diags_deinit(&unsaid);
    if (!is_fine) {
        free(text);
        return fl_error(diags, (fl_loc){0},
                        "bookmark %u is kept for this session only: %s has errors", slot, path);
    }
    for (uint32_t i = 0; i < VW_SLOT_COUNT; i++)
        if (bookmarks->is_unsaved[i])
            text = with_slot(bookmarks, i, text);
    is_fine = text ? fl_file_save(path, text, strlen(text), diags)
                   : fl_out_of_memory(diags, "the bookmarks");
    if (is_fine)
        memset(bookmarks->is_unsaved, 0, sizeof bookmarks->is_unsaved);
    free(text);
    return is_fine;
}

bool vw_bookmarks_store(vw_bookmarks *bookmarks, uint32_t slot, const fl_camera *camera,
                        const char *lights, const char *scene_path, fl_diags *diags)
{
    char path[PATH_BYTES];
    FL_ASSERT(slot >= 1 && slot <= VW_SLOT_COUNT);
    put(bookmarks, slot - 1, camera, false);
    snprintf(bookmarks->lights[slot - 1], FL_LIGHT_TEXT_MAX, "%s", lights);
    bookmarks->is_unsaved[slot - 1] = true;
    if (!scene_path)
        return true;
    if (!path_of(scene_path, path))
        return fl_environment_error(diags, "the scene's path is too long for bookmarks beside it");
    return write_slots(bookmarks, path, slot, diags);
}

const fl_camera *vw_bookmarks_find(const vw_bookmarks *bookmarks, uint32_t slot)
{
    bool is_there = slot >= 1 && slot <= VW_SLOT_COUNT && !is_empty(bookmarks, slot - 1);
    return is_there ? &bookmarks->cameras[slot - 1] : NULL;
}

const char *vw_bookmarks_lights(const vw_bookmarks *bookmarks, uint32_t slot)
{
    return slot >= 1 && slot <= VW_SLOT_COUNT ? bookmarks->lights[slot - 1] : "";
}
