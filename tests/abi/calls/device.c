/* Devices: the null device, and a driver written here as a host would. */
#include <string.h>

#include "calls.h"

/* What the test's driver was asked, and how it is to answer. */
typedef struct driver_log {
    uint32_t opened, closed, calibrated, exchanged, stopped;
    float last_force;
    frm_status answer; /* of every call */
    float grip;        /* in the state that exchange gives */
} driver_log;

static void describe(uint32_t index, frm_device_info *info) {
    info->serial = 100 + index;
    info->max_force = 5.0f;
    info->max_torque = 0.5f;
    info->period_ns = 1000000;
    memset(info->name, 0, sizeof info->name);
    strcpy(info->name, index ? "second" : "first");
}

static frm_status FRM_CALL driver_enumerate(void *user, frm_device_info *list, uint32_t capacity, uint32_t *count) {
    uint32_t i;
    *count = 2;
    for (i = 0; list && i < 2 && i < capacity; ++i) describe(i, &list[i]);
    return ((driver_log *)user)->answer;
}

static frm_status FRM_CALL driver_open(void *user, uint32_t index, void **instance) {
    driver_log *log = (driver_log *)user;
    if (index > 1) return FRM_ERROR_ARGUMENT;
    if (log->answer == FRM_OK) ++log->opened;
    *instance = log;
    return log->answer;
}

static frm_status FRM_CALL driver_close(void *user, void *instance) {
    ++((driver_log *)user)->closed;
    return instance == user ? ((driver_log *)user)->answer : FRM_ERROR_INTERNAL;
}

static frm_status FRM_CALL driver_info(void *user, void *instance, frm_device_info *info) {
    (void)instance;
    describe(1, info);
    return ((driver_log *)user)->answer;
}

static frm_status FRM_CALL driver_calibrate(void *user, void *instance) {
    (void)instance;
    ++((driver_log *)user)->calibrated;
    return ((driver_log *)user)->answer;
}

static frm_status FRM_CALL driver_exchange(void *user, void *instance, const frm_device_command *command,
                                           frm_device_state *state) {
    driver_log *log = (driver_log *)user;
    (void)instance;
    log->last_force = command ? command->wrench.force.x : 0.0f;
    state->status = FRM_DEVICE_READY;
    memset(&state->pose, 0, sizeof state->pose);
    memset(&state->twist, 0, sizeof state->twist);
    state->pose.position.x = 0.25;
    state->pose.rotation.w = 1.0f;
    state->grip = log->grip;
    state->buttons = 5;
    state->time_ns = 1000000u * (uint64_t)log->exchanged;
    state->sequence = log->exchanged++;
    return log->answer;
}

static frm_status FRM_CALL driver_stop(void *user, void *instance) {
    (void)instance;
    ++((driver_log *)user)->stopped;
    return ((driver_log *)user)->answer;
}

/* Three bytes, the first of which counts. */
static frm_status FRM_CALL driver_raw(void *user, void *instance, uint8_t *data, uint32_t capacity, uint32_t *size) {
    const driver_log *log = (const driver_log *)user;
    (void)instance;
    if (capacity < 3) return FRM_ERROR_CAPACITY;
    data[0] = (uint8_t)log->exchanged;
    data[1] = 0xAB;
    data[2] = 0;
    *size = 3;
    return log->answer;
}

static frm_device_driver make_driver(void) {
    frm_device_driver driver;
    memset(&driver, 0, sizeof driver);
    driver.struct_size = sizeof driver;
    driver.enumerate = driver_enumerate;
    driver.open = driver_open;
    driver.close = driver_close;
    driver.info = driver_info;
    driver.calibrate = driver_calibrate;
    driver.exchange = driver_exchange;
    driver.stop = driver_stop;
    return driver;
}

static frm_device filled; /* the device of check_filled */
static frm_status fill_info(void *info) { return frm_device_get_info(filled, (frm_device_info *)info); }
static frm_status fill_state(void *state) { return frm_device_exchange(filled, NULL, (frm_device_state *)state); }

