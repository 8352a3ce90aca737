/* SPDX-License-Identifier: MIT */
#include "viewer/lab.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "viewer/loading.h"

/* How soon a question that nobody wants any more is noticed. */
#define WAIT_SECONDS 0.02
enum { ROUNDS = 2 };

struct vw_lab {
    void (*notify)(void *context);
    void *context;
    pthread_t thread;
    fl_render *render;            /* The thread's own; NULL until first needed. */
    atomic_uint_least64_t newest; /* Number of the latest question; written under the lock. */
    pthread_mutex_t lock;         /* Guards all below. */
    pthread_cond_t changed;
    vw_lab_question question; /* The latest, with its references until they are taken. */
    uint64_t done;
    bool should_quit;
    vw_lab_answer ready;
    bool is_fresh;
};

/* A rendered mean. */
typedef struct mean {
    float *rgb; /* Owned. */
    size_t floats;
    fl_progress progress;
} mean;

static bool is_stale(const vw_lab *lab, uint64_t wish)
{
    return atomic_load_explicit(&lab->newest, memory_order_relaxed) != wish;
}

static void question_deinit(vw_lab_question *question)
{
    for (uint32_t i = 0; i < question->frame_count; i++)
        fl_frame_release(question->frames[i]);
    question->frame_count = 0;
}

void vw_lab_answer_deinit(vw_lab_answer *answer)
{
    free(answer->changes);
    *answer = (vw_lab_answer){0};
}

static bool refuse(vw_lab_answer *answer, const fl_diags *diags)
{
    snprintf(answer->error, sizeof answer->error, "%s",
             diags->count ? diags->items[0].message : "out of memory");
    return false;
}

static bool wait_until_done(vw_lab *lab, uint64_t wish)
{
    while (!fl_render_wait(lab->render, WAIT_SECONDS)) {
        fl_progress progress;
        fl_render_progress(lab->render, &progress);
        if (is_stale(lab, wish) || progress.state == FL_RENDER_FAILED)
            return false;
    }
    return true;
}

/* Render so many samples; false: nobody wants it any more, or answer->error says why not. */
static bool render(vw_lab *lab, fl_compiled *scene, const fl_params *params, uint32_t samples,
                   mean *out, vw_lab_answer *answer)
{
    fl_diags diags = {0};
    fl_render_options options = {.thread_count = 1, .is_low_priority = true};
    fl_render_limits limits = {.samples = samples};
    if (!lab->render)
        lab->render = fl_render_create(&options, &diags);
    bool is_fine = lab->render != NULL;
    if (is_fine) {
        fl_render_set_limits(lab->render, &limits);
        fl_render_set_paused(lab->render, false);
        is_fine = fl_render_restart(lab->render, scene, params, &diags);
    }
    if (!is_fine)
        refuse(answer, &diags);
    fl_diags_deinit(&diags);
    if (!is_fine || !wait_until_done(lab, answer->wish))
        return false;
    fl_render_progress(lab->render, &out->progress);
    out->floats = (size_t)out->progress.width * out->progress.height * 3;
    free(out->rgb);
    out->rgb = malloc(out->floats * sizeof *out->rgb);
    if (out->rgb && fl_render_mean(lab->render, out->rgb, out->floats, &out->progress))
        return true;
    return refuse(answer, &(fl_diags){0});
}

static uint64_t ray_count(const fl_counts *counts)
{
    return counts->camera_rays + counts->shadow_rays + counts->reflect_rays + counts->refract_rays;
}

static double mean_square(const float *a, const float *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a[i] - (double)b[i];
        sum += d * d;
    }
    return count ? sum / (double)count : 0.0;
}

/* Two pictures of n samples with nothing in common but what they converge to differ by twice the
 * variance of either. The same two seeds for all trials: what they share cancels in `change`. */
