/* SPDX-License-Identifier: MIT
 *
 * Reflected and refracted rays of a stream, FL_W hits at a time.
 */
#include "core/kernel_spawn.h"

#include "core/kernel_shade_vec.h"
#include "core/wide_sampler.h"

/* FL_W rays to append. */
typedef struct offshoot {
    fl_wm lanes;
    wide3 origin, direction, throughput;
    fl_wu path;
} offshoot;

/* Red green blue number `at` of each lane's shader, which nearly always is the same. */
FL_INLINE void weights_of(const fl_compiled *scene, const fl_stage *stage, uint32_t at,
                          wide3 *out_reflect, wide3 *out_refract)
{
    const uint32_t *number = stage->shader + at;
    uint32_t lanes = fl_min_u32(stage->rays.count - at, FL_W);
    float k[3][FL_W], m[3][FL_W];
    bool is_same = true;
    for (uint32_t l = 1; l < lanes; l++)
        is_same &= number[l] == number[0];
    if (is_same) {
        *out_reflect = set3(scene->shaders[number[0]].reflect);
        *out_refract = set3(scene->shaders[number[0]].refract);
        return;
    }
    for (uint32_t l = 0; l < FL_W; l++) {
        const fl_shader *shader = &scene->shaders[number[l < lanes ? l : 0]];
        for (int c = 0; c < 3; c++) {
            k[c][l] = shader->reflect[c];
            m[c][l] = shader->refract[c];
        }
    }
    *out_reflect = (wide3){fl_wf_load(k[0]), fl_wf_load(k[1]), fl_wf_load(k[2])};
    *out_refract = (wide3){fl_wf_load(m[0]), fl_wf_load(m[1]), fl_wf_load(m[2])};
}

/* What was there before misses were taken out of the stream. */
FL_INLINE wide3 gather3(fl_array3 a, fl_wi at)
{
    return (wide3){fl_wf_gather(a.x, at), fl_wf_gather(a.y, at), fl_wf_gather(a.z, at)};
}

/* Lanes that weigh enough to go on. */
FL_INLINE fl_wm heavy_lanes(const fl_frame *frame, wide3 c)
{
    float threshold = (float)frame->params.weight_threshold;
    fl_wm heavy = (c.x != 0.0f) | (c.y != 0.0f) | (c.z != 0.0f);
    if (threshold > 0.0f)
        heavy &= ~(fl_wf_max(fl_wf_max(c.x, c.y), c.z) < threshold);
    return heavy;
}

/* What both rays of a hit take along. */
typedef struct origin {
    fl_wu object, prim, slot, pixel;
} origin;

FL_INLINE void append(const origin *from, const offshoot *o, uint32_t branch, fl_branches *out)
{
    uint32_t n = out->count, order = fl_wm_order(o->lanes);
    const wide3 part[3] = {o->origin, o->direction, o->throughput};
    for (int k = 0; k < 3; k++) {
        fl_wf_store_packed(out->number[3 * k] + n, part[k].x, order);
        fl_wf_store_packed(out->number[3 * k + 1] + n, part[k].y, order);
        fl_wf_store_packed(out->number[3 * k + 2] + n, part[k].z, order);
    }
    fl_wu_store_packed(out->word[FL_BRANCH_OBJECT] + n, from->object, order);
    fl_wu_store_packed(out->word[FL_BRANCH_PRIM] + n, from->prim, order);
    fl_wu_store_packed(out->word[FL_BRANCH_PATH] + n, o->path, order);
    fl_wu_store_packed(out->word[FL_BRANCH_SLOT] + n, from->slot, order);
    fl_wu_store_packed(out->word[FL_BRANCH_PIXEL] + n, from->pixel, order);
    fl_wu_store(out->word[FL_BRANCH_REFRACTED] + n, fl_wu_set(branch));
    out->count = n + fl_wm_count(o->lanes);
}

/* Two kinds of rays, those of one hit next to each other and in order of path: as they will be
 * wanted, so that there is little left to sort. */
