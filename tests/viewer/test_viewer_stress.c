/* SPDX-License-Identifier: MIT
 *
 * Thousands of random inputs, resizes, reloads and looks at the picture, as fast as they go:
 * nothing breaks, and the film in the end is that of a fresh session with the same look. The first
 * argument is the number of inputs. With `--seconds S` behind it such rounds follow one another on
 * one session for so long, and neither memory nor open files may grow.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <malloc.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "support/seed.h"
#include "viewer/session.h"
#include "viewer_loader.h"

static uint32_t input_count = 2000;
static uint32_t seed;
static double run_seconds;

static uint32_t draw(uint32_t count)
{
    seed = fl_lowbias32(seed + 1);
    return seed % count;
}

static const int modifiers[] = {
    0, 0, 0, GLFW_MOD_SHIFT, GLFW_MOD_CONTROL, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT};

static vw_event random_event(void)
{
    vw_event event = {.mods = modifiers[draw(FL_COUNT_OF(modifiers))], .action = (int)draw(3)};
    switch (draw(9)) {
    case 8:
        event.kind = draw(3) ? VW_EVENT_AXIS : draw(9) ? VW_EVENT_PAD : VW_EVENT_SCALE;
        event.code = (int)draw(event.kind == VW_EVENT_AXIS ? 6 : 15);
        event.x = event.kind == VW_EVENT_SCALE ? 1.0 + draw(3) : draw(9) / 4.0 - 1.0;
        break;
    case 0:
        event.kind = VW_EVENT_BUTTON;
        event.code = (int)draw(3);
        break;
    case 1:
        event.kind = VW_EVENT_SCROLL;
        event.y = (double)draw(7) - 3.0;
        break;
    case 2:
        event.kind = VW_EVENT_RESIZE;
        event.width = 1 + draw(90);
        event.height = 1 + draw(60);
        break;
    case 3:
    case 4:
        event.kind = VW_EVENT_CURSOR;
        event.x = (double)draw(100) - 5.0;
        event.y = (double)draw(70) - 5.0;
        break;
    default:
        event.kind = draw(30) ? VW_EVENT_KEY : draw(2) ? VW_EVENT_FOCUS : VW_EVENT_ICONIFY;
        event.code = draw(3) ? GLFW_KEY_SPACE + (int)draw(64) : GLFW_KEY_ESCAPE + (int)draw(60);
        break;
    }
    return event;
}

static void film_of(vw_session *session, char out_sha256[FL_SHA256_HEX + 1])
{
    fl_diags diags = {0};
    fl_progress progress;
    vw_session_end_mix(session); /* A preview is never saved. */
    session->exact_samples = 2;
    vw_session_set_limits(session);
    assert_true(vw_session_restart(session, &diags));
    assert_true(fl_render_wait(session->render, -1.0));
    float *rgb = vw_session_mean(session, &progress, &diags);
    assert_non_null(rgb);
    assert_int_equal(progress.complete_samples, 2);
    fl_digest_sha256(rgb, (size_t)progress.width * progress.height * 12, out_sha256);
    free(rgb);
}

static void act(vw_session *session, vw_dirty dirty, fl_diags *diags)
{
    dirty = vw_session_answer(session, dirty, diags);
    if (dirty & VW_DIRTY_SCENE)
        assert_true(vw_session_load(session, VIEWER_TEST_SCENE, diags));
    if (dirty & (VW_DIRTY_CAMERA | VW_DIRTY_SCENE))
        assert_true(vw_session_restart(session, diags));
    if (dirty & VW_DIRTY_LIMITS)
        vw_session_set_limits(session);
    if (dirty & VW_DIRTY_TONEMAP)
        session->revision = 0;
    /* Costs grow with these alone; a day is not enough for all that a user may ask for. */
    session->state.look.depth_limit = fl_min_u32(session->state.look.depth_limit, 8);
    session->state.look.light_samples = fl_min_u32(session->state.look.light_samples, 4);
}

/* Random inputs, as fast as they go; returns how many pictures were shown. */
static uint32_t play(vw_session *session, uint64_t *ms)
{
    fl_diags diags = {0};
    uint32_t shown_count = 0;
    for (uint32_t i = 0; i < input_count; i++) {
        vw_event event = random_event();
        *ms += draw(40);
        act(session, vw_input_event(&session->input, &session->state, &event, *ms), &diags);
        /* Now and then the workers get so far that there is something to see. */
        if (draw(8) == 0)
            fl_render_wait(session->render, 0.004);
        if (vw_session_refresh(session, &diags)) {
            assert_non_null(vw_session_shown(session));
            shown_count++;
        }
        char notes[512];
        vw_session_notes(session, notes, sizeof notes);
        if (diags.error_count)
            fail_msg("input %u: %s", i, diags.items[0].message);
    }
    fl_diags_deinit(&diags);
    return shown_count;
}

static void open_session(vw_session *session, const vw_options *options, uint32_t width,
                         uint32_t height)
{
    fl_diags diags = {0};
    assert_true(vw_session_open(session, options, VIEWER_TEST_SCENE, width, height, &diags));
    assert_true(vw_session_start(session, NULL, NULL, &diags));
    session->is_replay = true;
}

