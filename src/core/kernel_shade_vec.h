/* SPDX-License-Identifier: MIT
 *
 * Layer 6, private to the shading kernels: FL_W vectors of floats, and the arrays they come from.
 */
#ifndef FL_KERNEL_SHADE_VEC_H
#define FL_KERNEL_SHADE_VEC_H

#include "core/kernel_shade.h"
#include "core/wide.h"

typedef struct wide3 {
    fl_wf x, y, z;
} wide3;

FL_INLINE wide3 load3(fl_array3 a, uint32_t at)
{
    return (wide3){fl_wf_load(a.x + at), fl_wf_load(a.y + at), fl_wf_load(a.z + at)};
}

FL_INLINE void store3(fl_array3 a, uint32_t at, wide3 v)
{
    fl_wf_store(a.x + at, v.x);
    fl_wf_store(a.y + at, v.y);
    fl_wf_store(a.z + at, v.z);
}

FL_INLINE wide3 set3(const float v[3])
{
    return (wide3){fl_wf_set(v[0]), fl_wf_set(v[1]), fl_wf_set(v[2])};
}

FL_INLINE fl_wf dot3(wide3 a, wide3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* a + s b */
FL_INLINE wide3 mad3(wide3 a, wide3 b, fl_wf s)
{
    return (wide3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

FL_INLINE wide3 scale3(wide3 a, fl_wf s)
{
    return (wide3){a.x * s, a.y * s, a.z * s};
}

FL_INLINE wide3 mul3(wide3 a, wide3 b)
{
    return (wide3){a.x * b.x, a.y * b.y, a.z * b.z};
}

FL_INLINE wide3 select3(fl_wm m, wide3 a, wide3 b)
{
    return (wide3){fl_wf_select(m, a.x, b.x), fl_wf_select(m, a.y, b.y), fl_wf_select(m, a.z, b.z)};
}

FL_INLINE wide3 load_point(const fl_stage *stage, uint32_t at)
{
    const fl_surface *s = &stage->surface;
    return (wide3){fl_wf_load(s->px + at), fl_wf_load(s->py + at), fl_wf_load(s->pz + at)};
}

FL_INLINE wide3 load_geometric(const fl_stage *stage, uint32_t at)
{
    const fl_surface *s = &stage->surface;
    return (wide3){fl_wf_load(s->ngx + at), fl_wf_load(s->ngy + at), fl_wf_load(s->ngz + at)};
}

/* Where a ray towards `direction` leaves the surface: outside its error bound, on the side it goes
 * to. */
FL_INLINE wide3 leave(const fl_stage *stage, uint32_t at, wide3 point, wide3 geometric,
                      wide3 direction)
{
    fl_wf side = dot3(geometric, direction);
    return mad3(point, geometric, fl_wf_copysign(fl_wf_load(stage->surface.offset + at), side));
}

#endif
