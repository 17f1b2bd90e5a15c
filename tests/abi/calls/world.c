/* Worlds: their defs, ticks, counters and hash. */
#include <fenv.h>
#include <string.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "calls.h"

static frm_status init(void *def, uint64_t size) { return frm_world_def_init((frm_world_def *)def, size); }

static frm_status use(const void *def) {
    frm_world world = 42;
    const frm_status status = frm_world_create(f.context, (const frm_world_def *)def, &world);
    if (status == FRM_OK) {
        OK(frm_world_destroy(world));
    } else {
        CHECK(world == 42);
    }
    return status;
}

static frm_status fill_def(void *def) { return frm_world_get_def(f.world, (frm_world_def *)def); }
static frm_status fill_stats(void *stats) { return frm_world_get_stats(f.world, (frm_world_stats *)stats); }

static void bad_defs(void) {
    const float bad_gravity[] = {-0.001f, 1000.5f, not_a_number, infinity_f, -infinity_f};
    const float bad_density[] = {0.0f, 9e-4f, 1.1e5f, -1000.0f, not_a_number, infinity_f};
    const float bad_viscosity[] = {0.0f, 9e-10f, 101.0f, -1.0f, not_a_number, infinity_f};
    frm_world_def def;
    size_t i;
    OK(init(&def, sizeof def));
    CHECK(def.model == FRM_MODEL_DEFAULT && def.surface == FRM_SURFACE_FLAT && def.level == 0.0);
    CHECK(def.skip == FRM_SKIP_DEFAULT && def.error_budget == 0.0f && def.time_budget == 0.0f);
    CHECK(def.gravity == 9.80665f && def.density == 1000.0f && def.viscosity == 1e-6f);

    def.model = 32;
    REFUSED(FRM_ERROR_ARGUMENT, "model", use(&def));
    OK(init(&def, sizeof def));
    def.surface = 2;
    REFUSED(FRM_ERROR_ARGUMENT, "surface", use(&def));
    OK(init(&def, sizeof def));
    def.skip = 256;
    REFUSED(FRM_ERROR_ARGUMENT, "skip", use(&def));
    OK(init(&def, sizeof def));
    def.error_budget = -1.0f;
    REFUSED(FRM_ERROR_ARGUMENT, "error_budget", use(&def));
    def.error_budget = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "error_budget", use(&def));
    OK(init(&def, sizeof def));
    def.time_budget = 1.1e6f;
    REFUSED(FRM_ERROR_ARGUMENT, "time_budget", use(&def));
    OK(init(&def, sizeof def));
    def.reserved = 1;
    REFUSED(FRM_ERROR_ARGUMENT, "reserved", use(&def));
    OK(init(&def, sizeof def));
    def.level = (double)not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "level", use(&def));
    def.level = (double)-infinity_f;
    REFUSED(FRM_ERROR_ARGUMENT, "level", use(&def));
    OK(init(&def, sizeof def));
    for (i = 0; i < sizeof bad_gravity / sizeof bad_gravity[0]; ++i) {
        def.gravity = bad_gravity[i];
        REFUSED(FRM_ERROR_ARGUMENT, "gravity", use(&def));
    }
    OK(init(&def, sizeof def));
    for (i = 0; i < sizeof bad_density / sizeof bad_density[0]; ++i) {
        def.density = bad_density[i];
        REFUSED(FRM_ERROR_ARGUMENT, "density", use(&def));
    }
    OK(init(&def, sizeof def));
    for (i = 0; i < sizeof bad_viscosity / sizeof bad_viscosity[0]; ++i) {
        def.viscosity = bad_viscosity[i];
        REFUSED(FRM_ERROR_ARGUMENT, "viscosity", use(&def));
    }
    OK(init(&def, sizeof def));
    def.gravity = 0.0f;
    def.model = FRM_MODEL_PAPER;
    OK(use(&def));
    OK(use(NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "world", frm_world_create(f.context, NULL, NULL));
}

