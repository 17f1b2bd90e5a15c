/* Recorder, replay, and the device that replays. The recording is made here, of a world of its own. */
#include <stdio.h>
#include <string.h>

#include "calls.h"

enum { TICKS = 150 };

static char path[1024], second_path[1024];
static frm_replay filled; /* the replay of check_filled */

static frm_status init(void *def, uint64_t size) { return frm_recorder_def_init((frm_recorder_def *)def, size); }

static frm_status use(const void *def) {
    frm_world world;
    frm_recorder recorder = 42;
    frm_status status;
    OK(frm_world_create(f.context, NULL, &world));
    status = frm_recorder_create(world, second_path, (const frm_recorder_def *)def, &recorder);
    if (status == FRM_OK) {
        OK(frm_recorder_close(recorder));
    } else {
        CHECK(recorder == 42);
    }
    OK(frm_world_destroy(world));
    return status;
}

static frm_status fill_info(void *info) { return frm_replay_get_info(filled, (frm_replay_info *)info); }
static frm_status fill_step(void *result) { return frm_replay_step(filled, (frm_replay_step_result *)result); }

static frm_recorder recorded; /* the recorder of check_filled */
static frm_status fill_stats(void *stats) { return frm_recorder_get_stats(recorded, (frm_recorder_stats *)stats); }
static frm_status init_tolerance(void *def, uint64_t size) {
    memset(def, 0, (size_t)size);
    if (size < 4) return FRM_ERROR_ARGUMENT;
    *(uint32_t *)def = (uint32_t)size;
    return FRM_OK;
}

static void tolerances(frm_replay replay) {
    const float bad[] = {-1e-6f, 2e9f, not_a_number, infinity_f};
    frm_replay_tolerance t;
    size_t i;
    OK(frm_replay_set_tolerance(replay, NULL));
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        OK(init_tolerance(&t, sizeof t));
        t.relative = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "relative", frm_replay_set_tolerance(replay, &t));
        OK(init_tolerance(&t, sizeof t));
        t.force = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "force", frm_replay_set_tolerance(replay, &t));
        OK(init_tolerance(&t, sizeof t));
        t.torque = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "torque", frm_replay_set_tolerance(replay, &t));
    }
    t.struct_size = 0;
    CHECK(frm_replay_set_tolerance(replay, &t) < 0);
    OK(init_tolerance(&t, sizeof t));
    t.relative = 1e-6f;
    OK(frm_replay_set_tolerance(replay, &t));
    OK(frm_replay_set_tolerance(replay, NULL));
    REFUSED_HANDLES(f.stale_body, f.world, frm_replay_set_tolerance(h, &t));
}

static int exists(const char *name) {
    FILE *file = fopen(name, "rb");
    if (file) fclose(file);
    return file != NULL;
}

static void bad_defs(void) {
    const uint32_t bad[] = {0, 1000001, UINT32_MAX};
    frm_recorder_def def;
    frm_recorder recorder = 42;
    frm_world world;
    size_t i;
    OK(init(&def, sizeof def));
    CHECK(def.hash_interval == 100 && def.queue_bytes == 1u << 22 && def.waits == 0 && def.force_interval == 1);
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        def.hash_interval = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "hash_interval", use(&def));
    }
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        OK(init(&def, sizeof def));
        def.force_interval = bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "force_interval", use(&def));
        OK(init(&def, sizeof def));
        def.queue_bytes = i == 1 ? 65535 : bad[i];
        REFUSED(FRM_ERROR_ARGUMENT, "queue_bytes", use(&def));
        OK(init(&def, sizeof def));
        def.waits = i + 2;
        REFUSED(FRM_ERROR_ARGUMENT, "waits", use(&def));
    }
    REFUSED(FRM_ERROR_STATE, NULL, frm_recorder_create(f.world, path, NULL, &recorder)); /* has ticked */
    REFUSED_HANDLES(f.stale_world, f.context, frm_recorder_create(h, path, NULL, &recorder));
    OK(frm_world_create(f.context, NULL, &world));
    REFUSED(FRM_ERROR_ARGUMENT, "path", frm_recorder_create(world, NULL, NULL, &recorder));
    REFUSED(FRM_ERROR_ARGUMENT, "recorder", frm_recorder_create(world, path, NULL, NULL));
    REFUSED(FRM_ERROR_FILE, "/nowhere/", frm_recorder_create(world, "/nowhere/r.frmrec", NULL, &recorder));
    CHECK(recorder == 42);
    OK(frm_world_destroy(world));
}

