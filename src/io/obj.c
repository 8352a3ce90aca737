/* SPDX-License-Identifier: MIT */
#include "io/obj.h"

#include <stdlib.h>
#include <string.h>

#include "io/mesh_file.h"

/* A positive index beyond what had been read at its face: legal if the vertex comes later. Only the
 * largest of a kind is kept; if any is wrong, that one is. */
typedef struct forward_index {
    int64_t index;
    fl_loc loc;
} forward_index;

enum { POSITION, UV, NORMAL, KIND_COUNT };

static const char *const kind_names[KIND_COUNT] = {"vertex", "texture coordinate", "normal"};

typedef struct obj_reader {
    const char *at, *end, *line_start;
    uint32_t line;
    const char *name;
    fl_diags *diags;
    uint32_t error_count;
    fl_mesh *mesh;
    uint32_t position_room, normal_room, uv_room, face_room;
    forward_index forward[KIND_COUNT];
} obj_reader;

static fl_loc loc_at(const obj_reader *r, const char *at, size_t length)
{
    return (fl_loc){r->name, r->line, (uint32_t)(at - r->line_start) + 1, (uint32_t)length};
}

/* A word for messages: from `at` to the next blank, at most 40 bytes. */
static int word_bytes(const obj_reader *r, const char *at)
{
    int length = 0;
    while (at + length < r->end && length < 40 && (unsigned char)at[length] > ' ')
        length++;
    return length;
}

static bool fail(obj_reader *r, const char *at, const char *what)
{
    r->error_count++;
    int length = word_bytes(r, at);
    if (length == 0)
        return fl_error(r->diags, loc_at(r, at, 1), "%s, but the line ends", what);
    return fl_error(r->diags, loc_at(r, at, (size_t)length), "%s, got '%.*s'", what, length, at);
}

/* ---- Text ---- */

static bool is_line_end(const obj_reader *r)
{
    return r->at == r->end || *r->at == '\n' || *r->at == '\r';
}

/* Step over one line end: LF, CRLF or CR. */
static void skip_line_end(obj_reader *r)
{
    if (r->at == r->end)
        return;
    bool is_crlf = *r->at == '\r' && r->end - r->at > 1 && r->at[1] == '\n';
    r->at += is_crlf ? 2 : 1;
    r->line++;
    r->line_start = r->at;
}

/* Step over blanks and continued line ends. */
static void skip_blanks(obj_reader *r)
{
    for (;;) {
        while (r->at < r->end && (*r->at == ' ' || *r->at == '\t'))
            r->at++;
        if (r->end - r->at < 2 || *r->at != '\\' || (r->at[1] != '\n' && r->at[1] != '\r'))
            return;
        r->at++;
        skip_line_end(r);
    }
}

/* At the end of a statement: a line end or a comment. */
static bool is_statement_end(const obj_reader *r)
{
    return is_line_end(r) || *r->at == '#';
}

static void skip_line(obj_reader *r)
{
    while (!is_line_end(r)) {
        if (*r->at == '\\' && r->end - r->at > 1 && (r->at[1] == '\n' || r->at[1] == '\r')) {
            r->at++;
            skip_line_end(r);
        } else {
            r->at++;
        }
    }
    skip_line_end(r);
}

/* Between a value and what follows it there is a blank or the end of the statement. */
static bool is_word_end(const obj_reader *r, const char *at)
{
    return at == r->end || (unsigned char)*at <= ' ' || *at == '#' || *at == '\\';
}

/* ---- Growing arrays ---- */

/* The array with room for one more item: itself, or twice as large and moved. NULL after adding an
 * error; the old array then stands. */
static void *grow(obj_reader *r, void *items, uint32_t count, uint32_t *room, size_t item_bytes)
{
    if (count < *room)
        return items;
    if (count >= FL_MESH_ELEMENTS_MAX) {
        r->error_count = FL_OBJ_ERRORS_MAX;
        fl_error(r->diags, loc_at(r, r->line_start, 1),
                 "the mesh is too large: more than %u elements of one kind", FL_MESH_ELEMENTS_MAX);
        return NULL;
    }
    uint32_t new_room = *room ? fl_min_u32(*room * 2, FL_MESH_ELEMENTS_MAX) : 256;
    void *grown = realloc(items, new_room * item_bytes);
    if (!grown) {
        r->error_count = FL_OBJ_ERRORS_MAX;
        fl_out_of_memory(r->diags, r->name);
        return NULL;
    }
    *room = new_room;
    return grown;
}

