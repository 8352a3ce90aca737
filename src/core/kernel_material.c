/* SPDX-License-Identifier: MIT
 *
 * What rays see where they end: background, materials, textures, ambient light. Neighbours in a
 * stream that met the same shader are done together.
 */
#include "core/kernel_material.h"

#include "core/kernel_shade_vec.h"

/* All of a stream are found, and begun to be fetched, before the first is read: texels are far
 * apart in memory. */
enum { SPOTS = FL_STREAM_RAYS + FL_STREAM_SLACK };

/* Where texture coordinates fall: numbers of the texels of two rows and two columns (row, column),
 * and the weight of the second of each. As pair and blend in texture.c, operation for operation. */
typedef struct spots {
    uint32_t texel[2][2][SPOTS];
    double across[SPOTS], down[SPOTS];
} spots;

typedef uint32_t half_u __attribute__((vector_size(4 * FL_WD)));

/* A coordinate as a fraction of the picture in [0, 1]. */
FL_INLINE fl_wd fraction(const float *coordinate, float scale, bool clamps)
{
    fl_wd zero = fl_wd_set(0.0), x = fl_wd_load_floats(coordinate) * (double)scale;
    x = fl_wd_select((fl_wl)(fl_wd_abs(x) < (double)INFINITY), x, zero);
    return clamps ? fl_wd_min(fl_wd_max(x, zero), fl_wd_set(1.0)) : x - fl_wd_floor(x);
}

FL_INLINE half_u to_index(fl_wd x)
{
    return (half_u) __builtin_convertvector(x, fl_wide_half_i);
}

FL_INLINE void store_texel(uint32_t *p, half_u row, uint32_t width, half_u column)
{
    half_u texel = row * width + column;
    memcpy(p, &texel, sizeof texel);
}

/* Both neighbours of x, in texels, along an axis of `size` that ends or comes round. */
FL_INLINE fl_wd neighbours(fl_wd x, double size, bool clamps, half_u out[2])
{
    fl_wd zero = fl_wd_set(0.0), last = fl_wd_set(size - 1.0);
    if (clamps)
        x = fl_wd_min(fl_wd_max(x - 0.5, zero), last);
    else
        x = fl_wd_select((fl_wl)(x < 0.5), x + size - 0.5, x - 0.5);
    fl_wd low = fl_wd_floor(x), first = fl_wd_min(low, last), second = first + 1.0;
    fl_wl is_end = (fl_wl)(second > last);
    out[0] = to_index(first);
    out[1] = to_index(fl_wd_select(is_end, clamps ? last : zero, second));
    return x - low;
}

static void locate(const fl_texture *texture, const float *u, const float *v, uint32_t begin,
                   uint32_t end, spots *out)
{
    const fl_image *image = texture->image;
    double width = (double)image->width, height = (double)image->height;
    bool is_nearest = texture->filter == FL_FILTER_NEAREST, clamps = texture->clamps_v;
    for (uint32_t i = begin; i < end; i += FL_WD) {
        fl_wd x = fraction(u + i, texture->scale[0], false) * width;
        fl_wd y = (1.0 - fraction(v + i, texture->scale[1], clamps)) * height;
        if (is_nearest) {
            store_texel(out->texel[0][0] + i, to_index(fl_wd_min(y, fl_wd_set(height - 1.0))),
                        image->width, to_index(fl_wd_min(x, fl_wd_set(width - 1.0))));
            continue;
        }
        half_u column[2], row[2];
        fl_wd_store(out->across + i, neighbours(x, width, false, column));
        fl_wd_store(out->down + i, neighbours(y, height, clamps, row));
        for (int k = 0; k < 2; k++)
            for (int l = 0; l < 2; l++)
                store_texel(out->texel[k][l] + i, row[k], image->width, column[l]);
    }
    size_t bytes = image->format == FL_PIXEL_FLOAT ? 3 * sizeof(float) : 3;
    for (uint32_t i = begin; i < end; i++)
        for (int k = 0; k < (is_nearest ? 1 : 2); k++)
            __builtin_prefetch((const char *)image->pixels + bytes * out->texel[k][0][i]);
}

/* One channel of a texel, as it stands in the picture or in its table. */
FL_INLINE float texel_channel(const void *pixels, fl_pixel_format format, size_t at)
{
    if (format == FL_PIXEL_FLOAT)
        return ((const float *)pixels)[at];
    uint8_t byte = ((const uint8_t *)pixels)[at];
    return format == FL_PIXEL_SRGB8 ? fl_srgb8_to_linear[byte] : (float)byte;
}

