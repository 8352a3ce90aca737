/* SPDX-License-Identifier: MIT
 *
 * Lights and materials, with what each course means by its keys.
 */
#include <float.h>
#include <math.h>

#include "core/parse_build.h"

/* The three ways to fade with the distance d, as the divisor a0 + a1 d + a2 d^2. */
static void set_attenuation(fl_builder *b, const fl_node *node, fl_light *light)
{
    const fl_node *falloff = fl_node_key(node, FL_KEY_FALLOFF);
    const fl_node *attenuation = fl_node_key(node, FL_KEY_ATTENUATION);
    light->attenuation[0] = 1.0;
    if (falloff && attenuation) {
        fl_error(b->diags, fl_build_loc(b, attenuation),
                 "'falloff' and 'attenuation' exclude each other");
        fl_note(b->diags, fl_build_loc(b, falloff), "'falloff' is here");
    } else if (falloff) {
        light->attenuation[2] = falloff->numbers[0];
        if (b->tree->dialect == FL_DIALECT_M12 && falloff->numbers[0] > 0.0)
            light->attenuation[0] = 0.0; /* color / (k d^2), as its reference pictures have it */
    } else if (attenuation) {
        for (int i = 0; i < 3; i++)
            light->attenuation[i] = attenuation->numbers[i];
        if (light->attenuation[0] + light->attenuation[1] + light->attenuation[2] == 0.0)
            fl_error(b->diags, fl_build_loc(b, attenuation), "'attenuation' must not be 0 0 0");
    }
}

void fl_build_light(fl_builder *b, const fl_node *node, fl_light *out_light)
{
    fl_light light = {.color = fl_build_vec3(b, node, FL_KEY_COLOR),
                      .attenuation = {1.0, 0.0, 0.0},
                      .is_two_sided = true,
                      .loc = fl_build_loc(b, node)};
    switch (node->block->id) {
    case FL_BLOCK_DIRECTIONAL:
        light.kind = FL_LIGHT_DIRECTIONAL;
        light.direction = fl_build_direction(b, node, FL_KEY_DIRECTION);
        break;
    case FL_BLOCK_POINT:
        light.kind = FL_LIGHT_POINT;
        light.position = fl_build_vec3(b, node, FL_KEY_POSITION);
        set_attenuation(b, node, &light);
        break;
    default:
        light.kind = FL_LIGHT_DISK;
        light.position = fl_build_vec3(b, node, FL_KEY_POSITION);
        light.direction = fl_build_direction(b, node, FL_KEY_DIRECTION);
        light.radius = fl_build_number(b, node, FL_KEY_RADIUS);
        light.samples = (uint32_t)fl_build_number(b, node, FL_KEY_SAMPLES);
        light.is_two_sided = fl_build_choice(b, node, FL_KEY_TWO_SIDED) == 1;
        set_attenuation(b, node, &light);
        break;
    }
    *out_light = light;
}

/* The 2012 course reflects by specularColor; a material with an index of refraction divides that
 * between the two rays by Fresnel's law. The ray tree has constant weights: Fresnel's reflectance
 * at normal incidence divides them. */
static void set_m12_branches(fl_material *material, double index)
{
    material->reflect = material->specular;
    material->refraction_index = 1.0;
    if (!(index > 0.0))
        return;
    double root = (index - 1.0) / (index + 1.0), reflectance = root * root;
    material->refraction_index = index;
    material->reflect = fl_v3_scale(material->specular, reflectance);
    material->refract = fl_v3_scale(material->specular, 1.0 - reflectance);
}

/* A lenient reader's stand-in for a procedural material: an earlier material, or a plain colour. */
static void stand_in(fl_builder *b, const fl_node *node, fl_material *material)
{
    uint32_t count = b->scene->material_count - 1; /* the one in progress is counted already */
    if (node->number_count == 3)
        material->diffuse = fl_v3(node->numbers[0], node->numbers[1], node->numbers[2]);
    if (node->number_count == 1 && node->numbers[0] >= 0.0 && node->numbers[0] < (double)count)
        *material = b->scene->materials[(uint32_t)node->numbers[0]];
}

void fl_build_material(fl_builder *b, const fl_node *node, fl_material *out_material)
{
    double scale[4] = {1.0, 1.0};
    fl_material material = {.diffuse = fl_v3(1, 1, 1),
                            .refraction_index = 1.0,
                            .image = FL_NONE,
                            .texture_scale = {1.0, 1.0}};
    const fl_node *key;
    *out_material = material;
    if (node->block->id == FL_BLOCK_PROCEDURAL) {
        stand_in(b, node, out_material);
        out_material->loc = fl_build_loc(b, node);
        return;
    }
    material.loc = fl_build_loc(b, node);
    material.diffuse = fl_build_vec3(b, node, FL_KEY_DIFFUSE);
    material.specular = fl_build_vec3(b, node, FL_KEY_SPECULAR);
    material.shininess = fl_build_number(b, node, FL_KEY_SHININESS);
    material.ambient = fl_build_vec3(b, node, FL_KEY_AMBIENT);
    material.has_ambient = fl_node_key(node, FL_KEY_AMBIENT);
    material.reflect = fl_build_vec3(b, node, FL_KEY_REFLECT);
    material.refract = fl_build_vec3(b, node, FL_KEY_REFRACT);
    material.refraction_index = fl_build_number(b, node, FL_KEY_REFRACTION_INDEX);
    material.filter = (fl_filter)fl_build_choice(b, node, FL_KEY_FILTER);
    fl_build_numbers(b, node, FL_KEY_TEXTURE_SCALE, scale);
    material.texture_scale[0] = scale[0];
    material.texture_scale[1] = scale[1];
    if (fabs(scale[0]) < (double)FLT_MIN || fabs(scale[1]) < (double)FLT_MIN)
        fl_error(b->diags, fl_build_loc(b, fl_node_key(node, FL_KEY_TEXTURE_SCALE)),
                 "'textureScale' must not be 0, nor below 1.2e-38, as a float is");
    if ((key = fl_node_key(node, FL_KEY_TEXTURE)))
        material.image = fl_build_image_file(b, key);
    if (b->tree->dialect == FL_DIALECT_M12)
        set_m12_branches(&material, material.refraction_index);
    *out_material = material;
    if ((key = fl_node_block(node, FL_BLOCK_PROCEDURAL)) && key->number_count == 3)
        out_material->diffuse = fl_v3(key->numbers[0], key->numbers[1], key->numbers[2]);
}
