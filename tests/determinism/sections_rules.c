/* What is repaired of the paper's method, what is left out, and budgets: each alone, all, and none. */
#include <string.h>

#include "tests/determinism/scene.h"

enum { body_count = 7 };

/* What was left out, summed over ticks. */
typedef struct Left {
    uint64_t dry, whole, still, deep, coarse, frictionless, steady, calm, waits;
} Left;

/* A world in which every rule has its case: a stirrer, a steady body under calm water, one far above it, one at rest at the
 * surface, one on the ground of deep water, a tiny one, and a slow one. */
static Left rules(Scene *scene, const frm_world_def *def, unsigned ticks, float dt) {
    static const Path paths[body_count] = {{{0.3, 0.2, 0}, {0.3f, 0.2f, 0.1f}, 0.45, 0.6f, 3.0f},
                                           {{-0.9, -0.9, -0.9}, {0.6f, 0.02f, 0.01f}, 0.1, 0.1f, 0},
                                           {{1.5, 1.5, 9}, {0.2f, 0.1f, 0.05f}, 0.47, 0.4f, 6.0f},
                                           {{-0.8, 0.9, 0.01}, {0, 0, 0}, 1, 0, 0},
                                           {{0.5, -0.9, -3.6}, {0.1f, 0.1f, 0.1f}, 0.7, 0.1f, 0.5f},
                                           {{1.1, -0.4, -0.01}, {0.2f, 0.1f, 0.01f}, 0.6, 0.6f, 9.0f},
                                           {{-1.2, 0, -0.5}, {1e-5f, 1e-5f, 1e-5f}, 0.8, 0, 1e-5f}};
    const frm_world world = make_world(scene, def);
    frm_water_def field;
    frm_water water = 0;
    frm_body bodies[body_count];
    Left left;
    unsigned t, b;
    memset(&left, 0, sizeof left);
    MUST(scene, frm_water_def_init(&field, sizeof field));
    field.nx = 160;
    field.ny = 130;
    field.border_cells = 12;
    field.depth = 4;
    MUST(scene, frm_water_create(world, &field, &water));
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->many_map, 0.8f, 1);
    bodies[2] = make_body(scene, world, scene->full_map, 1, 1);
    bodies[3] = make_body(scene, world, scene->full_map, 0.9f, 1);
    bodies[4] = make_body(scene, world, scene->old_map, 1, 1);
    bodies[5] = make_body(scene, world, scene->many_map, 0.05f, 0);
    bodies[6] = make_body(scene, world, scene->many_map, 1, 1);
    for (t = 0; t < ticks; ++t) {
        frm_world_stats stats;
        memset(&stats, 0, sizeof stats);
        stats.struct_size = sizeof stats;
        for (b = 0; b < body_count; ++b) place(scene, bodies[b], &paths[b], (double)t * (double)dt);
        MUST(scene, frm_world_tick(world, dt));
        for (b = 0; b < body_count; ++b) see_body(scene, bodies[b]);
        MUST(scene, frm_world_get_stats(world, &stats));
        left.dry += stats.dry_bodies;
        left.whole += stats.whole_bodies;
        left.still += stats.still_bodies;
        left.deep += stats.deep_bodies;
        left.coarse += stats.coarse_bodies;
        left.frictionless += stats.frictionless_sources;
        left.steady += stats.steady_sources;
        left.calm += stats.active_cells < field.nx * field.ny;
        left.waits = stats.water_waits;
        if (t % 8 == 0) see_world(scene, world);
    }
    see_world(scene, world);
    see_water(scene, water, 0);
    MUST(scene, frm_world_destroy(world));
    return left;
}

void section_models(Scene *scene) {
    uint32_t bit;
    frm_world_def def = world_def();
    def.model = FRM_MODEL_PAPER;
    rules(scene, &def, 80, 0.002f);
    for (bit = 1; bit < FRM_MODEL_DEFAULT; bit *= 2) {
        def.model = bit;
        rules(scene, &def, 40, 0.002f);
    }
    def.model = FRM_MODEL_PAPER;
    def.skip = FRM_SKIP_NOTHING;
    rules(scene, &def, 40, 0.002f);
}

static void add(Left *sum, const Left *left) {
    sum->dry += left->dry;
    sum->whole += left->whole;
    sum->still += left->still;
    sum->deep += left->deep;
    sum->frictionless += left->frictionless;
    sum->steady += left->steady;
    sum->calm += left->calm;
    sum->waits += left->waits;
}

