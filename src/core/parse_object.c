/* SPDX-License-Identifier: MIT
 *
 * Groups, transforms and objects.
 */
#include <math.h>

#include "core/math64.h"
#include "core/parse_build.h"

/* The transforms around an object; its entry in the scene is made when the first object needs it.
 */
typedef struct frame {
    fl_affine to_world;
    uint32_t index;
} frame;

static uint32_t frame_index(fl_builder *b, frame *f)
{
    if (f->index == FL_NONE && !fl_affine_is_identity(&f->to_world)) {
        f->index = b->scene->transform_count++;
        b->scene->transforms[f->index] = f->to_world;
    }
    return f->index;
}

/* Rotation by `deg` about a unit axis, counter-clockwise seen from its tip [Rodrigues]. */
static fl_affine rotation(fl_vec3 axis, double deg)
{
    double s, c;
    fl_d_sincos_deg(deg, &s, &c);
    double x = axis.x, y = axis.y, z = axis.z, k = 1.0 - c;
    return (fl_affine){{{c + k * x * x, k * x * y - s * z, k * x * z + s * y, 0.0},
                        {k * x * y + s * z, c + k * y * y, k * y * z - s * x, 0.0},
                        {k * x * z - s * y, k * y * z + s * x, c + k * z * z, 0.0}}};
}

static fl_affine scaling(double x, double y, double z)
{
    return (fl_affine){{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}}};
}

/* Sixteen numbers, column after column. */
static bool matrix_map(fl_builder *b, const fl_node *key, fl_affine *out)
{
    const double *n = key->numbers;
    if (n[3] != 0.0 || n[7] != 0.0 || n[11] != 0.0 || n[15] != 1.0)
        return fl_error(
            b->diags, fl_build_loc(b, key),
            "the last row of a matrix must be 0 0 0 1; columns are written one after another");
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            out->m[row][column] = n[4 * column + row];
    return true;
}

/* The map of one key. */
static bool key_map(fl_builder *b, const fl_node *key, fl_affine *out)
{
    const double *n = key->numbers;
    *out = fl_affine_identity();
    switch (key->key->id) {
    case FL_KEY_TRANSLATE:
        for (int i = 0; i < 3; i++)
            out->m[i][3] = n[i];
        return true;
    case FL_KEY_SCALE:
        *out = scaling(n[0], n[1], n[2]);
        break;
    case FL_KEY_UNIFORM_SCALE:
        *out = scaling(n[0], n[0], n[0]);
        break;
    case FL_KEY_X_ROTATE:
        *out = rotation(fl_v3(1, 0, 0), n[0]);
        return true;
    case FL_KEY_Y_ROTATE:
        *out = rotation(fl_v3(0, 1, 0), n[0]);
        return true;
    case FL_KEY_Z_ROTATE:
        *out = rotation(fl_v3(0, 0, 1), n[0]);
        return true;
    case FL_KEY_ROTATE: {
        fl_vec3 axis = fl_v3(n[0], n[1], n[2]);
        if (!(fl_v3_max_abs(axis) > 0.0) || fabs(n[3]) > 1e9)
            return fl_error(b->diags, fl_build_loc(b, key),
                            "'Rotate' takes an axis that is not 0 0 0, and at most 1e9 degrees");
        *out = rotation(fl_v3_normalize(axis), n[3]);
        return true;
    }
    default:
        return matrix_map(b, key, out);
    }
    if (out->m[0][0] == 0.0 || out->m[1][1] == 0.0 || out->m[2][2] == 0.0)
        return fl_error(b->diags, fl_build_loc(b, key), "'%s' must not be 0", key->key->name);
    return true;
}

