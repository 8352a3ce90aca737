/* SPDX-License-Identifier: MIT */
#include "viewer/words.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "io/path.h"
#include "viewer/input.h"
#include "viewer/viewer.h"

typedef struct buffer {
    char *out;
    size_t bytes, length; /* length: as if there were room for all */
} buffer;

static void add(buffer *b, const char *format, ...) FL_PRINTF(2, 3);

static void add(buffer *b, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    bool has_room = b->length < b->bytes;
    int length = vsnprintf(has_room ? b->out + b->length : NULL,
                           has_room ? b->bytes - b->length : 0, format, args);
    va_end(args);
    b->length += length > 0 ? (size_t)length : 0;
}

/* What a key prints on a US keyboard, or its short name, where GLFW's own name reads badly. */
static const struct {
    int key;
    const char *label;
} labels[] = {
    {GLFW_KEY_LEFT_BRACKET, "["}, {GLFW_KEY_RIGHT_BRACKET, "]"}, {GLFW_KEY_COMMA, ","},
    {GLFW_KEY_PERIOD, "."},       {GLFW_KEY_MINUS, "-"},         {GLFW_KEY_EQUAL, "="},
    {GLFW_KEY_TAB, "Tab"},        {GLFW_KEY_ESCAPE, "Esc"},      {GLFW_KEY_PAGE_UP, "PgUp"},
    {GLFW_KEY_PAGE_DOWN, "PgDn"}, {GLFW_KEY_SPACE, "Space"},     {GLFW_KEY_ENTER, "Enter"},
    {GLFW_KEY_UP, "Up"},          {GLFW_KEY_DOWN, "Down"},       {GLFW_KEY_LEFT, "Left"},
    {GLFW_KEY_RIGHT, "Right"},
};

static void key_label(vw_platform *platform, const vw_binding *binding, char out[16])
{
    /* A letter with Ctrl is the one that is printed so already (vw_key_of_label). */
    int key = binding->code;
    bool is_letter = (binding->mods & GLFW_MOD_CONTROL) && key >= GLFW_KEY_A && key <= GLFW_KEY_Z;
    const char *printed = platform && !is_letter ? platform->ops->key_label(platform, key) : NULL;
    const char *label = printed && printed[0] > ' ' ? printed : NULL;
    for (size_t i = 0; i < FL_COUNT_OF(labels) && !label; i++)
        if (labels[i].key == key)
            label = labels[i].label;
    if (!label)
        label = vw_key_name(key);
    snprintf(out, 16, "%s", label ? label : "?");
    if (out[0] >= 'a' && out[0] <= 'z' && out[1] == 0)
        out[0] = (char)(out[0] - 'a' + 'A');
}

/* How many bindings from this one on are keys that count up in a row: 1 to 9, F2 to F10. */
static int run_length(const vw_binding *binding)
{
    int length = 1;
    while (binding[length].kind == binding->kind && binding->kind == VW_BIND_PRESS &&
           binding[length].mods == binding->mods && binding[length].code == binding->code + length)
        length++;
    return length;
}

static void add_mods(buffer *b, int mods)
{
    if (mods & GLFW_MOD_CONTROL)
        add(b, "Ctrl+");
    if (mods & GLFW_MOD_SHIFT)
        add(b, "Shift+");
    if (mods & GLFW_MOD_ALT)
        add(b, "Alt+");
}

static void button_label(int code, char out[16])
{
    static const char *const buttons[] = {"left", "right", "middle"};
    bool has_word = code < (int)FL_COUNT_OF(buttons);
    snprintf(out, 16, has_word ? "%s" : "button %s",
             has_word ? buttons[code] : vw_button_name(code));
}

