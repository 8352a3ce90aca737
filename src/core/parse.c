/* SPDX-License-Identifier: MIT */
#include "core/parse.h"

#include <stdlib.h>
#include <string.h>

#include "core/number.h"
#include "core/parse_build.h"

fl_loc fl_build_loc(const fl_builder *b, const fl_node *node)
{
    return fl_token_loc(b->tree->name, &node->token);
}

/* The row of the table for a key that may be absent from the text, or even from the dialect: what a
 * course cannot say has our default. */
static const fl_key *key_row(const fl_builder *b, const fl_node *block, fl_key_id id)
{
    const fl_key *key = fl_grammar_key_by_id(block->block, id, b->tree->dialect);
    return key ? key : fl_grammar_key_by_id(block->block, id, FL_DIALECT_FIRSTLIGHT);
}

uint32_t fl_build_numbers(const fl_builder *b, const fl_node *block, fl_key_id id,
                          double out_numbers[4])
{
    const fl_node *node = fl_node_key(block, id);
    if (node) {
        uint32_t count = fl_min_u32(node->number_count, 4);
        memcpy(out_numbers, node->numbers, count * sizeof *out_numbers);
        return count;
    }
    const fl_key *key = key_row(b, block, id);
    return key ? fl_key_default(key, out_numbers) : 0;
}

double fl_build_number(const fl_builder *b, const fl_node *block, fl_key_id id)
{
    double numbers[4] = {0};
    fl_build_numbers(b, block, id, numbers);
    return numbers[0];
}

fl_vec3 fl_build_vec3(const fl_builder *b, const fl_node *block, fl_key_id id)
{
    double numbers[4] = {0};
    fl_build_numbers(b, block, id, numbers);
    return fl_v3(numbers[0], numbers[1], numbers[2]);
}

uint32_t fl_build_choice(const fl_builder *b, const fl_node *block, fl_key_id id)
{
    const fl_node *node = fl_node_key(block, id);
    if (node)
        return node->choice;
    const fl_key *key = key_row(b, block, id);
    fl_token word = {
        .kind = FL_TOKEN_WORD, .text = key->standard, .bytes = (uint32_t)strlen(key->standard)};
    return fl_key_choice(key, &word);
}

fl_vec3 fl_build_direction(fl_builder *b, const fl_node *block, fl_key_id id)
{
    fl_vec3 v = fl_build_vec3(b, block, id);
    const fl_node *key = fl_node_key(block, id);
    if (key && !(fl_v3_max_abs(v) > 0.0))
        fl_error(b->diags, fl_build_loc(b, key), "'%s' must not be 0 0 0", key->key->name);
    return fl_v3_normalize(v);
}

static bool alloc_arrays(fl_builder *b)
{
    fl_scene *scene = b->scene;
    const uint32_t *counts = b->tree->block_counts;
    uint32_t lights =
        counts[FL_BLOCK_DIRECTIONAL] + counts[FL_BLOCK_POINT] + counts[FL_BLOCK_DISK_LIGHT];
    uint32_t materials = counts[FL_BLOCK_MATERIAL] + counts[FL_BLOCK_PROCEDURAL] + 1;
    uint32_t objects = 0;
    for (int id = FL_BLOCK_SPHERE; id <= FL_BLOCK_REVOLUTION; id++)
        objects += counts[id];
    const struct {
        void **array;
        uint32_t count;
        size_t item_bytes;
    } rows[] = {
        {(void **)&scene->lights, lights, sizeof *scene->lights},
        {(void **)&scene->materials, materials, sizeof *scene->materials},
        {(void **)&scene->objects, objects, sizeof *scene->objects},
        {(void **)&scene->transforms, counts[FL_BLOCK_TRANSFORM], sizeof *scene->transforms},
        {(void **)&scene->profiles, counts[FL_BLOCK_REVOLUTION], sizeof *scene->profiles},
        {(void **)&scene->meshes, counts[FL_BLOCK_MESH], sizeof *scene->meshes},
        {(void **)&scene->images, b->tree->path_count, sizeof *scene->images},
        {(void **)&scene->views, counts[FL_BLOCK_VIEW], sizeof *scene->views},
        {(void **)&b->mesh_references, counts[FL_BLOCK_MESH], sizeof(char *)},
        {(void **)&b->image_references, b->tree->path_count, sizeof(char *)},
    };
    for (size_t i = 0; i < FL_COUNT_OF(rows); i++)
        if (!(*rows[i].array = fl_arena_alloc(&scene->arena, rows[i].count, rows[i].item_bytes)))
            return fl_out_of_memory(b->diags, "the scene");
    return true;
}