/* One more position or normal. */
static bool add_vec3(obj_reader *r, fl_vec3 **items, uint32_t *count, uint32_t *room,
                     const double value[3])
{
    fl_vec3 *grown = grow(r, *items, *count, room, sizeof *grown);
    if (!grown)
        return false;
    *items = grown;
    grown[(*count)++] = fl_v3(value[0], value[1], value[2]);
    return true;
}

/* ---- Statements ---- */

/* Read finite numbers to the end of the statement: at least `least`, at most `most`, the first
 * three kept. */
static bool read_numbers(obj_reader *r, int least, int most, double out_values[3])
{
    for (int i = 0;; i++) {
        skip_blanks(r);
        if (is_statement_end(r) && i >= least)
            return true;
        double value;
        const char *next = i < most ? fl_number_parse(r->at, r->end, &value) : NULL;
        if (i >= most)
            return fail(r, r->at, "expected the end of the statement");
        if (!next || !is_word_end(r, next))
            return fail(r, r->at, "expected a number");
        if (!isfinite(value))
            return fail(r, r->at, "expected a finite number");
        if (i < 3)
            out_values[i] = value;
        r->at = next;
    }
}

static bool read_position(obj_reader *r)
{
    double value[3];
    return read_numbers(r, 3, 8, value) &&
           add_vec3(r, &r->mesh->positions, &r->mesh->position_count, &r->position_room, value);
}

static bool read_normal(obj_reader *r)
{
    double value[3];
    return read_numbers(r, 3, 3, value) &&
           add_vec3(r, &r->mesh->normals, &r->mesh->normal_count, &r->normal_room, value);
}

static bool read_uv(obj_reader *r)
{
    double value[3] = {0, 0, 0};
    const char *start = r->at;
    if (!read_numbers(r, 1, 3, value))
        return false;
    if (!(isfinite((float)value[0]) && isfinite((float)value[1])))
        return fail(r, start, "expected texture coordinates below 3.4e38");
    fl_mesh *mesh = r->mesh;
    fl_uv *uvs = grow(r, mesh->uvs, mesh->uv_count, &r->uv_room, sizeof *uvs);
    if (!uvs)
        return false;
    mesh->uvs = uvs;
    uvs[mesh->uv_count++] = (fl_uv){(float)value[0], (float)value[1]};
    return true;
}

/* Read one index of a corner and resolve it against the elements read so far. */
static bool read_index(obj_reader *r, int kind, uint32_t *out_index)
{
    const fl_mesh *mesh = r->mesh;
    uint32_t count = kind == POSITION ? mesh->position_count
                     : kind == UV     ? mesh->uv_count
                                      : mesh->normal_count;
    int64_t index;
    const char *start = r->at, *next = fl_integer_parse(start, r->end, &index);
    if (!next)
        return fail(r, start, "expected an index");
    r->at = next;
    fl_loc loc = loc_at(r, start, (size_t)(next - start));
    if (index == 0 && kind != POSITION)
        return true; /* Some exporters write 0 for "none". */
    if (index == 0 || index < -(int64_t)count || index > (int64_t)FL_MESH_ELEMENTS_MAX) {
        r->error_count++;
        return fl_error(r->diags, loc, "%s index %lld is out of range: %u %s read so far",
                        kind_names[kind], (long long)index, count, count == 1 ? "was" : "were");
    }
    if (index > (int64_t)count && index > r->forward[kind].index)
        r->forward[kind] = (forward_index){index, loc};
    *out_index = (uint32_t)(index > 0 ? index - 1 : (int64_t)count + index);
    return true;
}

typedef struct corner {
    uint32_t index[KIND_COUNT];
} corner;

/* a, a/b, a//c or a/b/c; a number may be missing behind a slash. */
static bool read_corner(obj_reader *r, corner *out_corner)
{
    *out_corner = (corner){{FL_NONE, FL_NONE, FL_NONE}};
    const char *start = r->at;
    for (int kind = POSITION; kind < KIND_COUNT; kind++) {
        bool is_missing = kind != POSITION && (is_word_end(r, r->at) || *r->at == '/');
        if (!is_missing && !read_index(r, kind, &out_corner->index[kind]))
            return false;
        if (r->at == r->end || *r->at != '/')
            break;
        if (kind + 1 < KIND_COUNT)
            r->at++;
    }
    if (!is_word_end(r, r->at))
        return fail(r, start, "expected a corner a, a/b, a//c or a/b/c");
    return true;
}

static bool add_face(obj_reader *r, const corner *a, const corner *b, const corner *c)
{
    fl_mesh *mesh = r->mesh;
    fl_face *faces = grow(r, mesh->faces, mesh->face_count, &r->face_room, sizeof *faces);
    if (!faces)
        return false;
    mesh->faces = faces;
    fl_face *face = &faces[mesh->face_count++];
    const corner *corners[3] = {a, b, c};
    for (int k = 0; k < 3; k++) {
        face->position[k] = corners[k]->index[POSITION];
        face->uv[k] = corners[k]->index[UV];
        face->normal[k] = corners[k]->index[NORMAL];
    }
    return true;
}

