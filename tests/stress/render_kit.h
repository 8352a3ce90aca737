/* SPDX-License-Identifier: MIT
 *
 * What the render's stress tests share. Compiled instances are not needed: the fake frame ignores
 * its scene.
 */
#ifndef RENDER_KIT_H
#define RENDER_KIT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/render.h"
#include "fake_pipeline.h"

/* ThreadSanitizer slows everything about tenfold. */
#if defined(__SANITIZE_THREAD__)
#define KIT_IS_SLOW 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KIT_IS_SLOW 1
#endif
#endif
#ifndef KIT_IS_SLOW
#define KIT_IS_SLOW 0
#endif

static inline fl_render *kit_render(uint32_t threads)
{
    fl_diags diags = {0};
    fl_render *render = fl_render_create(&(fl_render_options){.thread_count = threads}, &diags);
    assert_non_null(render);
    assert_int_equal(diags.count, 0);
    return render;
}

static inline void kit_restart(fl_render *render, uint32_t seed, uint32_t x0, uint32_t y0,
                               uint32_t w, uint32_t h)
{
    fl_diags diags = {0};
    fl_params params = fake_params(seed, x0, y0, w, h);
    assert_true(fl_render_restart(render, NULL, &params, &diags));
    assert_int_equal(diags.count, 0);
    fake_poke();
}

static inline void kit_limit(fl_render *render, uint32_t samples)
{
    fl_render_set_limits(render, &(fl_render_limits){.samples = samples});
}

/* The film is exactly that of `samples` samples. */
static inline void kit_assert_film(fl_render *render, uint32_t seed, uint32_t x0, uint32_t y0,
                                   uint32_t w, uint32_t h, uint32_t samples)
{
    size_t floats = (size_t)3 * w * h;
    float *got = malloc(floats * sizeof *got), *want = malloc(floats * sizeof *want);
    assert_true(got && want);
    fl_progress progress;
    assert_true(fl_render_mean(render, got, floats, &progress));
    assert_int_equal(progress.width, w);
    assert_int_equal(progress.height, h);
    assert_int_equal(progress.complete_samples, samples);
    assert_true(progress.mean_samples == (double)samples);
    assert_int_equal(progress.counts.samples, (uint64_t)w * h * samples);
    fake_mean(seed, x0, y0, w, h, samples, want);
    assert_memory_equal(got, want, floats * sizeof *got);
    free(got);
    free(want);
}

#endif
