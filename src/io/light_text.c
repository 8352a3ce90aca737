/* SPDX-License-Identifier: MIT */
#include "io/light_text.h"

#include <stdio.h>
#include <string.h>

enum { NUMBERS = 10, NUMBER_BYTES = 32 };

static void put_numbers(const fl_light *light, double out[NUMBERS])
{
    const fl_vec3 *vectors[] = {&light->position, &light->direction};
    for (int i = 0; i < 2; i++) {
        out[3 * i] = vectors[i]->x;
        out[3 * i + 1] = vectors[i]->y;
        out[3 * i + 2] = vectors[i]->z;
    }
    out[6] = light->radius;
    out[7] = light->color.x;
    out[8] = light->color.y;
    out[9] = light->color.z;
}

void fl_lights_text(const fl_light *lights, uint32_t count, char out[FL_LIGHT_TEXT_MAX])
{
    out[0] = 0;
    if (count > FL_LIGHT_TEXT_LIGHTS)
        return;
    size_t length = (size_t)snprintf(out, FL_LIGHT_TEXT_MAX, "%u", count);
    for (uint32_t i = 0; i < count; i++) {
        double v[NUMBERS];
        put_numbers(&lights[i], v);
        for (int k = 0; k < NUMBERS; k++) {
            char text[NUMBER_BYTES];
            fl_number_format(v[k], text);
            length += (size_t)snprintf(out + length, FL_LIGHT_TEXT_MAX - length, " %s", text);
            FL_ASSERT(length < FL_LIGHT_TEXT_MAX);
        }
    }
}

static const char *next_number(const char *at, const char *end, double *out)
{
    while (at < end && *at == ' ')
        at++;
    at = fl_number_parse(at, end, out);
    return at && isfinite(*out) && fabs(*out) < 1e30 ? at : NULL;
}

bool fl_lights_read(const char *text, fl_light *lights, uint32_t count)
{
    fl_light read[FL_LIGHT_TEXT_LIGHTS];
    const char *end = text + strlen(text);
    double found;
    const char *at = next_number(text, end, &found);
    if (!at || count > FL_LIGHT_TEXT_LIGHTS || found != (double)count)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        double v[NUMBERS];
        for (int k = 0; k < NUMBERS; k++)
            if (!(at = next_number(at, end, &v[k])))
                return false;
        read[i] = lights[i];
        read[i].position = fl_v3(v[0], v[1], v[2]);
        read[i].direction = fl_v3(v[3], v[4], v[5]);
        read[i].radius = v[6];
        read[i].color = fl_v3(v[7], v[8], v[9]);
        bool has_direction = read[i].kind != FL_LIGHT_POINT;
        if (v[6] < 0.0 || (has_direction && fabs(fl_v3_length(read[i].direction) - 1.0) > 1e-6))
            return false;
    }
    if (count)
        memcpy(lights, read, count * sizeof *lights);
    return true;
}

size_t fl_lights_scene_text(const fl_light *lights, uint32_t count, char *out, size_t out_bytes)
{
    static const char *const names[] = {[FL_LIGHT_DIRECTIONAL] = "DirectionalLight",
                                        [FL_LIGHT_POINT] = "PointLight",
                                        [FL_LIGHT_DISK] = "DiskLight"};
    size_t length = 0;
#define ADD(...)                                                                                   \
    length += (size_t)snprintf(length < out_bytes ? out + length : NULL,                           \
                               length < out_bytes ? out_bytes - length : 0, __VA_ARGS__)
    ADD("Lights {\n    numLights %u\n", count);
    for (uint32_t i = 0; i < count; i++) {
        const fl_light *light = &lights[i];
        double v[NUMBERS];
        char n[NUMBERS][NUMBER_BYTES], a[3][NUMBER_BYTES];
        put_numbers(light, v);
        for (int k = 0; k < NUMBERS; k++)
            fl_number_format(v[k], n[k]);
        for (int k = 0; k < 3; k++)
            fl_number_format(light->attenuation[k], a[k]);
        ADD("    %s {", names[light->kind]);
        if (light->kind != FL_LIGHT_DIRECTIONAL)
            ADD(" position %s %s %s", n[0], n[1], n[2]);
        if (light->kind != FL_LIGHT_POINT)
            ADD(" direction %s %s %s", n[3], n[4], n[5]);
        if (light->kind == FL_LIGHT_DISK)
            ADD(" radius %s twoSided %d", n[6], light->is_two_sided);
        if (light->kind == FL_LIGHT_DISK && light->samples)
            ADD(" samples %u", light->samples);
        ADD(" color %s %s %s", n[7], n[8], n[9]);
        if (light->kind != FL_LIGHT_DIRECTIONAL)
            ADD(" attenuation %s %s %s", a[0], a[1], a[2]);
        ADD(" }\n");
    }
    ADD("}\n");
#undef ADD
    return length;
}