static void judge(const mean rounds[ROUNDS], const mean first[ROUNDS], uint32_t samples,
                  vw_trial *out)
{
    size_t floats = rounds[0].floats;
    double pixels = (double)floats / 3.0;
    for (int r = 0; r < ROUNDS; r++) {
        const fl_progress *p = &rounds[r].progress;
        double cpu = p->cpu_seconds / (pixels * samples);
        out->rays = (double)ray_count(&p->counts) / (pixels * samples);
        out->cpu_seconds = r == 0 ? cpu : fl_min(cpu, out->cpu_seconds);
    }
    out->rmse = sqrt(mean_square(rounds[0].rgb, rounds[1].rgb, floats) / 2.0);
    double sum = 0.0;
    for (size_t i = 0; i < floats; i++) {
        double d = 0.0;
        for (int r = 0; r < ROUNDS; r++)
            d += (double)rounds[r].rgb[i] - (double)first[r].rgb[i];
        sum += d * d / (ROUNDS * ROUNDS);
    }
    out->change = floats ? sqrt(sum / (double)floats) : 0.0;
}

static bool run_trials(vw_lab *lab, const vw_lab_question *question, vw_lab_answer *answer)
{
    mean means[VW_TRIALS_MAX][ROUNDS] = {0};
    bool is_fine = true;
    for (uint32_t r = 0; r < ROUNDS && is_fine; r++) {
        for (uint32_t i = 0; i < question->frame_count && is_fine; i++) {
            fl_params params = question->frames[i]->params;
            params.seed = fl_lowbias32(params.seed + 1 + r);
            is_fine = render(lab, question->frames[i]->scene, &params, question->samples,
                             &means[i][r], answer);
        }
    }
    for (uint32_t i = 0; i < question->frame_count && is_fine; i++) {
        vw_trial *trial = &answer->trials[i];
        memcpy(trial->name, question->names[i], sizeof trial->name);
        judge(means[i], means[0], question->samples, trial);
        answer->trial_count = i + 1;
    }
    for (uint32_t i = 0; i < question->frame_count; i++)
        for (int r = 0; r < ROUNDS; r++)
            free(means[i][r].rgb);
    return is_fine;
}

/* The scene at another size, with the lights as they are edited. */
static bool scale_scene(const vw_lab_question *question, fl_scene *scene, fl_diags *diags)
{
    const vw_look *look = &question->state.look;
    if (look->light_count > 0 && look->light_count == scene->light_count)
        memcpy(scene->lights, look->lights, look->light_count * sizeof *look->lights);
    return fl_scene_map(scene, question->scale, fl_v3(0.0, 0.0, 0.0), diags);
}

/* Render the question's scene at another size. */
static bool render_scaled(vw_lab *lab, const vw_lab_question *question, mean *out,
                          vw_lab_answer *answer)
{
    vw_scene scene = {0};
    fl_diags diags = {0};
    fl_compiled *compiled = NULL;
    const fl_geometry *geometry = &question->frames[0]->scene->geometry;
    if (is_stale(lab, answer->wish))
        return false;
    if (question->loader->load(question->loader->context, question->path, &scene, &diags) &&
        !is_stale(lab, answer->wish) && scene.scene && scale_scene(question, scene.scene, &diags)) {
        fl_compile_options options = {
            .accel = geometry->accel, .has_isa = true, .isa = question->frames[0]->scene->isa};
        compiled = fl_compile(scene.scene, &options, NULL, &diags);
    }
    bool is_fine = compiled != NULL;
    if (is_fine) {
        fl_params params;
        vw_state_params(&question->state, &question->base, &params);
        params.lights = scene.scene->lights;
        params.light_count = scene.scene->light_count;
        params.camera.center = fl_v3_scale(params.camera.center, question->scale);
        params.camera.aperture *= question->scale;
        params.camera.focus *= question->scale;
        params.camera.ortho_size *= question->scale;
        is_fine = render(lab, compiled, &params, question->samples, out, answer);
    } else {
        refuse(answer, &diags);
    }
    fl_diags_deinit(&diags);
    fl_compiled_release(compiled);
    vw_scene_deinit(&scene);
    return is_fine;
}

