/* Bodies and waves: both borders and orders, what the host does to the water, water for several threads, what diverges,
 * what jumps. */
#include <stdlib.h>
#include <string.h>

#include "tests/determinism/scene.h"

enum { body_count = 3 };

/* A stirrer through the surface, a slow floater, a diver. */
static const Path paths[body_count] = {{{0, 0, 0}, {0.5f, 0.4f, 0.12f}, 0.53, 0.6f, 3.0f},
                                       {{-0.4, 0.5, 0.01}, {0.05f, 0.02f, 0.01f}, 0.9, 0.1f, 0.3f},
                                       {{0.5, -0.5, -0.22}, {0.2f, 0.1f, 0.05f}, 0.47, 0.4f, 6.0f}};

static void make_bodies(Scene *scene, frm_world world, frm_body *bodies) {
    bodies[0] = make_body(scene, world, scene->many_map, 1, 2);
    bodies[1] = make_body(scene, world, scene->old_map, 0.6f, 1);
    bodies[2] = make_body(scene, world, scene->full_map, 0.8f, 1);
}

static void go(Scene *scene, frm_world world, const frm_body *bodies, unsigned from, unsigned to, float dt) {
    unsigned t, b;
    for (t = from; t < to; ++t) {
        for (b = 0; b < body_count; ++b) place(scene, bodies[b], &paths[b], (double)t * (double)dt);
        MUST(scene, frm_world_tick(world, dt));
        for (b = 0; b < body_count; ++b) see_body(scene, bodies[b]);
        if (t % 16 == 0) see_world(scene, world);
    }
    see_world(scene, world);
}

/* Ticks of 1 to 17 ms, as a game's frames come: steps of the water that they share, and what is left over. */
static void go_unevenly(Scene *scene, frm_world world, const frm_body *bodies, double time) {
    unsigned t, b;
    for (t = 0; t < 60; ++t) {
        const float dt = 0.001f * (float)(1 + 7 * t % 17);
        time += (double)dt;
        for (b = 0; b < body_count; ++b) place(scene, bodies[b], &paths[b], time);
        MUST(scene, frm_world_tick(world, dt));
        for (b = 0; b < body_count; ++b) see_body(scene, bodies[b]);
    }
    see_world(scene, world);
}

static void see_height(Scene *scene, frm_water water, double x, double y) {
    double height = 0;
    MUST(scene, frm_water_get_height(water, x, y, &height));
    see_double(scene, height);
}

static void waves(Scene *scene, uint32_t nx, uint32_t ny, uint32_t border) {
    uint32_t order;
    for (order = 2; order <= 4; order += 2) {
        const frm_world_def def = world_def();
        const frm_world world = make_world(scene, &def);
        const frm_water water = make_water(scene, world, nx, ny, border, order);
        frm_body bodies[body_count];
        frm_water_state state;
        make_bodies(scene, world, bodies);
        go(scene, world, bodies, 0, 160, 0.002f);
        see_water(scene, water, 1);
        go(scene, world, bodies, 160, 260, 0.004f);
        see_water(scene, water, 0);
        go_unevenly(scene, world, bodies, 260 * 0.004);
        see_water(scene, water, 1);
        see_height(scene, water, 0.031, -0.017);
        see_height(scene, water, 50, 50);
        memset(&state, 0, sizeof state);
        state.struct_size = sizeof state;
        MUST(scene, frm_water_read(water, &state));
        covers(state.time > 0, "the water did not move");
    }
}

void section_absorbing(Scene *scene) { waves(scene, 96, 80, FRM_BORDER_ABSORBING); }

/* Not a multiple of any vector, and narrower than a tile at its end. */
void section_reflecting(Scene *scene) { waves(scene, 83, 67, FRM_BORDER_REFLECTING); }

