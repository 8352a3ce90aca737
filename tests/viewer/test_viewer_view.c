/* SPDX-License-Identifier: MIT
 *
 * Drawing without a display: the picture's bytes arrive unchanged, overlays stay where they belong.
 * Text itself is never compared (decision 25). Runs on every offscreen platform that is there;
 * skips if none is.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "viewer/input.h"
#include "viewer/view.h"

static const char *platform_name;

typedef struct scene {
    vw_platform *platform;
    vw_view *view;
    vw_state state;
    fl_progress progress;
    uint8_t *picture, *shown;
    fl_diags diags;
} scene;

static void fill(uint8_t *rgba, size_t pixels, uint32_t seed)
{
    for (size_t i = 0; i < 4 * pixels; i++)
        rgba[i] = i % 4 == 3 ? 255 : (uint8_t)fl_lowbias32(seed + (uint32_t)i);
}

static bool open_scene(scene *s, uint32_t width, uint32_t height, uint32_t window_width,
                       uint32_t window_height)
{
    *s = (scene){0};
    vw_window_desc desc = {.title = "test", .width = window_width, .height = window_height};
    s->platform = vw_platform_create(platform_name, false, &desc, &s->diags);
    if (!s->platform) {
        fl_diags_deinit(&s->diags);
        return false;
    }
    s->view = vw_view_create(s->platform, NULL, &s->diags);
    assert_non_null(s->view);
    fl_params params = {
        .camera = {.direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_deg = 40, .focus = 1},
        .width = width,
        .height = height};
    s->state.width = window_width;
    s->state.height = window_height;
    vw_state_init(&s->state, &params, NULL, 64);
    s->state.is_hud_shown = false;
    s->picture = malloc((size_t)width * height * 4);
    s->shown = malloc((size_t)window_width * window_height * 4);
    fill(s->picture, (size_t)width * height, 1);
    vw_view_upload(s->view, s->picture, width, height);
    return true;
}

static void close_scene(scene *s)
{
    vw_view_destroy(s->view);
    s->platform->ops->destroy(s->platform);
    free(s->picture);
    free(s->shown);
    fl_diags_deinit(&s->diags);
}

static void draw(scene *s)
{
    assert_true(vw_view_draw(s->view, &s->state, &s->progress, &(vw_texts){0}, &s->diags));
    assert_true(vw_view_read(s->view, s->shown));
}

#define OPEN_OR_SKIP(s, ...)                                                                       \
    if (!open_scene(s, __VA_ARGS__))                                                               \
        skip();

static void bytes_arrive_unchanged(void **unused)
{
    (void)unused;
    scene s;
    OPEN_OR_SKIP(&s, 321, 203, 321, 203);
    draw(&s);
    assert_memory_equal(s.shown, s.picture, 321 * 203 * 4);
    fill(s.picture, 321 * 203, 99);
    vw_view_upload(s.view, s.picture, 321, 203);
    draw(&s);
    assert_memory_equal(s.shown, s.picture, 321 * 203 * 4);
    close_scene(&s);
}

static void a_smaller_picture_is_scaled_by_whole_pixels(void **unused)
{
    (void)unused;
    scene s;
    OPEN_OR_SKIP(&s, 50, 40, 150, 140);
    draw(&s);
    for (uint32_t y = 0; y < 120; y++)
        for (uint32_t x = 0; x < 150; x++)
            assert_memory_equal(s.shown + ((y + 10) * 150 + x) * 4,
                                s.picture + (y / 3 * 50 + x / 3) * 4, 4);
    /* Bars above and below are one colour. */
    for (uint32_t x = 1; x < 150; x++)
        assert_memory_equal(s.shown + (5 * 150 + x) * 4, s.shown + 5 * 150 * 4, 4);
    close_scene(&s);
}

static void resize_shows_the_new_picture(void **unused)
{
    (void)unused;
    scene s;
    OPEN_OR_SKIP(&s, 64, 48, 64, 48);
    s.state.follows_window = true;
    draw(&s);
    assert_true(s.platform->ops->resize(s.platform, 100, 30, &s.diags));
    assert_true(vw_state_resize(&s.state, 100, 30) & VW_DIRTY_CAMERA);
    free(s.shown);
    s.shown = malloc(100 * 30 * 4);
    draw(&s); /* The old texture, scaled: only must not fail. */
    free(s.picture);
    s.picture = malloc(100 * 30 * 4);
    fill(s.picture, 100 * 30, 5);
    vw_view_upload(s.view, s.picture, 100, 30);
    draw(&s);
    assert_memory_equal(s.shown, s.picture, 100 * 30 * 4);
    close_scene(&s);
}