bool fl_build_transform(fl_builder *b, const fl_node *node, fl_affine *out_map)
{
    fl_affine map = fl_affine_identity(), inverse;
    for (const fl_node *key = fl_node_first(node); key; key = fl_node_next(key)) {
        fl_affine next;
        if (key->kind != FL_NODE_KEY)
            continue;
        if (!key_map(b, key, &next))
            return false;
        /* A matrix is multiplied from the left, all others from the right: so the courses have it.
         */
        map =
            key->key->id == FL_KEY_MATRIX ? fl_affine_mul(&next, &map) : fl_affine_mul(&map, &next);
    }
    if (!fl_affine_invert(&map, &inverse))
        return fl_error(b->diags, fl_build_loc(b, node),
                        "the transforms here multiply to a singular matrix");
    *out_map = map;
    return true;
}

static uint32_t object_material(fl_builder *b, const fl_node *node)
{
    if (b->material != FL_NONE)
        return b->material;
    if (b->default_material == FL_NONE) {
        b->default_material = b->scene->material_count++;
        b->scene->materials[b->default_material] = (fl_material){.diffuse = fl_v3(1, 1, 1),
                                                                 .refraction_index = 1.0,
                                                                 .image = FL_NONE,
                                                                 .texture_scale = {1.0, 1.0},
                                                                 .loc = fl_build_loc(b, node)};
        if (b->default_material > 0)
            fl_warning(b->diags, fl_build_loc(b, node),
                       "no MaterialIndex before this object: it is plain white");
    }
    return b->default_material;
}

static bool set_square(fl_builder *b, const fl_node *node, fl_object *object)
{
    object->kind = FL_OBJECT_SQUARE;
    object->as.square.corner = fl_build_vec3(b, node, FL_KEY_CORNER);
    object->as.square.u = fl_build_vec3(b, node, FL_KEY_U);
    object->as.square.v = fl_build_vec3(b, node, FL_KEY_V);
    fl_vec3 u = fl_build_direction(b, node, FL_KEY_U), v = fl_build_direction(b, node, FL_KEY_V);
    if (fl_v3_max_abs(u) > 0.0 && fl_v3_max_abs(v) > 0.0 && fl_v3_length(fl_v3_cross(u, v)) < 1e-9)
        return fl_error(b->diags, fl_build_loc(b, node),
                        "'u' and 'v' of a 'Square' must not be parallel");
    return true;
}

static void set_triangle(fl_builder *b, const fl_node *node, fl_object *object)
{
    object->kind = FL_OBJECT_TRIANGLE;
    object->as.triangle.vertex[0] = fl_build_vec3(b, node, FL_KEY_VERTEX0);
    object->as.triangle.vertex[1] = fl_build_vec3(b, node, FL_KEY_VERTEX1);
    object->as.triangle.vertex[2] = fl_build_vec3(b, node, FL_KEY_VERTEX2);
}

static bool set_mesh(fl_builder *b, const fl_node *node, fl_object *object)
{
    object->kind = FL_OBJECT_MESH;
    object->as.mesh.mesh = fl_build_mesh_file(b, fl_node_key(node, FL_KEY_FILE));
    object->as.mesh.normals = (fl_normals)fl_build_choice(b, node, FL_KEY_NORMALS);
    bool is_flat = b->tree->dialect == FL_DIALECT_PA1 || b->tree->dialect == FL_DIALECT_M04;
    if (is_flat && !fl_node_key(node, FL_KEY_NORMALS))
        object->as.mesh.normals = FL_NORMALS_FLAT;
    return object->as.mesh.mesh != FL_NONE;
}

static bool set_revolution(fl_builder *b, const fl_node *node, fl_object *object)
{
    const fl_node *curve = fl_node_block(node, FL_BLOCK_BEZIER);
    const fl_node *texture = fl_node_key(node, FL_KEY_TEXTURE);
    if (!curve)
        curve = fl_node_block(node, FL_BLOCK_BSPLINE);
    if (!curve)
        return false; /* a lenient reader skipped what stood there */
    object->kind = FL_OBJECT_REVOLUTION;
    object->as.revolution.image = texture ? fl_build_image_file(b, texture) : FL_NONE;
    object->as.revolution.profile = fl_build_profile(b, curve);
    return object->as.revolution.profile != FL_NONE;
}

