/* SPDX-License-Identifier: MIT */
#include "viewer/camera.h"

/* Sine of the smallest angle between view and pole: half a degree. */
#define POLE_SINE 0.0087
#define LOG2_E    1.4426950408889634

/* `v` turned about the unit vector `axis_dir`, counter-clockwise seen against it [Rodrigues]. Where
 * a camera stands decides the picture: libm's sine, which differs between machines, is not used. */
static fl_vec3 rotate(fl_vec3 v, fl_vec3 axis_dir, double angle_rad)
{
    double s, c;
    fl_d_sincos(angle_rad, &s, &c);
    fl_vec3 along = fl_v3_scale(axis_dir, fl_v3_dot(axis_dir, v));
    fl_vec3 across = fl_v3_sub(v, along);
    fl_vec3 turned = fl_v3_cross(axis_dir, v);
    return fl_v3_add(along, fl_v3_add(fl_v3_scale(across, c), fl_v3_scale(turned, s)));
}

vw_basis vw_camera_basis(const fl_camera *camera)
{
    vw_basis basis;
    basis.forward = fl_v3_normalize(camera->direction);
    basis.right = fl_v3_normalize(fl_v3_cross(basis.forward, fl_v3_normalize(camera->up)));
    basis.up = fl_v3_cross(basis.right, basis.forward);
    return basis;
}

static double distance_to_pivot(const vw_state *state)
{
    return fl_v3_length(fl_v3_sub(state->pivot, state->look.camera.center));
}

static void aim_at_pivot(vw_state *state)
{
    fl_camera *camera = &state->look.camera;
    fl_vec3 way = fl_v3_sub(state->pivot, camera->center);
    camera->direction = fl_v3_scale(way, 1.0 / fl_v3_length(way));
}

double vw_camera_working_depth(const vw_state *state)
{
    const fl_camera *camera = &state->look.camera;
    if (state->mode == VW_MODE_ORBIT)
        return distance_to_pivot(state);
    if (camera->focus >= 1e-3 * state->scene_scale && camera->focus <= 10.0 * state->scene_scale)
        return camera->focus;
    fl_vec3 forward = fl_v3_normalize(camera->direction);
    double ahead = fl_v3_dot(forward, fl_v3_sub(state->scene_center, camera->center));
    return ahead > 0.1 * state->scene_scale ? ahead : state->scene_scale;
}

void vw_camera_toggle_orbit(vw_state *state)
{
    if (state->mode == VW_MODE_ORBIT) {
        state->mode = VW_MODE_FLY;
        return;
    }
    fl_camera *camera = &state->look.camera;
    fl_vec3 forward = fl_v3_normalize(camera->direction);
    state->pivot = fl_v3_mad(camera->center, forward, vw_camera_working_depth(state));
    state->mode = VW_MODE_ORBIT;
}

bool vw_camera_orbit_at(vw_state *state, fl_vec3 point)
{
    const fl_camera *camera = &state->look.camera;
    fl_vec3 way = fl_v3_sub(point, camera->center);
    double distance = fl_v3_length(way);
    if (!(distance > 1e-9 * state->scene_scale) || !isfinite(distance))
        return false;
    fl_vec3 across = fl_v3_cross(fl_v3_scale(way, 1.0 / distance), fl_v3_normalize(camera->up));
    if (!(fl_v3_length(across) > POLE_SINE))
        return false;
    state->pivot = point;
    state->mode = VW_MODE_ORBIT;
    aim_at_pivot(state);
    state->look.camera.focus = distance_to_pivot(state);
    return true;
}

/* Turn `forward` by yaw about the camera's up, then by pitch about its right, stopping short of the
 * pole. */
static fl_vec3 turn(const fl_camera *camera, double yaw_rad, double pitch_rad)
{
    fl_vec3 pole = fl_v3_normalize(camera->up);
    fl_vec3 yawed = rotate(fl_v3_normalize(camera->direction), pole, yaw_rad);
    fl_vec3 right = fl_v3_normalize(fl_v3_cross(yawed, pole));
    fl_vec3 pitched = fl_v3_normalize(rotate(yawed, right, pitch_rad));
    /* Past the pole the picture's right would flip. */
    bool is_over = fl_v3_dot(fl_v3_cross(pitched, pole), right) < POLE_SINE;
    return is_over ? fl_v3_normalize(yawed) : pitched;
}