static size_t count_changed(const scene *s, double x0, double y0, double x1, double y1,
                            size_t *out_outside)
{
    size_t inside = 0;
    *out_outside = 0;
    for (uint32_t y = 0; y < s->state.height; y++) {
        for (uint32_t x = 0; x < s->state.width; x++) {
            size_t at = ((size_t)y * s->state.width + x) * 4;
            bool is_inside = x >= x0 && x < x1 && y >= y0 && y < y1;
            bool is_changed = memcmp(s->shown + at, s->picture + at, 4) != 0;
            inside += is_changed && is_inside;
            *out_outside += is_changed && !is_inside;
        }
    }
    return inside;
}

/* Twice the density in twice as many pixels: the same layout, twice as large but for whole pixels
 * of letters. */
static void a_dense_screen_has_larger_text(void **unused)
{
    (void)unused;
    double box[2][4];
    for (uint32_t i = 0; i < 2; i++) {
        scene s;
        OPEN_OR_SKIP(&s, 900u << i, 700u << i, 900u << i, 700u << i);
        vw_event event = {.kind = VW_EVENT_SCALE, .x = 1.0 + i};
        vw_input input = {0};
        assert_int_equal(vw_input_event(&input, &s.state, &event, 0), VW_DIRTY_WINDOW);
        s.state.help_page = 1;
        draw(&s);
        assert_true(vw_view_help_box(s.view, &box[i][0], &box[i][1], &box[i][2], &box[i][3]));
        close_scene(&s);
    }
    for (int k = 0; k < 4; k++)
        assert_true(fabs(box[1][k] - 2.0 * box[0][k]) <= 0.08 * box[1][2]);
}

static void help_draws_in_its_panel_only(void **unused)
{
    (void)unused;
    static const uint32_t sizes[][2] = {
        {640, 640}, {1280, 720}, {320, 240}, {1920, 400}, {640, 300}};
    for (size_t i = 0; i < FL_COUNT_OF(sizes); i++) {
        scene s;
        OPEN_OR_SKIP(&s, sizes[i][0], sizes[i][1], sizes[i][0], sizes[i][1]);
        s.state.help_page = 1;
        draw(&s);
        double x, y, width, height;
        assert_true(vw_view_help_box(s.view, &x, &y, &width, &height));
        bool fits = x + width <= sizes[i][0] && y + height <= sizes[i][1];
        assert_true(fits || i == 2);
        size_t outside, inside = count_changed(&s, x, y, x + width, y + height, &outside);
        assert_int_equal(outside, 0);
        s.state.help_page = VW_HELP_PAGES;
        draw(&s);
        assert_true(vw_view_help_box(s.view, &x, &y, &width, &height));
        assert_true((x + width <= sizes[i][0] && y + height <= sizes[i][1]) || i == 2);
        assert_true((double)inside >
                    0.5 * fl_min(width, sizes[i][0]) * fl_min(height, sizes[i][1]));
        s.state.help_page = 0;
        draw(&s);
        assert_false(vw_view_help_box(s.view, &x, &y, &width, &height));
        assert_memory_equal(s.shown, s.picture, (size_t)sizes[i][0] * sizes[i][1] * 4);
        close_scene(&s);
    }
}

static void status_line_and_error_keep_to_the_edges(void **unused)
{
    (void)unused;
    scene s;
    OPEN_OR_SKIP(&s, 640, 480, 640, 480);
    s.state.is_hud_shown = true;
    draw(&s);
    size_t outside, inside = count_changed(&s, 0, 400, 640, 480, &outside);
    assert_true(inside > 1000);
    assert_int_equal(outside, 0);
    s.state.is_hud_shown = false;
    const char *error = "a.scene:1:2: error: unknown key 'x'\n    1 | x\n      | ^";
    assert_true(vw_view_draw(s.view, &s.state, &s.progress, &(vw_texts){.error = error}, &s.diags));
    assert_true(vw_view_read(s.view, s.shown));
    inside = count_changed(&s, 0, 0, 640, 100, &outside);
    assert_true(inside > 1000);
    assert_int_equal(outside, 0);
    close_scene(&s);
}