/* Heights and pressure that the host gives, in a host's axes with y up; nothing left out. */
void section_host_water(Scene *scene) {
    enum { nx = 70, ny = 90 };
    frm_world_def def = world_def();
    frm_world world;
    frm_water water;
    frm_body body;
    float *values = malloc(nx * ny * sizeof *values);
    int t, i, j;
    const Path path = {{0, 0, 0}, {0.3f, 0.1f, 0.3f}, 0.4, 0.5f, 3.0f};
    covers(values != NULL, "no memory for the water");
    def.skip = FRM_SKIP_NOTHING;
    world = make_world(scene, &def);
    water = make_water(scene, world, nx, ny, FRM_BORDER_ABSORBING, 2);
    body = make_body(scene, world, scene->full_map, 1, 1);
    for (j = 0; j < ny; ++j)
        for (i = 0; i < nx; ++i) {
            const float x = (float)(i - 30), y = (float)(j - 50), d = x * x + y * y;
            values[j * nx + i] = d < 400 ? 0.0001f * (400 - d) : 0;
        }
    MUST(scene, frm_water_set_height(water, values, nx * ny));
    for (t = 0; t < 180; ++t) {
        if (t == 60) {
            for (i = 0; i < nx * ny; ++i) values[i] = i % nx > 20 && i % nx < 40 ? 50.0f * (float)(i / nx) / ny : 0;
            MUST(scene, frm_water_set_pressure(water, values, nx * ny));
        }
        if (t == 120) MUST(scene, frm_water_set_pressure(water, NULL, 0));
        place(scene, body, &path, 0.003 * (double)t);
        MUST(scene, frm_world_tick(world, 0.003f));
        see_body(scene, body);
        if (t % 20 == 0) see_world(scene, world);
        if (t % 45 == 0) see_water(scene, water, 1);
    }
    see_water(scene, water, 0);
    free(values);
}

/* Enough cells, all of them moving, for several threads. */
void section_large(Scene *scene) {
    enum { side = 560 };
    uint32_t order;
    for (order = 2; order <= 4; order += 2) {
        const frm_world_def def = world_def();
        const frm_world world = make_world(scene, &def);
        const frm_water water =
            make_water(scene, world, side, side, order == 2 ? FRM_BORDER_ABSORBING : FRM_BORDER_REFLECTING, order);
        float *values = malloc(side * side * sizeof *values);
        frm_body bodies[body_count];
        frm_world_stats stats;
        int i;
        covers(values != NULL, "no memory for the water");
        for (i = 0; i < side * side; ++i)
            values[i] = 0.0005f * (float)((i % side * 7 + i / side * 13) % 64 - 32) / 32.0f;
        MUST(scene, frm_water_set_height(water, values, side * side));
        make_bodies(scene, world, bodies);
        go(scene, world, bodies, 0, 4, 0.01f);
        memset(&stats, 0, sizeof stats);
        stats.struct_size = sizeof stats;
        MUST(scene, frm_world_get_stats(world, &stats));
        covers(stats.active_cells >= 1u << 18, "the large water is too calm for threads");
        see_water(scene, water, 0);
        free(values);
    }
}

/* What no scene should do, short of what is refused: the fastest bodies, the longest ticks, the host's greatest pressure, in
 * water that feels its own waves. Forces leave the range of numbers, or nearly; what is left must not be a processor's own
 * idea of a number that is none. */
void section_extreme(Scene *scene) {
    enum { side = 48 };
    static const Path fast[body_count] = {{{0, 0, 0}, {0.5f, 0.4f, 0.12f}, 0.53, 0.6f, 9e3f},
                                          {{-0.4, 0.5, 0.01}, {0.3f, 0.2f, 0.01f}, 3e-4, 0.1f, 9e3f},
                                          {{0.5, -0.5, -0.22}, {0.2f, 0.1f, 0.05f}, 2e-4, 0.4f, 9e3f}};
    static const uint32_t models[] = {FRM_MODEL_PAPER, FRM_MODEL_DISPLACEMENT, FRM_MODEL_DEFAULT};
    static float values[side * side];
    unsigned m;
    int seen = 0;
    for (m = 0; m < 3; ++m) {
        frm_world_def def = world_def();
        frm_world world;
        frm_water water;
        frm_body bodies[body_count];
        int i, t;
        def.model = models[m];
        def.density = m == 1 ? 1e-3f : 1e5f;
        world = make_world(scene, &def);
        water = make_water(scene, world, side, side, FRM_BORDER_REFLECTING, 2);
        make_bodies(scene, world, bodies);
        for (t = 0; t < 60; ++t) {
            int b;
            frm_status status;
            if (t == 15 || t == 40) {
                for (i = 0; i < side * side; ++i) values[i] = i / 3 % 2 ? 1e9f : -1e9f;
                MUST(scene, frm_water_set_pressure(water, values, side * side));
            }
            if (t == 25) MUST(scene, frm_water_set_pressure(water, NULL, 0));
            for (b = 0; b < body_count; ++b) place(scene, bodies[b], &fast[b], 0.01 * (double)t);
            status = frm_world_tick(world, 0.1f);
            seen += status == FRM_ERROR_DIVERGED;
            if (status != FRM_ERROR_DIVERGED) MUST(scene, status);
            see_u32(scene, (uint32_t)status);
            for (b = 0; b < body_count; ++b) see_body(scene, bodies[b]);
            see_world(scene, world);
            see_water(scene, water, 0);
        }
    }
    covers(seen > 0 && seen < 180, "nothing diverged");
}