void vw_words_keys(const vw_command *command, const vw_keymap *keymap, vw_platform *platform,
                   char out[VW_KEYS_MAX])
{
    buffer b = {out, VW_KEYS_MAX, 0};
    char label[16];
    int last_mods = 0;
    out[0] = 0;
    const vw_binding *bindings = vw_command_bindings(command, keymap);
    for (const vw_binding *binding = bindings; binding->kind != VW_BIND_NONE; binding++) {
        if (binding != bindings)
            add(&b, binding->mods != last_mods ? "  " : " ");
        if (binding->mods != last_mods || binding == bindings)
            add_mods(&b, binding->mods);
        last_mods = binding->mods;
        switch (binding->kind) {
        case VW_BIND_PRESS:
        case VW_BIND_WHILE:
        case VW_BIND_HOLD:
            key_label(platform, binding, label);
            add(&b, "%s", label);
            if (run_length(binding) > 2) {
                binding += run_length(binding) - 1;
                key_label(platform, binding, label);
                add(&b, "-%s", label);
            }
            break;
        case VW_BIND_DRAG:
        case VW_BIND_CLICK:
            button_label(binding->code, label);
            add(&b, "%s %s", label, binding->kind == VW_BIND_DRAG ? "drag" : "click");
            break;
        case VW_BIND_WHEEL:
            add(&b, "wheel");
            break;
        case VW_BIND_NONE:
            break;
        }
    }
}

static vw_status *item(vw_status *out, uint32_t *count, const char *label)
{
    vw_status *status = &out[(*count)++];
    *status = (vw_status){.is_alarm = false};
    snprintf(status->label, sizeof status->label, "%s", label);
    return status;
}

static uint64_t ray_count(const fl_counts *counts)
{
    return counts->camera_rays + counts->shadow_rays + counts->reflect_rays + counts->refract_rays;
}

/* The next rounder error than the present one: 1, 2 or 5 of a power of ten. */
static double next_goal(double rmse)
{
    double goal = 1.0;
    static const double steps[3] = {2.0, 2.5, 2.0};
    for (int i = 0; goal > 0.7 * rmse && i < 60; i++)
        goal /= steps[i % 3];
    return goal;
}

/* "0.41 % ± 0.08", and when it will be at the next round number. */
static void error_items(const fl_progress *progress, vw_status *out, uint32_t *count)
{
    const fl_error_estimate *error = &progress->error;
    vw_status *s = item(out, count, "error");
    if (!error->is_known) {
        snprintf(s->value, sizeof s->value, "n/a");
        return;
    }
    char value[24], when[24], between[64];
    vw_words_percent(error->rmse, value);
    snprintf(s->value, sizeof s->value, "%s \302\261 %.1g", value,
             50.0 * (error->high - error->low));
    fl_error_forecast forecast;
    double goal = next_goal(error->rmse), second = progress->seconds / progress->mean_samples;
    if (progress->state == FL_RENDER_DONE || !(progress->mean_samples > 0.0) ||
        !fl_error_predict(error, goal, &forecast))
        return;
    double done = progress->mean_samples;
    vw_words_duration(fl_max(forecast.samples - done, 0.0) * second, when);
    vw_words_between(fl_max(forecast.low - done, 0.0) * second,
                     fl_max(forecast.high - done, 0.0) * second, between);
    vw_words_percent(goal, value);
    s = item(out, count, value);
    snprintf(s->value, sizeof s->value, "in %s (%s)", when, between);
}

