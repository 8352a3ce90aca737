/* SPDX-License-Identifier: MIT
 *
 * Texts that are almost scenes: bytes changed, words swapped, pieces cut out or doubled. Whatever
 * they are, parsing ends with a scene or with located errors, and what parses survives formatting.
 * Meant for sanitizers too.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/format.h"
#include "core/grammar.h"
#include "support/scene_dump.h"
#include "support/seed.h"

enum { TEXT_BYTES = 4096, ROUNDS = 20000 };

static const char *const seeds[] = {
    "firstlight 1\n"
    "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 aperture .1 focus inf }\n"
    "View a { center 0 0 10 direction 0 0 -1 up 0 1 0 size 30 }\n"
    "Render { samples 4 depth 3 weightThreshold 0.5 }\n"
    "Background { color 0.5 0.5 0.5 cubeMap sky } # comment\n"
    "Lights { numLights 2 PointLight { position 0 1 0 color 1 1 1 falloff 1 }\n"
    "  DiskLight { position 0 1 0 direction 0 -1 0 radius 1 color 1 1 1 samples 4 twoSided 1 } }\n"
    "Materials { numMaterials 1 Material { diffuseColor 1 0 0 reflect 1 texture a filter nearest } "
    "}\n"
    "Group { numObjects 3 MaterialIndex 0 Sphere { center 0 0 0 radius 1}\n"
    "  Transform { Rotate { 0 1 0 45 } Matrix4f { 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 }\n"
    "    RevSurface { profile BezierCurve { controls [ 1 0 0 ] [ 2 1 0 ] } texture v } }\n"
    "  RevSurface { profile BsplineCurve { controls [1 0 0] [1 1 0] [1 2 0] [1 3 0] [1 4 0] } } "
    "}\n",
    "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 width 9 height 9 }\n"
    "Group { numObjects 2 BezierCurve { controls [0 0 0] [0 1 0] [1 1 0] [1 2 0] }\n"
    "  Transform { Scale 1 2 3 Group { numObjects 1 TriangleMesh { obj_file m } } } }\n",
    "OrthographicCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 size 5 }\n"
    "Materials { numMaterials 2 PhongMaterial { exponent 3 reflectiveColor 1 1 1 }\n"
    "  Noise { Transform { Scale 1 1 1 } materialIndex 0 materialIndex 0 octaves 3 } }\n"
    "Group { numObjects 1 MaterialIndex 1 Triangle { vertex0 0 0 0 vertex1 1 0 0 vertex2 0 1 0 } "
    "}\n",
    "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }\n"
    "Lights { numLights 1 PointLight { position 0 0 1 color 1 1 1 falloff 2 } }\n"
    "Materials { numMaterials 1 Material { specularColor 1 1 1 refractionIndex 2 bump b\n"
    "  Noise { color 0 0 0 color 1 1 1 octaves 1 frequency 1 amplitude 1 } } }\n"};

static uint32_t random_state;

static uint32_t draw(uint32_t below)
{
    random_state = fl_hash_step(random_state, 77);
    return below ? random_state % below : 0;
}

static const char *any_word(void)
{
    static const char *const words[] = {
        "{",   "}",      "[",  "]",       "#",      "0",          "-1",  "1e999", "nan",
        "inf", "1e-320", "\n", "missing", "broken", "3000000000", "0.5", "\xff",  "firstlight"};
    if (draw(2))
        return words[draw(FL_COUNT_OF(words))];
    const fl_block *block = &fl_grammar_blocks[draw(fl_grammar_block_count)];
    return block->key_count && draw(2) ? block->keys[draw(block->key_count)].name : block->name;
}

/* Replace `cut` bytes at `at` by `piece`. */
static void splice(char *text, size_t *bytes, size_t at, size_t cut, const char *piece,
                   size_t piece_bytes)
{
    if (*bytes - cut + piece_bytes >= TEXT_BYTES)
        return;
    memmove(text + at + piece_bytes, text + at + cut, *bytes - at - cut);
    memcpy(text + at, piece, piece_bytes);
    *bytes += piece_bytes - cut;
}

