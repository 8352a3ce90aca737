/* SPDX-License-Identifier: MIT
 *
 * The grammar table as text: for a terminal, and as the page docs/scene-format.md.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/grammar.h"
#include "core/number.h"

enum { PIECE_BYTES = 256 };

typedef struct writer {
    fl_write_fn *write;
    void *context;
    bool is_markdown;
} writer;

static void put(const writer *w, const char *text)
{
    w->write(w->context, text, strlen(text));
}

/* Several pieces, up to a NULL. */
#define PUT(w, ...) put_all(w, (const char *const[]){__VA_ARGS__, NULL})
static void put_all(const writer *w, const char *const *pieces)
{
    for (; *pieces; pieces++)
        put(w, *pieces);
}

/* How the values of a key are written. */
static void describe_values(const fl_key *key, char out[PIECE_BYTES])
{
    static const char *const numbers[] = {"", "number", "2 numbers", "3 numbers", "4 numbers"};
    switch (key->kind) {
    case FL_VALUE_NUMBERS:
        snprintf(out, PIECE_BYTES, "%s", numbers[key->count]);
        break;
    case FL_VALUE_BRACED:
        snprintf(out, PIECE_BYTES, "{ %d numbers }", key->count);
        break;
    case FL_VALUE_COLOR:
        snprintf(out, PIECE_BYTES, "3 numbers or 1");
        break;
    case FL_VALUE_INTEGER:
        snprintf(out, PIECE_BYTES, "whole number");
        break;
    case FL_VALUE_PATH:
        snprintf(out, PIECE_BYTES, "file");
        break;
    case FL_VALUE_CHOICE:
        snprintf(out, PIECE_BYTES, "%s", key->choices);
        break;
    case FL_VALUE_POINTS:
        snprintf(out, PIECE_BYTES, "[ x y z ] ...");
        break;
    case FL_VALUE_NOTHING:
        snprintf(out, PIECE_BYTES, "a curve");
        break;
    }
}

static void describe_range(const fl_key *key, char out[PIECE_BYTES])
{
    char lo[32], hi[32];
    fl_number_format(key->lo, lo);
    fl_number_format(key->hi, hi);
    bool has_numbers =
        key->kind != FL_VALUE_PATH && key->kind != FL_VALUE_CHOICE && key->kind != FL_VALUE_NOTHING;
    out[0] = '\0';
    if (!has_numbers || key->lo == -HUGE_VAL)
        return;
    if (key->hi < HUGE_VAL)
        snprintf(out, PIECE_BYTES, "%s to %s", lo, hi);
    else
        snprintf(out, PIECE_BYTES, "%s %s%s", key->flags & FL_KEY_ABOVE_LO ? "above" : "at least",
                 lo, key->flags & FL_KEY_TAKES_INF ? ", or inf" : "");
}

/* "pa1 m04", or nothing for all dialects. */
static void describe_dialects(uint32_t dialects, char out[PIECE_BYTES])
{
    size_t bytes = 0;
    out[0] = '\0';
    for (int d = 0; d < FL_DIALECT_COUNT && dialects != FL_IN_ALL; d++)
        if (dialects & (1u << d))
            bytes += (size_t)snprintf(out + bytes, PIECE_BYTES - bytes, "%s%s", bytes ? " " : "",
                                      fl_dialect_names[d]);
}

