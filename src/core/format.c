/* SPDX-License-Identifier: MIT */
#include "core/format.h"

#include <stdlib.h>
#include <string.h>

#include "core/number.h"
#include "core/parse_build.h"

enum { INDENT = 4 };

typedef struct printer {
    char *text;
    size_t bytes, capacity;
    bool is_out_of_memory;
    bool has_comment; /* on the line being written */
    int depth;
    const fl_tree *tree;
    const fl_scene *scene; /* what the tree means: where our keys differ from the course's */
    uint32_t material_count;
} printer;

static void put(printer *p, const char *text, size_t bytes)
{
    if (p->capacity - p->bytes <= bytes && !p->is_out_of_memory) {
        size_t capacity = 2 * p->capacity + bytes + 1024;
        char *larger = realloc(p->text, capacity);
        p->is_out_of_memory = !larger;
        if (larger) {
            p->text = larger;
            p->capacity = capacity;
        }
    }
    if (p->is_out_of_memory)
        return;
    memcpy(p->text + p->bytes, text, bytes);
    p->bytes += bytes;
    p->text[p->bytes] = '\0';
}

static void put_text(printer *p, const char *text)
{
    put(p, text, strlen(text));
}

/* Lines are begun, not ended, so that a comment can still be added to the last one. */
static void begin_line(printer *p, bool is_after_gap)
{
    if (p->bytes > 0)
        put_text(p, is_after_gap ? "\n\n" : "\n");
    for (int i = 0; i < p->depth * INDENT; i++)
        put_text(p, " ");
    p->has_comment = false;
}

static void put_comment(printer *p, const fl_token *comment, bool is_trailing, bool is_after_gap)
{
    if (is_trailing && !p->has_comment)
        put_text(p, " ");
    else
        begin_line(p, is_after_gap);
    put(p, comment->text, comment->bytes);
    p->has_comment = true;
}

static void put_numbers(printer *p, const double *numbers, uint32_t count)
{
    char text[32];
    for (uint32_t i = 0; i < count; i++) {
        put_text(p, i > 0 && i % 4 == 0 ? "  " : " "); /* columns of a matrix stand apart */
        put(p, text, fl_number_format(numbers[i], text));
    }
}

/* A key that the text has not, from here. */
static void put_key(printer *p, const char *name, const double *numbers, uint32_t count)
{
    begin_line(p, false);
    put_text(p, name);
    put_numbers(p, numbers, count);
}

static void put_color(printer *p, const char *name, fl_vec3 color)
{
    put_key(p, name, (const double[]){color.x, color.y, color.z}, 3);
}

static void put_color_if(printer *p, const char *name, fl_vec3 color, double standard)
{
    if (color.x != standard || color.y != standard || color.z != standard)
        put_color(p, name, color);
}

/* A Transform or RevSurface whose content a lenient reader left out. */
static bool is_hollow(const fl_node *node)
{
    if (node->kind != FL_NODE_BLOCK)
        return false;
    if (node->block->id == FL_BLOCK_REVOLUTION)
        return !fl_node_block(node, FL_BLOCK_BEZIER) && !fl_node_block(node, FL_BLOCK_BSPLINE);
    if (node->block->id != FL_BLOCK_TRANSFORM)
        return false;
    for (const fl_node *n = fl_node_first(node); n; n = fl_node_next(n))
        if (n->kind == FL_NODE_BLOCK && !is_hollow(n))
            return false;
    return true;
}

static uint32_t count_members(const fl_node *block)
{
    uint32_t count = 0;
    for (const fl_node *node = fl_node_first(block); node; node = fl_node_next(node))
        count += node->kind == FL_NODE_BLOCK && !is_hollow(node);
    return count;
}

static bool is_dialect(const printer *p, uint32_t dialects)
{
    return (1u << p->tree->dialect) & dialects;
}

static void put_points(printer *p, const fl_node *node)
{
    p->depth++;
    for (uint32_t i = 0; i + 3 <= node->number_count; i += 3) {
        begin_line(p, false);
        put_text(p, "[");
        put_numbers(p, node->numbers + i, 3);
        put_text(p, " ]");
    }
    p->depth--;
}