FL_INLINE void append_both(const origin *from, const offshoot kinds[2], fl_branches *out)
{
    float number[2][FL_BRANCH_NUMBERS][FL_W];
    uint32_t word[2][FL_BRANCH_WORDS][FL_W], bits[2];
    for (uint32_t b = 0; b < 2; b++) {
        const offshoot *o = &kinds[b];
        const wide3 part[3] = {o->origin, o->direction, o->throughput};
        for (int k = 0; k < 3; k++) {
            fl_wf_store(number[b][3 * k], part[k].x);
            fl_wf_store(number[b][3 * k + 1], part[k].y);
            fl_wf_store(number[b][3 * k + 2], part[k].z);
        }
        fl_wu_store(word[b][FL_BRANCH_OBJECT], from->object);
        fl_wu_store(word[b][FL_BRANCH_PRIM], from->prim);
        fl_wu_store(word[b][FL_BRANCH_PATH], o->path);
        fl_wu_store(word[b][FL_BRANCH_SLOT], from->slot);
        fl_wu_store(word[b][FL_BRANCH_PIXEL], from->pixel);
        fl_wu_store(word[b][FL_BRANCH_REFRACTED], fl_wu_set(b));
        bits[b] = fl_wm_bits(o->lanes);
    }
    for (uint32_t left = bits[0] | bits[1]; left; left &= left - 1) {
        uint32_t l = (uint32_t)__builtin_ctz(left);
        uint32_t first = word[1][FL_BRANCH_PATH][l] < word[0][FL_BRANCH_PATH][l];
        for (uint32_t turn = 0; turn < 2; turn++) {
            uint32_t b = turn ^ first, n = out->count;
            if (!(bits[b] >> l & 1u))
                continue;
            for (int k = 0; k < FL_BRANCH_NUMBERS; k++)
                out->number[k][n] = number[b][k][l];
            for (int k = 0; k < FL_BRANCH_WORDS; k++)
                out->word[k][n] = word[b][k][l];
            out->count++;
        }
    }
}

/* The ray into the other medium; returns the lanes that it does not enter. */
FL_INLINE fl_wm refract(const fl_stage *stage, uint32_t at, wide3 point, wide3 geometric,
                        wide3 normal, wide3 view, fl_wf n_v, offshoot *out)
{
    fl_wf index = fl_wf_load(stage->index + at), zero = fl_wf_set(0.0f);
    /* The part along the surface scales by the ratio of the indices; what is left of 1 goes across.
     */
    fl_wm enters = dot3(geometric, view) >= 0.0f;
    fl_wf ratio = fl_wf_select(enters, 1.0f / index, index);
    wide3 along = scale3(mad3(scale3(normal, n_v), view, fl_wf_set(-1.0f)), ratio);
    fl_wf across = 1.0f - dot3(along, along);
    out->direction = mad3(along, normal, -fl_wf_sqrt(fl_wf_max(across, zero)));
    out->origin = leave(stage, at, point, geometric, out->direction);
    return ~(across > 0.0f);
}

void FL_ISA_NAME(fl_shade_spawn)(const fl_frame *frame, const fl_stage *stage, fl_array3 throughput,
                                 const uint32_t *slot, fl_branches *out)
{
    fl_wf one = fl_wf_set(1.0f);
    for (uint32_t i = 0; i < stage->rays.count; i += FL_W) {
        fl_wm live = fl_wm_first(stage->rays.count - i);
        live &= fl_wf_load(stage->index + i) != 0.0f;
        if (!fl_wm_any(live))
            continue;
        wide3 point = load_point(stage, i), geometric = load_geometric(stage, i);
        wide3 normal = load3(stage->normal, i), view = load3(stage->view, i), k, m;
        fl_wf n_v = fl_wf_max(fl_wf_min(dot3(normal, view), one), -one);
        weights_of(frame->scene, stage, i, &k, &m);
        fl_wi entry = (fl_wi)fl_wu_load(stage->entry + i) & fl_wm_first(stage->rays.count - i);
        wide3 before = gather3(throughput, entry);
        origin from = {fl_wu_load(stage->hits.object + i), fl_wu_load(stage->hits.prim + i),
                       fl_wu_gather(slot, entry), fl_wu_load(stage->pixel + i)};
        fl_wu path = fl_wu_load(stage->path + i);
        offshoot kinds[2] = {{.lanes = fl_wi_set(0)}, {.lanes = fl_wi_set(0)}};
        offshoot *mirrored = &kinds[0], *bent = &kinds[1];
        mirrored->direction = mad3(scale3(normal, 2.0f * n_v), view, -one);
        mirrored->origin = leave(stage, i, point, geometric, mirrored->direction);
        mirrored->path = fl_wu_path_child(frame->params.seed, path, 0);
        if (frame->plan.has_refraction) {
            /* Under total reflection the mirrored ray has both weights. */
            fl_wm is_total = refract(stage, i, point, geometric, normal, view, n_v, bent);
            wide3 both = {k.x + m.x, k.y + m.y, k.z + m.z};
            k = select3(is_total, both, k);
            bent->throughput = mul3(before, m);
            bent->lanes = live & ~is_total & heavy_lanes(frame, bent->throughput);
        }
        mirrored->throughput = mul3(before, k);
        mirrored->lanes = live & heavy_lanes(frame, mirrored->throughput);
        if (!fl_wm_any(bent->lanes)) {
            append(&from, mirrored, 0, out);
            continue;
        }
        bent->path = fl_wu_path_child(frame->params.seed, path, 1);
        append_both(&from, kinds, out);
    }
}