static double clamp_angle(double angle_rad)
{
    return fl_clamp(angle_rad, -VW_PI, VW_PI);
}

void vw_camera_look(vw_state *state, double dx_px, double dy_px)
{
    fl_camera *camera = &state->look.camera;
    double height = (double)fl_max_u32(state->picture_height, 1);
    if (state->mode == VW_MODE_ORBIT) {
        double distance = distance_to_pivot(state);
        double per_px = VW_PI / height;
        camera->direction =
            turn(camera, clamp_angle(-dx_px * per_px), clamp_angle(-dy_px * per_px));
        camera->center = fl_v3_mad(state->pivot, camera->direction, -distance);
        return;
    }
    double fov_deg = camera->projection == FL_PERSPECTIVE ? camera->fov_deg : 45.0;
    double per_px = fov_deg * (VW_PI / 180.0) / height;
    camera->direction = turn(camera, clamp_angle(-dx_px * per_px), clamp_angle(-dy_px * per_px));
}

void vw_camera_fly(vw_state *state, double right, double up, double forward)
{
    fl_camera *camera = &state->look.camera;
    vw_basis basis = vw_camera_basis(camera);
    if (state->mode == VW_MODE_FLY) {
        fl_vec3 step = fl_v3_add(fl_v3_scale(basis.right, right),
                                 fl_v3_scale(fl_v3_normalize(camera->up), up));
        camera->center = fl_v3_add(camera->center, fl_v3_mad(step, basis.forward, forward));
        return;
    }
    double distance = distance_to_pivot(state);
    /* What the camera looks at stays sharp, unless the focus was pulled elsewhere. */
    bool is_focused = fabs(camera->focus - distance) <= 1e-6 * distance;
    camera->direction = turn(camera, clamp_angle(right / distance), clamp_angle(-up / distance));
    /* Who is closer than that already stays where he is. */
    distance = fl_max(distance - forward, fl_min(distance, 1e-3 * state->scene_scale));
    camera->center = fl_v3_mad(state->pivot, camera->direction, -distance);
    aim_at_pivot(state);
    if (is_focused)
        camera->focus = distance_to_pivot(state);
}

void vw_camera_pan(vw_state *state, double dx_px, double dy_px)
{
    fl_camera *camera = &state->look.camera;
    vw_basis basis = vw_camera_basis(camera);
    double height = (double)fl_max_u32(state->picture_height, 1);
    double view_height =
        camera->projection == FL_PERSPECTIVE
            ? 2.0 * fl_d_tan_deg(camera->fov_deg / 2.0) * vw_camera_working_depth(state)
            : camera->ortho_size;
    double per_px = view_height / height;
    fl_vec3 step =
        fl_v3_add(fl_v3_scale(basis.right, -dx_px * per_px), fl_v3_scale(basis.up, dy_px * per_px));
    camera->center = fl_v3_add(camera->center, step);
    if (state->mode == VW_MODE_ORBIT)
        state->pivot = fl_v3_add(state->pivot, step);
}

void vw_camera_dolly(vw_state *state, double dy_px)
{
    fl_camera *camera = &state->look.camera;
    double part = -dy_px / (double)fl_max_u32(state->picture_height, 1);
    if (state->mode == VW_MODE_FLY) {
        fl_vec3 forward = fl_v3_normalize(camera->direction);
        camera->center = fl_v3_mad(camera->center, forward, part * vw_camera_working_depth(state));
        return;
    }
    double distance = distance_to_pivot(state);
    double target = distance * fl_d_exp2(fl_clamp(-2.0 * part, -8.0, 8.0) * LOG2_E);
    vw_camera_fly(state, 0.0, 0.0, distance - target);
}