/* The film of a fresh session with the same look is the same. */
static void assert_no_trace(vw_session *session, const vw_options *options)
{
    char after[FL_SHA256_HEX + 1], want[FL_SHA256_HEX + 1];
    vw_session fresh;
    film_of(session, after);
    open_session(&fresh, options, session->state.width, session->state.height);
    fresh.state.look = session->state.look;
    film_of(&fresh, want);
    assert_string_equal(after, want);
    vw_session_close(&fresh);
}

static void random_inputs_leave_no_trace_in_the_film(void **unused)
{
    (void)unused;
    seed = test_seed(20);
    printf("%u inputs\n", input_count);
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, 0, 0);
    assert_true(vw_session_restart(&session, &diags));
    uint64_t ms = 0;
    uint32_t shown_count = play(&session, &ms);
    printf("%u pictures were shown, %llu restarts made\n", shown_count,
           (unsigned long long)session.progress.newest_generation);
    assert_true(shown_count > 0);
    assert_no_trace(&session, &options);
    vw_session_close(&session);
}

static uint32_t open_files(void)
{
    uint32_t count = 0;
    DIR *folder = opendir("/proc/self/fd");
    while (folder && readdir(folder))
        count++;
    if (folder)
        closedir(folder);
    return count;
}

/* Scenes that bring files with them, opened and left again. */
static void visit(vw_session *session, const char *path)
{
    fl_diags diags = {0};
    char film[FL_SHA256_HEX + 1];
    assert_true(vw_session_load(session, path, &diags));
    film_of(session, film);
    fl_diags_deinit(&diags);
}

/* Bytes that malloc has given out, large pieces with a mapping of their own included, with the
 * session brought to the same state each time. */
static size_t settled_bytes(vw_session *session)
{
    fl_diags diags = {0};
    char film[FL_SHA256_HEX + 1];
    vw_state_resize(&session->state, 100, 70);
    act(session, VW_DIRTY_SCENE, &diags);
    for (int i = 0; i < 3; i++) /* All films that are kept have this size. */
        film_of(session, film);
    session->exact_samples = 0;
    vw_session_set_limits(session);
    struct mallinfo2 all = mallinfo2();
    return all.uordblks + all.hblkhd;
}

/* The least of each half of the run counts: a pinned picture, a measuring render or a larger queue
 * passes, a leak does not. */
enum { WINDOW_ROUNDS = 16, WARM_UP_ROUNDS = 16, GROWTH_MAX_BYTES = 64 << 10 };

static void hours_leave_nothing_behind(void **unused)
{
    (void)unused;
    seed = test_seed(20);
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, 0, 0);
    assert_true(vw_session_restart(&session, &diags));
    uint64_t ms = 0;
    time_t begun = time(NULL);
    size_t half_least[2] = {SIZE_MAX, SIZE_MAX}, least = SIZE_MAX;
    uint32_t files = 0, rounds = 0;
    for (double passed = 0.0; passed < run_seconds || rounds < 48; rounds++) {
        play(&session, &ms);
        visit(&session, FL_SOURCE_DIR "/tests/reference/scenes/mesh_glass.txt");
        visit(&session, FL_SOURCE_DIR "/tests/reference/scenes/textures.txt");
        size_t bytes = settled_bytes(&session);
        least = bytes < least ? bytes : least;
        passed = difftime(time(NULL), begun);
        if (rounds == WARM_UP_ROUNDS)
            files = open_files();
        assert_true(rounds < WARM_UP_ROUNDS || open_files() == files);
        if (rounds % WINDOW_ROUNDS != WINDOW_ROUNDS - 1)
            continue;
        printf("%7.0f s, %9u inputs, %zu bytes, %u files\n", passed, (rounds + 1) * input_count,
               least, open_files());
        fflush(stdout);
        size_t half = passed < 0.5 * run_seconds ? 0u : 1u;
        if (rounds > WARM_UP_ROUNDS && least < half_least[half])
            half_least[half] = least;
        least = SIZE_MAX;
    }
    printf("%u rounds, %.2f hours of flying; least bytes of the halves %zu, %zu\n", rounds,
           (double)ms / 3.6e6, half_least[0], half_least[1]);
    assert_true(half_least[1] <= half_least[0] + GROWTH_MAX_BYTES);
    assert_no_trace(&session, &options);
    vw_session_close(&session);
}

int main(int argc, char **argv)
{
    double count;
    if (argc > 1 && fl_number_parse(argv[1], argv[1] + strlen(argv[1]), &count))
        input_count = (uint32_t)count;
    if (argc > 3 && strcmp(argv[2], "--seconds") == 0)
        fl_number_parse(argv[3], argv[3] + strlen(argv[3]), &run_seconds);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_inputs_leave_no_trace_in_the_film),
    };
    const struct CMUnitTest hours[] = {
        cmocka_unit_test(hours_leave_nothing_behind),
    };
    return run_seconds > 0.0 ? cmocka_run_group_tests(hours, NULL, NULL)
                             : cmocka_run_group_tests(tests, NULL, NULL);
}