static void compare(const mean *a, const mean *b, float *out)
{
    for (size_t i = 0; i < a->floats / 3; i++) {
        double largest = 0.0;
        for (size_t c = 0; c < 3; c++) {
            double d = fabs((double)a->rgb[3 * i + c] - (double)b->rgb[3 * i + c]);
            largest = isfinite(d) ? fl_max(d, largest) : (double)INFINITY;
        }
        out[i] = (float)largest;
    }
}

static bool run_stress(vw_lab *lab, const vw_lab_question *question, vw_lab_answer *answer)
{
    mean plain = {0}, other = {0};
    if (question->error[0]) {
        memcpy(answer->error, question->error, sizeof answer->error);
        return false;
    }
    const fl_frame *const *frames = (const fl_frame *const *)question->frames;
    bool is_fine =
        render(lab, frames[0]->scene, &frames[0]->params, question->samples, &plain, answer);
    if (is_fine)
        is_fine = question->scale > 0.0 ? render_scaled(lab, question, &other, answer)
                                        : render(lab, frames[1]->scene, &frames[1]->params,
                                                 question->samples, &other, answer);
    if (is_fine && plain.floats == other.floats) {
        answer->changes = malloc(plain.floats / 3 * sizeof *answer->changes);
        answer->width = plain.progress.width;
        answer->height = plain.progress.height;
        is_fine = answer->changes || refuse(answer, &(fl_diags){0});
        if (is_fine)
            compare(&plain, &other, answer->changes);
    }
    free(plain.rgb);
    free(other.rgb);
    return is_fine;
}

/* Hand an answer over. Takes what it owns. */
static void publish(vw_lab *lab, const vw_lab_answer *answer)
{
    pthread_mutex_lock(&lab->lock);
    vw_lab_answer old = lab->ready;
    lab->ready = *answer;
    lab->is_fresh = true;
    pthread_mutex_unlock(&lab->lock);
    vw_lab_answer_deinit(&old);
    if (lab->notify)
        lab->notify(lab->context);
}

/* Round by round: the first is there soon, the last is sharp. */
static bool run_noise(vw_lab *lab, const vw_lab_question *question, vw_lab_answer *answer)
{
    fl_diags diags = {0};
    const fl_frame *frame = question->frames[0];
    fl_noise *noise = fl_noise_create(frame->scene, &frame->params, question->samples, &diags);
    bool is_fine = noise || refuse(answer, &diags);
    fl_diags_deinit(&diags);
    for (uint32_t round = 0; is_fine && round < FL_NOISE_ROUNDS;) {
        if (is_stale(lab, answer->wish))
            is_fine = false;
        else if (!fl_noise_step(noise))
            is_fine = refuse(answer, &(fl_diags){0});
        else if (fl_noise_rounds(noise) > round && fl_noise_read(noise, &answer->noise) &&
                 ++round < FL_NOISE_ROUNDS)
            publish(lab, answer);
    }
    fl_noise_destroy(noise);
    return is_fine;
}

/* Answer; an answer that nobody wants any more is thrown away. */
static void work(vw_lab *lab, const vw_lab_question *question, uint64_t wish)
{
    vw_lab_answer answer = {.kind = question->kind, .wish = wish, .samples = question->samples};
    bool is_done = question->frame_count > 0;
    if (is_done && question->kind == VW_LAB_NOISE)
        is_done = run_noise(lab, question, &answer);
    else if (is_done && question->kind == VW_LAB_TRIALS)
        is_done = run_trials(lab, question, &answer);
    else if (is_done && question->kind == VW_LAB_STRESS)
        is_done = run_stress(lab, question, &answer);
    if (lab->render)
        fl_render_set_paused(lab->render, true);
    if (is_done || answer.error[0])
        publish(lab, &answer);
    else
        vw_lab_answer_deinit(&answer);
}

