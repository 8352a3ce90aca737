/* SPDX-License-Identifier: MIT */
#include "viewer/event.h"

#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

typedef struct code_name {
    const char *name;
    int code;
} code_name;

/* clang-format off */
#define KEY(name) {#name, GLFW_KEY_##name}

static const code_name key_names[] = {
    KEY(SPACE), KEY(APOSTROPHE), KEY(COMMA), KEY(MINUS), KEY(PERIOD), KEY(SLASH), KEY(0),
    KEY(1), KEY(2), KEY(3), KEY(4), KEY(5), KEY(6), KEY(7), KEY(8), KEY(9), KEY(SEMICOLON),
    KEY(EQUAL), KEY(A), KEY(B), KEY(C), KEY(D), KEY(E), KEY(F), KEY(G), KEY(H), KEY(I), KEY(J),
    KEY(K), KEY(L), KEY(M), KEY(N), KEY(O), KEY(P), KEY(Q), KEY(R), KEY(S), KEY(T), KEY(U),
    KEY(V), KEY(W), KEY(X), KEY(Y), KEY(Z), KEY(LEFT_BRACKET), KEY(BACKSLASH),
    KEY(RIGHT_BRACKET), KEY(GRAVE_ACCENT), KEY(WORLD_1), KEY(WORLD_2), KEY(ESCAPE), KEY(ENTER),
    KEY(TAB), KEY(BACKSPACE), KEY(INSERT), KEY(DELETE), KEY(RIGHT), KEY(LEFT), KEY(DOWN),
    KEY(UP), KEY(PAGE_UP), KEY(PAGE_DOWN), KEY(HOME), KEY(END), KEY(CAPS_LOCK),
    KEY(SCROLL_LOCK), KEY(NUM_LOCK), KEY(PRINT_SCREEN), KEY(PAUSE), KEY(F1), KEY(F2), KEY(F3),
    KEY(F4), KEY(F5), KEY(F6), KEY(F7), KEY(F8), KEY(F9), KEY(F10), KEY(F11), KEY(F12),
    KEY(F13), KEY(F14), KEY(F15), KEY(F16), KEY(F17), KEY(F18), KEY(F19), KEY(F20), KEY(F21),
    KEY(F22), KEY(F23), KEY(F24), KEY(F25), KEY(KP_0), KEY(KP_1), KEY(KP_2), KEY(KP_3),
    KEY(KP_4), KEY(KP_5), KEY(KP_6), KEY(KP_7), KEY(KP_8), KEY(KP_9), KEY(KP_DECIMAL),
    KEY(KP_DIVIDE), KEY(KP_MULTIPLY), KEY(KP_SUBTRACT), KEY(KP_ADD), KEY(KP_ENTER),
    KEY(KP_EQUAL), KEY(LEFT_SHIFT), KEY(LEFT_CONTROL), KEY(LEFT_ALT), KEY(LEFT_SUPER),
    KEY(RIGHT_SHIFT), KEY(RIGHT_CONTROL), KEY(RIGHT_ALT), KEY(RIGHT_SUPER), KEY(MENU),
};
/* clang-format on */

/* LEFT, RIGHT and MIDDLE are GLFW's own aliases of the first three. */
static const code_name button_names[] = {
    {"LEFT", GLFW_MOUSE_BUTTON_LEFT},     {"RIGHT", GLFW_MOUSE_BUTTON_RIGHT},
    {"MIDDLE", GLFW_MOUSE_BUTTON_MIDDLE}, {"4", GLFW_MOUSE_BUTTON_4},
    {"5", GLFW_MOUSE_BUTTON_5},           {"6", GLFW_MOUSE_BUTTON_6},
    {"7", GLFW_MOUSE_BUTTON_7},           {"8", GLFW_MOUSE_BUTTON_8},
    {"1", GLFW_MOUSE_BUTTON_1},           {"2", GLFW_MOUSE_BUTTON_2},
    {"3", GLFW_MOUSE_BUTTON_3},
};

static char upper(char c)
{
    return c >= 'a' && c <= 'z' ? (char)(c - 'a' + 'A') : c;
}

static bool is_equal(const char *text, size_t text_bytes, const char *name)
{
    if (strlen(name) != text_bytes)
        return false;
    for (size_t i = 0; i < text_bytes; i++)
        if (upper(text[i]) != name[i])
            return false;
    return true;
}

static const code_name axis_names[] = {
    {"LEFT_X", GLFW_GAMEPAD_AXIS_LEFT_X},
    {"LEFT_Y", GLFW_GAMEPAD_AXIS_LEFT_Y},
    {"RIGHT_X", GLFW_GAMEPAD_AXIS_RIGHT_X},
    {"RIGHT_Y", GLFW_GAMEPAD_AXIS_RIGHT_Y},
    {"LEFT_TRIGGER", GLFW_GAMEPAD_AXIS_LEFT_TRIGGER},
    {"RIGHT_TRIGGER", GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER},
};

static const code_name pad_names[] = {
    {"A", GLFW_GAMEPAD_BUTTON_A},
    {"B", GLFW_GAMEPAD_BUTTON_B},
    {"X", GLFW_GAMEPAD_BUTTON_X},
    {"Y", GLFW_GAMEPAD_BUTTON_Y},
    {"LEFT_BUMPER", GLFW_GAMEPAD_BUTTON_LEFT_BUMPER},
    {"RIGHT_BUMPER", GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER},
    {"BACK", GLFW_GAMEPAD_BUTTON_BACK},
    {"START", GLFW_GAMEPAD_BUTTON_START},
    {"GUIDE", GLFW_GAMEPAD_BUTTON_GUIDE},
    {"LEFT_THUMB", GLFW_GAMEPAD_BUTTON_LEFT_THUMB},
    {"RIGHT_THUMB", GLFW_GAMEPAD_BUTTON_RIGHT_THUMB},
    {"DPAD_UP", GLFW_GAMEPAD_BUTTON_DPAD_UP},
    {"DPAD_RIGHT", GLFW_GAMEPAD_BUTTON_DPAD_RIGHT},
    {"DPAD_DOWN", GLFW_GAMEPAD_BUTTON_DPAD_DOWN},
    {"DPAD_LEFT", GLFW_GAMEPAD_BUTTON_DPAD_LEFT},
};

