/* SPDX-License-Identifier: MIT */
#include "viewer/guide.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { COARSE_STEP = 8, BAND_ROWS = 16 };

struct vw_guide {
    void (*notify)(void *context);
    void *context;
    pthread_t thread;
    atomic_uint_least64_t newest; /* Number of the latest wish; written under the lock. */
    pthread_mutex_t lock;         /* Guards all below. */
    pthread_cond_t changed;
    fl_frame *frame; /* Of the latest wish; a reference, or NULL. */
    int kind;
    uint64_t done; /* Wish that is finished or given up. */
    bool should_quit;
    vw_guide_picture ready;
    bool is_fresh; /* `ready` was not taken yet. */
};

/* Part of a picture: one or two evaluations. */
static bool eval(const fl_frame *frame, int kind, const fl_aov_grid *grid, float *out_values)
{
    static const double left[2] = {-1.0, 0.0}, right[2] = {1.0, 0.0};
    size_t count = (size_t)grid->width * grid->height;
    if (kind != VW_GUIDE_RANGEFINDER)
        return fl_aov_eval(frame, (fl_aov)kind, NULL, grid, out_values);
    float *other = malloc(count * 3 * sizeof *other);
    bool is_fine = other && fl_aov_eval(frame, FL_AOV_SHAPE, left, grid, out_values) &&
                   fl_aov_eval(frame, FL_AOV_SHAPE, right, grid, other);
    for (size_t i = 0; i < count && is_fine; i++) {
        const float *a = out_values + 3 * i, *b = other + 3 * i;
        float red = (a[0] + a[1] + a[2]) / 3.0f, cyan = (b[0] + b[1] + b[2]) / 3.0f;
        out_values[3 * i] = red;
        out_values[3 * i + 1] = out_values[3 * i + 2] = cyan;
    }
    free(other);
    return is_fine;
}

/* Hand a picture over. Takes its values. */
static void publish(vw_guide *guide, const vw_guide_picture *picture)
{
    pthread_mutex_lock(&guide->lock);
    float *old = guide->ready.values;
    guide->ready = *picture;
    guide->is_fresh = true;
    pthread_mutex_unlock(&guide->lock);
    free(old);
    if (guide->notify)
        guide->notify(guide->context);
}

static float *allocate(const fl_frame *frame)
{
    return malloc((size_t)frame->width * frame->height * 3 * sizeof(float));
}

/* One value for each 8 x 8 pixels, spread over them. */
static bool show_coarse(vw_guide *guide, const fl_frame *frame, vw_guide_picture picture)
{
    fl_aov_grid grid = {.step = COARSE_STEP,
                        .width = (frame->width + COARSE_STEP - 1) / COARSE_STEP,
                        .height = (frame->height + COARSE_STEP - 1) / COARSE_STEP};
    float *cells = malloc((size_t)grid.width * grid.height * 3 * sizeof *cells);
    picture.values = allocate(frame);
    picture.is_coarse = true;
    bool is_fine = cells && picture.values && eval(frame, picture.kind, &grid, cells);
    for (uint32_t y = 0; y < frame->height && is_fine; y++)
        for (uint32_t x = 0; x < frame->width; x++)
            memcpy(picture.values + 3 * ((size_t)y * frame->width + x),
                   cells + 3 * ((size_t)(y / COARSE_STEP) * grid.width + x / COARSE_STEP),
                   3 * sizeof *cells);
    free(cells);
    if (is_fine)
        publish(guide, &picture);
    else
        free(picture.values);
    return is_fine;
}

static void show_all(vw_guide *guide, const fl_frame *frame, vw_guide_picture picture)
{
    picture.values = allocate(frame);
    bool is_fine = picture.values != NULL;
    for (uint32_t y = 0; y < frame->height && is_fine; y += BAND_ROWS) {
        fl_aov_grid grid = {.y0 = y,
                            .step = 1,
                            .width = frame->width,
                            .height = fl_min_u32(BAND_ROWS, frame->height - y)};
        is_fine = atomic_load_explicit(&guide->newest, memory_order_relaxed) == picture.wish &&
                  eval(frame, picture.kind, &grid, picture.values + 3 * (size_t)y * frame->width);
    }
    if (is_fine)
        publish(guide, &picture);
    else
        free(picture.values);
}