static void null_device(frm_device *stale) {
    frm_device device = 42;
    frm_device_info info = {sizeof info};
    frm_device_state state = {sizeof state};
    frm_device_command command = {sizeof command};
    const float bad[] = {not_a_number, infinity_f, -infinity_f};
    uint64_t time;
    size_t i;
    REFUSED_HANDLES(f.stale_context, f.map, frm_device_open_null(h, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "device", frm_device_open_null(f.context, NULL));
    CHECK(device == 42);
    OK(frm_device_open_null(f.context, &device));
    OK(frm_device_get_info(device, &info));
    CHECK(info.max_force == 0.0f && memchr(info.name, 0, sizeof info.name));

    OK(frm_device_exchange(device, NULL, &state));
    CHECK(state.status == FRM_DEVICE_READY && state.sequence == 0);
    CHECK(state.pose.position.x == 0.0 && state.pose.rotation.w == 1.0f && state.twist.linear.x == 0.0f);
    time = state.time_ns;
    command.wrench.force.x = 3.0f;
    OK(frm_device_exchange(device, &command, &state));
    CHECK(state.sequence == 1 && state.time_ns == time + 2000000);
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        command.wrench.force.x = 0.0f;
        command.wrench.torque.z = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "command", frm_device_exchange(device, &command, &state));
    }
    command.wrench.torque.z = 0.0f;
    command.struct_size = 0;
    CHECK(frm_device_exchange(device, &command, &state) < 0);
    command.struct_size = sizeof command;
    CHECK(state.sequence == 1);
    REFUSED(FRM_ERROR_ARGUMENT, "state", frm_device_exchange(device, &command, NULL));
    OK(frm_device_exchange(device, &command, &state));
    CHECK(state.sequence == 2);
    REFUSED(FRM_ERROR_ARGUMENT, "info", frm_device_get_info(device, NULL));
    OK(frm_device_calibrate(device));
    OK(frm_device_stop(device));
    filled = device;
    check_filled("frm_device_info", sizeof(frm_device_info), fill_info);
    check_filled("frm_device_state", sizeof(frm_device_state), fill_state);
    OK(frm_device_close(device));
    EXPECT(FRM_ERROR_HANDLE, frm_device_close(device));
    *stale = device;
}

static void bad_drivers(void) {
    driver_log log;
    frm_device_driver driver = make_driver();
    frm_device_info list[3];
    frm_device device = 42;
    uint32_t count = 42;
    memset(&log, 0, sizeof log);
    memset(list, 0, sizeof list);
    REFUSED(FRM_ERROR_ARGUMENT, "driver", frm_device_enumerate(f.context, NULL, &log, NULL, 0, &count));
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_device_enumerate(f.context, &driver, &log, list, 3, NULL));
    REFUSED_HANDLES(f.stale_context, f.world, frm_device_enumerate(h, &driver, &log, NULL, 0, &count));
    REFUSED(FRM_ERROR_ARGUMENT, "driver", frm_device_open(f.context, NULL, &log, 0, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "device", frm_device_open(f.context, &driver, &log, 0, NULL));
    REFUSED_HANDLES(f.stale_context, f.body, frm_device_open(h, &driver, &log, 0, &device));
    CHECK(frm_device_open(f.context, &driver, &log, 2, &device) < 0);

    driver.exchange = NULL;
    REFUSED(FRM_ERROR_ARGUMENT, "driver", frm_device_open(f.context, &driver, &log, 0, &device));
    driver = make_driver();
    driver.open = NULL;
    REFUSED(FRM_ERROR_ARGUMENT, "driver", frm_device_open(f.context, &driver, &log, 0, &device));
    driver = make_driver();
    driver.struct_size = 0;
    CHECK(frm_device_open(f.context, &driver, &log, 0, &device) < 0);

    driver = make_driver();
    log.answer = FRM_ERROR_DEVICE;
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_open(f.context, &driver, &log, 0, &device));
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_enumerate(f.context, &driver, &log, NULL, 0, &count));
    CHECK(device == 42 && log.opened == 0);
    CHECK(count == 42); /* results are written only on success, whatever the driver wrote */
}