static void skip_prefix(const char **text, size_t *text_bytes, const char *prefix)
{
    size_t prefix_bytes = strlen(prefix);
    if (*text_bytes > prefix_bytes && is_equal(*text, prefix_bytes, prefix)) {
        *text += prefix_bytes;
        *text_bytes -= prefix_bytes;
    }
}

static const char *find_name(const code_name *table, size_t count, int code)
{
    for (size_t i = 0; i < count; i++)
        if (table[i].code == code)
            return table[i].name;
    return NULL;
}

static int find_code(const code_name *table, size_t count, const char *name, size_t name_bytes,
                     const char *prefix)
{
    skip_prefix(&name, &name_bytes, "GLFW_");
    skip_prefix(&name, &name_bytes, prefix);
    for (size_t i = 0; i < count; i++)
        if (is_equal(name, name_bytes, table[i].name))
            return table[i].code;
    return -1;
}

static const char *nearest(const code_name *table, size_t count, const char *name,
                           size_t name_bytes, const char *prefix)
{
    const char *candidates[FL_COUNT_OF(key_names)];
    FL_ASSERT(count <= FL_COUNT_OF(candidates));
    skip_prefix(&name, &name_bytes, "GLFW_");
    skip_prefix(&name, &name_bytes, prefix);
    for (size_t i = 0; i < count; i++)
        candidates[i] = table[i].name;
    return fl_nearest_name(name, name_bytes, candidates, count);
}

const char *vw_key_name(int key)
{
    return find_name(key_names, FL_COUNT_OF(key_names), key);
}

const char *vw_button_name(int button)
{
    return find_name(button_names, FL_COUNT_OF(button_names), button);
}

int vw_key_find(const char *name, size_t name_bytes)
{
    return find_code(key_names, FL_COUNT_OF(key_names), name, name_bytes, "KEY_");
}

int vw_button_find(const char *name, size_t name_bytes)
{
    return find_code(button_names, FL_COUNT_OF(button_names), name, name_bytes, "MOUSE_BUTTON_");
}

const char *vw_axis_name(int axis)
{
    return find_name(axis_names, FL_COUNT_OF(axis_names), axis);
}

const char *vw_pad_name(int button)
{
    return find_name(pad_names, FL_COUNT_OF(pad_names), button);
}

int vw_axis_find(const char *name, size_t name_bytes)
{
    return find_code(axis_names, FL_COUNT_OF(axis_names), name, name_bytes, "GAMEPAD_AXIS_");
}

int vw_pad_find(const char *name, size_t name_bytes)
{
    return find_code(pad_names, FL_COUNT_OF(pad_names), name, name_bytes, "GAMEPAD_BUTTON_");
}

const char *vw_key_nearest(const char *name, size_t name_bytes)
{
    return nearest(key_names, FL_COUNT_OF(key_names), name, name_bytes, "KEY_");
}

const char *vw_button_nearest(const char *name, size_t name_bytes)
{
    return nearest(button_names, FL_COUNT_OF(button_names), name, name_bytes, "MOUSE_BUTTON_");
}

int vw_key_modifier(int key)
{
    switch (key) {
    case GLFW_KEY_LEFT_SHIFT:
    case GLFW_KEY_RIGHT_SHIFT:
        return GLFW_MOD_SHIFT;
    case GLFW_KEY_LEFT_CONTROL:
    case GLFW_KEY_RIGHT_CONTROL:
        return GLFW_MOD_CONTROL;
    case GLFW_KEY_LEFT_ALT:
    case GLFW_KEY_RIGHT_ALT:
        return GLFW_MOD_ALT;
    case GLFW_KEY_LEFT_SUPER:
    case GLFW_KEY_RIGHT_SUPER:
        return GLFW_MOD_SUPER;
    default:
        return 0;
    }
}

int vw_key_of_label(int key, const char *label)
{
    char letter = label && label[0] && !label[1] ? upper(label[0]) : 0;
    return letter >= 'A' && letter <= 'Z' ? GLFW_KEY_A + (letter - 'A') : key;
}

void vw_event_push(vw_event_queue *queue, const vw_event *event)
{
    if (queue->begin + queue->count == queue->capacity) {
        if (queue->begin > 0) {
            memmove(queue->items, queue->items + queue->begin, queue->count * sizeof(vw_event));
            queue->begin = 0;
        } else {
            size_t capacity = queue->capacity ? 2 * queue->capacity : 32;
            vw_event *items = realloc(queue->items, capacity * sizeof(vw_event));
            if (!items) {
                queue->dropped_count++;
                return;
            }
            queue->items = items;
            queue->capacity = capacity;
        }
    }
    queue->items[queue->begin + queue->count++] = *event;
}

bool vw_event_pop(vw_event_queue *queue, vw_event *out_event)
{
    if (queue->count == 0)
        return false;
    *out_event = queue->items[queue->begin++];
    if (--queue->count == 0)
        queue->begin = 0;
    return true;
}

void vw_event_queue_deinit(vw_event_queue *queue)
{
    free(queue->items);
    *queue = (vw_event_queue){0};
}