/* A world with water and a body that moves with a device; the hash at its end. */
static uint64_t record(frm_recorder *stale) {
    frm_world world;
    frm_water water;
    frm_water_def water_def;
    frm_body body;
    frm_body_def def;
    frm_device device;
    frm_device_state state = {sizeof state};
    frm_recorder recorder = 0, other = 42;
    uint64_t hash = 0;
    int tick;
    OK(frm_world_create(f.context, NULL, &world));
    OK(frm_recorder_create(world, path, NULL, &recorder));
    REFUSED(FRM_ERROR_STATE, NULL, frm_recorder_create(world, second_path, NULL, &other));
    CHECK(other == 42);
    OK(frm_device_open_null(f.context, &device));
    REFUSED_HANDLES(f.stale_body, f.world, frm_recorder_add_device(recorder, h));
    REFUSED_HANDLES(f.stale_map, f.world, frm_recorder_add_device(h, device));
    OK(frm_recorder_add_device(recorder, device));

    OK(frm_water_def_init(&water_def, sizeof water_def));
    water_def.nx = water_def.ny = 32;
    water_def.border_cells = 4;
    OK(frm_water_create(world, &water_def, &water));
    OK(frm_body_def_init(&def, sizeof def));
    def.map = f.map;
    OK(frm_body_create(world, &def, &body));
    for (tick = 0; tick < TICKS; ++tick) {
        OK(frm_device_exchange(device, NULL, &state));
        state.pose.position.x = 0.001 * tick;
        state.twist.linear.x = 0.5f;
        OK(frm_body_set_motion(body, &state.pose, &state.twist));
        OK(frm_world_tick(world, 0.002f));
    }
    OK(frm_world_hash(world, &hash));
    REFUSED(FRM_ERROR_STATE, NULL, frm_world_destroy(world));
    CHECK(!exists(path));
    {
        frm_recorder_stats stats = {sizeof stats};
        OK(frm_recorder_get_stats(recorder, &stats));
        CHECK(stats.ticks <= TICKS && stats.lost_events == 0 && stats.queue_bytes == 1u << 22);
        CHECK(stats.file_bytes > 0 && stats.queue_most > 0 && stats.queue_most <= stats.queue_bytes);
        REFUSED(FRM_ERROR_ARGUMENT, "stats", frm_recorder_get_stats(recorder, NULL));
        REFUSED_HANDLES(f.stale_body, f.world, frm_recorder_get_stats(h, &stats));
        recorded = recorder;
        check_filled("frm_recorder_stats", sizeof(frm_recorder_stats), fill_stats);
    }
    OK(frm_recorder_close(recorder));
    CHECK(exists(path));
    EXPECT(FRM_ERROR_HANDLE, frm_recorder_close(recorder));
    EXPECT(FRM_ERROR_HANDLE, frm_recorder_add_device(recorder, device));
    OK(frm_device_close(device));
    OK(frm_world_destroy(world));
    *stale = recorder;
    return hash;
}

static void what_it_holds(frm_replay replay) {
    frm_replay_info info = {sizeof info};
    frm_map map = 0;
    frm_map_info original = {sizeof original}, held = {sizeof held};
    OK(frm_replay_get_info(replay, &info));
    CHECK(info.torn == 0 && info.ticks == TICKS && info.bodies == 1 && info.devices == 1);
    CHECK(info.has_water == 1 && info.maps == 1 && info.time > 0.2999 && info.time < 0.3001);
    OK(frm_replay_get_map(replay, 0, &map));
    OK(frm_map_get_info(f.map, &original));
    OK(frm_map_get_info(map, &held));
    CHECK(original.content_hash == held.content_hash);
    map = 42;
    REFUSED(FRM_ERROR_ARGUMENT, "index", frm_replay_get_map(replay, 1, &map));
    REFUSED(FRM_ERROR_ARGUMENT, "map", frm_replay_get_map(replay, 0, NULL));
    CHECK(map == 42);
}