static void put_key(const writer *w, const fl_block *block, const fl_key *key)
{
    char values[PIECE_BYTES], range[PIECE_BYTES], dialects[PIECE_BYTES];
    describe_values(key, values);
    describe_range(key, range);
    bool is_everywhere = (key->dialects & block->dialects) == block->dialects;
    describe_dialects(is_everywhere ? FL_IN_ALL : key->dialects, dialects);
    const char *standard = key->flags & FL_KEY_REQUIRED ? "required" : key->standard;
    if (w->is_markdown) {
        PUT(w, "| `", key->name, "` | ", values, " | ", range, " | ", key->unit, " | ");
        PUT(w, standard ? standard : "", " | ", dialects, " | ", key->help, " |\n");
        return;
    }
    PUT(w, "    ", key->name, "  <", values, ">");
    if (range[0])
        PUT(w, "  ", range);
    if (key->unit[0])
        PUT(w, "  ", key->unit);
    if (standard)
        PUT(w, "  ", key->flags & FL_KEY_REQUIRED ? "(" : "(default ", standard, ")");
    if (dialects[0])
        PUT(w, "  [", dialects, "]");
    PUT(w, "\n        ", key->help, "\n");
}

/* "In the scene itself, Group or Transform." */
static void put_parents(const writer *w, const fl_block *block)
{
    bool is_first = true;
    for (uint32_t i = 0; i < fl_grammar_block_count; i++) {
        const fl_block *parent = &fl_grammar_blocks[i];
        bool is_repeated = i > 0 && fl_grammar_blocks[i - 1].keys == parent->keys && parent->keys;
        if (!(block->parents & (1u << parent->id)) || is_repeated)
            continue;
        put(w, is_first ? "stands in " : ", ");
        put(w, parent->id == FL_BLOCK_TOP ? "the text itself" : parent->name);
        is_first = false;
    }
}

static void put_block(const writer *w, const fl_block *block)
{
    char dialects[PIECE_BYTES];
    describe_dialects(block->dialects, dialects);
    PUT(w, w->is_markdown ? "\n### " : "\n", block->name, block->is_named ? " NAME" : "");
    PUT(w, w->is_markdown ? "\n\n" : ": ", block->help, "; ");
    put_parents(w, block);
    if (dialects[0])
        PUT(w, " [", dialects, "]");
    put(w, w->is_markdown ? ".\n" : "\n");
    bool is_alias = block > fl_grammar_blocks && block->keys && block->keys == block[-1].keys;
    if (is_alias || block->key_count == 0)
        return;
    if (w->is_markdown)
        put(w, "\n| key | values | range | unit | default | dialects | meaning |\n"
               "|---|---|---|---|---|---|---|\n");
    for (uint32_t i = 0; i < block->key_count; i++)
        put_key(w, block, &block->keys[i]);
}

static void put_limits(const writer *w)
{
    char text[PIECE_BYTES * 2];
    snprintf(
        text, sizeof text,
        "Limits: %d bytes of text, %d bytes a word, %d open braces, %d objects with groups and "
        "transforms, %d lights,\n%d materials, %d views, %d control points a curve, degree %d of "
        "one "
        "Bezier curve, %d different meshes and %d pictures,\n%d triangles a mesh; %ju bytes of "
        "memory for meshes and pictures together.\n",
        FL_TEXT_BYTES_MAX, FL_WORD_BYTES_MAX, FL_NESTING_MAX, FL_OBJECTS_MAX, FL_LIGHTS_MAX,
        FL_MATERIALS_MAX, FL_VIEWS_MAX, FL_CONTROLS_MAX, FL_DEGREE_MAX, FL_FILES_MAX, FL_FILES_MAX,
        FL_FACES_MAX, (uintmax_t)FL_SCENE_MEMORY_LIMIT);
    put(w, text);
}

static void put_blocks(const writer *w)
{
    for (uint32_t i = 1; i < fl_grammar_block_count; i++)
        put_block(w, &fl_grammar_blocks[i]);
}

void fl_grammar_write_help(fl_write_fn *write, void *context)
{
    const writer w = {.write = write, .context = context};
    put(&w,
        "A scene is blocks `Name { ... }` of keys and values, in any order. `#` begins a comment.\n"
        "The first line `firstlight 1` says that the text is of this dialect; [names] in brackets "
        "say which\n"
        "dialects have a block or key, where not all do: firstlight, pa1, m04, m12.\n\n");
    put_limits(&w);
    put_blocks(&w);
}

