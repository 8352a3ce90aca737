/* SPDX-License-Identifier: MIT */
#include "core/kernel_resolve.h"

#include "core/kernel_resolve_mesh.h"

/* A sphere knows its own rays by name, so only the rounding of the point itself remains. */
#define SPHERE_ROUNDINGS 4.0

/* Unit normals nearer than this to the y axis count as along it when a plane's texture is laid out.
 */
#define ALONG_AXIS 1e-6

/* from[entry] of each lane: mostly one for all. */
FL_INLINE fl_wd gather(const double *from, const block *b)
{
    fl_wd v = fl_wd_set(from[b->entry[0]]);
    for (int l = 1; l < FL_WD && !b->has_one_entry; l++)
        v[l] = from[b->entry[l]];
    return v;
}

FL_INLINE vec gather_vec(const fl_vec3 *from, const block *b)
{
    const fl_vec3 *first = &from[b->entry[0]];
    vec v = {fl_wd_set(first->x), fl_wd_set(first->y), fl_wd_set(first->z)};
    for (int l = 1; l < FL_WD && !b->has_one_entry; l++) {
        v.x[l] = from[b->entry[l]].x;
        v.y[l] = from[b->entry[l]].y;
        v.z[l] = from[b->entry[l]].z;
    }
    return v;
}

/* The quotient t, or what the float test said where there is none. */
FL_INLINE fl_wd or_tested(fl_wd t, const block *b)
{
    return fl_wd_select((fl_wl)(fl_wd_abs(t) < (double)INFINITY), t, b->t);
}

/* --- Shapes ---------------------------------------------------------------------------------- */

FL_INLINE void solve_spheres(const run *r, const block *b, solution *s)
{
    const fl_spheres *spheres = &r->geometry->spheres;
    vec c = gather_vec(spheres->center, b), f = vec_sub(b->o, c);
    fl_wd radius = gather(spheres->radius, b), zero = fl_wd_set(0.0);
    fl_wd a = vec_dot(b->d, b->d), half = -vec_dot(f, b->d);
    vec l = vec_mad(f, b->d, half / a);
    fl_wd rest = fl_wd_max(radius * radius - vec_dot(l, l), zero);
    fl_wd q = half + fl_wd_copysign(fl_wd_sqrt(a * rest), half);
    fl_wd t1 = q / a;
    fl_wd t0 = fl_wd_select((fl_wl)(q != zero), (vec_dot(f, f) - radius * radius) / q, t1);
    fl_wl is_first = (fl_wl)(fl_wd_abs(t0 - b->t) < fl_wd_abs(t1 - b->t));
    vec n = vec_unit(vec_mad(f, b->d, fl_wd_select(is_first, t0, t1)));
    s->p = vec_mad(c, n, radius);
    s->ng = s->ns = n;
    s->roundings = SPHERE_ROUNDINGS;
    if (r->needs_uv) {
        const double half_turn = 3.14159265358979323846;
        fl_wd phi = fl_wd_atan2(n.y, n.x);
        fl_wd theta = fl_wd_atan2(fl_wd_sqrt(n.x * n.x + n.y * n.y), n.z);
        s->u = phi / (2.0 * half_turn);
        s->u = fl_wd_select((fl_wl)(s->u < zero), s->u + 1.0, s->u);
        s->v = 1.0 - theta / half_turn;
    }
}

FL_INLINE void plane_uv(const run *r, vec n, solution *s)
{
    const fl_vec3 *origin = &r->geometry->origin;
    vec at = r->instance ? s->p : (vec){s->p.x + origin->x, s->p.y + origin->y, s->p.z + origin->z};
    fl_wd zero = fl_wd_set(0.0), one = fl_wd_set(1.0);
    vec x = vec_cross((vec){zero, one, zero}, n);
    fl_wl is_along = (fl_wl)(vec_max_abs(x) < ALONG_AXIS);
    x = vec_unit(x);
    s->u = fl_wd_select(is_along, at.x, vec_dot(at, x));
    s->v = fl_wd_select(is_along, -at.z, vec_dot(at, vec_cross(n, x)));
}