static bool check_limits(const fl_builder *b)
{
    const uint32_t *counts = b->tree->block_counts;
    uint32_t objects = 0;
    for (int id = FL_BLOCK_GROUP; id <= FL_BLOCK_REVOLUTION; id++)
        objects += counts[id];
    const struct {
        const char *what;
        uint32_t count, most;
    } rows[] = {
        {"lights",
         counts[FL_BLOCK_DIRECTIONAL] + counts[FL_BLOCK_POINT] + counts[FL_BLOCK_DISK_LIGHT],
         FL_LIGHTS_MAX},
        {"materials", counts[FL_BLOCK_MATERIAL] + counts[FL_BLOCK_PROCEDURAL], FL_MATERIALS_MAX},
        {"objects, groups and transforms", objects, FL_OBJECTS_MAX},
        {"views", counts[FL_BLOCK_VIEW], FL_VIEWS_MAX},
    };
    for (size_t i = 0; i < FL_COUNT_OF(rows); i++)
        if (rows[i].count > rows[i].most)
            return fl_error(b->diags, (fl_loc){.file = b->tree->name},
                            "a scene text holds at most %u %s, this one %u", (unsigned)rows[i].most,
                            rows[i].what, (unsigned)rows[i].count);
    return true;
}

static void build_lights(fl_builder *b, const fl_node *lights)
{
    for (const fl_node *node = fl_node_first(lights); node; node = fl_node_next(node))
        if (node->kind == FL_NODE_BLOCK)
            fl_build_light(b, node, &b->scene->lights[b->scene->light_count++]);
}

static void build_materials(fl_builder *b, const fl_node *materials)
{
    for (const fl_node *node = fl_node_first(materials); node; node = fl_node_next(node))
        if (node->kind == FL_NODE_BLOCK)
            fl_build_material(b, node, &b->scene->materials[b->scene->material_count++]);
}

static void build_view(fl_builder *b, const fl_node *node)
{
    fl_scene *scene = b->scene;
    for (uint32_t i = 0; i < scene->view_count; i++) {
        if (!fl_token_is(&node->word, scene->views[i].name))
            continue;
        fl_error(b->diags, fl_token_loc(b->tree->name, &node->word), "the view '%s' exists already",
                 scene->views[i].name);
        fl_note(b->diags, scene->views[i].loc, "the first one is here");
        return;
    }
    fl_view *view = &scene->views[scene->view_count++];
    view->name = fl_arena_text(&scene->arena, node->word.text, node->word.bytes);
    view->loc = fl_build_loc(b, node);
    if (!view->name) {
        fl_out_of_memory(b->diags, "the scene");
        scene->view_count--;
        return;
    }
    fl_build_camera(b, node, &view->camera);
}

/* What a text leaves out, from the table: as if its blocks stood there empty. */
static void set_defaults(fl_builder *b)
{
    static const fl_block_id ids[] = {FL_BLOCK_PERSPECTIVE, FL_BLOCK_BACKGROUND, FL_BLOCK_RENDER};
    fl_node empty[FL_COUNT_OF(ids)];
    for (size_t i = 0; i < FL_COUNT_OF(ids); i++) {
        empty[i] = (fl_node){.kind = FL_NODE_BLOCK};
        for (uint32_t j = 0; j < fl_grammar_block_count; j++)
            if (fl_grammar_blocks[j].id == ids[i])
                empty[i].block = &fl_grammar_blocks[j];
    }
    fl_build_background(b, &empty[1]);
    fl_build_render(b, &empty[2]);
    b->scene->camera = (fl_camera){.direction = fl_v3(0, 0, -1),
                                   .up = fl_v3(0, 1, 0),
                                   .fov_deg = 40.0,
                                   .focus = fl_build_number(b, &empty[0], FL_KEY_FOCUS)};
}

