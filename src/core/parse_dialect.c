/* SPDX-License-Identifier: MIT
 *
 * Which course a text comes from, by the words that only one of them has.
 */
#include "core/parse_tree.h"

#include <stdio.h>
#include <string.h>

typedef enum mark {
    MARK_SIZE,   /* width or height of a camera */
    MARK_CURVE,  /* PA2 */
    MARK_M04,    /* words of the 2004 course only */
    MARK_M12,    /* words of the 2010 to 2016 course only */
    MARK_OURS,   /* our additions */
    MARK_CAMERA, /* any camera */
    MARK_MESH,
    MARK_COUNT
} mark;

static const struct {
    const char *word;
    mark mark;
} marks[] = {{"width", MARK_SIZE},
             {"height", MARK_SIZE},
             {"RevSurface", MARK_CURVE},
             {"BezierCurve", MARK_CURVE},
             {"BsplineCurve", MARK_CURVE},
             {"OrthographicCamera", MARK_M04},
             {"exponent", MARK_M04},
             {"reflectiveColor", MARK_M04},
             {"transparentColor", MARK_M04},
             {"indexOfRefraction", MARK_M04},
             {"attenuation", MARK_M04},
             {"materialIndex", MARK_M04},
             {"Matrix", MARK_M04},
             {"shininess", MARK_M12},
             {"cubeMap", MARK_M12},
             {"falloff", MARK_M12},
             {"refractionIndex", MARK_M12},
             {"texture", MARK_M12},
             {"bump", MARK_M12},
             {"Matrix4f", MARK_M12},
             {"octaves", MARK_M12},
             {"View", MARK_OURS},
             {"Render", MARK_OURS},
             {"DiskLight", MARK_OURS},
             {"aperture", MARK_OURS},
             {"reflect", MARK_OURS},
             {"refract", MARK_OURS},
             {"Square", MARK_OURS},
             {"Disk", MARK_OURS},
             {"PerspectiveCamera", MARK_CAMERA},
             {"TriangleMesh", MARK_MESH}};

/* The first token of each mark, and how often it was seen. */
typedef struct evidence {
    fl_token first[MARK_COUNT];
    uint32_t count[MARK_COUNT];
} evidence;

static void collect(evidence *e, const char *text, size_t text_bytes)
{
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, text_bytes);
    for (fl_token token; (token = fl_lexer_next(&lexer)).kind != FL_TOKEN_END;) {
        if (token.kind != FL_TOKEN_WORD)
            continue;
        for (size_t i = 0; i < FL_COUNT_OF(marks); i++)
            if (fl_token_is(&token, marks[i].word) && e->count[marks[i].mark]++ == 0)
                e->first[marks[i].mark] = token;
    }
}

static bool begins_with_version(const char *text, size_t text_bytes)
{
    fl_lexer lexer;
    fl_lexer_init(&lexer, text, text_bytes);
    fl_token token = fl_lexer_next(&lexer);
    while (token.kind == FL_TOKEN_COMMENT)
        token = fl_lexer_next(&lexer);
    return fl_token_is(&token, "firstlight");
}

/* The dialect, and the mark that decided or MARK_COUNT. */
static fl_dialect decide(const evidence *e, mark *out_by, const char **out_plain_reason)
{
    *out_by = MARK_COUNT;
    if (e->count[MARK_SIZE])
        return *out_by = MARK_SIZE, FL_DIALECT_PA1;
    if (e->count[MARK_CURVE])
        return *out_by = MARK_CURVE, FL_DIALECT_PA1;
    if (e->count[MARK_OURS] && !e->count[MARK_M04])
        return *out_by = MARK_OURS, FL_DIALECT_FIRSTLIGHT;
    if (e->count[MARK_M04] > e->count[MARK_M12])
        return *out_by = MARK_M04, FL_DIALECT_M04;
    if (e->count[MARK_M12])
        return *out_by = MARK_M12, FL_DIALECT_M12;
    if (!e->count[MARK_CAMERA]) {
        *out_plain_reason = "it has no camera and no word of a course alone";
        return FL_DIALECT_FIRSTLIGHT;
    }
    *out_plain_reason =
        e->count[MARK_MESH]
            ? "its camera has no size, and it has a mesh; the 2004 course fits too"
            : "its camera has no size, and it has no mesh; the 2012 course fits too";
    return e->count[MARK_MESH] ? FL_DIALECT_M12 : FL_DIALECT_M04;
}

fl_dialect fl_dialect_recognise(const char *text, size_t text_bytes, fl_arena *arena,
                                const char **out_reason)
{
    *out_reason = "its first word is 'firstlight'";
    if (begins_with_version(text, text_bytes))
        return FL_DIALECT_FIRSTLIGHT;
    evidence e = {.count = {0}};
    collect(&e, text, text_bytes);
    mark by;
    fl_dialect dialect = decide(&e, &by, out_reason);
    if (by < MARK_COUNT) {
        char reason[128];
        int bytes = snprintf(reason, sizeof reason, "'%.*s' in line %u is a word of that dialect",
                             (int)e.first[by].bytes, e.first[by].text, (unsigned)e.first[by].line);
        *out_reason = fl_arena_text(arena, reason, (size_t)bytes);
    }
    return dialect;
}