static void *thread_main(void *context)
{
    vw_lab *lab = context;
    /* Behind the picture's workers. On Linux `who` 0 is this thread alone; where it is the whole
     * process, nothing is lost but a little priority. */
    setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + 1);
    pthread_mutex_lock(&lab->lock);
    while (!lab->should_quit) {
        uint64_t wish = atomic_load_explicit(&lab->newest, memory_order_relaxed);
        if (wish == lab->done) {
            pthread_cond_wait(&lab->changed, &lab->lock);
            continue;
        }
        vw_lab_question question = lab->question;
        lab->question.frame_count = 0;
        pthread_mutex_unlock(&lab->lock);
        work(lab, &question, wish);
        question_deinit(&question);
        pthread_mutex_lock(&lab->lock);
        lab->done = wish;
        pthread_cond_broadcast(&lab->changed);
    }
    pthread_mutex_unlock(&lab->lock);
    fl_render_destroy(lab->render);
    return NULL;
}

vw_lab *vw_lab_create(void (*notify)(void *context), void *context, fl_diags *diags)
{
    vw_lab *lab = calloc(1, sizeof *lab);
    if (!lab) {
        fl_out_of_memory(diags, "measuring");
        return NULL;
    }
    lab->notify = notify;
    lab->context = context;
    atomic_init(&lab->newest, 0);
    pthread_mutex_init(&lab->lock, NULL);
    pthread_cond_init(&lab->changed, NULL);
    if (pthread_create(&lab->thread, NULL, thread_main, lab) == 0)
        return lab;
    fl_environment_error(diags, "cannot start the thread that measures");
    pthread_cond_destroy(&lab->changed);
    pthread_mutex_destroy(&lab->lock);
    free(lab);
    return NULL;
}

void vw_lab_destroy(vw_lab *lab)
{
    if (!lab)
        return;
    pthread_mutex_lock(&lab->lock);
    lab->should_quit = true;
    atomic_fetch_add_explicit(&lab->newest, 1, memory_order_relaxed);
    pthread_cond_broadcast(&lab->changed);
    pthread_mutex_unlock(&lab->lock);
    pthread_join(lab->thread, NULL);
    question_deinit(&lab->question);
    vw_lab_answer_deinit(&lab->ready);
    pthread_cond_destroy(&lab->changed);
    pthread_mutex_destroy(&lab->lock);
    free(lab);
}

uint64_t vw_lab_ask(vw_lab *lab, const vw_lab_question *question)
{
    pthread_mutex_lock(&lab->lock);
    vw_lab_question old = lab->question;
    lab->question = *question;
    for (uint32_t i = 0; i < question->frame_count; i++)
        fl_frame_retain(question->frames[i]);
    uint64_t wish = atomic_fetch_add_explicit(&lab->newest, 1, memory_order_relaxed) + 1;
    pthread_cond_broadcast(&lab->changed);
    pthread_mutex_unlock(&lab->lock);
    question_deinit(&old);
    return wish;
}

bool vw_lab_take(vw_lab *lab, vw_lab_answer *out)
{
    pthread_mutex_lock(&lab->lock);
    bool is_fresh = lab->is_fresh;
    if (is_fresh) {
        vw_lab_answer_deinit(out);
        *out = lab->ready;
        lab->ready = (vw_lab_answer){0};
        lab->is_fresh = false;
    }
    pthread_mutex_unlock(&lab->lock);
    return is_fresh;
}

void vw_lab_wait(vw_lab *lab)
{
    pthread_mutex_lock(&lab->lock);
    while (lab->done != atomic_load_explicit(&lab->newest, memory_order_relaxed))
        pthread_cond_wait(&lab->changed, &lab->lock);
    pthread_mutex_unlock(&lab->lock);
}