/* Messages go on in the next row; what quotes a file is cut, so that the mark stays below it. */
static void long_errors_are_read_in_narrow_windows(void **unused)
{
    (void)unused;
    static const char *const texts[] = {
        "a.scene:1:2: error: unknown key 'radios' in 'Sphere'; did you mean 'radius'?\n"
        "   37 |     Sphere { center -1.1 0.7 0.4 radios 0.7 }\n"
        "abcdefghijklmnopqrstuvwxyz-abcdefghijklmnopqrstuvwxyz",
        "a.scene:1:2: error: unknown key\n'radios' in 'Sphere'; did you\nmean 'radius'?\n"
        "   37 |     Sphere { center -1.1 \nabcdefghijklmnopqrstuvwxyz-abcdef\n"
        "ghijklmnopqrstuvwxyz"};
    scene s;
    OPEN_OR_SKIP(&s, 300, 200, 300, 200);
    size_t bytes = (size_t)300 * 200 * 4;
    uint8_t *first = malloc(bytes);
    assert_non_null(first);
    for (int i = 0; i < 2; i++) {
        assert_true(
            vw_view_draw(s.view, &s.state, &s.progress, &(vw_texts){.error = texts[i]}, &s.diags));
        assert_true(vw_view_read(s.view, i ? s.shown : first));
    }
    assert_memory_equal(first, s.shown, bytes);
    free(first);
    close_scene(&s);
}

static void tiny_windows_and_odd_text_are_survived(void **unused)
{
    (void)unused;
    scene s;
    OPEN_OR_SKIP(&s, 1, 1, 1, 1);
    s.state.help_page = 1;
    s.state.is_hud_shown = true;
    vw_state_say(&s.state, "%s", "\xff\xc3 \xf0\x9f\x99\x82 \xe2\x88");
    assert_true(vw_view_draw(s.view, &s.state, &s.progress,
                             &(vw_texts){.notes = "a\n", .error = "\n\n\xff\n"}, &s.diags));
    s.state.help_page = 0;
    assert_true(vw_view_draw(s.view, &s.state, &s.progress, &(vw_texts){.notes = "\n", .error = ""},
                             &s.diags));
    close_scene(&s);
}

static void a_broken_shader_is_an_error(void **unused)
{
    (void)unused;
    vw_window_desc desc = {.title = "test", .width = 16, .height = 16};
    fl_diags diags = {0};
    vw_platform *platform = vw_platform_create(platform_name, false, &desc, &diags);
    if (!platform) {
        fl_diags_deinit(&diags);
        skip();
    }
    assert_null(vw_view_create(platform, "/nonexistent", &diags));
    assert_true(diags.error_count > 0);
    fl_diags_deinit(&diags);
    vw_view *view = vw_view_create(platform, FL_SOURCE_DIR "/shaders", &diags);
    assert_non_null(view);
    vw_view_destroy(view);
    platform->ops->destroy(platform);
}

static void unknown_platform_is_named(void **unused)
{
    (void)unused;
    vw_window_desc desc = {.title = "test", .width = 16, .height = 16};
    fl_diags diags = {0};
    assert_null(vw_platform_create("osmeza", false, &desc, &diags));
    assert_non_null(strstr(diags.items[0].message, "did you mean 'osmesa'?"));
    fl_diags_deinit(&diags);
}

static void waiting_ends_by_wake_or_time(void **unused)
{
    (void)unused;
    vw_window_desc desc = {.title = "test", .width = 16, .height = 16};
    fl_diags diags = {0};
    vw_platform *platform = vw_platform_create(platform_name, false, &desc, &diags);
    if (!platform) {
        fl_diags_deinit(&diags);
        skip();
    }
    platform->ops->wake(platform);
    platform->ops->pump(platform, -1.0);
    platform->ops->pump(platform, 0.001);
    platform->ops->set_clipboard(platform, "words");
    assert_string_equal(platform->ops->clipboard(platform), "words");
    platform->ops->destroy(platform);
}

int main(int argc, char **argv)
{
    platform_name = argc > 1 ? argv[1] : "osmesa";
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_arrive_unchanged),
        cmocka_unit_test(a_smaller_picture_is_scaled_by_whole_pixels),
        cmocka_unit_test(resize_shows_the_new_picture),
        cmocka_unit_test(a_dense_screen_has_larger_text),
        cmocka_unit_test(help_draws_in_its_panel_only),
        cmocka_unit_test(status_line_and_error_keep_to_the_edges),
        cmocka_unit_test(long_errors_are_read_in_narrow_windows),
        cmocka_unit_test(tiny_windows_and_odd_text_are_survived),
        cmocka_unit_test(a_broken_shader_is_an_error),
        cmocka_unit_test(unknown_platform_is_named),
        cmocka_unit_test(waiting_ends_by_wake_or_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
