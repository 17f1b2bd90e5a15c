/* The safety layer of a device, and servos. */
#include <string.h>

#include "calls.h"

static frm_device used;

static frm_status init_safety(void *def, uint64_t size) {
    return frm_device_safety_def_init((frm_device_safety_def *)def, size);
}
static frm_status use_safety(const void *def) {
    return frm_device_set_safety(used, (const frm_device_safety_def *)def);
}
static frm_status fill_safety(void *state) { return frm_device_get_safety(used, (frm_device_safety_state *)state); }

static void safety(void) {
    frm_device_safety_def def;
    frm_device_safety_state state = {sizeof state};
    frm_device_state device_state = {sizeof device_state};
    frm_device stale = 0;
    float *const numbers[] = {&def.max_force,    &def.max_torque,     &def.slew_time,  &def.ramp_time, &def.max_step,
                              &def.max_speed,    &def.max_spin,       &def.brake_time, &def.grip_mass, &def.grip_inertia,
                              &def.energy_reserve, &def.quick_time,   &def.dead_band,  &def.spin_dead_band,
                              &def.dead_man_grip};
    const float bad[] = {not_a_number, infinity_f, -1.0f};
    size_t i, j;
    OK(frm_device_open_null(f.context, &stale));
    OK(frm_device_close(stale));
    OK(frm_device_open_null(f.context, &used));
    check_def("frm_device_safety_def", sizeof def, init_safety, use_safety);
    check_filled("frm_device_safety_state", sizeof state, fill_safety);
    REFUSED_HANDLES(stale, f.world, frm_device_set_safety(h, NULL));
    REFUSED_HANDLES(stale, f.world, frm_device_get_safety(h, &state));
    REFUSED_HANDLES(stale, f.world, frm_device_engage(h));
    REFUSED_HANDLES(stale, f.world, frm_device_disengage(h));
    REFUSED_HANDLES(stale, f.world, frm_device_clear_fault(h));
    REFUSED(FRM_ERROR_ARGUMENT, "state", frm_device_get_safety(used, NULL));
    OK(frm_device_set_safety(used, NULL));
    for (i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        for (j = 0; j < sizeof bad / sizeof bad[0]; ++j) {
            OK(init_safety(&def, sizeof def));
            *numbers[i] = bad[j];
            REFUSED(FRM_ERROR_ARGUMENT, "def.", use_safety(&def));
        }
    }
    OK(init_safety(&def, sizeof def));
    def.max_stale = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "max_stale", use_safety(&def));
    OK(init_safety(&def, sizeof def));
    def.passivity = 2;
    REFUSED(FRM_ERROR_ARGUMENT, "passivity", use_safety(&def));
    OK(init_safety(&def, sizeof def));
    def.deadline_ns = 1;
    REFUSED(FRM_ERROR_ARGUMENT, "deadline_ns", use_safety(&def));

    OK(init_safety(&def, sizeof def));
    def.deadline_ns = 10000000000u; /* whatever this machine does */
    OK(use_safety(&def));
    OK(frm_device_get_safety(used, &state));
    CHECK(state.engaged == 0 && state.faults == 0 && state.reason[0] == 0);
    OK(frm_device_engage(used));
    OK(frm_device_engage(used));
    OK(frm_device_get_safety(used, &state));
    CHECK(state.engaged == 2);
    OK(frm_device_exchange(used, NULL, &device_state));
    OK(frm_device_get_safety(used, &state));
    CHECK(state.engaged == 1);
    REFUSED(FRM_ERROR_STATE, "engaged", frm_device_set_safety(used, NULL));
    OK(frm_device_disengage(used));
    OK(frm_device_disengage(used));
    OK(frm_device_clear_fault(used));
    OK(frm_device_get_safety(used, &state));
    CHECK(state.engaged == 0);
    OK(frm_device_set_safety(used, NULL));
    OK(frm_device_close(used));
}

static frm_servo_def servo_def; /* of a world of its own: f.world is hashed all the time */
static frm_servo servo;