static bool read_face(obj_reader *r)
{
    corner first = {{0}}, last = {{0}}, next;
    for (uint32_t count = 0;; count++) {
        skip_blanks(r);
        if (is_statement_end(r) && count >= 3)
            return true;
        if (is_statement_end(r))
            return fail(r, r->at, "expected a face of at least 3 corners");
        if (!read_corner(r, &next))
            return false;
        if (count == 0)
            first = next;
        else if (count >= 2 && !add_face(r, &first, &last, &next))
            return false;
        last = next;
    }
}

/* One line; true also for statements that mean nothing to us. */
static bool read_statement(obj_reader *r)
{
    static const struct {
        const char *word;
        bool (*read)(obj_reader *r);
    } statements[] = {{"v", read_position}, {"vt", read_uv}, {"vn", read_normal}, {"f", read_face}};

    skip_blanks(r);
    size_t length = 0;
    while (!is_word_end(r, r->at + length))
        length++;
    for (size_t i = 0; i < FL_COUNT_OF(statements); i++) {
        if (length != strlen(statements[i].word) || memcmp(r->at, statements[i].word, length) != 0)
            continue;
        r->at += length;
        return statements[i].read(r);
    }
    return true;
}

/* ---- The file ---- */

/* A picture or an archive under the name of a mesh is one error, not one a line. */
static bool check_is_text(obj_reader *r)
{
    const char *zero = memchr(r->at, 0, (size_t)(r->end - r->at));
    if (!zero)
        return true;
    return fl_error(r->diags, (fl_loc){.file = r->name},
                    "this is not an OBJ text: it has a zero byte at offset %zu",
                    (size_t)(zero - r->at));
}

static bool check_whole(obj_reader *r)
{
    const fl_mesh *mesh = r->mesh;
    uint32_t counts[KIND_COUNT] = {mesh->position_count, mesh->uv_count, mesh->normal_count};
    bool is_good = r->error_count == 0;
    for (int kind = POSITION; kind < KIND_COUNT; kind++) {
        const forward_index *forward = &r->forward[kind];
        if (forward->index > (int64_t)counts[kind])
            is_good =
                fl_error(r->diags, forward->loc, "%s index %lld is out of range: the file has %u",
                         kind_names[kind], (long long)forward->index, counts[kind]);
    }
    if (is_good && mesh->face_count == 0)
        is_good = fl_error(r->diags, (fl_loc){.file = r->name}, "the mesh has no faces");
    return is_good;
}

static bool read_text(obj_reader *r)
{
    if (!check_is_text(r))
        return false;
    if (r->end - r->at >= 3 && memcmp(r->at, "\xEF\xBB\xBF", 3) == 0)
        r->at += 3;
    while (r->at < r->end && r->error_count < FL_OBJ_ERRORS_MAX) {
        (void)read_statement(r); /* It has counted its error; the next line may have more. */
        skip_line(r);
    }
    return check_whole(r);
}

/* Give back what doubling left over. */
static void *fit(void *items, uint32_t count, size_t item_bytes)
{
    void *fitted = count ? realloc(items, count * item_bytes) : NULL;
    return fitted ? fitted : items;
}

fl_mesh *fl_obj_parse(const char *text, size_t text_bytes, const char *name, fl_diags *diags)
{
    obj_reader r = {.at = text,
                    .end = text + text_bytes,
                    .line_start = text,
                    .line = 1,
                    .name = name,
                    .diags = diags,
                    .mesh = fl_mesh_create()};
    if (!r.mesh) {
        fl_out_of_memory(diags, name);
        return NULL;
    }
    const char *outer_text = diags->text, *outer_file = diags->text_file;
    size_t outer_bytes = diags->text_bytes;
    fl_diags_set_text(diags, name, text, text_bytes);
    bool is_read = read_text(&r);
    fl_diags_set_text(diags, outer_file, outer_text, outer_bytes);
    fl_mesh *mesh = r.mesh;
    if (!is_read) {
        fl_mesh_release(mesh);
        return NULL;
    }
    mesh->positions = fit(mesh->positions, mesh->position_count, sizeof *mesh->positions);
    mesh->normals = fit(mesh->normals, mesh->normal_count, sizeof *mesh->normals);
    mesh->uvs = fit(mesh->uvs, mesh->uv_count, sizeof *mesh->uvs);
    mesh->faces = fit(mesh->faces, mesh->face_count, sizeof *mesh->faces);
    return mesh;
}