/* Keys that mean something else in ours. True: this was one, and it is done. */
static bool put_special_key(printer *p, const fl_node *parent, const fl_node *node)
{
    double count = (double)count_members(parent);
    switch (node->key->id) {
    case FL_KEY_COUNT_OF_MEMBERS:
        put_numbers(p, &count, 1);
        return true;
    case FL_KEY_AMBIENT_LIGHT: {
        fl_vec3 ambient = p->scene->background.ambient;
        put_numbers(p, (const double[]){ambient.x, ambient.y, ambient.z}, 3);
        return true;
    }
    default:
        return false;
    }
}

static void put_key_node(printer *p, const fl_node *parent, const fl_node *node, bool is_after_gap)
{
    const fl_key *key = fl_grammar_key_by_id(parent->block, node->key->id, FL_DIALECT_FIRSTLIGHT);
    bool is_divided = is_dialect(p, FL_IN_M12) && node->key->id == FL_KEY_FALLOFF &&
                      node->numbers[0] > 0.0; /* color / (k d^2) */
    begin_line(p, is_after_gap);
    if (is_divided) {
        put_text(p, "attenuation");
        put_numbers(p, (const double[]){0.0, 0.0, node->numbers[0]}, 3);
        return;
    }
    /* Only the name that the text uses tells obj_file from file. */
    bool is_same = node->key->dialects & FL_IN_FIRSTLIGHT;
    put_text(p, is_same ? node->key->name : key->name);
    if (put_special_key(p, parent, node))
        return;
    switch (node->key->kind) {
    case FL_VALUE_PATH:
    case FL_VALUE_CHOICE:
        put_text(p, " ");
        put(p, node->word.text, node->word.bytes);
        break;
    case FL_VALUE_POINTS:
        put_points(p, node);
        break;
    case FL_VALUE_BRACED:
        put_text(p, " {");
        put_numbers(p, node->numbers, node->number_count);
        put_text(p, " }");
        break;
    default:
        put_numbers(p, node->numbers, node->number_count);
    }
}

static void put_children(printer *p, const fl_node *block);

/* A material of the MIT courses, said in our keys. */
static void put_meaning(printer *p, const fl_node *node, const fl_material *material)
{
    const fl_node *bump = fl_node_key(node, FL_KEY_BUMP);
    put_color(p, "diffuseColor", material->diffuse);
    put_color_if(p, "specularColor", material->specular, 0.0);
    if (material->has_ambient) /* of the material it stands in for */
        put_color(p, "ambient", material->ambient);
    if (material->shininess != 0.0)
        put_key(p, "shininess", &material->shininess, 1);
    put_color_if(p, "reflect", material->reflect, 0.0);
    put_color_if(p, "refract", material->refract, 0.0);
    if (material->refraction_index != 1.0)
        put_key(p, "refractionIndex", &material->refraction_index, 1);
    if (material->image != FL_NONE) { /* of the node, or of the material it stands in for */
        begin_line(p, false);
        put_text(p, "texture ");
        put_text(p, p->scene->images[material->image].path); /* as written: no files were looked for */
    }
    if (material->texture_scale[0] != 1.0 || material->texture_scale[1] != 1.0)
        put_key(p, "textureScale", material->texture_scale, 2);
    if (material->filter != FL_FILTER_BILINEAR) {
        begin_line(p, false);
        put_text(p, "filter nearest");
    }
    if (bump) {
        begin_line(p, false);
        put_text(p, "# bump ");
        put(p, bump->word.text, bump->word.bytes);
        p->has_comment = true;
    }
    for (const fl_node *n = node->first; n; n = n->next)
        if (n->kind == FL_NODE_COMMENT)
            put_comment(p, &n->token, false, false);
}

/* What our defaults would make different. */
static void put_supplement(printer *p, const fl_node *node)
{
    fl_vec3 ambient = p->scene->background.ambient;
    if (node->block->id == FL_BLOCK_MESH && is_dialect(p, FL_IN_PA1 | FL_IN_M04) &&
        !fl_node_key(node, FL_KEY_NORMALS)) {
        begin_line(p, false);
        put_text(p, "normals flat");
    }
    if (node->block->id == FL_BLOCK_BACKGROUND && !fl_node_key(node, FL_KEY_AMBIENT_LIGHT))
        put_color_if(p, "ambientLight", ambient, 0.0);
}