static void mutate(char *text, size_t *bytes)
{
    char piece[64];
    size_t at = draw((uint32_t)*bytes + 1), rest = *bytes - at;
    size_t cut = draw((uint32_t)(rest < 40 ? rest + 1 : 40));
    switch (draw(5)) {
    case 0: /* a byte becomes another */
        if (rest > 0)
            text[at] = (char)draw(256);
        break;
    case 1:
        splice(text, bytes, at, cut, "", 0);
        break;
    case 2: /* a piece is doubled elsewhere */
        memcpy(piece, text + at, cut);
        splice(text, bytes, draw((uint32_t)*bytes + 1), 0, piece, cut);
        break;
    default: { /* a word is put between others, or in place of one */
        while (at > 0 && at < *bytes && text[at] != ' ')
            at--;
        size_t word = 0;
        while (draw(2) && at + 1 + word < *bytes && text[at + 1 + word] != ' ')
            word = strcspn(text + at + 1, " ");
        int length = snprintf(piece, sizeof piece, " %s", any_word());
        splice(text, bytes, at, word && at + 1 + word <= *bytes ? word + 1 : 0, piece,
               (size_t)length);
    }
    }
    text[*bytes] = '\0';
}

static void check_located(const fl_diags *diags, size_t bytes)
{
    assert_true(diags->error_count > 0 && diags->count <= FL_DIAGS_MAX);
    for (uint32_t i = 0; i < diags->count; i++) {
        char out[2048];
        assert_true(diags->items[i].loc.line <= bytes + 1 &&
                    diags->items[i].loc.column <= bytes + 1);
        assert_true(fl_diag_format(&diags->items[i], out, sizeof out) > 0);
    }
}

/* Parse exactly `bytes` bytes; true when there is a scene, which then survives formatting. */
static bool check(const char *text, size_t bytes, const fl_parse_options *options)
{
    char *exact = malloc(bytes + 1); /* so that a sanitizer sees a read beyond the end */
    assert_non_null(exact);
    memcpy(exact, text, bytes);
    fake_files fake;
    fake_files_init(&fake);
    fl_diags diags = {0};
    fl_scene *scene = fl_scene_parse(exact, bytes, "m", options, &fake.files, &diags);
    if (scene) {
        size_t ours_bytes = 0;
        char *ours = fl_scene_format(exact, bytes, "m", options, &ours_bytes, &diags);
        assert_non_null(ours);
        fl_parse_options strict = {0};
        fl_scene *back = fl_scene_parse(ours, ours_bytes, "m", &strict, &fake.files, &diags);
        assert_non_null(back);
        char *want = scene_dump(scene), *got = scene_dump(back);
        assert_string_equal(got, want);
        free(want);
        free(got);
        free(ours);
        fl_scene_destroy(back);
    } else {
        check_located(&diags, bytes);
    }
    bool is_scene = scene != NULL;
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(exact);
    return is_scene;
}

static void test_mutations(void **state)
{
    (void)state;
    random_state = test_seed(20240);
    unsigned scenes = 0;
    for (int round = 0; round < ROUNDS; round++) {
        char text[TEXT_BYTES];
        size_t bytes = strlen(strcpy(text, seeds[draw(FL_COUNT_OF(seeds))]));
        for (uint32_t i = draw(5); i > 0; i--)
            mutate(text, &bytes);
        fl_parse_options options = {.is_lenient = draw(2), .has_dialect = draw(4) == 0};
        options.dialect = (fl_dialect)draw(FL_DIALECT_COUNT);
        scenes += check(text, bytes, &options);
    }
    print_message("%u of them scenes\n", scenes);
    assert_true(scenes > ROUNDS / 10 && scenes < ROUNDS);
}

/* Every beginning of every seed. */
static void test_truncations(void **state)
{
    (void)state;
    for (size_t i = 0; i < FL_COUNT_OF(seeds); i++)
        for (size_t bytes = 0; bytes <= strlen(seeds[i]); bytes++)
            check(seeds[i], bytes, &(fl_parse_options){.is_lenient = bytes & 1});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mutations),
                                       cmocka_unit_test(test_truncations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
