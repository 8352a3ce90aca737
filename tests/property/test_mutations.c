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
#include "support/property.h"
#include "support/scene_dump.h"

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
    "  Noise { color 0 0 0 color 1 1 1 octaves 1 frequency 1 amplitude 1 } } }\n",
    "firstlight 1 PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n"
    "Materials { Material { diffuseColor 1 0 0 ambient 0 1 0 shininess 4 specularColor 1 1 1\n"
    "  refract .5 refractionIndex 2 texture a textureScale 2 3 filter nearest }\n"
    "  Noise { materialIndex 0 octaves 3 } }\n"
    "Group { MaterialIndex 1 Square { corner 0 0 0 u 1 0 0 v 0 1 0 } }\n"};

static uint32_t draw(property *p, uint32_t below)
{
    return (uint32_t)property_below(p, below);
}

static const char *any_word(property *p)
{
    static const char *const words[] = {
        "{",   "}",      "[",  "]",       "#",      "0",          "-1",  "1e999", "nan",
        "inf", "1e-320", "\n", "missing", "broken", "3000000000", "0.5", "\xff",  "firstlight"};
    if (draw(p, 2))
        return words[draw(p, FL_COUNT_OF(words))];
    const fl_block *block = &fl_grammar_blocks[draw(p, fl_grammar_block_count)];
    return block->key_count && draw(p, 2) ? block->keys[draw(p, block->key_count)].name
                                          : block->name;
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

static void mutate(property *p, char *text, size_t *bytes)
{
    char piece[64];
    property_mark(p);
    size_t at = draw(p, (uint32_t)*bytes + 1), rest = *bytes - at;
    size_t cut = draw(p, (uint32_t)(rest < 40 ? rest + 1 : 40));
    switch (draw(p, 5)) {
    case 0: /* a byte becomes another */
        if (rest > 0)
            text[at] = (char)draw(p, 256);
        break;
    case 1:
        splice(text, bytes, at, cut, "", 0);
        break;
    case 2: /* a piece is doubled elsewhere */
        memcpy(piece, text + at, cut);
        splice(text, bytes, draw(p, (uint32_t)*bytes + 1), 0, piece, cut);
        break;
    default: { /* a word is put between others, or in place of one */
        while (at > 0 && at < *bytes && text[at] != ' ')
            at--;
        size_t word = 0;
        while (draw(p, 2) && at + 1 + word < *bytes && text[at + 1 + word] != ' ')
            word = strcspn(text + at + 1, " ");
        int length = snprintf(piece, sizeof piece, " %s", any_word(p));
        splice(text, bytes, at, word && at + 1 + word <= *bytes ? word + 1 : 0, piece,
               (size_t)length);
    }
    }
    text[*bytes] = '\0';
}

/* Every diagnostic has a place in the text and can be printed. */
static bool is_located(const fl_diags *diags, size_t bytes)
{
    bool is_good = diags->error_count > 0 && diags->count <= FL_DIAGS_MAX;
    for (uint32_t i = 0; is_good && i < diags->count; i++) {
        char out[2048];
        is_good = diags->items[i].loc.line <= bytes + 1 &&
                  diags->items[i].loc.column <= bytes + 1 &&
                  fl_diag_format(&diags->items[i], out, sizeof out) > 0;
    }
    return is_good;
}

/* What a scene means, after our own format has said it. */
static bool survives(property *p, fl_scene *scene, const char *text, size_t bytes,
                     const fl_parse_options *options, const fl_files *files, fl_diags *diags)
{
    fl_parse_options strict = {0};
    size_t ours_bytes = 0;
    char *ours = fl_scene_format(text, bytes, "m", options, &ours_bytes, diags);
    fl_scene *back = ours ? fl_scene_parse(ours, ours_bytes, "m", &strict, files, diags) : NULL;
    char *want = scene_dump(scene), *got = back ? scene_dump(back) : NULL;
    bool is_same = got && strcmp(got, want) == 0;
    free(want);
    free(got);
    free(ours);
    fl_scene_destroy(back);
    return is_same || property_fail(p, "does not survive formatting:\n%.*s", (int)bytes, text);
}

/* Parse exactly `bytes` bytes; counts a scene, which then survives formatting. */
static bool check(property *p, const char *text, size_t bytes, const fl_parse_options *options,
                  unsigned *scene_count)
{
    char *exact = malloc(bytes + 1); /* so that a sanitizer sees a read beyond the end */
    assert_non_null(exact);
    memcpy(exact, text, bytes);
    fake_files fake;
    fake_files_init(&fake);
    fl_diags diags = {0};
    fl_scene *scene = fl_scene_parse(exact, bytes, "m", options, &fake.files, &diags);
    bool holds = scene ? survives(p, scene, exact, bytes, options, &fake.files, &diags)
                       : is_located(&diags, bytes) ||
                             property_fail(p, "errors without a place:\n%.*s", (int)bytes, text);
    *scene_count += scene != NULL;
    fl_scene_destroy(scene);
    fl_diags_deinit(&diags);
    free(exact);
    return holds;
}

static bool mutations_are_scenes_or_errors(property *p, void *data)
{
    char text[TEXT_BYTES];
    size_t bytes = strlen(strcpy(text, seeds[draw(p, FL_COUNT_OF(seeds))]));
    fl_parse_options options = {.is_lenient = draw(p, 2), .has_dialect = draw(p, 4) == 3};
    options.dialect = (fl_dialect)draw(p, FL_DIALECT_COUNT);
    for (uint32_t i = draw(p, 5); i > 0; i--)
        mutate(p, text, &bytes);
    return check(p, text, bytes, &options, data);
}

static void test_mutations(void **state)
{
    (void)state;
    unsigned scenes = 0;
    static const uint64_t stand_in[] = {4, 0, 1}; /* when its filter was lost */
    const property_case kept[] = {PROPERTY_CASE(stand_in)};
    property_run(mutations_are_scenes_or_errors, &scenes, 20240, ROUNDS, kept, FL_COUNT_OF(kept));
    print_message("%u of them scenes\n", scenes);
    assert_true(scenes > ROUNDS / 10 && scenes < ROUNDS);
}

/* Every beginning of every seed; nothing is drawn. */
static bool beginnings_are_scenes_or_errors(property *p, void *data)
{
    (void)data;
    unsigned scenes = 0;
    for (size_t i = 0; i < FL_COUNT_OF(seeds); i++)
        for (size_t bytes = 0; bytes <= strlen(seeds[i]); bytes++)
            if (!check(p, seeds[i], bytes, &(fl_parse_options){.is_lenient = bytes & 1}, &scenes))
                return false;
    return true;
}

static void test_truncations(void **state)
{
    (void)state;
    property_run(beginnings_are_scenes_or_errors, NULL, 0, 1, NULL, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_mutations),
                                       cmocka_unit_test(test_truncations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