static void work_items(const vw_state *state, const fl_progress *progress, vw_status *out,
                       uint32_t *count)
{
    vw_status *s = item(out, count, "");
    const char *word = state->is_mixing                      ? "preview"
                       : state->is_paused                    ? "paused"
                       : progress->state == FL_RENDER_DONE   ? "done"
                       : progress->state == FL_RENDER_FAILED ? "out of memory"
                       : state->is_refining                  ? "refining the hierarchy"
                       : progress->complete_samples == 0     ? "first look"
                                                             : "rendering";
    snprintf(s->value, sizeof s->value, "%s", word);
    s->is_alarm = progress->state == FL_RENDER_FAILED;
    s = item(out, count, "samples");
    snprintf(s->value, sizeof s->value, "%u/%u", vw_words_samples(progress),
             state->look.sample_cap);
    s = item(out, count, "time");
    snprintf(s->value, sizeof s->value, progress->seconds < 100.0 ? "%.1f s" : "%.0f s",
             progress->seconds);
    error_items(progress, out, count);
    s = item(out, count, "");
    double rate = progress->seconds > 0.0
                      ? (double)ray_count(&progress->counts) / progress->seconds * 1e-6
                      : 0.0;
    snprintf(s->value, sizeof s->value, "%.1f Mray/s", rate);
    if (progress->counts.invalid_samples > 0) {
        s = item(out, count, "invalid");
        snprintf(s->value, sizeof s->value, "%llu",
                 (unsigned long long)progress->counts.invalid_samples);
        s->is_alarm = true;
    }
    if (progress->counts.stopped_shadow_rays > 0) {
        s = item(out, count, "shadow rays stopped");
        snprintf(s->value, sizeof s->value, "%llu",
                 (unsigned long long)progress->counts.stopped_shadow_rays);
        s->is_alarm = true;
    }
}

void vw_words_welcome(const vw_keymap *keymap, char *out, size_t out_bytes)
{
    static const struct {
        const char *command, *what;
    } first[] = {{"help", "help"}, {"look", "look"}, {"forward", "fly"}, {"focus-at", "focus"}};
    buffer b = {out, out_bytes, 0};
    out[0] = 0;
    for (size_t i = 0; i < FL_COUNT_OF(first); i++) {
        char keys[VW_KEYS_MAX];
        vw_words_keys(vw_command_named(first[i].command), keymap, NULL, keys);
        if (keys[0]) /* A user may have taken them all away. */
            add(&b, "%s%s: %s", b.length ? "    " : "", keys, first[i].what);
    }
}

uint32_t vw_words_status(const vw_state *state, const fl_progress *progress,
                         vw_status out[VW_STATUS_MAX])
{
    static const struct {
        const char *label, *command;
    } values[] = {
        {"aperture", "aperture"}, {"focus", "focus"}, {"fov", "fov"}, {"light", "light-samples"},
        {"depth", "depth"},       {"", "exposure"},   {"", "orbit"},
    };
    uint32_t count = 0;
    char value[VW_VALUE_MAX];
    work_items(state, progress, out, &count);
    for (size_t i = 0; i < FL_COUNT_OF(values); i++) {
        vw_status *s = item(out, &count, values[i].label);
        vw_command_named(values[i].command)->value(state, value);
        snprintf(s->value, sizeof s->value, "%.*s", (int)sizeof s->value - 1, value);
    }
    FL_ASSERT(count <= VW_STATUS_MAX);
    return count;
}

uint32_t vw_words_samples(const fl_progress *progress)
{
    return progress->is_adaptive ? (uint32_t)(progress->mean_samples + 0.5)
                                 : progress->complete_samples;
}

void vw_words_percent(double value, char out[24])
{
    snprintf(out, 24, 100.0 * value >= 10.0 ? "%.0f %%" : "%.2g %%", 100.0 * value);
}

void vw_words_duration(double seconds, char out[24])
{
    if (seconds < 9.95)
        snprintf(out, 24, "%.1f s", seconds);
    else if (seconds < 299.5)
        snprintf(out, 24, "%.0f s", seconds);
    else if (seconds < 99.5 * 60.0)
        snprintf(out, 24, "%.0f min", seconds / 60.0);
    else
        snprintf(out, 24, seconds < 3600.0 * 1e4 ? "%.3g h" : "never", seconds / 3600.0);
}

void vw_words_between(double low_seconds, double high_seconds, char out[64])
{
    char low[24], high[24];
    vw_words_duration(low_seconds, low);
    vw_words_duration(high_seconds, high);
    char *unit = strchr(low, ' '), *other = strchr(high, ' ');
    if (unit && other && strcmp(unit, other) == 0)
        *unit = 0;
    snprintf(out, 64, "%s\342\200\223%s", low, high);
}

