/* Bodies: their defs, motion, and what they feel. */
#include <math.h>
#include <string.h>

#include "calls.h"

static frm_status init(void *def, uint64_t size) { return frm_body_def_init((frm_body_def *)def, size); }

/* In a world of its own, so that f.world keeps its hash. A def without a map, as the init leaves it, gets one. */
static frm_status use(const void *def) {
    uint64_t copy[128];
    uint32_t size;
    frm_body_def *known = (frm_body_def *)(void *)copy;
    frm_world world;
    frm_body body = 42;
    frm_status status;
    memcpy(&size, def, sizeof size);
    if (size < sizeof(frm_body_def) || size > sizeof copy) size = sizeof(frm_body_def);
    memcpy(copy, def, size);
    if (!known->map) known->map = f.map;
    OK(frm_world_create(f.context, NULL, &world));
    status = frm_body_create(world, known, &body);
    if (status == FRM_OK) {
        OK(frm_body_destroy(body));
    } else {
        CHECK(body == 42);
    }
    OK(frm_world_destroy(world));
    return status;
}

static frm_status fill_def(void *def) { return frm_body_get_def(f.body, (frm_body_def *)def); }
static frm_status fill_forces(void *forces) { return frm_body_get_forces(f.body, (frm_forces *)forces); }
static frm_status fill_state(void *state) { return frm_body_get_state(f.body, (frm_body_state *)state); }

static void bad_defs(void) {
    const float bad_scale[] = {0.0f, 9e-4f, 1001.0f, -1.0f, not_a_number, infinity_f};
    const float bad_mass[] = {-0.001f, 1.1e9f, not_a_number, infinity_f};
    frm_context other_context;
    frm_body_def def;
    frm_body body = 42;
    size_t i;
    OK(init(&def, sizeof def));
    CHECK(def.scale == 1.0f && def.map == 0 && def.mass == 0.0f && def.centre_of_mass.x == 0.0f);
    CHECK(def.pose.position.x == 0.0 && def.pose.rotation.w == 1.0f && def.twist.linear.z == 0.0f);
    for (i = 0; i < sizeof bad_scale / sizeof bad_scale[0]; ++i) {
        OK(init(&def, sizeof def));
        def.scale = bad_scale[i];
        REFUSED(FRM_ERROR_ARGUMENT, "scale", use(&def));
    }
    for (i = 0; i < sizeof bad_mass / sizeof bad_mass[0]; ++i) {
        OK(init(&def, sizeof def));
        def.mass = bad_mass[i];
        REFUSED(FRM_ERROR_ARGUMENT, "mass", use(&def));
    }
    OK(init(&def, sizeof def));
    def.centre_of_mass.y = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "centre_of_mass", use(&def));
    OK(init(&def, sizeof def));
    def.pose.rotation.w = 0.0f;
    REFUSED(FRM_ERROR_ARGUMENT, "rotation", use(&def));
    OK(init(&def, sizeof def));
    def.pose.position.z = (double)infinity_f;
    REFUSED(FRM_ERROR_ARGUMENT, "position", use(&def));
    OK(init(&def, sizeof def));
    def.twist.angular.x = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "twist", use(&def));

    OK(init(&def, sizeof def));
    REFUSED(FRM_ERROR_HANDLE, "map", frm_body_create(f.world, &def, &body));
    def.map = f.stale_map;
    REFUSED(FRM_ERROR_HANDLE, "map", frm_body_create(f.world, &def, &body));
    def.map = f.world;
    REFUSED(FRM_ERROR_HANDLE, "map", frm_body_create(f.world, &def, &body));
    OK(frm_context_create(NULL, &other_context));
    OK(frm_map_open_file(other_context, f.map_path, &def.map));
    {
        const uint64_t before = world_hash();
        const frm_status status = frm_body_create(f.world, &def, &body);
        CHECK(status == FRM_ERROR_ARGUMENT || status == FRM_ERROR_HANDLE);
        CHECK(before == world_hash());
    }
    OK(frm_context_destroy(other_context));
    def.map = f.map;
    REFUSED(FRM_ERROR_ARGUMENT, "body", frm_body_create(f.world, &def, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "def", frm_body_create(f.world, NULL, &body));
    REFUSED_HANDLES(f.stale_world, f.water, frm_body_create(h, &def, &body));
    CHECK(body == 42);
}