FL_INLINE void solve_planes(const run *r, const block *b, solution *s)
{
    const fl_planes *planes = &r->geometry->planes;
    vec n = gather_vec(planes->normal, b);
    fl_wd offset = gather(planes->offset, b);
    fl_wd t = (offset - vec_dot(n, b->o)) / vec_dot(n, b->d);
    vec p = vec_mad(b->o, b->d, or_tested(t, b));
    s->p = vec_mad(p, n, offset - vec_dot(n, p));
    s->ng = s->ns = n;
    if (r->needs_uv)
        plane_uv(r, n, s);
}

FL_INLINE void solve_patches(const run *r, const block *b, solution *s)
{
    const fl_patches *patches = &r->geometry->patches;
    vec n = gather_vec(patches->normal, b), c = gather_vec(patches->corner, b);
    vec f = vec_sub(b->o, c);
    fl_wd t = -vec_dot(n, f) / vec_dot(n, b->d);
    f = vec_mad(f, b->d, or_tested(t, b));
    f = vec_mad(f, n, -vec_dot(n, f));
    s->p = vec_add(c, f);
    s->ng = s->ns = n;
    s->size = vec_max_abs(c) + vec_max_abs(f);
    if (r->needs_uv) {
        fl_wd zero = fl_wd_set(0.0), one = fl_wd_set(1.0);
        fl_wl is_disk;
        for (int l = 0; l < FL_WD; l++)
            is_disk[l] = -(int64_t)patches->is_disk[b->entry[l]];
        s->u = vec_dot(f, gather_vec(patches->dual_u, b));
        s->v = vec_dot(f, gather_vec(patches->dual_v, b));
        s->u = fl_wd_select(is_disk, 0.5 * (s->u + 1.0), s->u);
        s->v = fl_wd_select(is_disk, 0.5 * (s->v + 1.0), s->v);
        s->u = fl_wd_min(fl_wd_max(s->u, zero), one);
        s->v = fl_wd_min(fl_wd_max(s->v, zero), one);
    }
}

/* --- Surfaces of revolution, one by one ------------------------------------------------------- */

/* The very ray that the kernel gave to the solver, so that it has the same root. */
static void solver_ray(const run *r, const fl_rays *rays, uint32_t i, double out_o[3],
                       double out_d[3])
{
    const float o[3] = {rays->ox[i], rays->oy[i], rays->oz[i]};
    const float d[3] = {rays->dx[i], rays->dy[i], rays->dz[i]};
    const fl_vec3 *shift = &r->geometry->revolutions.shift;
    const double from[3] = {shift->x, shift->y, shift->z};
    for (int a = 0; a < 3; a++) {
        if (r->instance) {
            const float *row = r->instance->to_object + 4 * a;
            float oa = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3];
            float da = row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
            out_o[a] = (double)oa;
            out_d[a] = (double)da;
        } else {
            out_o[a] = (double)o[a] + from[a];
            out_d[a] = (double)d[a];
        }
    }
}

/* The root that the search found, or, where it kept none, the same again. */
static bool root_of(const run *r, const fl_hits *hits, uint32_t i, uint32_t entry,
                    const double o[3], const double d[3], fl_revolve_hit *out_root)
{
    if (hits->root) {
        *out_root = hits->root[hits->root_at ? hits->root_at[i] : i];
        return true;
    }
    return fl_revolve_nearest(r->geometry->revolutions.profile[entry], o, d, 0.0,
                              (double)hits->t[i] * (1.0 + 0x1p-22), r->context->solver, out_root);
}