/* A driver may have packets, or not; one of an older header has no place for them. */
static void packets(frm_device null_device_handle, frm_device stale) {
    driver_log log;
    frm_device_driver driver = make_driver();
    frm_device device = 0;
    frm_device_state state = {sizeof state};
    uint8_t data[3] = {9, 9, 9};
    uint32_t size = 42;
    memset(&log, 0, sizeof log);
    OK(frm_device_get_raw(null_device_handle, data, sizeof data, &size));
    CHECK(size == 0 && data[0] == 9);
    driver.raw = driver_raw;
    OK(frm_device_open(f.context, &driver, &log, 0, &device));
    OK(frm_device_exchange(device, NULL, &state));
    OK(frm_device_get_raw(device, NULL, 0, &size));
    CHECK(size == 3);
    REFUSED(FRM_ERROR_CAPACITY, "3", frm_device_get_raw(device, data, 2, &size));
    CHECK(size == 3 && data[0] == 9);
    OK(frm_device_get_raw(device, data, 3, &size));
    CHECK(data[0] == 1 && data[1] == 0xAB && data[2] == 0);
    REFUSED(FRM_ERROR_ARGUMENT, "size", frm_device_get_raw(device, data, 3, NULL));
    REFUSED_HANDLES(stale, f.world, frm_device_get_raw(h, data, 3, &size));
    OK(frm_device_close(device));

    driver.struct_size = (uint32_t)offsetof(frm_device_driver, raw);
    OK(frm_device_open(f.context, &driver, &log, 0, &device));
    OK(frm_device_exchange(device, NULL, &state));
    OK(frm_device_get_raw(device, data, 3, &size));
    CHECK(size == 0);
    OK(frm_device_close(device));
}

static void own_driver(frm_device stale) {
    driver_log log;
    frm_device_driver driver = make_driver();
    frm_device_info list[3], info = {sizeof info};
    frm_device_state state = {sizeof state};
    frm_device_command command = {sizeof command};
    frm_device device = 0;
    uint32_t count = 0, stopped, i;
    memset(&log, 0, sizeof log);
    memset(list, 0, sizeof list);
    for (i = 0; i < 3; ++i) list[i].struct_size = sizeof list[i];

    OK(frm_device_enumerate(f.context, &driver, &log, NULL, 0, &count));
    CHECK(count == 2);
    OK(frm_device_enumerate(f.context, &driver, &log, list, 1, &count));
    CHECK(count == 2 && list[0].serial == 100 && list[1].serial == 0);
    OK(frm_device_enumerate(f.context, &driver, &log, list, 3, &count));
    CHECK(count == 2 && strcmp(list[1].name, "second") == 0 && list[2].serial == 0);

    OK(frm_device_open(f.context, &driver, &log, 1, &device));
    memset(&driver, 0, sizeof driver); /* it was copied */
    CHECK(log.opened == 1);
    OK(frm_device_get_info(device, &info));
    CHECK(info.serial == 101 && info.max_force == 5.0f && info.struct_size == sizeof info);
    OK(frm_device_calibrate(device));
    CHECK(log.calibrated == 1);
    command.wrench.force.x = 1.25f;
    OK(frm_device_exchange(device, &command, &state));
    /* Nothing is felt before the host engages the device (servo.c has the rest of the safety layer). */
    CHECK(log.last_force == 0.0f && state.pose.position.x == 0.25 && state.buttons == 5);
    OK(frm_device_exchange(device, NULL, &state));
    CHECK(log.last_force == 0.0f && log.exchanged == 2);

    /* Refused before the driver sees it; and what the driver says is not trusted. */
    command.wrench.force.x = not_a_number;
    REFUSED(FRM_ERROR_ARGUMENT, "command", frm_device_exchange(device, &command, &state));
    CHECK(log.exchanged == 2);
    command.wrench.force.x = 0.0f;
    log.grip = not_a_number;
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_exchange(device, &command, &state));
    CHECK(state.grip == 0.0f && log.exchanged == 3);
    log.grip = 0.0f;
    log.answer = FRM_ERROR_DEVICE;
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_exchange(device, &command, &state));
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_calibrate(device));
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_get_info(device, &info));
    /* A device that failed may have been stopped already, so stops are counted from here. */
    stopped = log.stopped;
    REFUSED(FRM_ERROR_DEVICE, NULL, frm_device_stop(device));
    CHECK(log.stopped == stopped + 1);
    log.answer = FRM_OK;
    OK(frm_device_exchange(device, &command, &state));
    OK(frm_device_stop(device));
    CHECK(log.stopped == stopped + 2);

    REFUSED_HANDLES(stale, f.world, frm_device_get_info(h, &info));
    REFUSED_HANDLES(stale, f.map, frm_device_calibrate(h));
    REFUSED_HANDLES(stale, f.body, frm_device_exchange(h, &command, &state));
    REFUSED_HANDLES(stale, f.water, frm_device_stop(h));
    REFUSED_HANDLES(stale, f.context, frm_device_close(h));
    OK(frm_device_close(device));
    CHECK(log.closed == 1 && log.stopped == stopped + 3); /* stops before it closes */
}