static void *thread_main(void *context)
{
    vw_guide *guide = context;
    pthread_mutex_lock(&guide->lock);
    for (;;) {
        uint64_t wish = atomic_load_explicit(&guide->newest, memory_order_relaxed);
        if (guide->should_quit)
            break;
        if (wish == guide->done) {
            pthread_cond_wait(&guide->changed, &guide->lock);
            continue;
        }
        fl_frame *frame = fl_frame_retain(guide->frame);
        vw_guide_picture picture = {
            .width = frame->width, .height = frame->height, .kind = guide->kind, .wish = wish};
        pthread_mutex_unlock(&guide->lock);
        if (show_coarse(guide, frame, picture))
            show_all(guide, frame, picture);
        fl_frame_release(frame);
        pthread_mutex_lock(&guide->lock);
        guide->done = wish;
        pthread_cond_broadcast(&guide->changed);
    }
    pthread_mutex_unlock(&guide->lock);
    return NULL;
}

vw_guide *vw_guide_create(void (*notify)(void *context), void *context, fl_diags *diags)
{
    vw_guide *guide = calloc(1, sizeof *guide);
    if (!guide) {
        fl_out_of_memory(diags, "the views");
        return NULL;
    }
    guide->notify = notify;
    guide->context = context;
    atomic_init(&guide->newest, 0);
    pthread_mutex_init(&guide->lock, NULL);
    pthread_cond_init(&guide->changed, NULL);
    if (pthread_create(&guide->thread, NULL, thread_main, guide) == 0)
        return guide;
    fl_environment_error(diags, "cannot start the thread of the views");
    pthread_cond_destroy(&guide->changed);
    pthread_mutex_destroy(&guide->lock);
    free(guide);
    return NULL;
}

void vw_guide_destroy(vw_guide *guide)
{
    if (!guide)
        return;
    pthread_mutex_lock(&guide->lock);
    guide->should_quit = true;
    atomic_fetch_add_explicit(&guide->newest, 1, memory_order_relaxed);
    pthread_cond_broadcast(&guide->changed);
    pthread_mutex_unlock(&guide->lock);
    pthread_join(guide->thread, NULL);
    fl_frame_release(guide->frame);
    free(guide->ready.values);
    pthread_cond_destroy(&guide->changed);
    pthread_mutex_destroy(&guide->lock);
    free(guide);
}

uint64_t vw_guide_ask(vw_guide *guide, fl_frame *frame, int kind)
{
    pthread_mutex_lock(&guide->lock);
    fl_frame *old = guide->frame;
    guide->frame = fl_frame_retain(frame);
    guide->kind = kind;
    uint64_t wish = atomic_fetch_add_explicit(&guide->newest, 1, memory_order_relaxed) + 1;
    pthread_cond_broadcast(&guide->changed);
    pthread_mutex_unlock(&guide->lock);
    fl_frame_release(old);
    return wish;
}

bool vw_guide_take(vw_guide *guide, vw_guide_picture *out)
{
    pthread_mutex_lock(&guide->lock);
    bool is_fresh = guide->is_fresh;
    if (is_fresh) {
        free(out->values);
        *out = guide->ready;
        guide->ready = (vw_guide_picture){0};
        guide->is_fresh = false;
    }
    pthread_mutex_unlock(&guide->lock);
    return is_fresh;
}

void vw_guide_wait(vw_guide *guide)
{
    pthread_mutex_lock(&guide->lock);
    while (guide->done != atomic_load_explicit(&guide->newest, memory_order_relaxed))
        pthread_cond_wait(&guide->changed, &guide->lock);
    pthread_mutex_unlock(&guide->lock);
}