static frm_pose good_pose(void) {
    frm_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.position.z = -0.2;
    pose.rotation.w = 2.0f; /* is normalised */
    return pose;
}

static void motion(void) {
    const double bad_position[] = {1.1e9, -1.1e9, 1e300, (double)not_a_number, (double)infinity_f};
    const float bad_speed[] = {1.1e4f, -1.1e4f, 3e38f, not_a_number, infinity_f};
    frm_pose pose = good_pose();
    frm_twist twist;
    size_t i;
    memset(&twist, 0, sizeof twist);
    OK(frm_body_set_motion(f.body, &pose, NULL));
    twist.linear.x = 0.5f;
    OK(frm_body_set_motion(f.body, &pose, &twist));
    for (i = 0; i < sizeof bad_position / sizeof bad_position[0]; ++i) {
        pose = good_pose();
        pose.position.x = bad_position[i];
        REFUSED(FRM_ERROR_ARGUMENT, "position", frm_body_set_motion(f.body, &pose, &twist));
        pose = good_pose();
        twist.linear.y = bad_speed[i];
        REFUSED(FRM_ERROR_ARGUMENT, "linear", frm_body_set_motion(f.body, &pose, &twist));
        twist.linear.y = 0;
        twist.angular.z = bad_speed[i];
        REFUSED(FRM_ERROR_ARGUMENT, "angular", frm_body_set_motion(f.body, &pose, &twist));
        twist.angular.z = 0;
    }
    pose.rotation.w = 0.0f;
    REFUSED(FRM_ERROR_ARGUMENT, "rotation", frm_body_set_motion(f.body, &pose, &twist));
    pose.rotation.w = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "rotation", frm_body_set_motion(f.body, &pose, &twist));
    pose.rotation.w = 1.0f;
    pose.rotation.y = infinity_f;
    REFUSED(FRM_ERROR_ARGUMENT, "rotation", frm_body_set_motion(f.body, &pose, &twist));
    REFUSED(FRM_ERROR_ARGUMENT, "pose", frm_body_set_motion(f.body, NULL, &twist));
    pose = good_pose();
    REFUSED_HANDLES(f.stale_body, f.world, frm_body_set_motion(h, &pose, &twist));
}