/* Red green blue of one texel of each of the first `lanes` lanes; the others, whose spots are those
 * of another, perhaps larger picture, get the first one's. */
FL_INLINE void gather_texels(const void *pixels, fl_pixel_format format, const uint32_t *texel,
                             uint32_t lanes, fl_wd out[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        fl_wide_half_f c;
        for (uint32_t l = 0; l < FL_WD; l++)
            c[l] = texel_channel(pixels, format, 3 * (size_t)texel[l < lanes ? l : 0] + k);
        out[k] = FL_WIDE_WIDEN_F(c);
        if (format == FL_PIXEL_LINEAR8)
            out[k] = out[k] / 255.0;
    }
}

/* Spots i to i + FL_WD - 1, of which `lanes` count. */
FL_INLINE void read_block(const fl_texture *texture, fl_pixel_format format, const spots *s,
                          uint32_t i, uint32_t lanes, fl_array3 out)
{
    const void *pixels = texture->image->pixels;
    float *channel[3] = {out.x, out.y, out.z};
    fl_wd a[3], b[3], c[3], d[3];
    gather_texels(pixels, format, s->texel[0][0] + i, lanes, a);
    if (texture->filter != FL_FILTER_NEAREST) {
        gather_texels(pixels, format, s->texel[0][1] + i, lanes, b);
        gather_texels(pixels, format, s->texel[1][0] + i, lanes, c);
        gather_texels(pixels, format, s->texel[1][1] + i, lanes, d);
        fl_wd across = fl_wd_load(s->across + i), down = fl_wd_load(s->down + i);
        for (int k = 0; k < 3; k++) {
            fl_wd top = a[k] + across * (b[k] - a[k]);
            fl_wd bottom = c[k] + across * (d[k] - c[k]);
            a[k] = top + down * (bottom - top);
        }
    }
    for (int k = 0; k < 3; k++)
        fl_wd_store_floats(channel[k] + i, a[k]);
}

/* One copy for each format, which is then a constant. */
FL_INLINE void read_all(const fl_texture *texture, fl_pixel_format format, const spots *s,
                        uint32_t begin, uint32_t end, fl_array3 out)
{
    uint32_t i = begin;
    for (; i + FL_WD <= end; i += FL_WD)
        read_block(texture, format, s, i, FL_WD, out);
    if (i < end)
        read_block(texture, format, s, i, end - i, out);
}

static void read_texels(const fl_texture *texture, const spots *s, uint32_t begin, uint32_t end,
                        fl_array3 out)
{
    switch (texture->image->format) {
    case FL_PIXEL_FLOAT:
        read_all(texture, FL_PIXEL_FLOAT, s, begin, end, out);
        break;
    case FL_PIXEL_SRGB8:
        read_all(texture, FL_PIXEL_SRGB8, s, begin, end, out);
        break;
    case FL_PIXEL_LINEAR8:
        read_all(texture, FL_PIXEL_LINEAR8, s, begin, end, out);
        break;
    }
}

void FL_ISA_NAME(fl_shade_texture)(const fl_texture *texture, const float *u, const float *v,
                                   uint32_t count, fl_array3 out)
{
    spots s;
    FL_ASSERT(count <= FL_STREAM_RAYS);
    locate(texture, u, v, 0, count, &s);
    read_texels(texture, &s, 0, count, out);
}

/* Index of refraction with which rays go on, or 0. */
static float branch_index(const fl_shader *shader)
{
    const float *k = shader->reflect, *m = shader->refract;
    bool spawns = k[0] != 0.0f || k[1] != 0.0f || k[2] != 0.0f || m[0] != 0.0f || m[1] != 0.0f ||
                  m[2] != 0.0f;
    if (!spawns)
        return 0.0f;
    return shader->refraction_index > 0.0f ? shader->refraction_index : 1.0f;
}

/* Rays [begin, end) met `shader`; if it has a texture, that colour stands in stage->diffuse. Whole
 * vectors are written: what lies beyond the end belongs to a later run, or to nobody. */