static void solve_revolution(const run *r, const fl_rays *rays, const fl_hits *hits, uint32_t i,
                             uint32_t entry, int lane, solution *s)
{
    const fl_revolve *profile = r->geometry->revolutions.profile[entry];
    double o[3], d[3];
    fl_revolve_hit root;
    solver_ray(r, rays, i, o, d);
    if (!root_of(r, hits, i, entry, o, d, &root))
        return; /* The point on the ray, facing it, will do. */
    fl_revolve_point point;
    fl_revolve_resolve(profile, o, d, &root, &point);
    fl_vec3 shift = r->instance ? fl_v3(0, 0, 0) : r->geometry->revolutions.shift;
    s->p.x[lane] = point.position.x - shift.x;
    s->p.y[lane] = point.position.y - shift.y;
    s->p.z[lane] = point.position.z - shift.z;
    s->ng.x[lane] = point.normal.x;
    s->ng.y[lane] = point.normal.y;
    s->ng.z[lane] = point.normal.z;
    s->u[lane] = point.u;
    s->v[lane] = point.v;
    s->size[lane] = point.scale;
}

FL_INLINE void solve_revolutions(const run *r, const fl_rays *rays, const fl_hits *hits,
                                 const block *b, solution *s)
{
    vec back = vec_unit(b->d);
    s->p = vec_mad(b->o, b->d, b->t);
    s->ng = vec_scale(back, fl_wd_set(-1.0));
    for (int l = 0; l < FL_WD; l++)
        solve_revolution(r, rays, hits, b->at[l], b->entry[l], l, s);
    s->ns = s->ng;
}

/* --- All of them ----------------------------------------------------------------------------- */