static frm_status init_servo(void *def, uint64_t size) {
    const frm_status status = frm_servo_def_init((frm_servo_def *)def, size);
    /* What is required; a def that is as large as the library's has room for it. */
    if (status == FRM_OK && size >= sizeof(frm_servo_def)) {
        ((frm_servo_def *)def)->device = servo_def.device;
        ((frm_servo_def *)def)->body = servo_def.body;
    }
    return status;
}
static frm_status use_servo(const void *def) {
    frm_servo made = 0;
    const frm_status status = frm_servo_create(f.context, (const frm_servo_def *)def, &made);
    if (status == FRM_OK) OK(frm_servo_destroy(made));
    return status;
}
static frm_status init_input(void *input, uint64_t size) { return frm_servo_input_init((frm_servo_input *)input, size); }
static frm_status use_input(const void *input) { return frm_servo_set_input(servo, (const frm_servo_input *)input); }
static frm_status fill_state(void *state) { return frm_servo_get_state(servo, (frm_servo_state *)state); }
static frm_status fill_stats(void *stats) { return frm_servo_get_stats(servo, (frm_servo_stats *)stats); }

static frm_status FRM_CALL on_tick(void *user, uint64_t tick, float dt) {
    /* The servo's own thread may use the world. */
    frm_world_stats stats = {sizeof stats};
    (void)tick;
    if (frm_world_get_stats(*(frm_world *)user, &stats) != FRM_OK || !(dt > 0)) return FRM_ERROR_INTERNAL;
    return FRM_OK;
}

static void defs(void) {
    frm_servo_def def;
    frm_servo made = 42;
    OK(init_servo(&def, sizeof def));
    REFUSED(FRM_ERROR_ARGUMENT, "def", frm_servo_create(f.context, NULL, &made));
    REFUSED(FRM_ERROR_ARGUMENT, "servo", frm_servo_create(f.context, &def, NULL));
    REFUSED_HANDLES(f.stale_context, f.world, frm_servo_create(h, &def, &made));
    def.rate = 99;
    REFUSED(FRM_ERROR_ARGUMENT, "def.rate", use_servo(&def));
    def.rate = 5001;
    REFUSED(FRM_ERROR_ARGUMENT, "def.rate", use_servo(&def));
    OK(init_servo(&def, sizeof def));
    def.priority = 100;
    REFUSED(FRM_ERROR_ARGUMENT, "def.priority", use_servo(&def));
    OK(init_servo(&def, sizeof def));
    def.lock_memory = 2;
    REFUSED(FRM_ERROR_ARGUMENT, "def.lock_memory", use_servo(&def));
    OK(init_servo(&def, sizeof def));
    def.grip.rotation.w = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "def.grip", use_servo(&def));
    OK(init_servo(&def, sizeof def));
    def.body = f.stale_body;
    REFUSED(FRM_ERROR_HANDLE, "def.body", use_servo(&def));
    OK(init_servo(&def, sizeof def));
    def.device = f.world;
    REFUSED(FRM_ERROR_HANDLE, "def.device", use_servo(&def));
    CHECK(made == 42);
}

static void inputs(frm_servo stale) {
    frm_servo_input input;
    REFUSED(FRM_ERROR_ARGUMENT, "input", frm_servo_set_input(servo, NULL));
    OK(init_input(&input, sizeof input));
    input.force_scale = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "input.force_scale", use_input(&input));
    OK(init_input(&input, sizeof input));
    input.torque_scale = -1;
    REFUSED(FRM_ERROR_ARGUMENT, "input.torque_scale", use_input(&input));
    OK(init_input(&input, sizeof input));
    input.motion_scale = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "input.motion_scale", use_input(&input));
    OK(init_input(&input, sizeof input));
    input.extra.torque.z = infinity_f;
    REFUSED(FRM_ERROR_ARGUMENT, "input.extra", use_input(&input));
    OK(init_input(&input, sizeof input));
    input.anchor.rotation.w = 0;
    REFUSED(FRM_ERROR_ARGUMENT, "input.anchor", use_input(&input));
    REFUSED_HANDLES(stale, f.world, frm_servo_set_input(h, &input));
}

