/* Water: its def, views of the field, heights and pressures that the host sets. */
#include <string.h>

#include "calls.h"

enum { NX = 48, NY = 40, CELLS = NX * NY };

static float heights[CELLS], velocities_x[CELLS], velocities_y[CELLS];

static frm_status init(void *def, uint64_t size) { return frm_water_def_init((frm_water_def *)def, size); }

/* In a world of its own, because a world takes one water. */
static frm_status use(const void *def) {
    frm_world world;
    frm_water water = 42;
    frm_status status;
    OK(frm_world_create(f.context, NULL, &world));
    status = frm_water_create(world, (const frm_water_def *)def, &water);
    if (status == FRM_OK) {
        OK(frm_water_destroy(water));
    } else {
        CHECK(water == 42);
    }
    OK(frm_world_destroy(world));
    return status;
}

static frm_status fill_def(void *def) { return frm_water_get_def(f.water, (frm_water_def *)def); }
static frm_status fill_state(void *state) { return frm_water_read(f.water, (frm_water_state *)state); }
static frm_status fill_snapshot(void *state) { return frm_water_read_snapshot(f.water, (frm_water_state *)state); }

static void refuse_size(uint32_t nx, uint32_t ny, uint32_t border, uint32_t border_cells, const char *naming) {
    frm_water_def def;
    OK(init(&def, sizeof def));
    def.nx = nx;
    def.ny = ny;
    def.border = border;
    def.border_cells = border_cells;
    REFUSED(FRM_ERROR_ARGUMENT, naming, use(&def));
}

static void bad_defs(void) {
    const float bad_cell[] = {0.0f, 9e-5f, 1001.0f, -1.0f, not_a_number, infinity_f};
    const float bad_depth[] = {0.0f, 9e-4f, 10001.0f, -1.0f, not_a_number, infinity_f};
    const float bad_interval[] = {-0.01f, 10.1f, not_a_number, infinity_f};
    const double bad_centre[] = {(double)not_a_number, (double)infinity_f, (double)-infinity_f};
    frm_water_def def;
    size_t i;
    OK(init(&def, sizeof def));
    CHECK(def.nx == 200 && def.ny == 200 && def.border == FRM_BORDER_ABSORBING && def.border_cells == 0);
    CHECK(def.cell == 0.025f && def.depth == 0.5f && def.snapshot_interval == 1.0f / 60);
    CHECK(def.centre_x == 0.0 && def.centre_y == 0.0 && def.order == 2);
    def.order = 3;
    REFUSED(FRM_ERROR_ARGUMENT, "order", use(&def));
    OK(init(&def, sizeof def));
    def.reserved = 1;
    REFUSED(FRM_ERROR_ARGUMENT, "reserved", use(&def));

    refuse_size(7, 200, 0, 0, "nx");
    refuse_size(0, 200, 0, 0, "nx");
    refuse_size(8193, 200, 0, 16, "nx");
    refuse_size(UINT32_MAX, 200, 0, 16, "nx");
    refuse_size(200, 7, 0, 0, "ny");
    refuse_size(200, UINT32_MAX, 0, 16, "ny");
    refuse_size(UINT32_MAX, UINT32_MAX, 0, 16, "nx");
    refuse_size(200, 200, 2, 16, "border");
    refuse_size(200, 200, 0, 65, "border_cells");
    refuse_size(40, 200, 0, 14, "border_cells");
    refuse_size(200, 40, 0, UINT32_MAX, "border_cells");
    for (i = 0; i < sizeof bad_cell / sizeof bad_cell[0]; ++i) {
        OK(init(&def, sizeof def));
        def.cell = bad_cell[i];
        REFUSED(FRM_ERROR_ARGUMENT, "cell", use(&def));
        OK(init(&def, sizeof def));
        def.depth = bad_depth[i];
        REFUSED(FRM_ERROR_ARGUMENT, "depth", use(&def));
    }
    for (i = 0; i < sizeof bad_interval / sizeof bad_interval[0]; ++i) {
        OK(init(&def, sizeof def));
        def.snapshot_interval = bad_interval[i];
        REFUSED(FRM_ERROR_ARGUMENT, "snapshot_interval", use(&def));
    }
    for (i = 0; i < sizeof bad_centre / sizeof bad_centre[0]; ++i) {
        OK(init(&def, sizeof def));
        def.centre_x = bad_centre[i];
        REFUSED(FRM_ERROR_ARGUMENT, "centre_x", use(&def));
        OK(init(&def, sizeof def));
        def.centre_y = bad_centre[i];
        REFUSED(FRM_ERROR_ARGUMENT, "centre_y", use(&def));
    }
    OK(init(&def, sizeof def));
    def.nx = def.ny = 8;
    def.border_cells = 0;
    OK(use(&def));
    OK(use(NULL));
}

/* Where water may not be: twice in a world, or in a world without a surface. */
static void bad_places(void) {
    frm_world world;
    frm_world_def def;
    frm_water water = 42;
    REFUSED(FRM_ERROR_STATE, NULL, frm_water_create(f.world, NULL, &water));
    REFUSED_HANDLES(f.stale_world, f.body, frm_water_create(h, NULL, &water));
    OK(frm_world_def_init(&def, sizeof def));
    def.surface = FRM_SURFACE_NONE;
    OK(frm_world_create(f.context, &def, &world));
    REFUSED(FRM_ERROR_STATE, NULL, frm_water_create(world, NULL, &water));
    OK(frm_world_destroy(world));
    CHECK(water == 42);
    OK(frm_world_create(f.context, NULL, &world));
    REFUSED(FRM_ERROR_ARGUMENT, "water", frm_water_create(world, NULL, NULL));
    OK(frm_world_destroy(world));
}

