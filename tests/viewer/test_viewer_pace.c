/* SPDX-License-Identifier: MIT
 *
 * When the window looks at the picture, and that it does not while it is hidden.
 */
#include "viewer_kit.h"

#include "viewer/pace.h"

static void the_first_look_is_one_frame_after_the_first_edit(void **unused)
{
    (void)unused;
    vw_pace pace = {0};
    fl_progress shown = {
        .generation = 1, .complete_samples = 300, .complete_ranks = 64, .seconds = 9};
    vw_pace_shown(&pace, &shown, 1000);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 1500);
    assert_int_equal(vw_pace_held_until_ms(&pace), 0);
    vw_pace_restart(&pace, 2, 2000);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 2000 + VW_PACE_FIRST_MS);
    assert_int_equal(vw_pace_held_until_ms(&pace), 2000 + VW_PACE_HOLD_MS);
    /* However many edits follow, the screen gets its picture in time. */
    for (uint64_t i = 1; i < 9; i++)
        vw_pace_restart(&pace, 2 + i, 2000 + i);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 2000 + VW_PACE_FIRST_MS);
    /* Nothing new there yet: again soon, not at once. */
    vw_pace_shown(&pace, &shown, 2010);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 2011);
    shown = (fl_progress){.generation = 10, .complete_ranks = 3};
    vw_pace_shown(&pace, &shown, 2011);
    assert_int_equal(vw_pace_held_until_ms(&pace), 0);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 2011 + 33);
}

static void looks_get_rarer_as_the_picture_settles(void **unused)
{
    (void)unused;
    static const struct {
        uint32_t ranks, samples;
        double seconds;
        uint64_t interval_ms;
    } steps[] = {{1, 0, 0.01, 33},  {7, 0, 0.02, 33},   {8, 0, 0.03, 16},
                 {64, 1, 0.1, 16},  {64, 4, 0.4, 16},   {64, 4, 9.0, 16},
                 {64, 5, 0.5, 100}, {64, 9, 0.99, 100}, {64, 10, 1.0, 500}};
    vw_pace pace = {0};
    for (size_t i = 0; i < FL_COUNT_OF(steps); i++) {
        fl_progress shown = {.generation = 1,
                             .complete_ranks = steps[i].ranks,
                             .complete_samples = steps[i].samples,
                             .seconds = steps[i].seconds};
        vw_pace_shown(&pace, &shown, 70);
        assert_int_equal(vw_pace_due_ms(&pace, &shown), 70 + steps[i].interval_ms);
    }
}

static void a_slow_screen_is_drawn_rarely(void **unused)
{
    (void)unused;
    vw_pace pace = {0};
    fl_progress shown = {.generation = 1, .complete_ranks = 20};
    vw_pace_shown(&pace, &shown, 100);
    vw_pace_took(&pace, 2);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 100 + 16);
    vw_pace_took(&pace, 10);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 100 + 70);
    /* The first look at an edit is as soon as ever, and all other drawing waits for it. */
    vw_pace_restart(&pace, 2, 200);
    assert_int_equal(vw_pace_due_ms(&pace, &shown), 200 + VW_PACE_FIRST_MS);
    assert_int_equal(vw_pace_draw_from_ms(&pace), 200 + VW_PACE_FIRST_MS);
    shown.generation = 2;
    vw_pace_shown(&pace, &shown, 207);
    assert_int_equal(vw_pace_draw_from_ms(&pace), 0);
}

static void the_first_whole_sample_is_worth_a_look(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    options.limits.samples = 2;
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    for (int edit = 0; edit < 3; edit++) {
        assert_true(vw_session_restart(&session, &diags));
        assert_true(fl_render_wait(session.render, -1.0));
        /* Of an older picture everything was seen. */
        assert_int_equal(vw_session_is_full_sample_new(&session), edit == 0);
        assert_true(vw_session_refresh(&session, &diags));
        assert_false(vw_session_is_full_sample_new(&session));
        session.progress.complete_samples = 0; /* As if it had been seen amid sample 0. */
        assert_true(vw_session_is_full_sample_new(&session));
        assert_true(vw_session_restart(&session, &diags));
        fl_render_progress(session.render, &session.progress);
        session.progress.complete_samples = 0;
        session.progress.generation = session.progress.newest_generation + 1;
        assert_false(vw_session_is_full_sample_new(&session)); /* Not of that one. */
        assert_true(fl_render_wait(session.render, -1.0));
        session.progress.complete_samples = 1;
    }
    vw_session_close(&session);
}

static fl_render_state state_of(vw_session *session)
{
    fl_progress progress;
    fl_render_progress(session->render, &progress);
    return progress.state;
}

static void an_icon_renders_nothing(void **unused)
{
    (void)unused;
    vw_options options = viewer_test_options();
    options.limits.samples = 1 << 20;
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, VIEWER_TEST_SCENE);
    assert_true(vw_session_restart(&session, &diags));
    vw_event event = {.kind = VW_EVENT_ICONIFY, .action = GLFW_PRESS};
    assert_true(send(&session, &event, 10) & VW_DIRTY_LIMITS);
    vw_session_set_limits(&session);
    assert_int_equal(state_of(&session), FL_RENDER_PAUSED);
    /* Edits of other windows' keys do not start it; P is not undone by it. */
    tap(&session, GLFW_KEY_P, 0, 20);
    event.action = GLFW_RELEASE;
    send(&session, &event, 30);
    vw_session_set_limits(&session);
    assert_int_equal(state_of(&session), FL_RENDER_PAUSED);
    tap(&session, GLFW_KEY_P, 0, 40);
    vw_session_set_limits(&session);
    assert_int_equal(state_of(&session), FL_RENDER_RUNNING);
    vw_session_close(&session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_look_is_one_frame_after_the_first_edit),
        cmocka_unit_test(looks_get_rarer_as_the_picture_settles),
        cmocka_unit_test(a_slow_screen_is_drawn_rarely),
        cmocka_unit_test(the_first_whole_sample_is_worth_a_look),
        cmocka_unit_test(an_icon_renders_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