/* Bodies that jump, come and go; water that goes and comes. */
void section_teleports(Scene *scene) {
    const frm_world_def def = world_def();
    const frm_world world = make_world(scene, &def);
    frm_water water = make_water(scene, world, 80, 80, FRM_BORDER_ABSORBING, 2);
    frm_body bodies[body_count], guest = 0;
    const Path far_away = {{500, -300, -0.1}, {0.1f, 0.1f, 0.2f}, 0.4, 0.5f, 3.0f};
    const Path here = {{0.3, 0.2, -0.03}, {0.1f, 0.1f, 0.05f}, 0.4, 0.5f, 3.0f};
    int t, b;
    make_bodies(scene, world, bodies);
    for (t = 0; t < 200; ++t) {
        const double time = 0.002 * (double)t;
        place(scene, bodies[0], t / 25 % 2 ? &here : &paths[0], time);
        place(scene, bodies[1], t / 40 % 2 ? &far_away : &paths[1], time);
        place(scene, bodies[2], &paths[2], 3 * (double)(t / 10));
        if (t == 50) guest = make_body(scene, world, scene->full_map, 1.5f, 0);
        if (t >= 50 && t < 120) place(scene, guest, &here, time);
        if (t == 120) MUST(scene, frm_body_destroy(guest));
        if (t == 150) MUST(scene, frm_water_destroy(water));
        if (t == 160) water = make_water(scene, world, 64, 64, FRM_BORDER_REFLECTING, 4);
        MUST(scene, frm_world_tick(world, 0.002f));
        for (b = 0; b < body_count; ++b) see_body(scene, bodies[b]);
        if (t >= 50 && t < 120) see_body(scene, guest);
        if (t % 10 == 0) see_world(scene, world);
    }
    see_water(scene, water, 0);
}

/* A body that is large for its cells: what it displaces, and presses, is laid on more grids than others need. */
void section_hull(Scene *scene) {
    const frm_world_def def = world_def();
    const frm_world world = make_world(scene, &def);
    const frm_water water = make_water(scene, world, 112, 96, FRM_BORDER_REFLECTING, 2);
    const frm_body body = make_body(scene, world, scene->full_map, 10, 1);
    const Path path = {{0, 0, -0.4}, {0.3f, 0.2f, 0.9f}, 0.8, 0.5f, 1.5f};
    double most = 0;
    int t;
    for (t = 0; t < 160; ++t) {
        frm_body_state state;
        place(scene, body, &path, 0.004 * (double)t);
        MUST(scene, frm_world_tick(world, 0.004f));
        see_body(scene, body);
        if (t % 16 == 0) see_world(scene, world);
        memset(&state, 0, sizeof state);
        state.struct_size = sizeof state;
        MUST(scene, frm_body_get_state(body, &state));
        if ((double)state.displaced_volume > most) most = (double)state.displaced_volume;
    }
    see_water(scene, water, 0);
    /* Six grids: 0.44 cbrt(V) is more than the widest of five (core/water/footprint.cpp), 11.3 cells of 25 mm. */
    covers(most > 0.27, "the hull is too small for its cells");
}