static void replay_all(uint64_t hash) {
    frm_replay replay = 42;
    frm_replay_step_result result = {sizeof result};
    frm_world world = 42;
    frm_water water = 42;
    frm_body body = 42;
    uint64_t replayed = 0;
    int tick;
    OK(frm_replay_open(f.context, path, &replay));
    what_it_holds(replay);
    tolerances(replay);
    for (tick = 1; tick <= TICKS; ++tick) {
        OK(frm_replay_step(replay, &result));
        CHECK(result.diverged == 0 && result.tick == (uint64_t)tick && result.part == FRM_PART_NONE);
        CHECK(result.time > 0.00199 * tick && result.time < 0.00201 * tick);
    }
    OK(frm_replay_get_world(replay, &world));
    OK(frm_world_hash(world, &replayed));
    CHECK(replayed == hash);
    OK(frm_replay_get_water(replay, &water));
    OK(frm_replay_get_body(replay, 0, &body));
    {
        frm_forces forces = {sizeof forces};
        frm_water_state state = {sizeof state};
        OK(frm_body_get_forces(body, &forces));
        CHECK(forces.pressure.force.x != 0);
        OK(frm_water_read(water, &state));
        CHECK(state.nx == 32);
    }
    REFUSED(FRM_ERROR_END, NULL, frm_replay_step(replay, &result));
    CHECK(result.tick == TICKS);
    /* It belongs to the replay. */
    REFUSED(FRM_ERROR_STATE, NULL, frm_world_tick(world, 0.002f));
    REFUSED(FRM_ERROR_STATE, NULL, frm_world_destroy(world));

    world = water = body = 42;
    CHECK(frm_replay_get_body(replay, 1, &body) == FRM_ERROR_STATE);
    REFUSED(FRM_ERROR_ARGUMENT, "world", frm_replay_get_world(replay, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "water", frm_replay_get_water(replay, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "body", frm_replay_get_body(replay, 0, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "info", frm_replay_get_info(replay, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "result", frm_replay_step(replay, NULL));
    OK(frm_replay_close(replay));
    {
        frm_replay_info info = {sizeof info};
        frm_map map = 42;
        REFUSED_HANDLES(replay, f.world, frm_replay_get_info(h, &info));
        REFUSED_HANDLES(replay, f.map, frm_replay_step(h, &result));
        REFUSED_HANDLES(replay, f.body, frm_replay_get_world(h, &world));
        REFUSED_HANDLES(replay, f.water, frm_replay_get_water(h, &water));
        REFUSED_HANDLES(replay, f.context, frm_replay_get_body(h, 0, &body));
        REFUSED_HANDLES(replay, f.world, frm_replay_get_map(h, 0, &map));
        REFUSED_HANDLES(replay, f.map, frm_replay_close(h));
        CHECK(world == 42 && water == 42 && body == 42 && map == 42);
    }

    /* A recording of a world that never had water or a body. */
    OK(frm_replay_open(f.context, second_path, &filled));
    REFUSED(FRM_ERROR_STATE, "water", frm_replay_get_water(filled, &water));
    REFUSED(FRM_ERROR_STATE, "body", frm_replay_get_body(filled, 0, &body));
    REFUSED(FRM_ERROR_END, NULL, frm_replay_step(filled, &result));
    CHECK(water == 42 && body == 42);
    OK(frm_replay_close(filled));

    OK(frm_replay_open(f.context, path, &filled));
    check_filled("frm_replay_info", sizeof(frm_replay_info), fill_info);
    check_filled("frm_replay_step_result", sizeof(frm_replay_step_result), fill_step);
    OK(frm_replay_close(filled));
}

static void bad_files(void) {
    frm_replay replay = 42;
    frm_device device = 42;
    REFUSED(FRM_ERROR_ARGUMENT, "path", frm_replay_open(f.context, NULL, &replay));
    REFUSED(FRM_ERROR_ARGUMENT, "replay", frm_replay_open(f.context, path, NULL));
    REFUSED(FRM_ERROR_FILE, "no such", frm_replay_open(f.context, "/nowhere/no such.frmrec", &replay));
    REFUSED(FRM_ERROR_CORRUPT, NULL, frm_replay_open(f.context, f.map_path, &replay));
    REFUSED_HANDLES(f.stale_context, f.body, frm_replay_open(h, path, &replay));

    REFUSED(FRM_ERROR_ARGUMENT, "path", frm_device_open_replay(f.context, NULL, 0, &device));
    REFUSED(FRM_ERROR_ARGUMENT, "device", frm_device_open_replay(f.context, path, 0, NULL));
    REFUSED(FRM_ERROR_FILE, "no such", frm_device_open_replay(f.context, "/nowhere/no such.frmrec", 0, &device));
    REFUSED(FRM_ERROR_CORRUPT, NULL, frm_device_open_replay(f.context, f.map_path, 0, &device));
    REFUSED(FRM_ERROR_STATE, NULL, frm_device_open_replay(f.context, path, 1, &device));
    REFUSED_HANDLES(f.stale_context, f.world, frm_device_open_replay(h, path, 0, &device));
    CHECK(replay == 42 && device == 42);
}

static void device_of_the_recording(void) {
    frm_device device = 0;
    frm_device_state state = {sizeof state};
    int exchange;
    OK(frm_device_open_replay(f.context, path, 0, &device));
    for (exchange = 0; exchange < TICKS; ++exchange) {
        uint32_t size = 42;
        OK(frm_device_exchange(device, NULL, &state));
        CHECK(state.sequence == (uint64_t)exchange && state.pose.rotation.w == 1.0f);
        OK(frm_device_get_raw(device, NULL, 0, &size));
        CHECK(size == 0);
    }
    REFUSED(FRM_ERROR_END, NULL, frm_device_exchange(device, NULL, &state));
    CHECK(state.sequence == TICKS - 1);
    OK(frm_device_close(device));
}

void call_recording(void) {
    frm_recorder stale = 0;
    uint64_t hash;
    snprintf(path, sizeof path, "%s/every_function.frmrec", f.directory);
    snprintf(second_path, sizeof second_path, "%s/every_function_2.frmrec", f.directory);
    remove(path);
    check_def("frm_recorder_def", sizeof(frm_recorder_def), init, use);
    bad_defs();
    hash = record(&stale);
    REFUSED_HANDLES(stale, f.map, frm_recorder_close(h));
    replay_all(hash);
    bad_files();
    device_of_the_recording();
}