typedef frm_status(FRM_CALL *read_fn)(frm_water, frm_water_state *);

static void read_by(read_fn read) {
    frm_water_state state = {sizeof state};
    size_t i;
    OK(read(f.water, &state));
    CHECK(state.nx == NX && state.ny == NY && state.tick > 0 && state.time > 0);

    state.capacity = CELLS;
    state.height = heights;
    state.velocity_x = velocities_x;
    state.velocity_y = velocities_y;
    heights[CELLS - 1] = velocities_x[0] = velocities_y[0] = 1e9f;
    OK(read(f.water, &state));
    for (i = 0; i < CELLS; ++i) {
        CHECK(heights[i] > -0.5f && heights[i] < 0.5f);
        CHECK(velocities_x[i] > -10 && velocities_x[i] < 10 && velocities_y[i] > -10 && velocities_y[i] < 10);
    }
    state.capacity = CELLS - 1;
    heights[0] = 1e9f;
    REFUSED(FRM_ERROR_CAPACITY, "capacity", read(f.water, &state));
    CHECK(heights[0] == 1e9f);
    CHECK(state.nx == NX && state.ny == NY);
    state.velocity_x = state.velocity_y = NULL;
    state.capacity = 0;
    REFUSED(FRM_ERROR_CAPACITY, "capacity", read(f.water, &state));
    state.height = NULL;
    OK(read(f.water, &state));
    REFUSED(FRM_ERROR_ARGUMENT, "state", read(f.water, NULL));
    REFUSED_HANDLES(f.stale_water, f.world, read(h, &state));
}

static void set_heights(void) {
    frm_water_state state = {sizeof state};
    float copy[CELLS];
    const float bad[] = {not_a_number, infinity_f, -infinity_f, 0.6f, -0.6f};
    size_t i;
    for (i = 0; i < CELLS; ++i) heights[i] = (float)(i % 7) * 0.001f;
    OK(frm_water_set_height(f.water, heights, CELLS));
    state.capacity = CELLS;
    state.height = copy;
    OK(frm_water_read(f.water, &state));
    CHECK(memcmp(copy, heights, sizeof copy) == 0);
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        heights[CELLS - 1] = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "height", frm_water_set_height(f.water, heights, CELLS));
    }
    heights[CELLS - 1] = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_water_set_height(f.water, heights, CELLS - 1));
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_water_set_height(f.water, heights, UINT64_MAX));
    REFUSED(FRM_ERROR_ARGUMENT, "height", frm_water_set_height(f.water, NULL, CELLS));
    REFUSED_HANDLES(f.stale_water, f.map, frm_water_set_height(h, heights, CELLS));
}

static void set_pressures(void) {
    float pressures[CELLS] = {0};
    uint64_t before, after;
    pressures[CELLS / 2 + NX / 2] = 50.0f;
    before = world_hash();
    OK(frm_water_set_pressure(f.water, pressures, CELLS));
    after = world_hash();
    CHECK(before != after);
    OK(frm_world_tick(f.world, 0.002f));
    pressures[3] = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "pressure", frm_water_set_pressure(f.water, pressures, CELLS));
    pressures[3] = infinity_f;
    REFUSED(FRM_ERROR_ARGUMENT, "pressure", frm_water_set_pressure(f.water, pressures, CELLS));
    pressures[3] = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_water_set_pressure(f.water, pressures, CELLS + 1));
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_water_set_pressure(f.water, pressures, 0));
    REFUSED(FRM_ERROR_ARGUMENT, NULL, frm_water_set_pressure(f.water, NULL, CELLS));
    REFUSED_HANDLES(f.stale_water, f.context, frm_water_set_pressure(h, pressures, CELLS));
    OK(frm_water_set_pressure(f.water, NULL, 0));
    OK(frm_world_tick(f.world, 0.002f));
}

static void height_at(void) {
    double height = 42;
    OK(frm_water_get_height(f.water, 0.0, 0.0, &height));
    CHECK(height > -0.5 && height < 0.5);
    OK(frm_water_get_height(f.water, 1e6, -1e6, &height));
    CHECK(height == 0.0);
    height = 42;
    REFUSED(FRM_ERROR_ARGUMENT, "x", frm_water_get_height(f.water, (double)not_a_number, 0.0, &height));
    REFUSED(FRM_ERROR_ARGUMENT, "y", frm_water_get_height(f.water, 0.0, (double)infinity_f, &height));
    REFUSED(FRM_ERROR_ARGUMENT, "height", frm_water_get_height(f.water, 0.0, 0.0, NULL));
    REFUSED_HANDLES(f.stale_water, f.body, frm_water_get_height(h, 0.0, 0.0, &height));
    CHECK(height == 42);
}

void call_water(void) {
    frm_water_def def = {sizeof def};
    check_def("frm_water_def", sizeof(frm_water_def), init, use);
    bad_defs();
    bad_places();

    check_filled("frm_water_def", sizeof(frm_water_def), fill_def);
    OK(frm_water_get_def(f.water, &def));
    CHECK(def.nx == NX && def.ny == NY && def.border_cells == 8 && def.depth == 0.5f);
    REFUSED(FRM_ERROR_ARGUMENT, "def", frm_water_get_def(f.water, NULL));
    REFUSED_HANDLES(f.stale_water, f.world, frm_water_get_def(h, &def));

    check_filled("frm_water_state", sizeof(frm_water_state), fill_state);
    check_filled("frm_water_state", sizeof(frm_water_state), fill_snapshot);
    OK(frm_world_tick(f.world, 0.1f)); /* longer than the snapshot interval */
    read_by(frm_water_read);
    read_by(frm_water_read_snapshot);
    set_heights();
    set_pressures();
    height_at();
    REFUSED_HANDLES(f.stale_water, f.body, frm_water_destroy(h));
}