static void build_all(fl_builder *b)
{
    const fl_node *top = b->tree->top, *node;
    fl_scene *scene = b->scene;
    set_defaults(b);
    for (node = fl_node_first(top); node; node = fl_node_next(node)) {
        if (node->block->id == FL_BLOCK_PERSPECTIVE || node->block->id == FL_BLOCK_ORTHOGRAPHIC) {
            fl_build_camera(b, node, &scene->camera);
            scene->has_camera = true;
        } else if (node->block->id == FL_BLOCK_VIEW) {
            build_view(b, node);
        }
    }
    if ((node = fl_node_block(top, FL_BLOCK_RENDER)))
        fl_build_render(b, node);
    if ((node = fl_node_block(top, FL_BLOCK_LIGHTS)))
        build_lights(b, node);
    if ((node = fl_node_block(top, FL_BLOCK_BACKGROUND)))
        fl_build_background(b, node);
    bool is_mit = (1u << b->tree->dialect) & FL_IN_MIT;
    if (is_mit && scene->light_count == 0)
        scene->background.ambient = fl_v3(1, 1, 1);
    if ((node = fl_node_block(top, FL_BLOCK_MATERIALS)))
        build_materials(b, node);
    if ((node = fl_node_block(top, FL_BLOCK_GROUP)))
        fl_build_objects(b, node);
}

fl_scene *fl_build_scene(const fl_tree *tree, const char *text, size_t text_bytes,
                         const fl_files *files, fl_diags *diags)
{
    uint32_t errors_before = diags->error_count;
    fl_tree named = *tree;
    fl_builder b = {.tree = &named,
                    .files = files,
                    .diags = diags,
                    .text = text,
                    .text_bytes = text_bytes,
                    .material = FL_NONE,
                    .default_material = FL_NONE};
    b.scene = calloc(1, sizeof *b.scene);
    if (!b.scene) {
        fl_out_of_memory(diags, "the scene");
        return NULL;
    }
    b.scene->path = named.name = fl_arena_text(&b.scene->arena, tree->name, strlen(tree->name));
    b.scene->dialect = tree->dialect;
    if (!named.name)
        fl_out_of_memory(diags, "the scene");
    else if (check_limits(&b) && alloc_arrays(&b))
        build_all(&b);
    if (diags->error_count == errors_before)
        return b.scene;
    fl_scene_destroy(b.scene);
    return NULL;
}

/* Whether there is anything but white space and comments. */
static bool says_something(const char *text, size_t text_bytes)
{
    fl_lexer lexer;
    fl_token token;
    fl_lexer_init(&lexer, text, text_bytes);
    do
        token = fl_lexer_next(&lexer);
    while (token.kind == FL_TOKEN_COMMENT);
    return token.kind != FL_TOKEN_END;
}

/* With the text set for quoting, and the dialect known. */
static fl_scene *parse_text(const char *text, size_t text_bytes, const char *name,
                            const fl_parse_options *options, const fl_files *files, fl_arena *arena,
                            fl_diags *diags)
{
    if (!fl_lex_check(text, text_bytes, name, options->is_lenient, diags))
        return NULL;
    if (!says_something(text, text_bytes)) {
        fl_error(diags, (fl_loc){.file = name},
                 "the scene is empty; expected PerspectiveCamera, Lights, Materials and Group");
        return NULL;
    }
    fl_dialect dialect = options->dialect;
    const char *reason = "it was named";
    if (!options->has_dialect)
        dialect = fl_dialect_recognise(text, text_bytes, arena, &reason);
    if (!reason) {
        fl_out_of_memory(diags, "the scene text");
        return NULL;
    }
    fl_tree tree;
    if (!fl_tree_parse(&tree, text, text_bytes, name, dialect, options->is_lenient, arena, diags))
        return NULL;
    fl_scene *scene = fl_build_scene(&tree, text, text_bytes, files, diags);
    if (!scene)
        return NULL;
    scene->dialect_reason = fl_arena_text(&scene->arena, reason, strlen(reason));
    if (scene->dialect_reason)
        return scene;
    fl_out_of_memory(diags, "the scene");
    fl_scene_destroy(scene);
    return NULL;
}

fl_scene *fl_scene_parse(const char *text, size_t text_bytes, const char *name,
                         const fl_parse_options *options, const fl_files *files, fl_diags *diags)
{
    const char *outer_file = diags->text_file, *outer_text = diags->text;
    size_t outer_bytes = diags->text_bytes;
    fl_arena arena = {0};
    fl_diags_set_text(diags, name, text, text_bytes);
    fl_scene *scene = parse_text(text, text_bytes, name, options, files, &arena, diags);
    fl_diags_set_text(diags, outer_file, outer_text, outer_bytes);
    fl_arena_deinit(&arena);
    return scene;
}
