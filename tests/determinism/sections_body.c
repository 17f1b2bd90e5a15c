/* Bodies without waves: what a map says, streams from everywhere, the flat surface, other axes, fluids and places. */
#include <stdlib.h>
#include <string.h>

#include "tests/determinism/scene.h"

static void see_map(Scene *scene, frm_map map) {
    frm_map_info info;
    uint32_t i;
    char *text;
    uint64_t size = 0;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    MUST(scene, frm_map_get_info(map, &info));
    see_u32(scene, info.format_version);
    see_u64(scene, info.content_hash);
    see_u32(scene, info.sources);
    see_u32(scene, info.directions);
    see_u32(scene, info.fluctuation_directions);
    see_u32(scene, info.speeds);
    see_u32(scene, info.samples);
    see_u32(scene, info.triangles);
    see_float(scene, info.period);
    see_float(scene, info.base_speed);
    see_float(scene, info.density);
    see_float(scene, info.viscosity);
    see_float(scene, info.reynolds);
    see_float(scene, info.reynolds_solved);
    see_float(scene, info.reference_length);
    see_float(scene, info.quantisation_error);
    see_float(scene, info.area);
    see_float(scene, info.volume);
    see_vec3(scene, &info.centroid);
    see_vec3(scene, &info.bounds_low);
    see_vec3(scene, &info.bounds_high);
    see_float(scene, info.direction_error_rms);
    see_float(scene, info.direction_error_worst);
    see_float(scene, info.uncertainty);
    for (i = 0; i < info.sources; ++i) {
        frm_map_source source;
        memset(&source, 0, sizeof source);
        source.struct_size = sizeof source;
        MUST(scene, frm_map_get_source(map, i, &source));
        see_float(scene, source.area);
        see_vec3(scene, &source.position);
        see_vec3(scene, &source.normal);
    }
    if (info.has_added_mass) {
        double matrix[36];
        MUST(scene, frm_map_get_added_mass(map, 1025, 0.7f, matrix));
        for (i = 0; i < 36; ++i) see_double(scene, matrix[i]);
    }
    MUST(scene, frm_map_get_provenance(map, NULL, 0, &size));
    text = malloc((size_t)size);
    covers(text != NULL, "no memory for a text");
    MUST(scene, frm_map_get_provenance(map, text, size, &size));
    see_text(scene, text);
    free(text);
}

void section_maps(Scene *scene) {
    frm_map_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    see_map(scene, scene->old_map);
    see_map(scene, scene->full_map);
    see_map(scene, scene->many_map);
    MUST(scene, frm_map_get_info(scene->full_map, &info));
    covers(info.has_added_mass && info.has_spin && info.speeds > 1, "the full map lacks something");
    MUST(scene, frm_map_get_info(scene->many_map, &info));
    covers(info.sources > 64, "the map of many sources has too few for clusters");
}

/* Ticks a world of bodies that follow paths, and sees them. */
static void go(Scene *scene, frm_world world, const frm_body *bodies, const Path *paths, unsigned count, unsigned ticks,
               float dt) {
    unsigned t, b;
    for (t = 0; t < ticks; ++t) {
        for (b = 0; b < count; ++b) place(scene, bodies[b], &paths[b], (double)t * (double)dt);
        MUST(scene, frm_world_tick(world, dt));
        for (b = 0; b < count; ++b) see_body(scene, bodies[b]);
    }
    see_world(scene, world);
}

/* Fluid everywhere, and streams from every side, slow and fast: all cells of the direction sets. */
void section_immersed(Scene *scene) {
    frm_world_def def = world_def();
    frm_world world;
    frm_body bodies[3];
    const Path paths[3] = {{{0, 0, 0}, {0.9f, 0.8f, 0.7f}, 0.41, 0.9f, 4.0f},
                           {{5, 0, 0}, {0.02f, 0.03f, 0.01f}, 0.77, 0.5f, 25.0f},
                           {{0, 5, 0}, {2.0f, 1.0f, 3.0f}, 0.63, 1.5f, 0.5f}};
    def.surface = FRM_SURFACE_NONE;
    world = make_world(scene, &def);
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->full_map, 1.3f, 0.4f);
    bodies[2] = make_body(scene, world, scene->old_map, 0.5f, 0);
    go(scene, world, bodies, paths, 3, 400, 0.002f);
}