static frm_device simulated_device;
static frm_status fill_simulated_state(void *state) {
    return frm_device_exchange(simulated_device, NULL, (frm_device_state *)state);
}

/* A simulated SPIDAR-G is always there; a real one hardly ever, but its arguments are looked at first. */
static void spidar_g(void) {
    frm_device device = 42;
    frm_device_info list[1], info = {sizeof info};
    frm_device_safety_def safety;
    frm_device_state state = {sizeof state};
    frm_device_command command = {sizeof command};
    uint32_t count = 42, i;
    frm_status status;
    memset(list, 0, sizeof list);
    list[0].struct_size = sizeof list[0];
    REFUSED(FRM_ERROR_ARGUMENT, "device", frm_device_open_simulated(f.context, NULL, NULL));
    REFUSED(FRM_ERROR_FILE, "/nonexistent.json", frm_device_open_simulated(f.context, "/nonexistent.json", &device));
    REFUSED_HANDLES(f.stale_context, f.world, frm_device_open_simulated(h, NULL, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "device", frm_device_open_spidar_g(f.context, NULL, -1, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "rotary", frm_device_open_spidar_g(f.context, NULL, 16, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "rotary", frm_device_open_spidar_g(f.context, NULL, -2, &device));
    REFUSED(FRM_ERROR_FILE, "/nonexistent.json", frm_device_open_spidar_g(f.context, "/nonexistent.json", -1, &device));
    REFUSED_HANDLES(f.stale_context, f.body, frm_device_open_spidar_g(h, NULL, -1, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "count", frm_device_enumerate_spidar_g(f.context, NULL, list, 1, NULL));
    REFUSED(FRM_ERROR_FILE, "/nonexistent.json",
            frm_device_enumerate_spidar_g(f.context, "/nonexistent.json", list, 1, &count));
    REFUSED_HANDLES(f.stale_context, f.map, frm_device_enumerate_spidar_g(h, NULL, list, 1, &count));
    CHECK(device == 42 && count == 42);
    /* None is plugged in where tests run, or libusb is missing or may not look. */
    status = frm_device_enumerate_spidar_g(f.context, NULL, list, 1, &count);
    CHECK(status == FRM_OK || status == FRM_ERROR_UNSUPPORTED || status == FRM_ERROR_DEVICE);

    OK(frm_device_open_simulated(f.context, NULL, &device));
    OK(frm_device_get_info(device, &info));
    CHECK(info.max_force > 20.0f && info.max_torque > 0.4f && info.period_ns == 1000000);
    OK(frm_device_exchange(device, NULL, &state));
    CHECK(state.status == FRM_DEVICE_UNCALIBRATED && state.faults == FRM_DEVICE_FAULT_UNCALIBRATED);
    OK(frm_device_calibrate(device));
    OK(frm_device_safety_def_init(&safety, sizeof safety));
    safety.deadline_ns = 10000000000u; /* a busy machine is no stalled host */
    OK(frm_device_set_safety(device, &safety));
    OK(frm_device_engage(device));
    command.wrench.force.y = 2.0f;
    for (i = 0; i < 1700; ++i) OK(frm_device_exchange(device, &command, &state));
    CHECK(state.status == FRM_DEVICE_READY && state.faults == 0);
    CHECK(state.achieved.force.y > 1.9f && state.achieved.force.y < 2.1f && state.pose.position.y > 0.001);
    simulated_device = device;
    check_filled("frm_device_state", sizeof(frm_device_state), fill_simulated_state);
    OK(frm_device_stop(device));
    OK(frm_device_close(device));
}

/* A context that goes takes its devices with it. */
static void closed_with_the_context(void) {
    driver_log log;
    const frm_device_driver driver = make_driver();
    frm_context context;
    frm_device device;
    memset(&log, 0, sizeof log);
    OK(frm_context_create(NULL, &context));
    OK(frm_device_open(context, &driver, &log, 0, &device));
    OK(frm_context_destroy(context));
    CHECK(log.opened == 1 && log.closed == 1);
    EXPECT(FRM_ERROR_HANDLE, frm_device_stop(device));
}

void call_device(void) {
    frm_device stale = 0;
    null_device(&stale);
    bad_drivers();
    {
        frm_device device = 0;
        OK(frm_device_open_null(f.context, &device));
        packets(device, stale);
        OK(frm_device_close(device));
    }
    own_driver(stale);
    spidar_g();
    closed_with_the_context();
}