double vw_words_done(const vw_state *state, const fl_progress *progress)
{
    if (progress->state == FL_RENDER_DONE)
        return 1.0;
    return fl_clamp(progress->mean_samples / (double)fl_max_u32(state->look.sample_cap, 1), 0.0,
                    1.0);
}

void vw_words_title(const vw_state *state, const fl_progress *progress, const char *scene_path,
                    char *out, size_t out_bytes)
{
    const char *name = fl_path_name(scene_path);
    if (progress->state == FL_RENDER_DONE)
        snprintf(out, out_bytes, "%s \342\200\224 firstlight", name);
    else if (state->is_paused)
        snprintf(out, out_bytes, "paused \342\200\224 %s \342\200\224 firstlight", name);
    else
        snprintf(out, out_bytes, "%.0f %% \342\200\224 %s \342\200\224 firstlight",
                 floor(100.0 * vw_words_done(state, progress)), name);
}

/* docs/strips/NAME.log, or else NAME.sh, makes docs/strips/NAME.jpg (tools/make-strips). */
static void add_strips(buffer *b)
{
    static const struct {
        const char *name, *caption;
    } strips[] = {
        {"focus",
         "Pulling focus: what is sharp to a pixel is green; last the rangefinder, where the "
         "two colours meet in what is sharp."},
        {"compare", "A picture is pinned (V) and the lens opened; wipe at the cursor and signed "
                    "difference (Shift+V)."},
        {"region", "A region: drawn while Z is down, rendered alone; a tap on Z brings the whole "
                   "picture back."},
        {"lights",
         "A light is picked (Y) and made brighter (Up): a mix of two pictures until the hand "
         "rests; warmer (Right); the other one off (U)."},
        {"views", "Behind the picture: depth (F3), normals (F4), cost (F8), blur (F9)."},
        {"branches",
         "And albedo (F5), error (F7), objects (F10), the ray that adds most (Shift+F8)."},
        {"mirror", "Focus on the vase, on what stands in one mirror, and farther, in two "
                   "(Ctrl+Shift+click)."},
        {"rays",
         "The pixel under the cursor (I), and all rays of one of its samples (Ctrl+click); the "
         "terminal gets every number."},
        {"noise", "Where the noise comes from (N), and what the scene needs and that costs (M)."},
        {"trade", "Error against time (T): the way so far, the forecast, and one step of each knob "
                  "as measured; l2 is two light samples."},
        {"stress",
         "The stress lens (J): against double, the scene a thousandth of its size, a million "
         "times, and through a pinhole. Violet changed in last bits only, orange visibly."},
        {"undo", "Flown aside, the lens opened; the lens taken back (Ctrl+Z), the flight too, and "
                 "that done again (Ctrl+Y)."},
        {"keys", "Other keys (`--keys`, [file](strips/keys.keys)): the help names them, and the "
                 "number pad flies."},
        {"gamepad", "A gamepad: the left stick flies, the right one turns, a bumper opens the "
                    "lens, A focuses at the middle."},
        {"live", "The scene is saved with another colour; with a mistake, which is shown over the "
                 "last good picture; and mended."},
    };
    add(b, "\n## In pictures\n\nEach strip is made by a log of input, which `firstlight replay` "
           "plays, the last one by a\nscript with a real window (tools/make-strips).\n");
    for (size_t i = 0; i < FL_COUNT_OF(strips); i++) {
        bool is_live = strcmp(strips[i].name, "live") == 0;
        add(b, "\n%s ([%s](strips/%s.%s))\n\n![%s](strips/%s.jpg)\n", strips[i].caption,
            is_live ? "script" : "log", strips[i].name, is_live ? "sh" : "log", strips[i].name,
            strips[i].name);
    }
}