/* In and out of a flat surface, tilted, and bodies that stay dry, half wet and wholly wet. */
void section_surface(Scene *scene) {
    frm_world_def def = world_def();
    frm_world world;
    frm_body bodies[5];
    frm_world_stats stats;
    const Path paths[5] = {{{0, 0, 0}, {0.3f, 0.2f, 0.5f}, 0.31, 0.8f, 3.0f},
                           {{1, 0, 0.02}, {0, 0, 0.01f}, 0.5, 0.1f, 0.2f},
                           {{2, 0, -0.6}, {0.2f, 0.1f, 0.05f}, 0.37, 0.3f, 1.0f},
                           {{3, 0, 0.9}, {0.2f, 0.1f, 0.05f}, 0.43, 0.3f, 1.0f},
                           {{4, 0, -0.05}, {0.1f, 0.1f, 0.2f}, 0.29, 2.0f, 12.0f}};
    def.level = 0.015;
    world = make_world(scene, &def);
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->full_map, 1, 1);
    bodies[2] = make_body(scene, world, scene->old_map, 1, 1);
    bodies[3] = make_body(scene, world, scene->many_map, 0.5f, 1);
    bodies[4] = make_body(scene, world, scene->full_map, 0.8f, 0.3f);
    go(scene, world, bodies, paths, 5, 400, 0.002f);
    memset(&stats, 0, sizeof stats);
    stats.struct_size = sizeof stats;
    MUST(scene, frm_world_get_stats(world, &stats));
    covers(stats.clipped_triangles > 0 && stats.wet_bodies < 5 && stats.wet_bodies > 1,
           "bodies are not dry, half wet and wet at a time");
}

/* The same in a host's left-handed axes with y up: what comes out is in them too. */
void section_axes(Scene *scene) {
    const frm_world_def def = world_def();
    const frm_world world = make_world(scene, &def);
    frm_body bodies[2];
    const Path paths[2] = {{{0, 0, 0}, {0.2f, 0.3f, 0.4f}, 0.35, 0.7f, 5.0f},
                           {{0, -0.5, 2}, {0.2f, 0.1f, 0.3f}, 0.45, 0.4f, 2.0f}};
    bodies[0] = make_body(scene, world, scene->full_map, 1, 1);
    bodies[1] = make_body(scene, world, scene->many_map, 1, 1);
    see_map(scene, scene->full_map);
    go(scene, world, bodies, paths, 2, 200, 0.004f);
}

/* Glycerine, air and the fluid of another planet; ticks of many lengths. */
void section_fluids(Scene *scene) {
    static const struct {
        float density, viscosity, gravity, dt;
    } fluids[] = {{1260, 1.1e-3f, 9.80665f, 0.001f}, {1.2f, 1.5e-5f, 9.80665f, 0.01f}, {660, 5e-7f, 1.352f, 0.0333f}};
    unsigned i;
    for (i = 0; i < sizeof fluids / sizeof fluids[0]; ++i) {
        frm_world_def def = world_def();
        frm_world world;
        frm_body bodies[2];
        const Path paths[2] = {{{0, 0, 0}, {0.2f, 0.3f, 0.4f}, 0.57, 0.7f, 5.0f},
                               {{3, 0, -0.9}, {0.4f, 0.1f, 0.3f}, 0.79, 0.4f, 2.0f}};
        def.density = fluids[i].density;
        def.viscosity = fluids[i].viscosity;
        def.gravity = fluids[i].gravity;
        world = make_world(scene, &def);
        bodies[0] = make_body(scene, world, scene->full_map, 20, 100);
        bodies[1] = make_body(scene, world, scene->many_map, 0.05f, 0.001f);
        go(scene, world, bodies, paths, 2, 120, fluids[i].dt);
    }
}

/* Ten kilometres from the origin, with water there, and 1e8 m away without. */
void section_far(Scene *scene) {
    frm_world_def def = world_def();
    frm_world world;
    frm_water water = 0;
    frm_water_def field;
    frm_body bodies[2];
    const Path near_by[2] = {{{10000, -7000, 3000}, {0.3f, 0.2f, 0.15f}, 0.4, 0.5f, 3.0f},
                             {{10000.5, -7000.3, 2999.9}, {0.1f, 0.2f, 0.1f}, 0.6, 0.5f, 3.0f}};
    const Path out_there[2] = {{{1e8, 0, 0}, {0.3f, 0.2f, 0.15f}, 0.4, 0.5f, 3.0f},
                               {{0, -1e8, -0.2}, {0.1f, 0.2f, 0.1f}, 0.6, 0.5f, 3.0f}};
    def.level = 3000.0;
    world = make_world(scene, &def);
    MUST(scene, frm_water_def_init(&field, sizeof field));
    field.nx = field.ny = 80;
    field.border_cells = 8;
    field.centre_x = 10000.1;
    field.centre_y = -7000.1;
    MUST(scene, frm_water_create(world, &field, &water));
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->full_map, 1, 1);
    go(scene, world, bodies, near_by, 2, 150, 0.002f);
    see_water(scene, water, 0);
    MUST(scene, frm_world_destroy(world));
    def.level = 0;
    world = make_world(scene, &def);
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->full_map, 1, 1);
    go(scene, world, bodies, out_there, 2, 50, 0.002f);
}