void section_skips(Scene *scene) {
    uint32_t bit;
    frm_world_def def = world_def();
    Left sum = rules(scene, &def, 100, 0.002f), left = rules(scene, &def, 40, 0.0002f);
    add(&sum, &left);
    /* Friction is next to nothing in a fluid without viscosity. */
    def.viscosity = 1e-9f;
    left = rules(scene, &def, 40, 0.001f);
    add(&sum, &left);
    covers(sum.dry && sum.whole && sum.still && sum.deep && sum.calm,
           "a rule that leaves out bodies or water has no case");
    covers(sum.frictionless && sum.steady && sum.waits, "a rule that leaves out sources or steps has no case");
    def.skip = FRM_SKIP_NOTHING;
    left = rules(scene, &def, 40, 0.0002f);
    covers(!left.dry && !left.whole && !left.still && !left.deep && !left.frictionless && !left.steady && !left.waits,
           "something is left out where nothing should be");
    for (bit = 1; bit < FRM_SKIP_DEFAULT; bit *= 2) {
        def.skip = bit;
        rules(scene, &def, 30, 0.0004f);
    }
}

/* Waves that come to tiles at rest, wake them and leave them calm again. */
void section_calm(Scene *scene) {
    const frm_world_def def = world_def();
    const frm_world world = make_world(scene, &def);
    const frm_body body = make_body(scene, world, scene->many_map, 0.2f, 1);
    const Path path = {{-1, -0.8, 0}, {0.02f, 0.01f, 0.01f}, 0.3, 0.3f, 1.0f},
               away = {{-1, -0.8, 90}, {0, 0, 0}, 1, 0, 0};
    frm_water_def field;
    frm_water water = 0;
    uint32_t first = 0, most = 0, last = 0;
    unsigned t;
    MUST(scene, frm_water_def_init(&field, sizeof field));
    field.nx = 130;
    field.ny = 100;
    field.border_cells = 30;
    MUST(scene, frm_water_create(world, &field, &water));
    for (t = 0; t < 400; ++t) {
        frm_world_stats stats;
        memset(&stats, 0, sizeof stats);
        stats.struct_size = sizeof stats;
        place(scene, body, t < 40 ? &path : &away, 0.004 * (double)t);
        MUST(scene, frm_world_tick(world, t < 60 ? 0.008f : 0.1f));
        MUST(scene, frm_world_get_stats(world, &stats));
        see_body(scene, body);
        see_u32(scene, stats.active_cells);
        if (t % 100 == 0) see_world(scene, world);
        last = stats.active_cells;
        if (t == 0) first = last;
        if (last > most) most = last;
    }
    covers(first < most && last < most, "no tile woke or none came to rest");
    see_water(scene, water, 0);
}

/* Groups of sources stand for the sources where no wave is near: with no surface, and at a flat one. */
void section_budgets(Scene *scene) {
    static const float errors[] = {0, 1e-3f, 0.3f, 30};
    static const float times[] = {0, 0.2f, 0.7f, 3};
    static const Path paths[3] = {{{0, 0, 0}, {0.3f, 0.2f, 0.1f}, 0.45, 0.6f, 3.0f},
                                  {{2, 0, -0.9}, {0.5f, 0.2f, 0.1f}, 0.3, 0.1f, 0.3f},
                                  {{4, 0, 0}, {0.05f, 0.02f, 0.3f}, 0.9, 0.3f, 1.0f}};
    uint64_t coarse = 0;
    unsigned surface, e, b, t;
    for (surface = FRM_SURFACE_FLAT; surface <= FRM_SURFACE_NONE; ++surface)
        for (e = 0; e < 16; ++e) {
            frm_world_def def = world_def();
            frm_world world;
            frm_body bodies[3];
            def.surface = surface;
            def.error_budget = errors[e / 4];
            def.time_budget = times[e % 4];
            if (e % 2) def.model &= ~(uint32_t)FRM_MODEL_SPIN;
            world = make_world(scene, &def);
            bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
            bodies[1] = make_body(scene, world, scene->many_map, 0.8f, 1);
            bodies[2] = make_body(scene, world, scene->full_map, 1, 1);
            for (t = 0; t < 40; ++t) {
                frm_world_stats stats;
                memset(&stats, 0, sizeof stats);
                stats.struct_size = sizeof stats;
                for (b = 0; b < 3; ++b) place(scene, bodies[b], &paths[b], 0.005 * (double)t);
                MUST(scene, frm_world_tick(world, 0.005f));
                for (b = 0; b < 3; ++b) see_body(scene, bodies[b]);
                MUST(scene, frm_world_get_stats(world, &stats));
                coarse += stats.coarse_bodies;
            }
            see_world(scene, world);
            MUST(scene, frm_world_destroy(world));
        }
    covers(coarse > 1000, "hardly a body was looked up by groups");
}