static void ticks(void) {
    const float bad[] = {0.0f, -0.0f, -0.002f, 9e-7f, 0.1001f, 1e30f, not_a_number, infinity_f, -infinity_f};
    frm_world_stats before = {sizeof before}, after = {sizeof after};
    uint64_t hash = 0, again = 0;
    size_t i;
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        REFUSED(FRM_ERROR_ARGUMENT, "dt", frm_world_tick(f.world, bad[i]));
    }
    OK(frm_world_get_stats(f.world, &before));
    OK(frm_world_hash(f.world, &hash));
    OK(frm_world_hash(f.world, &again));
    CHECK(hash == again);
    OK(frm_world_tick(f.world, 0.002f));
    OK(frm_world_tick(f.world, 1e-6f));
    OK(frm_world_tick(f.world, 0.1f));
    OK(frm_world_hash(f.world, &again));
    CHECK(hash != again);
    OK(frm_world_get_stats(f.world, &after));
    CHECK(before.bodies == 1 && after.bodies == 1);
    CHECK(after.ticks == before.ticks + 3);
    CHECK(after.time - before.time > 0.102 && after.time - before.time < 0.10201);
    CHECK(after.wet_bodies == 1 && after.wet_sources > 0 && after.water_substeps > 0);
}

static frm_world small_world(void) {
    frm_world world = 0;
    frm_water water;
    frm_water_def water_def;
    frm_body body;
    frm_body_def body_def;
    OK(frm_world_create(f.context, NULL, &world));
    OK(frm_water_def_init(&water_def, sizeof water_def));
    water_def.nx = 32;
    water_def.ny = 32;
    water_def.border_cells = 4;
    OK(frm_water_create(world, &water_def, &water));
    OK(frm_body_def_init(&body_def, sizeof body_def));
    body_def.map = f.map;
    body_def.pose.rotation.x = 0.3f;
    body_def.twist.linear.x = 0.7f;
    OK(frm_body_create(world, &body_def, &body));
    return world;
}

/* The caller's rounding and flush modes change no result, and are as they were after each call. */
static void floating_point_modes(void) {
    const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    const frm_world plain = small_world();
    uint64_t hash = 0, other = 0;
    int tick;
    size_t i;
    for (tick = 0; tick < 20; ++tick) OK(frm_world_tick(plain, 0.002f));
    OK(frm_world_hash(plain, &hash));
    for (i = 0; i < sizeof modes / sizeof modes[0]; ++i) {
        frm_world world;
        frm_status status = FRM_OK;
        int mode;
#if defined(__SSE2__)
        const unsigned int flush = 0x8040u; /* denormals are zero, in and out */
        const unsigned int saved = _mm_getcsr();
        unsigned int csr;
        _mm_setcsr(saved | flush);
#endif
        fesetround(modes[i]);
        world = small_world();
        for (tick = 0; tick < 20 && status == FRM_OK; ++tick) status = frm_world_tick(world, 0.002f);
        mode = fegetround();
#if defined(__SSE2__)
        csr = _mm_getcsr();
        _mm_setcsr(saved);
        CHECK((csr & flush) == flush);
#endif
        fesetround(FE_TONEAREST);
        CHECK(status == FRM_OK);
        CHECK(mode == modes[i]);
        OK(frm_world_hash(world, &other));
        CHECK(other == hash);
        OK(frm_world_destroy(world));
    }
    OK(frm_world_destroy(plain));
}

void call_world(void) {
    frm_world_def def = {sizeof def};
    frm_world world = 42;
    frm_world_stats stats = {sizeof stats};
    uint64_t hash = 42;
    check_def("frm_world_def", sizeof(frm_world_def), init, use);
    bad_defs();
    REFUSED_HANDLES(f.stale_context, f.map, frm_world_create(h, NULL, &world));
    CHECK(world == 42);

    check_filled("frm_world_def", sizeof(frm_world_def), fill_def);
    OK(frm_world_get_def(f.world, &def));
    CHECK(def.model == FRM_MODEL_DEFAULT && def.surface == FRM_SURFACE_FLAT && def.density == 1000.0f && def.level == 0.0);
    REFUSED(FRM_ERROR_ARGUMENT, "def", frm_world_get_def(f.world, NULL));
    REFUSED_HANDLES(f.stale_world, f.water, frm_world_get_def(h, &def));

    check_filled("frm_world_stats", sizeof(frm_world_stats), fill_stats);
    ticks();
    REFUSED(FRM_ERROR_ARGUMENT, "stats", frm_world_get_stats(f.world, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "hash", frm_world_hash(f.world, NULL));
    REFUSED_HANDLES(f.stale_world, f.body, frm_world_tick(h, 0.002f));
    REFUSED_HANDLES(f.stale_world, f.water, frm_world_get_stats(h, &stats));
    REFUSED_HANDLES(f.stale_world, f.context, frm_world_hash(h, &hash));
    REFUSED_HANDLES(f.stale_world, f.map, frm_world_destroy(h));
    CHECK(hash == 42);
    floating_point_modes();
}
