/* SPDX-License-Identifier: MIT
 *
 * Lights are edited: the preview is the sum that it claims to be, what follows is the picture of a
 * scene with such lights, and nothing of it gets lost.
 */
#include "viewer_kit.h"

#include "io/image_file.h"
#include "io/state_text.h"

static const char camera[] =
    "PerspectiveCamera { center 0 1.4 6 direction 0 -0.15 -1 up 0 1 0 angle 36 width 96 height 64\n"
    "                    aperture 0.08 focus 6 }\n";
static const char rest[] =
    "Background { color 0.35 0.45 0.6 ambientLight 0.1 0.1 0.12 }\n"
    "Materials { numMaterials 2 Material { diffuseColor 0.7 0.7 0.68 }\n"
    "            Material { diffuseColor 0.05 0.05 0.06 specularColor 0.8 0.8 0.8 shininess 90\n"
    "                       reflect 0.7 } }\n"
    "Group { numObjects 2 MaterialIndex 0 Square { corner -8 0 6 u 16 0 0 v 0 0 -16 }\n"
    "        MaterialIndex 1 Sphere { center -0.4 0.9 0 radius 0.9 } }\n";

static void write_scene(const char *name, const char *second_color, char out_path[256])
{
    char text[4096];
    snprintf(text, sizeof text,
             "firstlight 1\n%sLights { numLights 2\n"
             "DirectionalLight { direction 1 -2 -1 color 0.3 0.3 0.2 }\n"
             "PointLight { position 3 5 4 color %s falloff 0.05 } }\n%s",
             camera, second_color, rest);
    write_file(name, text, out_path);
}

static void bring_to(vw_session *session, uint32_t samples)
{
    fl_diags diags = {0};
    session->exact_samples = samples;
    vw_session_set_limits(session);
    assert_true(vw_session_restart(session, &diags));
    assert_true(fl_render_wait(session->render, -1.0));
    if (session->mix.unit)
        assert_true(fl_render_wait(session->mix.unit, -1.0));
}

static void hash_of(const vw_session *session, char out[FL_SHA256_HEX + 1])
{
    static float rgb[96 * 64 * 3];
    fl_progress progress;
    assert_true(fl_render_mean(session->render, rgb, FL_COUNT_OF(rgb), &progress));
    fl_digest_sha256(rgb, sizeof rgb, out);
}

static void the_preview_is_the_picture(void **unused)
{
    (void)unused;
    char path[256];
    write_scene("preview.txt", "2 1 0.5", path);
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_Y, 0, 10);
    assert_int_equal(session.state.light, 1);
    assert_string_equal(session.state.message, "light 2/2, line 6: 2 1 0.5");
    /* Twice brighter: four steps. The first needs two new pictures, the others none. */
    assert_true(tap(&session, GLFW_KEY_UP, 0, 20) & VW_DIRTY_CAMERA);
    assert_true(session.state.is_mixing);
    bring_to(&session, 8);
    for (uint64_t i = 0; i < 3; i++) {
        vw_dirty dirty = tap(&session, GLFW_KEY_UP, 0, 30 + i);
        assert_true(dirty & VW_DIRTY_TONEMAP);
        assert_false(dirty & VW_DIRTY_CAMERA);
    }
    char notes[256];
    vw_session_notes(&session, notes, sizeof notes);
    assert_string_equal(notes, "preview of light 2");
    assert_true(vw_session_refresh(&session, &diags));
    enum { BYTES = 96 * 64 * 4 };
    static uint8_t preview[BYTES];
    memcpy(preview, vw_session_shown(&session), BYTES);
    assert_true(tap(&session, GLFW_KEY_V, 0, 60) != VW_DIRTY_NONE); /* A preview is not pinned. */
    assert_null(session.show.pin.rgb);
    /* The hand rests: one restart, of the whole. */
    vw_event nothing = {.kind = VW_EVENT_CURSOR, .x = 1.0};
    assert_true(send(&session, &nothing, 60 + VW_MIX_MS) & VW_DIRTY_CAMERA);
    assert_false(session.state.is_mixing);
    bring_to(&session, 8);
    assert_null(session.mix.unit);
    assert_true(vw_session_refresh(&session, &diags));
    const uint8_t *shown = vw_session_shown(&session);
    uint32_t differing = 0;
    for (int i = 0; i < BYTES; i++) {
        assert_in_range(shown[i] + 1 - preview[i], 0, 2);
        differing += shown[i] != preview[i];
    }
    assert_true(differing < BYTES / 50);
    vw_session_close(&session);
}

static void an_edited_light_is_that_of_a_scene_with_it(void **unused)
{
    (void)unused;
    char path[256], other[256], edited[FL_SHA256_HEX + 1], written[FL_SHA256_HEX + 1];
    write_scene("edited.txt", "2 1 0.5", path);
    write_scene("other.txt", "0 0 0", other);
    vw_options options = viewer_test_options();
    vw_session session;
    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_Y, 0, 10);
    tap(&session, GLFW_KEY_U, 0, 20);
    assert_true(vw_session_end_mix(&session));
    bring_to(&session, 3);
    hash_of(&session, edited);
    /* On again, it is what it was; and undo walks back through all of it. */
    vw_look before = session.state.look;
    tap(&session, GLFW_KEY_U, 0, 2000);
    assert_true(vw_lights_are_same(&session.state.look, &session.state.start));
    tap(&session, GLFW_KEY_Z, GLFW_MOD_CONTROL, 4000);
    assert_true(vw_lights_are_same(&session.state.look, &before));
    tap(&session, GLFW_KEY_R, 0, 6000);
    assert_true(vw_lights_are_same(&session.state.look, &session.state.start));
    vw_session_close(&session);
    open_session(&session, &options, other);
    bring_to(&session, 3);
    hash_of(&session, written);
    assert_string_equal(edited, written);
    vw_session_close(&session);
}

