/* SPDX-License-Identifier: MIT */
#include "viewer/log.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

void vw_log_write_header(FILE *file, uint32_t width, uint32_t height, const char *scene)
{
    fprintf(file, "firstlight-log 1 %ux%u %s\n", width, height, scene);
}

static void write_mods(FILE *file, int mods)
{
    static const struct {
        int mod;
        const char *name;
    } names[] = {{GLFW_MOD_SHIFT, "SHIFT"},
                 {GLFW_MOD_CONTROL, "CONTROL"},
                 {GLFW_MOD_ALT, "ALT"},
                 {GLFW_MOD_SUPER, "SUPER"}};
    for (size_t i = 0; i < FL_COUNT_OF(names); i++)
        if (mods & names[i].mod)
            fprintf(file, " %s", names[i].name);
}

static const char *action_name(int action)
{
    return action == GLFW_PRESS ? "press" : action == GLFW_RELEASE ? "release" : "repeat";
}

void vw_log_write_event(FILE *file, uint64_t ms, const vw_event *event)
{
    char x[32], y[32];
    unsigned long long at = (unsigned long long)ms;
    fl_number_format(event->x, x);
    fl_number_format(event->y, y);
    const char *name;
    switch (event->kind) {
    case VW_EVENT_KEY:
        name = vw_key_name(event->code);
        if (!name) /* A key GLFW has no name for: no command can be bound to it. */
            return;
        fprintf(file, "%llu key %s %s", at, name, action_name(event->action));
        write_mods(file, event->mods);
        break;
    case VW_EVENT_BUTTON:
        name = vw_button_name(event->code);
        if (!name)
            return;
        fprintf(file, "%llu button %s %s", at, name, action_name(event->action));
        write_mods(file, event->mods);
        break;
    case VW_EVENT_CURSOR:
        fprintf(file, "%llu cursor %s %s", at, x, y);
        break;
    case VW_EVENT_SCROLL:
        fprintf(file, "%llu scroll %s %s", at, x, y);
        write_mods(file, event->mods);
        break;
    case VW_EVENT_RESIZE:
        fprintf(file, "%llu resize %u %u", at, event->width, event->height);
        break;
    case VW_EVENT_DROP:
        fprintf(file, "%llu drop %s", at, event->path);
        break;
    case VW_EVENT_RELOAD:
        fprintf(file, "%llu reload", at);
        break;
    case VW_EVENT_PASTE:
        fprintf(file, "%llu paste %s", at, event->path);
        break;
    case VW_EVENT_FOCUS:
        fprintf(file, "%llu focus lost", at);
        break;
    case VW_EVENT_SCALE:
        fprintf(file, "%llu scale %s", at, x);
        break;
    case VW_EVENT_AXIS:
        fprintf(file, "%llu axis %s %s", at, vw_axis_name(event->code), x);
        break;
    case VW_EVENT_PAD:
        fprintf(file, "%llu pad %s %s", at, vw_pad_name(event->code), action_name(event->action));
        break;
    case VW_EVENT_ICONIFY:
        fprintf(file, "%llu %s", at, event->action == GLFW_PRESS ? "iconify" : "restore");
        break;
    case VW_EVENT_CLOSE: /* The end is written as `quit`. */
        return;
    }
    fputc('\n', file);
}

void vw_log_write_snapshot(FILE *file, uint64_t ms, const char *path, uint32_t samples)
{
    fprintf(file, "%llu snapshot %s %u\n", (unsigned long long)ms, path, samples);
}

void vw_log_write_quit(FILE *file, uint64_t ms)
{
    fprintf(file, "%llu quit\n", (unsigned long long)ms);
}