static void one_at_a_time(frm_servo stale) {
    uint64_t edges[128], counts[128];
    uint32_t count = 0;
    frm_servo_state state = {sizeof state};
    frm_servo_stats stats = {sizeof stats};
    REFUSED(FRM_ERROR_STATE, "servo", frm_device_close(servo_def.device));
    REFUSED(FRM_ERROR_STATE, "servo", frm_body_destroy(servo_def.body));
    REFUSED(FRM_ERROR_STATE, "servo", use_servo(&servo_def)); /* the device has one */
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_servo_get_histogram(servo, FRM_SERVO_TICK, NULL, NULL, 0, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "which", frm_servo_get_histogram(servo, 2, NULL, NULL, 0, &count));
    OK(frm_servo_get_histogram(servo, FRM_SERVO_LATE, NULL, NULL, 0, &count));
    CHECK(count > 0 && count <= 128);
    REFUSED(FRM_ERROR_CAPACITY, NULL, frm_servo_get_histogram(servo, FRM_SERVO_TICK, edges, counts, count - 1, &count));
    OK(frm_servo_get_histogram(servo, FRM_SERVO_TICK, edges, counts, 128, &count));
    CHECK(edges[0] == 128 && edges[1] == 160 && edges[4] == 256);
    REFUSED(FRM_ERROR_ARGUMENT, "state", frm_servo_get_state(servo, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "stats", frm_servo_get_stats(servo, NULL));
    REFUSED_HANDLES(stale, f.body, frm_servo_get_state(h, &state));
    REFUSED_HANDLES(stale, f.body, frm_servo_get_stats(h, &stats));
    REFUSED_HANDLES(stale, f.body, frm_servo_get_histogram(h, 0, NULL, NULL, 0, &count));
    REFUSED_HANDLES(stale, f.body, frm_servo_start(h));
    REFUSED_HANDLES(stale, f.body, frm_servo_stop(h));
    REFUSED_HANDLES(stale, f.body, frm_servo_engage(h));
    REFUSED_HANDLES(stale, f.body, frm_servo_disengage(h));
    REFUSED_HANDLES(stale, f.body, frm_servo_clear_fault(h));
    REFUSED_HANDLES(stale, f.body, frm_servo_destroy(h));
}

static void servos(void) {
    frm_world world;
    frm_body_def body_def;
    frm_body_state body_state = {sizeof body_state};
    frm_device_safety_state safety_state = {sizeof safety_state};
    frm_servo_state state = {sizeof state};
    frm_servo_stats stats = {sizeof stats};
    frm_device_state device_state = {sizeof device_state};
    frm_servo stale = 0;
    OK(frm_world_create(f.context, NULL, &world));
    OK(frm_body_def_init(&body_def, sizeof body_def));
    body_def.map = f.map;
    OK(frm_servo_def_init(&servo_def, sizeof servo_def));
    OK(frm_body_create(world, &body_def, &servo_def.body));
    OK(frm_device_open_null(f.context, &servo_def.device));
    check_def("frm_servo_def", sizeof servo_def, init_servo, use_servo);
    OK(frm_servo_create(f.context, &servo_def, &stale));
    OK(frm_servo_destroy(stale));
    defs();

    servo_def.on_tick = on_tick;
    servo_def.user = &world;
    servo_def.lock_memory = 0;
    OK(frm_servo_create(f.context, &servo_def, &servo));
    check_def("frm_servo_input", sizeof(frm_servo_input), init_input, use_input);
    check_filled("frm_servo_state", sizeof state, fill_state);
    check_filled("frm_servo_stats", sizeof stats, fill_stats);
    inputs(stale);
    one_at_a_time(stale);
    EXPECT(FRM_ERROR_STATE, frm_world_destroy(world));

    OK(frm_servo_engage(servo));
    OK(frm_servo_start(servo));
    OK(frm_servo_start(servo));
    EXPECT(FRM_ERROR_STATE, frm_world_tick(world, 0.001f));
    EXPECT(FRM_ERROR_STATE, frm_body_get_state(servo_def.body, &body_state));
    EXPECT(FRM_ERROR_STATE, frm_device_exchange(servo_def.device, NULL, &device_state));
    EXPECT(FRM_ERROR_STATE, frm_device_get_safety(servo_def.device, &safety_state));
    do OK(frm_servo_get_state(servo, &state));
    while (state.ticks < 20 && state.running);
    CHECK(state.running == 1 && state.status == FRM_OK && state.engaged != 0);
    OK(frm_servo_clear_fault(servo));
    OK(frm_servo_disengage(servo));
    OK(frm_servo_stop(servo));
    OK(frm_servo_stop(servo));
    OK(frm_servo_get_state(servo, &state));
    CHECK(state.running == 0);
    OK(frm_servo_get_stats(servo, &stats));
    CHECK(stats.ticks == state.ticks && stats.period_ns == 1000000);
    OK(frm_world_tick(world, 0.001f)); /* it is the host's again */
    OK(frm_device_exchange(servo_def.device, NULL, &device_state));
    OK(frm_servo_destroy(servo));
    OK(frm_device_close(servo_def.device));
    OK(frm_world_destroy(world));
}

void call_servo(void) {
    safety();
    servos();
}