static int finite_vec3(frm_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static frm_status fill_coefficients(void *c) { return frm_body_get_coefficients(f.body, (frm_coefficients *)c); }

/* After forces_and_state: towed along x at 0.5 m/s, all under water. */
static void coefficients(void) {
    frm_coefficients c = {sizeof c};
    frm_forces forces = {sizeof forces};
    double added_mass[36], drag;
    int i, j;
    check_filled("frm_coefficients", sizeof(frm_coefficients), fill_coefficients);
    OK(frm_body_get_coefficients(f.body, &c));
    CHECK(c.wet_share > 0.999f && c.wet_share < 1.001f);
    OK(frm_map_get_added_mass(f.map, 1000.0f, 1.0f, added_mass));
    for (i = 0; i < 6; ++i) {
        for (j = 0; j < 6; ++j) {
            /* The body is not turned against the world. */
            CHECK(fabs(c.added_mass[6 * i + j] - added_mass[6 * i + j]) <= 1e-5 * fabs(added_mass[6 * i + j]) + 1e-9);
            CHECK(c.added_mass[6 * i + j] == c.added_mass[6 * j + i] && c.damping[6 * i + j] == c.damping[6 * j + i]);
            CHECK(isfinite(c.damping[6 * i + j]));
        }
        CHECK(c.damping[7 * i] >= 0);
    }
    /* Drag goes with the square of the speed, so it grows by twice itself over the speed, and no part of it less. */
    OK(frm_body_get_forces(f.body, &forces));
    drag = -(double)forces.pressure.force.x;
    CHECK(c.damping[0] > 1.8 * drag / 0.5 && c.damping[0] < 10 * drag / 0.5);
    REFUSED(FRM_ERROR_ARGUMENT, "coefficients", frm_body_get_coefficients(f.body, NULL));
    REFUSED_HANDLES(f.stale_body, f.water, frm_body_get_coefficients(h, &c));
}

static void forces_and_state(void) {
    frm_forces forces = {sizeof forces};
    frm_body_state state = {sizeof state};
    float sum;
    OK(frm_world_tick(f.world, 0.002f));
    OK(frm_body_get_forces(f.body, &forces));
    CHECK(finite_vec3(forces.total.force) && finite_vec3(forces.total.torque));
    sum = forces.buoyancy.force.z + forces.pressure.force.z + forces.friction.force.z + forces.gravity.force.z;
    CHECK(fabsf(sum - forces.total.force.z) <= 1e-4f * (fabsf(sum) + 1));
    CHECK(forces.buoyancy.force.z > 0 && forces.gravity.force.z < -14.0f && forces.gravity.force.z > -15.0f);
    CHECK(forces.pressure.force.x < 0); /* against the motion */
    CHECK(forces.reserved == 0);

    OK(frm_body_get_state(f.body, &state));
    CHECK(state.wet_area > 0 && state.displaced_volume > 0 && state.wet_sources > 0);
    CHECK(state.relative_speed > 0.3f && state.relative_speed < 0.7f && state.reynolds > 0);
    CHECK(state.pose.position.z == -0.2 && state.pose.rotation.w >= 0.999f && state.pose.rotation.x == 0.0f);
    CHECK(state.twist.linear.x == 0.5f);
    REFUSED(FRM_ERROR_ARGUMENT, "forces", frm_body_get_forces(f.body, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "state", frm_body_get_state(f.body, NULL));
    REFUSED_HANDLES(f.stale_body, f.water, frm_body_get_forces(h, &forces));
    REFUSED_HANDLES(f.stale_body, f.map, frm_body_get_state(h, &state));
}

static void sources(void) {
    enum { MOST = 4096 };
    static frm_source_state states[MOST];
    uint32_t count = 0, again = 0, i;
    double force = 0;
    frm_forces forces = {sizeof forces};
    frm_map_info info = {sizeof info};
    OK(frm_map_get_info(f.map, &info));
    OK(frm_body_get_sources(f.body, NULL, 0, &count));
    CHECK(count == info.sources && count <= MOST);
    states[0].wet_ratio = 1e9f;
    REFUSED(FRM_ERROR_CAPACITY, NULL, frm_body_get_sources(f.body, states, count - 1, &again));
    CHECK(again == count && states[0].wet_ratio == 1e9f);
    OK(frm_body_get_sources(f.body, states, MOST, &again));
    CHECK(again == count);
    OK(frm_body_get_forces(f.body, &forces));
    for (i = 0; i < count; ++i) {
        CHECK(states[i].wet_ratio >= 0 && states[i].wet_ratio <= 1);
        CHECK(finite_vec3(states[i].force) && finite_vec3(states[i].relative_velocity));
        force += (double)states[i].force.x;
    }
    {
        const double expected = (double)forces.pressure.force.x + (double)forces.friction.force.x;
        CHECK(fabs(force - expected) < 1e-3 * (1 + fabs(expected)));
    }
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_body_get_sources(f.body, states, MOST, NULL));
    REFUSED_HANDLES(f.stale_body, f.context, frm_body_get_sources(h, states, MOST, &count));
}

void call_body(void) {
    frm_body_def def = {sizeof def};
    check_def("frm_body_def", sizeof(frm_body_def), init, use);
    bad_defs();
    check_filled("frm_body_def", sizeof(frm_body_def), fill_def);
    OK(frm_body_get_def(f.body, &def));
    CHECK(def.map == f.map && def.scale > 0.0f && def.pose.rotation.w != 0.0f);
    REFUSED(FRM_ERROR_ARGUMENT, "def", frm_body_get_def(f.body, NULL));
    REFUSED_HANDLES(f.stale_body, f.world, frm_body_get_def(h, &def));

    check_filled("frm_forces", sizeof(frm_forces), fill_forces);
    check_filled("frm_body_state", sizeof(frm_body_state), fill_state);
    motion();
    forces_and_state();
    coefficients();
    sources();
    REFUSED_HANDLES(f.stale_body, f.map, frm_body_destroy(h));
}
