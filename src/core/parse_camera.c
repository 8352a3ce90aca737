/* SPDX-License-Identifier: MIT
 *
 * Camera, views, background, Render block.
 */
#include <string.h>

#include "core/parse_build.h"

/* Sine of the angle between `up` and `direction` below which there is no telling where up is. */
#define PARALLEL 1e-9

static uint32_t whole(const fl_builder *b, const fl_node *block, fl_key_id id)
{
    return (uint32_t)fl_build_number(b, block, id);
}

static void set_projection(fl_builder *b, const fl_node *node, fl_camera *camera)
{
    bool has_angle = fl_node_key(node, FL_KEY_ANGLE), has_size = fl_node_key(node, FL_KEY_SIZE);
    if (has_angle == has_size)
        fl_error(b->diags, fl_build_loc(b, node), "a '%s' needs either 'angle' or 'size'",
                 node->block->name);
    camera->projection = has_size ? FL_ORTHOGRAPHIC : FL_PERSPECTIVE;
    camera->fov_deg = fl_build_number(b, node, FL_KEY_ANGLE);
    camera->ortho_size = fl_build_number(b, node, FL_KEY_SIZE);
}

void fl_build_camera(fl_builder *b, const fl_node *node, fl_camera *out_camera)
{
    fl_camera camera = {.center = fl_build_vec3(b, node, FL_KEY_CENTER),
                        .direction = fl_build_vec3(b, node, FL_KEY_DIRECTION),
                        .up = fl_build_vec3(b, node, FL_KEY_UP),
                        .aperture = fl_build_number(b, node, FL_KEY_APERTURE),
                        .focus = HUGE_VAL,
                        .blades = whole(b, node, FL_KEY_BLADES),
                        .blade_rotation_deg = fl_build_number(b, node, FL_KEY_BLADE_ROTATION),
                        .exposure_ev = fl_build_number(b, node, FL_KEY_EXPOSURE),
                        .width = whole(b, node, FL_KEY_WIDTH),
                        .height = whole(b, node, FL_KEY_HEIGHT)};
    double focus[4];
    if (fl_build_numbers(b, node, FL_KEY_FOCUS, focus) == 1) /* an orthographic camera has none */
        camera.focus = focus[0];
    set_projection(b, node, &camera);
    fl_vec3 direction = fl_build_direction(b, node, FL_KEY_DIRECTION);
    fl_vec3 up = fl_build_direction(b, node, FL_KEY_UP);
    bool is_zero = !(fl_v3_max_abs(direction) > 0.0 && fl_v3_max_abs(up) > 0.0);
    if (!is_zero && fl_v3_length(fl_v3_cross(direction, up)) < PARALLEL)
        fl_error(b->diags, fl_build_loc(b, fl_node_key(node, FL_KEY_UP)),
                 "'up' must not be parallel to 'direction'");
    if (camera.blades == 1 || camera.blades == 2)
        fl_error(b->diags, fl_build_loc(b, fl_node_key(node, FL_KEY_BLADES)),
                 "'blades' must be 0 or from 3 to 9, got %u", (unsigned)camera.blades);
    if ((camera.width == 0) != (camera.height == 0))
        fl_error(b->diags, fl_build_loc(b, node), "'width' and 'height' belong together");
    *out_camera = camera;
}

void fl_build_background(fl_builder *b, const fl_node *node)
{
    fl_background *background = &b->scene->background;
    *background = (fl_background){.color = fl_build_vec3(b, node, FL_KEY_COLOR),
                                  .ambient = fl_build_vec3(b, node, FL_KEY_AMBIENT_LIGHT),
                                  .loc = fl_build_loc(b, node)};
    for (int i = 0; i < FL_CUBE_FACES; i++)
        background->cube_image[i] = FL_NONE;
    const fl_node *cube_map = fl_node_key(node, FL_KEY_CUBE_MAP);
    if (cube_map)
        fl_build_cube_map(b, cube_map, background->cube_image);
}

void fl_build_render(fl_builder *b, const fl_node *node)
{
    b->scene->render = (fl_render_block){
        .samples = whole(b, node, FL_KEY_SAMPLES),
        .depth = whole(b, node, FL_KEY_DEPTH),
        .light_samples = whole(b, node, FL_KEY_LIGHT_SAMPLES),
        .weight_threshold = fl_build_number(b, node, FL_KEY_WEIGHT_THRESHOLD),
        .has_samples = fl_node_key(node, FL_KEY_SAMPLES),
        .has_depth = fl_node_key(node, FL_KEY_DEPTH),
        .has_light_samples = fl_node_key(node, FL_KEY_LIGHT_SAMPLES),
        .has_weight_threshold = fl_node_key(node, FL_KEY_WEIGHT_THRESHOLD),
        .has_transparent_shadows = fl_node_key(node, FL_KEY_TRANSPARENT_SHADOWS),
        .transparent_shadows = fl_build_choice(b, node, FL_KEY_TRANSPARENT_SHADOWS) == 1,
        .loc = fl_build_loc(b, node)};
}
