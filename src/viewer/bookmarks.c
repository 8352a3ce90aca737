/* SPDX-License-Identifier: MIT */
#include "viewer/bookmarks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/files.h"
#include "io/state_text.h"

enum { PATH_BYTES = 1200, FILE_BYTES = 16384 + VW_SLOT_COUNT * FL_LIGHT_TEXT_MAX };

static const char header[] = "firstlight 1\n"
                             "# Bookmarks: key 1 to 9 goes there, Ctrl with it writes this file.\n";

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

/* The comments that are ours. */
static void read_lights(vw_bookmarks *bookmarks, const char *text)
{
    static const char word[] = "# lights ";
    for (const char *at = text; (at = strstr(at, word)); at += sizeof word - 1) {
        const char *numbers = at + sizeof word - 1;
        char name[2] = {numbers[0], 0};
        uint32_t slot = slot_of(name);
        size_t bytes = strcspn(numbers, "\r\n");
        if ((at != text && at[-1] != '\n') || slot == VW_SLOT_COUNT || bytes < 3 ||
            bytes - 2 >= FL_LIGHT_TEXT_MAX)
            continue;
        memcpy(bookmarks->lights[slot], numbers + 2, bytes - 2);
        bookmarks->lights[slot][bytes - 2] = 0;
    }
}

static bool read_file(vw_bookmarks *bookmarks, const char *path, fl_diags *diags)
{
    size_t bytes;
    char *text = fl_file_load(path, "bookmarks", FL_SCENE_FILE_MAX_BYTES, (fl_loc){.file = path},
                              diags, &bytes);
    if (!text)
        return false;
    fl_scene *scene =
        fl_scene_parse(text, bytes, path, &(fl_parse_options){0}, &fl_files_on_disk, diags);
    if (scene)
        read_lights(bookmarks, text);
    free(text);
    if (!scene)
        return false;
    for (uint32_t i = 0; i < scene->view_count; i++) {
        uint32_t slot = slot_of(scene->views[i].name);
        if (slot < VW_SLOT_COUNT)
            put(bookmarks, slot, &scene->views[i].camera, false);
    }
    fl_scene_destroy(scene);
    return true;
}

bool vw_bookmarks_load(vw_bookmarks *bookmarks, const char *scene_path, const fl_scene *scene,
                       fl_diags *diags)
{
    char path[PATH_BYTES];
    *bookmarks = (vw_bookmarks){0};
    if (path_of(scene_path, path) && access(path, F_OK) == 0)
        bookmarks->is_broken = !read_file(bookmarks, path, diags);
    if (scene)
        take_scene_views(bookmarks, scene);
    return !bookmarks->is_broken;
}

static bool write_file(const vw_bookmarks *bookmarks, const char *scene_path, fl_diags *diags)
{
    char path[PATH_BYTES], text[FILE_BYTES];
    size_t length = sizeof header - 1;
    memcpy(text, header, length);
    for (uint32_t slot = 0; slot < VW_SLOT_COUNT; slot++) {
        char name[2] = {(char)('1' + slot), 0};
        if (bookmarks->is_set[slot])
            length += fl_camera_scene_text(&bookmarks->cameras[slot], name, text + length,
                                           sizeof text - length);
        if (bookmarks->is_set[slot] && bookmarks->lights[slot][0])
            length += (size_t)snprintf(text + length, sizeof text - length, "# lights %s %s\n",
                                       name, bookmarks->lights[slot]);
        FL_ASSERT(length < sizeof text);
    }
    if (!path_of(scene_path, path))
        return fl_environment_error(diags, "the scene's path is too long for bookmarks beside it");
    return fl_file_save(path, text, length, diags);
}

bool vw_bookmarks_store(vw_bookmarks *bookmarks, uint32_t slot, const fl_camera *camera,
                        const char *lights, const char *scene_path, fl_diags *diags)
{
    FL_ASSERT(slot >= 1 && slot <= VW_SLOT_COUNT);
    put(bookmarks, slot - 1, camera, false);
    snprintf(bookmarks->lights[slot - 1], FL_LIGHT_TEXT_MAX, "%s", lights);
    if (!scene_path)
        return true;
    if (bookmarks->is_broken)
        return fl_error(diags, (fl_loc){0},
                        "bookmark %u is kept for this session only: %s.views has errors", slot,
                        scene_path);
    return write_file(bookmarks, scene_path, diags);
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
