/* A device of a host's own, in C: the grip goes where lines of "x y" (metres) on standard input say, as a mouse or a
 * gamepad would have it, and what it is to feel is printed. A real driver does the same with its hardware instead.
 *
 *   cc host_device.c -o host_device $(pkg-config --cflags --libs frm)
 *   printf '0 0\n0 0.002\n0 0.004\n' | ./host_device paddle.frm
 *
 * The driver is a struct of seven functions (frm_device_driver in frm.h). Everything above it - limits, ramp, faults,
 * recording - is the library's, for this device as for any other. */
#include <frm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t cycle_ns = 2000000; /* 500 lines a second */

typedef struct mouse {
    double x, y;
    int ended;
    uint64_t cycles;
    frm_wrench felt;
} mouse;

static frm_status FRM_CALL mouse_enumerate(void *user, frm_device_info *list, uint32_t capacity, uint32_t *count) {
    (void)user;
    *count = 1;
    if (list && capacity > 0) strcpy(list[0].name, "mouse");
    return FRM_OK;
}

static frm_status FRM_CALL mouse_open(void *user, uint32_t index, void **instance) {
    if (index != 0) return FRM_ERROR_ARGUMENT;
    *instance = user;
    return FRM_OK;
}

static frm_status FRM_CALL mouse_close(void *user, void *instance) {
    (void)user, (void)instance;
    return FRM_OK;
}

static frm_status FRM_CALL mouse_info(void *user, void *instance, frm_device_info *info) {
    (void)user, (void)instance;
    strcpy(info->name, "mouse");
    info->max_force = 10; /* what the layer above lets through at most */
    info->max_torque = 1;
    info->period_ns = cycle_ns;
    return FRM_OK;
}

static frm_status FRM_CALL mouse_calibrate(void *user, void *instance) {
    mouse *m = (mouse *)instance;
    (void)user;
    m->x = m->y = 0;
    return FRM_OK;
}

/* One cycle: show the force, say where the grip is. Time must run and sequence must count: a device whose clock stands
 * still is taken for broken. */
static frm_status FRM_CALL mouse_exchange(void *user, void *instance, const frm_device_command *command,
                                          frm_device_state *state) {
    mouse *m = (mouse *)instance;
    const double last_x = m->x, last_y = m->y;
    (void)user;
    if (scanf("%lf %lf", &m->x, &m->y) != 2) return FRM_ERROR_END;
    m->felt = command->wrench;
    state->status = FRM_DEVICE_READY;
    state->pose.position.x = m->x;
    state->pose.position.y = m->y;
    state->pose.rotation.w = 1;
    if (m->cycles > 0) {
        state->twist.linear.x = (float)((m->x - last_x) * 1e9 / (double)cycle_ns);
        state->twist.linear.y = (float)((m->y - last_y) * 1e9 / (double)cycle_ns);
    }
    state->sequence = m->cycles++;
    state->time_ns = state->sequence * cycle_ns;
    return FRM_OK;
}

static frm_status FRM_CALL mouse_stop(void *user, void *instance) {
    (void)user;
    memset(&((mouse *)instance)->felt, 0, sizeof(frm_wrench));
    return FRM_OK;
}

static frm_context context;

static void ok(frm_status status) {
    char text[256] = "";
    uint64_t size;
    if (status == FRM_OK) return;
    frm_context_last_error(context, text, sizeof text, &size);
    fprintf(stderr, "%s: %s\n", frm_status_name(status), text);
    exit(1);
}

int main(int argc, char **argv) {
    static mouse m;
    const frm_device_driver driver = {sizeof driver, 0,           mouse_enumerate, mouse_open, mouse_close,
                                      mouse_info,    mouse_calibrate, mouse_exchange,  mouse_stop, NULL};
    frm_map map;
    frm_world world;
    frm_body body;
    frm_body_def def;
    frm_device device;
    frm_device_safety_def safety;
    frm_device_command command = {sizeof command};
    frm_forces forces = {sizeof forces};
    uint64_t lines = 0;

    ok(frm_context_create(NULL, &context));
    ok(frm_map_open_file(context, argc > 1 ? argv[1] : "paddle.frm", &map));
    ok(frm_world_create(context, NULL, &world));
    ok(frm_body_def_init(&def, sizeof def));
    def.map = map;
    ok(frm_body_create(world, &def, &body));
    ok(frm_device_open(context, &driver, &m, 0, &device));
    ok(frm_device_safety_def_init(&safety, sizeof safety));
    safety.ramp_time = 0.02f;
    safety.deadline_ns = 10000000000u; /* it waits for somebody who types */
    ok(frm_device_set_safety(device, &safety));
    ok(frm_device_engage(device)); /* nothing is felt before */
    for (;;) {
        frm_device_state state = {sizeof state};
        const frm_status status = frm_device_exchange(device, &command, &state);
        if (status == FRM_ERROR_END) break;
        ok(status);
        state.pose.position.z = -0.3; /* under water */
        ok(frm_body_set_motion(body, &state.pose, &state.twist));
        ok(frm_world_tick(world, 1e-9f * (float)cycle_ns));
        ok(frm_body_get_forces(body, &forces));
        command.wrench.force.x = forces.pressure.force.x + forces.friction.force.x;
        command.wrench.force.y = forces.pressure.force.y + forces.friction.force.y;
        ++lines;
    }
    printf("%llu lines; felt at the end: %.3f %.3f N\n", (unsigned long long)lines, m.felt.force.x, m.felt.force.y);
    ok(frm_context_destroy(context));
    return 0;
}