static void put_block_node(printer *p, const fl_node *node, bool is_after_gap)
{
    const fl_material *material = NULL;
    const char *name = node->block->name;
    if (node->block->id == FL_BLOCK_MATERIAL || node->block->id == FL_BLOCK_PROCEDURAL)
        material = &p->scene->materials[p->material_count++];
    if (node->block->id == FL_BLOCK_PROCEDURAL)
        name = "Material";
    begin_line(p, is_after_gap);
    put_text(p, name);
    if (node->block->is_named) {
        put_text(p, " ");
        put(p, node->word.text, node->word.bytes);
    }
    put_text(p, " {");
    p->depth++;
    if (material && (is_dialect(p, FL_IN_MIT) || node->block->id == FL_BLOCK_PROCEDURAL))
        put_meaning(p, node, material);
    else
        put_children(p, node);
    put_supplement(p, node);
    p->depth--;
    begin_line(p, false);
    put_text(p, "}");
}

static void put_children(printer *p, const fl_node *block)
{
    bool is_top = block->block->id == FL_BLOCK_TOP;
    const fl_node *before = NULL;
    for (const fl_node *node = block->first; node; node = node->next) {
        if (node->is_replaced || is_hollow(node))
            continue;
        bool is_block = node->kind == FL_NODE_BLOCK;
        bool is_gap = before ? node->is_after_gap : is_top && !is_dialect(p, FL_IN_FIRSTLIGHT);
        if (is_top && is_block && (!before || before->kind == FL_NODE_BLOCK))
            is_gap = true;
        if (is_top && !before && node->is_after_gap)
            is_gap = true;
        if (node->kind == FL_NODE_COMMENT)
            put_comment(p, &node->token, node->is_trailing, is_gap);
        else if (is_block)
            put_block_node(p, node, is_gap);
        else
            put_key_node(p, block, node, is_gap);
        if (!(node->kind == FL_NODE_COMMENT && node->is_trailing))
            before = node;
    }
}

static void put_scene(printer *p)
{
    const fl_node *top = p->tree->top;
    put_text(p, "firstlight 1");
    put_children(p, top);
    /* No lights in an MIT text: light from everywhere, even without a Background. */
    if (!fl_node_block(top, FL_BLOCK_BACKGROUND) && p->scene->background.ambient.x != 0.0)
        put_text(p, "\n\nBackground {\n    ambientLight 1 1 1\n}");
    put_text(p, "\n");
}

static char *format_text(const char *text, size_t text_bytes, const char *name,
                         const fl_parse_options *options, size_t *out_bytes, fl_arena *arena,
                         fl_diags *diags)
{
    fl_tree tree;
    const char *reason;
    if (!fl_lex_check(text, text_bytes, name, options->is_lenient, diags))
        return NULL;
    fl_dialect dialect = options->has_dialect
                             ? options->dialect
                             : fl_dialect_recognise(text, text_bytes, arena, &reason);
    if (!fl_tree_parse(&tree, text, text_bytes, name, dialect, options->is_lenient, arena, diags))
        return NULL;
    fl_scene *scene = fl_build_scene(&tree, text, text_bytes, NULL, diags);
    if (!scene)
        return NULL;
    printer p = {.tree = &tree, .scene = scene};
    put_scene(&p);
    fl_scene_destroy(scene);
    if (!p.is_out_of_memory) {
        *out_bytes = p.bytes;
        return p.text;
    }
    fl_out_of_memory(diags, "the formatted text");
    free(p.text);
    return NULL;
}

char *fl_scene_format(const char *text, size_t text_bytes, const char *name,
                      const fl_parse_options *options, size_t *out_bytes, fl_diags *diags)
{
    const char *outer_file = diags->text_file, *outer_text = diags->text;
    size_t outer_bytes = diags->text_bytes;
    fl_arena arena = {0};
    fl_diags_set_text(diags, name, text, text_bytes);
    char *formatted = format_text(text, text_bytes, name, options, out_bytes, &arena, diags);
    fl_diags_set_text(diags, outer_file, outer_text, outer_bytes);
    fl_arena_deinit(&arena);
    return formatted;
}