static void fill_run(const fl_frame *frame, const fl_shader *shader, uint32_t number,
                     bool is_textured, uint32_t begin, uint32_t end, fl_stage *stage)
{
    const fl_frame_plan *plan = &frame->plan;
    const fl_vec3 ambient = frame->params.ambient;
    const float light[3] = {(float)ambient.x, (float)ambient.y, (float)ambient.z};
    const fl_rays *rays = &stage->rays;
    const wide3 zero = set3((const float[3]){0.0f, 0.0f, 0.0f}), factor = set3(light);
    fl_wf index = fl_wf_set(branch_index(shader));
    for (uint32_t i = begin; i < end; i += FL_W) {
        wide3 diffuse = set3(shader->diffuse), specular = set3(shader->specular);
        if (is_textured)
            diffuse = mul3(diffuse, load3(stage->diffuse, i));
        wide3 glow = mul3(shader->ambient_is_diffuse ? diffuse : set3(shader->ambient), factor);
        if (frame->params.exact.black_back_faces) {
            wide3 d = {fl_wf_load(rays->dx + i), fl_wf_load(rays->dy + i),
                       fl_wf_load(rays->dz + i)};
            fl_wm is_behind = dot3(load_geometric(stage, i), d) > 0.0f;
            diffuse = select3(is_behind, zero, diffuse);
            glow = select3(is_behind, zero, glow);
            specular = select3(is_behind, zero, specular);
        }
        store3(stage->diffuse, i, diffuse);
        store3(stage->radiance, i, glow);
        fl_wu_store(stage->shader + i, fl_wu_set(number));
        if (plan->has_specular) {
            store3(stage->specular, i, specular);
            fl_wf_store(stage->shininess + i, fl_wf_set(shader->shininess));
        }
        if (plan->has_reflection || plan->has_refraction)
            fl_wf_store(stage->index + i, index);
    }
}

/* The end of the run of rays from `begin` on that met one shader. */
FL_INLINE uint32_t run_end(const fl_compiled *scene, const fl_stage *stage, uint32_t begin)
{
    const uint32_t *object = stage->hits.object;
    uint32_t end = begin + 1, number = scene->object_shader[object[begin]];
    while (end < stage->rays.count &&
           (object[end] == object[end - 1] || scene->object_shader[object[end]] == number))
        end++;
    return end;
}

bool FL_ISA_NAME(fl_shade_material)(const fl_frame *frame, fl_stage *stage,
                                    uint64_t *texture_lookups)
{
    const fl_compiled *scene = frame->scene;
    const fl_frame_plan *plan = &frame->plan;
    const uint32_t *object = stage->hits.object, count = stage->rays.count;
    bool has_branches = false;
    spots s;
    for (uint32_t begin = 0, end; plan->has_textures && begin < count; begin = end) {
        uint32_t texture = scene->shaders[scene->object_shader[object[begin]]].texture;
        end = run_end(scene, stage, begin);
        if (texture == FL_NONE)
            continue;
        locate(&scene->textures[texture], stage->surface.u, stage->surface.v, begin, end, &s);
        *texture_lookups += end - begin;
    }
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        uint32_t number = scene->object_shader[object[begin]];
        const fl_shader *shader = &scene->shaders[number];
        bool is_textured = plan->has_textures && shader->texture != FL_NONE;
        end = run_end(scene, stage, begin);
        if (is_textured)
            read_texels(&scene->textures[shader->texture], &s, begin, end, stage->diffuse);
        fill_run(frame, shader, number, is_textured, begin, end, stage);
        has_branches |= branch_index(shader) != 0.0f;
    }
    return has_branches && (plan->has_reflection || plan->has_refraction);
}

/* Every array of the stage that later stages read, packed to the front. */
FL_INLINE void pack(fl_stage *stage, uint32_t to, uint32_t from, uint32_t order)
{
    fl_rays *r = &stage->rays;
    float *const floats[] = {r->ox, r->oy, r->oz, r->dx, r->dy, r->dz, stage->hits.t};
    uint32_t *const words[] = {stage->hits.object, stage->hits.prim, stage->pixel, stage->path};
    for (size_t k = 0; k < FL_COUNT_OF(floats); k++)
        fl_wf_store_packed(floats[k] + to, fl_wf_load(floats[k] + from), order);
    for (size_t k = 0; k < FL_COUNT_OF(words); k++)
        fl_wu_store_packed(words[k] + to, fl_wu_load(words[k] + from), order);
}

uint32_t FL_ISA_NAME(fl_shade_keep_hits)(fl_stage *stage)
{
    uint32_t kept = 0, count = stage->rays.count;
    for (uint32_t i = 0; i < count; i += FL_W) {
        fl_wm hit = (fl_wm)(fl_wu_load(stage->hits.object + i) != FL_NONE);
        hit &= fl_wm_first(count - i);
        uint32_t order = fl_wm_order(hit), here = fl_wm_count(hit);
        fl_wu_store_packed(stage->entry + kept, (fl_wu)fl_wi_iota() + i, order);
        if (here > 0 && (here < FL_W || kept != i))
            pack(stage, kept, i, order);
        kept += here;
    }
    return kept;
}
