/* What the sections are made with: worlds, water and bodies, the ways that they go, and what is seen of them. */
#include <stdlib.h>
#include <string.h>

#include "tests/determinism/scene.h"

/* Of what is no number, only that it is none: processors differ in the bits of infinity - infinity. */
void see_float(Scene *scene, float value) {
    uint32_t bits;
    if (!(value == value)) {
        see_text(scene, "none");
        return;
    }
    memcpy(&bits, &value, sizeof bits);
    see_u32(scene, bits);
}

void see_double(Scene *scene, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    see_u64(scene, bits);
}

void see_vec3(Scene *scene, const frm_vec3 *value) {
    see_float(scene, value->x);
    see_float(scene, value->y);
    see_float(scene, value->z);
}

static void see_wrench(Scene *scene, const frm_wrench *value) {
    see_vec3(scene, &value->force);
    see_vec3(scene, &value->torque);
}

void see_body(Scene *scene, frm_body body) {
    static frm_source_state sources[512];
    frm_forces forces;
    frm_body_state state;
    uint32_t count = 0, i;
    memset(&forces, 0, sizeof forces);
    forces.struct_size = sizeof forces;
    MUST(scene, frm_body_get_forces(body, &forces));
    see_wrench(scene, &forces.buoyancy);
    see_wrench(scene, &forces.pressure);
    see_wrench(scene, &forces.friction);
    see_wrench(scene, &forces.gravity);
    see_wrench(scene, &forces.total);
    memset(&state, 0, sizeof state);
    state.struct_size = sizeof state;
    MUST(scene, frm_body_get_state(body, &state));
    see_float(scene, state.wet_area);
    see_float(scene, state.displaced_volume);
    see_float(scene, state.relative_speed);
    see_float(scene, state.reynolds);
    see_u32(scene, state.wet_sources);
    MUST(scene, frm_body_get_sources(body, sources, 512, &count));
    for (i = 0; i < count; ++i) {
        see_double(scene, sources[i].position.x);
        see_double(scene, sources[i].position.y);
        see_double(scene, sources[i].position.z);
        see_vec3(scene, &sources[i].force);
        see_vec3(scene, &sources[i].relative_velocity);
        see_float(scene, sources[i].wet_ratio);
        see_float(scene, sources[i].map_time);
    }
}

void see_world(Scene *scene, frm_world world) {
    frm_world_stats stats;
    uint64_t hash = 0;
    memset(&stats, 0, sizeof stats);
    stats.struct_size = sizeof stats;
    MUST(scene, frm_world_get_stats(world, &stats));
    see_double(scene, stats.time);
    see_u64(scene, stats.ticks);
    see_u64(scene, stats.water_waits);
    see_u32(scene, stats.wet_bodies);
    see_u32(scene, stats.wet_sources);
    see_u32(scene, stats.clipped_triangles);
    see_u32(scene, stats.water_substeps);
    see_u32(scene, stats.dry_bodies);
    see_u32(scene, stats.whole_bodies);
    see_u32(scene, stats.still_bodies);
    see_u32(scene, stats.deep_bodies);
    see_u32(scene, stats.coarse_bodies);
    see_u32(scene, stats.frictionless_sources);
    see_u32(scene, stats.steady_sources);
    see_u32(scene, stats.active_cells);
    MUST(scene, frm_world_hash(world, &hash));
    see_u64(scene, hash);
}

void see_water(Scene *scene, frm_water water, int snapshot) {
    frm_water_state state;
    float *values;
    uint64_t cells, i;
    memset(&state, 0, sizeof state);
    state.struct_size = sizeof state;
    MUST(scene, frm_water_read(water, &state));
    cells = (uint64_t)state.nx * state.ny;
    values = malloc((size_t)cells * 3 * sizeof *values);
    covers(values != NULL, "no memory for the water");
    state.capacity = cells;
    state.height = values;
    state.velocity_x = values + cells;
    state.velocity_y = values + 2 * cells;
    if (snapshot)
        MUST(scene, frm_water_read_snapshot(water, &state));
    else
        MUST(scene, frm_water_read(water, &state));
    see_u64(scene, state.tick);
    see_double(scene, state.time);
    for (i = 0; i < 3 * cells; ++i) see_float(scene, values[i]);
    free(values);
}

frm_world_def world_def(void) {
    frm_world_def def;
    frm_world_def_init(&def, sizeof def);
    return def;
}

frm_world make_world(Scene *scene, const frm_world_def *def) {
    frm_world world = 0;
    MUST(scene, frm_world_create(scene->context, def, &world));
    return world;
}

frm_water make_water(Scene *scene, frm_world world, uint32_t nx, uint32_t ny, uint32_t border, uint32_t order) {
    frm_water_def def;
    frm_water water = 0;
    MUST(scene, frm_water_def_init(&def, sizeof def));
    def.nx = nx;
    def.ny = ny;
    def.border = border;
    def.border_cells = border == FRM_BORDER_ABSORBING ? 10 : 0;
    def.order = order;
    MUST(scene, frm_water_create(world, &def, &water));
    return water;
}

frm_body make_body(Scene *scene, frm_world world, frm_map map, float scale, float mass) {
    frm_body_def def;
    frm_body body = 0;
    MUST(scene, frm_body_def_init(&def, sizeof def));
    def.map = map;
    def.scale = scale;
    def.mass = mass;
    def.centre_of_mass.x = 0.01f;
    def.centre_of_mass.z = -0.02f;
    MUST(scene, frm_body_create(world, &def, &body));
    return body;
}

/* Two parabolas a period in place of a sine: the value, -1 to 1, and its slope in time. */
static double swing(double time, double period, double *slope) {
    const double turns = time / period;
    const double q = 4 * (turns - (double)(int32_t)turns), x = q < 2 ? q - 1 : q - 3;
    *slope = (q < 2 ? -2 * x : 2 * x) * 4 / period;
    return q < 2 ? 1 - x * x : x * x - 1;
}

void place(Scene *scene, frm_body body, const Path *path, double time) {
    double slope[3], at[3];
    frm_pose pose;
    frm_twist twist;
    at[0] = swing(time, path->period, &slope[0]);
    at[1] = swing(time, 1.25 * path->period, &slope[1]);
    at[2] = swing(time, 1.5 * path->period, &slope[2]);
    pose.position.x = path->centre.x + (double)path->reach.x * at[0];
    pose.position.y = path->centre.y + (double)path->reach.y * at[1];
    pose.position.z = path->centre.z + (double)path->reach.z * at[2];
    pose.rotation.x = path->turn * (float)at[1];
    pose.rotation.y = path->turn * (float)at[2];
    pose.rotation.z = path->turn * (float)at[0];
    pose.rotation.w = 1;
    twist.linear.x = path->reach.x * (float)slope[0];
    twist.linear.y = path->reach.y * (float)slope[1];
    twist.linear.z = path->reach.z * (float)slope[2];
    twist.angular.x = path->spin * (float)at[2];
    twist.angular.y = path->spin * (float)at[0];
    twist.angular.z = path->spin * (float)at[1];
    MUST(scene, frm_body_set_motion(body, &pose, &twist));
}