static void edit_all(vw_session *session)
{
    tap(session, GLFW_KEY_RIGHT, 0, 10);
    tap(session, GLFW_KEY_LEFT, GLFW_MOD_SHIFT, 20);
    tap(session, GLFW_KEY_Y, 0, 30);
    tap(session, GLFW_KEY_DOWN, 0, 40);
    tap(session, GLFW_KEY_UP, GLFW_MOD_SHIFT, 50);
    tap(session, GLFW_KEY_UP, GLFW_MOD_SHIFT | GLFW_MOD_CONTROL, 60);
    vw_session_end_mix(session);
    assert_false(vw_lights_are_same(&session->state.look, &session->state.start));
}

static void lights_are_kept(void **unused)
{
    (void)unused;
    char path[256], picture[256], before[FL_SHA256_HEX + 1], after[FL_SHA256_HEX + 1];
    write_scene("kept.txt", "2 1 0.5", path);
    path_in_folder("kept.png", picture);
    vw_options options = viewer_test_options();
    vw_session session;
    fl_diags diags = {0};
    fl_progress progress;
    open_session(&session, &options, path);
    edit_all(&session);
    bring_to(&session, 3);
    hash_of(&session, before);
    float *rgb = vw_session_mean(&session, &progress, &diags);
    assert_true(vw_session_save(&session, picture, rgb, &progress, &diags));
    free(rgb);
    tap(&session, GLFW_KEY_4, GLFW_MOD_CONTROL, 100);
    char copy[2 * FL_STATE_TEXT_MAX + FL_LIGHT_TEXT_MAX];
    assert_true(vw_session_copy(&session, copy, sizeof copy) < sizeof copy);
    vw_look want = session.state.look;
    vw_session_close(&session);

    open_session(&session, &options, picture); /* The picture opens with its lights. */
    bring_to(&session, 3);
    hash_of(&session, after);
    assert_string_equal(before, after);
    vw_session_close(&session);

    open_session(&session, &options, path);
    tap(&session, GLFW_KEY_4, 0, 100);
    assert_true(vw_lights_are_same(&session.state.look, &want));
    bring_to(&session, 3);
    hash_of(&session, after);
    assert_string_equal(before, after);
    tap(&session, GLFW_KEY_R, 0, 200);
    for (char *c = copy; *c; c++) /* As the clipboard comes: one line, without comments. */
        if (*c == '\n')
            *c = ' ';
    assert_true(vw_session_paste(&session, strstr(copy, "PerspectiveCamera")) & VW_DIRTY_CAMERA);
    for (uint32_t i = 0; i < 2; i++) { /* Directions are made unit vectors when they are read. */
        const fl_light *a = &session.state.look.lights[i], *b = &want.lights[i];
        assert_true(fl_v3_length(fl_v3_sub(a->color, b->color)) == 0.0 &&
                    fl_v3_length(fl_v3_sub(a->position, b->position)) == 0.0 &&
                    fl_v3_length(fl_v3_sub(a->direction, b->direction)) < 1e-15);
    }
    vw_session_close(&session);
}

static void texts_of_other_lights_change_nothing(void **unused)
{
    (void)unused;
    fl_light lights[2] = {{.kind = FL_LIGHT_POINT, .color = {1, 2, 3}},
                          {.kind = FL_LIGHT_DISK, .direction = {0, -1, 0}, .radius = 0.1}};
    char text[FL_LIGHT_TEXT_MAX];
    fl_light read[2];
    memcpy(read, lights, sizeof read);
    fl_lights_text(lights, 2, text);
    read[0].color.x = read[1].radius = 7.0;
    assert_true(fl_lights_read(text, read, 2));
    assert_memory_equal(read, lights, sizeof read);
    static const char *const wrong[] = {"",
                                        "x",
                                        "1 0 0 0 0 0 0 0 1 1 1",
                                        "2 0 0 0",
                                        "2 0 0 0 0 0 0 0 1 1 1  0 0 0 0 3 0 0 1 1 1",
                                        "2 0 0 0 0 0 0 0 1 1 1  0 0 0 0 1 0 -1 1 1 1",
                                        "2 0 0 0 0 0 0 0 1 inf 1  0 0 0 0 1 0 0 1 1 1"};
    for (size_t i = 0; i < FL_COUNT_OF(wrong); i++) {
        assert_false(fl_lights_read(wrong[i], read, 2));
        assert_memory_equal(read, lights, sizeof read);
    }
}

static int finish(void **unused)
{
    (void)unused;
    static const char *const names[] = {"preview.txt", "edited.txt", "other.txt",
                                        "kept.txt",    "kept.png",   "kept.txt.views"};
    return remove_files(names, FL_COUNT_OF(names));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_preview_is_the_picture),
        cmocka_unit_test(an_edited_light_is_that_of_a_scene_with_it),
        cmocka_unit_test(lights_are_kept),
        cmocka_unit_test(texts_of_other_lights_change_nothing),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