size_t vw_controls_markdown(char *out, size_t out_bytes)
{
    buffer b = {out, out_bytes, 0};
    add(&b, "# Controls\n\nMade from the command table (src/viewer/command_table.c); keys are "
            "those of a US keyboard, and\n"
            "the help in the window (F1) names them as your keyboard prints them. Letters with "
            "Ctrl are "
            "those it prints.\n");
    for (int group = 0; group < VW_GROUP_COUNT; group++) {
        add(&b, "\n## %s\n\n| input | what it does |\n|---|---|\n", vw_group_titles[group]);
        for (size_t i = 0; i < vw_command_count; i++) {
            if (vw_commands[i].group != (vw_group)group)
                continue;
            char keys[VW_KEYS_MAX];
            vw_words_keys(&vw_commands[i], NULL, NULL, keys);
            add(&b, "| `%s` | %s |\n", keys, vw_commands[i].help);
        }
    }
    add(&b, "\n## Views\n\n| key | shows |\n|---|---|\n");
    static const char *const layers[VW_LAYER_COUNT] = {
        "the picture",
        "distance along the view, bright is near",
        "shading normals, x y z as red green blue",
        "diffuse colour with textures",
        "samples of each pixel",
        "estimated error, in squares of 16 pixels",
        "rays that one sample costs",
        "circle of confusion: white is sharp to a pixel, orange too near, blue too far",
        "a colour for each object",
        ("which kind of ray adds most: the surface's own yellow, a mirror's blue, glass's green, "
         "deeper is darker")};
    for (int layer = 0; layer < VW_LAYER_COUNT; layer++)
        add(&b, "| `%s%d` | %s: %s |\n", layer == VW_LAYER_BRANCH ? "Shift+F" : "F",
            layer == VW_LAYER_BRANCH ? 8 : layer + 2, vw_layer_names[layer], layers[layer]);
    add(&b,
        "\n## Files\n\nBookmarks are kept beside the scene as `SCENE.views`, which is scene text "
        "(`View 1 { ... }`); views\nof the scene itself stand in the slots that it leaves empty. "
        "The file\nmay be edited meanwhile: of it only the view that is stored is replaced. A "
        "snapshot (.png, .exr) dropped on the\nwindow, or named in place of a scene, opens "
        "exactly where it was taken. Scene, meshes and textures are\nread again when they are "
        "saved, or made that were missing. `--pin FILE` compares with a picture of another day or "
        "program, as V does\nwith "
        "the present one: Space flips, Shift+V wipes and subtracts, the error stands in the "
        "corner.\n");
    add(&b, "\n## Gamepad\n\n| input | command |\n|---|---|\n");
    for (const vw_pad_binding *p = vw_pad_bindings; p->command; p++)
        add(&b, "| `%s` | %s |\n", p->is_axis ? vw_axis_name(p->code) : vw_pad_name(p->code),
            p->command);
    add(&b, "\nA pressed left stick is fast, the right one slow; A focuses at the middle of the "
            "picture. The pad is asked 60 times a\nsecond, only while one is connected.\n");
    add(&b,
        "\n## Other keys\n\n`$XDG_CONFIG_HOME/firstlight/keys` (`~/.config/firstlight/keys`), or "
        "the file of `--keys`, binds commands to other\nchords, in the order of the tables above; "
        "the help in the window follows.\n\n```\nforward = KP_8 KP_2      # a comment\n"
        "focus-at = Alt+left\nexposure = Ctrl+B Ctrl+Shift+B\nprint = none\n```\n\n"
        "Keys are called as in GLFW (`LEFT_BRACKET`) or as a US keyboard prints them (`[`). A "
        "chord "
        "that two commands share,\nan unknown command or key is an error at its line. A recorded "
        "log holds keys, not commands: replay it with the same `--keys`.\n\nThe commands: ");
    for (size_t i = 0; i < vw_command_count; i++)
        add(&b, "%s`%s`", i ? ", " : "", vw_commands[i].name);
    add(&b, ".\n");
    add_strips(&b);
    return b.length;
}