static const char introduction[] =
    "# Scene text\n\n"
    "This page is written by `firstlight help scene-markdown` from the table that the parser "
    "reads\n"
    "(`src/core/grammar.c`); do not edit it.\n\n"
    "## Words\n\n"
    "A scene is blocks `Name { ... }` of keys and their values. Words are separated by white space "
    "or by\n"
    "`{ } [ ]`, so a number may touch a brace. `#` at the beginning of a word begins a comment, up "
    "to the end\n"
    "of the line. Keys of a block may stand in any order. Case matters. Numbers are decimal: "
    "`-.16`, `1.`,\n"
    "`1e-3`; `inf` is a value of `focus` alone, `nan` of nothing. File names hold no white space "
    "and are looked\n"
    "for as given, then in the folder of the scene, then in the folders above it.\n\n";

static const char semantics[] =
    "\n## Meaning\n\n"
    "- Colours are linear RGB. Angles are degrees, full angles for cameras; rotations are "
    "counter-clockwise\n"
    "  seen from the tip of the axis, in right-handed coordinates.\n"
    "- `MaterialIndex` holds for every object that follows, to the end of the text, whatever the "
    "groups. An\n"
    "  object before the first one is plain white.\n"
    "- Transforms are multiplied from left to right: the one written last is applied first. A "
    "matrix is\n"
    "  multiplied from the left of all before it, and written column after column.\n"
    "- A plane is `normal . p = offset` with the normal as written, of any length.\n"
    "- A `BezierCurve` of n points is one curve of degree n-1, or with `piecewise 1` cubics end to "
    "end. A\n"
    "  `BsplineCurve` is uniform and cubic: span j runs over the points j to j+3.\n"
    "- A texture multiplies the diffuse colour.\n\n"
    "## Dialects\n\n"
    "A text that begins with `firstlight 1` is of our dialect. Others are recognised by their "
    "words, or named\n"
    "with `--dialect`:\n\n"
    "| dialect | whose | recognised by | what is different |\n"
    "|---|---|---|---|\n"
    "| `firstlight` | ours | first line, or one of our additions and no size in the camera | an "
    "unknown or "
    "repeated key is an error |\n"
    "| `pa1` | Tsinghua, 2020 on, curves included | a camera with a size, or a curve | meshes are "
    "flat; "
    "Bezier curves have 3k+1 points; our additions are understood |\n"
    "| `m04` | MIT 6.837, 2004 | `exponent`, `reflectiveColor`, `OrthographicCamera` ... | meshes "
    "are flat; "
    "procedural materials are not supported |\n"
    "| `m12` | MIT 6.837, 2010 to 2016 | `shininess`, `cubeMap`, `falloff` ... without a size | "
    "`specularColor` reflects; a positive `refractionIndex` refracts, specularColor being divided "
    "by the "
    "Fresnel reflectance at normal incidence; `falloff k` is color / (k d^2) |\n\n"
    "A text that could be of both MIT courses is taken for the later one if it has a mesh or a "
    "cube map. In the\n"
    "course dialects the last of several equal keys or blocks counts, with a warning. In both MIT "
    "dialects a scene\n"
    "without lights has the ambient light 1 1 1.\n\n"
    "`--lenient` turns into warnings: unknown keys and blocks (skipped; an unknown material still "
    "takes a number),\n"
    "wrong counts, whole numbers with a fraction of zero, superfluous numbers, braces around the "
    "numbers of a\n"
    "transform, a byte order mark, curves of a length that the course forbids, procedural "
    "materials (their first\n"
    "material or colour stands in).\n\n";

void fl_grammar_write_markdown(fl_write_fn *write, void *context)
{
    const writer w = {.write = write, .context = context, .is_markdown = true};
    put(&w, introduction);
    put_limits(&w);
    put(&w, semantics);
    put(&w, "## Blocks and keys\n");
    put_blocks(&w);
}