/* The shape of an object; false: there is none, or an error was reported. */
static bool set_shape(fl_builder *b, const fl_node *node, fl_object *object)
{
    switch (node->block->id) {
    case FL_BLOCK_SPHERE:
        object->kind = FL_OBJECT_SPHERE;
        object->as.sphere.center = fl_build_vec3(b, node, FL_KEY_CENTER);
        object->as.sphere.radius = fl_build_number(b, node, FL_KEY_RADIUS);
        return true;
    case FL_BLOCK_PLANE:
        object->kind = FL_OBJECT_PLANE;
        object->as.plane.normal = fl_build_vec3(b, node, FL_KEY_NORMAL);
        object->as.plane.offset = fl_build_number(b, node, FL_KEY_OFFSET);
        fl_build_direction(b, node, FL_KEY_NORMAL);
        return true;
    case FL_BLOCK_SQUARE:
        return set_square(b, node, object);
    case FL_BLOCK_DISK:
        object->kind = FL_OBJECT_DISK;
        object->as.disk.center = fl_build_vec3(b, node, FL_KEY_CENTER);
        object->as.disk.normal = fl_build_vec3(b, node, FL_KEY_NORMAL);
        object->as.disk.radius = fl_build_number(b, node, FL_KEY_RADIUS);
        fl_build_direction(b, node, FL_KEY_NORMAL);
        return true;
    case FL_BLOCK_TRIANGLE:
        set_triangle(b, node, object);
        return true;
    case FL_BLOCK_MESH:
        return set_mesh(b, node, object);
    case FL_BLOCK_REVOLUTION:
        return set_revolution(b, node, object);
    default: /* a curve by itself: rays do not meet it */
        if (b->tree->dialect == FL_DIALECT_FIRSTLIGHT)
            fl_warning(b->diags, fl_build_loc(b, node), "a '%s' by itself is never seen",
                       node->block->name);
        return false;
    }
}

static void build_members(fl_builder *b, const fl_node *parent, frame *f);

static void build_object(fl_builder *b, const fl_node *node, frame *f)
{
    if (node->block->id == FL_BLOCK_GROUP) {
        build_members(b, node, f);
    } else if (node->block->id == FL_BLOCK_TRANSFORM) {
        frame inner = {.index = FL_NONE};
        fl_affine map, inverse;
        if (!fl_build_transform(b, node, &map))
            map = fl_affine_identity();
        inner.to_world = fl_affine_mul(&f->to_world, &map);
        if (!fl_affine_invert(&inner.to_world, &inverse))
            fl_error(b->diags, fl_build_loc(b, node),
                     "with those around it, this transform is singular");
        build_members(b, node, &inner);
    } else {
        fl_object object = {.loc = fl_build_loc(b, node)};
        if (!set_shape(b, node, &object))
            return;
        object.material = object_material(b, node);
        object.transform = frame_index(b, f);
        b->scene->objects[b->scene->object_count++] = object;
    }
}

static void build_members(fl_builder *b, const fl_node *parent, frame *f)
{
    for (const fl_node *node = fl_node_first(parent); node; node = fl_node_next(node)) {
        if (node->kind == FL_NODE_BLOCK) {
            build_object(b, node, f);
        } else if (node->key->id == FL_KEY_MATERIAL_INDEX) {
            uint32_t count = b->scene->material_count - (b->default_material != FL_NONE);
            b->material = (uint32_t)node->numbers[0];
            if (b->material < count)
                continue;
            fl_error(b->diags, fl_build_loc(b, node),
                     "MaterialIndex %u, but there are %u materials", (unsigned)b->material,
                     (unsigned)count);
            b->material = FL_NONE;
        }
    }
}

void fl_build_objects(fl_builder *b, const fl_node *group)
{
    frame world = {.to_world = fl_affine_identity(), .index = FL_NONE};
    build_members(b, group, &world);
}