FL_INLINE vec affine_point(const fl_affine *a, vec p)
{
    const double(*m)[4] = a->m;
    return (vec){m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
                 m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                 m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
}

FL_INLINE vec affine_direction(const fl_affine *a, vec d)
{
    const double(*m)[4] = a->m;
    return (vec){m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z,
                 m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
                 m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z};
}

/* By the transpose: with the inverse of a map, this carries normals. */
FL_INLINE vec affine_normal(const fl_affine *a, vec n)
{
    const double(*m)[4] = a->m;
    return vec_unit((vec){m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
                          m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z});
}

FL_INLINE fl_wd load(const float *from, const block *b)
{
    return b->is_dense ? fl_wd_load_floats(from + b->at[0]) : fl_wd_gather_floats(from, b->at);
}

/* Rays first, first + 1, ... of the run in the space of their winners. */
FL_INLINE void block_load(const run *r, const fl_rays *rays, const fl_hits *hits, uint32_t first,
                          block *out)
{
    out->is_dense = out->has_one_entry = true;
    for (uint32_t l = 0; l < FL_WD; l++) {
        uint32_t at = r->ray[fl_min_u32(first + l, r->count - 1)];
        out->at[l] = at;
        out->entry[l] = r->geometry->object_entry[hits->object[at]];
        out->prim[l] = hits->prim[at];
        out->is_dense &= at == out->at[0] + l;
        out->has_one_entry &= out->entry[l] == out->entry[0];
    }
    out->o = (vec){load(rays->ox, out), load(rays->oy, out), load(rays->oz, out)};
    out->d = (vec){load(rays->dx, out), load(rays->dy, out), load(rays->dz, out)};
    out->t = load(hits->t, out);
    if (r->instance && !r->instance->is_identity) {
        out->o = affine_point(&r->instance->to_object_exact, out->o);
        out->d = affine_direction(&r->instance->to_object_exact, out->d);
    }
}

/* Back to world space; returns the error bound in world units. */
FL_INLINE fl_wd to_world(const run *r, solution *s)
{
    const fl_instance *instance = r->instance;
    fl_wd gain = fl_wd_set(1.0), base = s->size;
    if (instance) {
        gain = fl_wd_set(instance->error_gain);
        base = fl_wd_set(instance->error_base);
        if (!instance->is_identity) {
            s->p = affine_point(&instance->to_world_exact, s->p);
            s->ng = affine_normal(&instance->to_object_exact, s->ng);
            s->ns = affine_normal(&instance->to_object_exact, s->ns);
        }
    }
    fl_wl is_behind = (fl_wl)(vec_dot(s->ns, s->ng) < 0.0);
    s->ns = vec_select(is_behind, vec_scale(s->ns, fl_wd_set(-1.0)), s->ns);
    fl_wd bound = s->roundings * FL_EPSILON * (gain * vec_max_abs(s->p) + base);
    return fl_wd_max(bound, fl_wd_set(1e-30));
}

FL_INLINE void store_one(float *to, fl_wd v, const block *b)
{
    if (b->is_dense)
        fl_wd_store_floats(to + b->at[0], v);
    else
        fl_wd_scatter_floats(to, b->at, v);
}

FL_INLINE void store_vec(float *x, float *y, float *z, vec v, const block *b)
{
    store_one(x, v.x, b);
    store_one(y, v.y, b);
    store_one(z, v.z, b);
}

FL_INLINE void store(fl_surface *out, const block *b, const solution *s, fl_wd offset)
{
    store_vec(out->px, out->py, out->pz, s->p, b);
    store_vec(out->ngx, out->ngy, out->ngz, s->ng, b);
    store_vec(out->nsx, out->nsy, out->nsz, s->ns, b);
    store_one(out->offset, offset, b);
    store_one(out->u, s->u, b);
    store_one(out->v, s->v, b);
}

FL_INLINE void solve_block(const run *r, fl_object_kind kind, const fl_rays *rays,
                           const fl_hits *hits, uint32_t first, fl_surface *out)
{
    block b;
    solution s; /* No initialiser: p and the normals are always set. */
    block_load(r, rays, hits, first, &b);
    s.u = s.v = s.size = fl_wd_set(0.0);
    s.roundings = OFFSET_ROUNDINGS;
    if (kind == FL_OBJECT_SPHERE)
        solve_spheres(r, &b, &s);
    else if (kind == FL_OBJECT_PLANE)
        solve_planes(r, &b, &s);
    else if (kind == FL_OBJECT_SQUARE)
        solve_patches(r, &b, &s);
    else if (kind == FL_OBJECT_REVOLUTION)
        solve_revolutions(r, rays, hits, &b, &s);
    else
        solve_triangles(r, &b, &s);
    fl_wd offset = to_world(r, &s);
    store(out, &b, &s, offset);
}

/* One copy of all stages for each kind: what follows is written for a kind that is a constant. */
#define SOLVE_RUN(name, kind)                                                                      \
    static void name(const run *r, const fl_rays *rays, const fl_hits *hits, fl_surface *out)      \
    {                                                                                              \
        for (uint32_t first = 0; first < r->count; first += FL_WD)                                 \
            solve_block(r, kind, rays, hits, first, out);                                          \
    }
SOLVE_RUN(run_of_spheres, FL_OBJECT_SPHERE)
SOLVE_RUN(run_of_planes, FL_OBJECT_PLANE)
SOLVE_RUN(run_of_patches, FL_OBJECT_SQUARE)
SOLVE_RUN(run_of_revolutions, FL_OBJECT_REVOLUTION)
SOLVE_RUN(run_of_triangles, FL_OBJECT_MESH)

static void solve_run(const run *r, fl_object_kind kind, const fl_rays *rays, const fl_hits *hits,
                      fl_surface *out)
{
    switch (kind) {
    case FL_OBJECT_SPHERE:
        run_of_spheres(r, rays, hits, out);
        break;
    case FL_OBJECT_PLANE:
        run_of_planes(r, rays, hits, out);
        break;
    case FL_OBJECT_SQUARE:
    case FL_OBJECT_DISK:
        run_of_patches(r, rays, hits, out);
        break;
    case FL_OBJECT_REVOLUTION:
        run_of_revolutions(r, rays, hits, out);
        break;
    case FL_OBJECT_TRIANGLE:
    case FL_OBJECT_MESH:
    default:
        run_of_triangles(r, rays, hits, out);
    }
}

static void store_miss(fl_surface *out, uint32_t i)
{
    float *zero[] = {out->px,  out->py,  out->pz,  out->ngx, out->ngy, out->ngz,
                     out->nsx, out->nsy, out->nsz, out->u,   out->v};
    for (size_t k = 0; k < FL_COUNT_OF(zero); k++)
        zero[k][i] = 0.0f;
    out->offset[i] = 1e-30f;
}

/* What rays of one run have in common: disks and squares solve alike. */
typedef struct run_key {
    fl_object_kind kind;
    uint32_t instance;
    bool needs_uv;
} run_key;

FL_INLINE run_key key_of(const fl_geometry *g, const uint8_t *needs_uv, uint32_t object)
{
    fl_object_kind kind = g->object_kind[object];
    return (run_key){kind == FL_OBJECT_DISK ? FL_OBJECT_SQUARE : kind, g->object_instance[object],
                     needs_uv && needs_uv[object]};
}

/* A part of the stream, and the rays in it that are solved alike. */
enum { WINDOW_RAYS = 256, WINDOW_KEYS = 16 };

typedef struct window {
    run_key key[WINDOW_KEYS];
    uint32_t key_count, count[WINDOW_KEYS];
    uint32_t ray[WINDOW_KEYS][WINDOW_RAYS];
} window;

/* The place of a key; WINDOW_KEYS when there is no room for another. */
FL_INLINE uint32_t window_find(window *w, run_key key)
{
    uint32_t k = 0;
    while (k < w->key_count && (w->key[k].kind != key.kind || w->key[k].instance != key.instance ||
                                w->key[k].needs_uv != key.needs_uv))
        k++;
    if (k == w->key_count && k < WINDOW_KEYS) {
        w->key[k] = key;
        w->count[k] = 0;
        w->key_count++;
    }
    return k;
}

/* Sort hits from `begin` on by what is solved alike; returns the end of the window. */
static uint32_t window_fill(window *w, const fl_geometry *geometry, const uint8_t *needs_uv,
                            const uint32_t *object, uint32_t begin, uint32_t count)
{
    uint32_t end = fl_min_u32(count, begin + WINDOW_RAYS);
    w->key_count = 0;
    for (uint32_t i = begin; i < end;) {
        uint32_t same = object[i];
        if (same == FL_NONE) {
            i++;
            continue;
        }
        uint32_t k = window_find(w, key_of(geometry, needs_uv, same));
        if (k == WINDOW_KEYS)
            return i;
        uint32_t n = w->count[k];
        while (i < end && object[i] == same)
            w->ray[k][n++] = i++;
        w->count[k] = n;
    }
    return end;
}

void FL_ISA_NAME(fl_resolve)(const fl_geometry *geometry, const fl_rays *rays, const fl_hits *hits,
                             const uint8_t *needs_uv, fl_surface *out_surface,
                             fl_isect_context *context)
{
    window w;
    run r = {.geometry = geometry, .context = context};
    for (uint32_t begin = 0, end; begin < rays->count; begin = end) {
        if (fl_is_cancelled(context))
            return;
        end = window_fill(&w, geometry, needs_uv, hits->object, begin, rays->count);
        for (uint32_t i = begin; i < end; i++)
            if (hits->object[i] == FL_NONE)
                store_miss(out_surface, i);
        for (uint32_t k = 0; k < w.key_count; k++) {
            uint32_t instance = w.key[k].instance;
            r.instance = instance == FL_NONE ? NULL : &geometry->instances[instance];
            r.needs_uv = w.key[k].needs_uv;
            r.ray = w.ray[k];
            r.count = w.count[k];
            solve_run(&r, w.key[k].kind, rays, hits, out_surface);
        }
    }
}
