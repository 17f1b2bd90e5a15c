/* The library's own threads on another machine: a servo, the watchdog of an engaged device and a recorder's writer.
 * Where libfrm was built without threads (WebAssembly) the first two are refused and leave all as it was, and a recorder
 * writes in the thread that ticks. What was recorded replays to the same bits either way. Usage: threads DATA WORK */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "frm.h"

#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
enum { has_threads = 0 };
#else
enum { has_threads = 1 };
#endif

static frm_context context;

static void expect(frm_status got, frm_status want, const char *call) {
    char text[512] = "";
    uint64_t size = 0;
    if (got == want) return;
    frm_context_last_error(context, text, sizeof text, &size);
    fprintf(stderr, "%s: %s, not %s: %s\n", call, frm_status_name(got), frm_status_name(want), text);
    exit(1);
}
#define GOOD(call) expect(call, FRM_OK, #call)

static void holds(int condition, const char *what) {
    if (condition) return;
    fprintf(stderr, "not so: %s\n", what);
    exit(1);
}

/* FRM_OK with threads; else refused, and the text says why. */
static void possible(frm_status got, const char *call) {
    char text[512] = "";
    uint64_t size = 0;
    expect(got, has_threads ? FRM_OK : FRM_ERROR_UNSUPPORTED, call);
    if (has_threads) return;
    GOOD(frm_context_last_error(context, text, sizeof text, &size));
    holds(strstr(text, "without threads") != NULL, text);
}

static void drive(frm_device device, frm_body body, frm_world world, frm_recorder recorder) {
    frm_servo_def def;
    frm_servo servo = 0;
    frm_servo_state state;
    frm_recorder_stats stats;
    memset(&state, 0, sizeof state);
    state.struct_size = sizeof state;
    memset(&stats, 0, sizeof stats);
    stats.struct_size = sizeof stats;
    GOOD(frm_servo_def_init(&def, sizeof def));
    def.device = device;
    def.body = body;
    GOOD(frm_servo_create(context, &def, &servo));
    possible(frm_servo_start(servo), "frm_servo_start");
    if (has_threads) {
        /* A starved machine may take its time. */
        const time_t begin = time(NULL);
        GOOD(frm_servo_engage(servo));
        do {
            GOOD(frm_servo_get_state(servo, &state));
        } while (state.ticks < 100 && state.running && time(NULL) - begin < 300);
        holds(state.ticks >= 100, "a servo ticks");
        expect(state.status, FRM_OK, "a servo's status");
    } else {
        int t;
        possible(frm_servo_start(servo), "frm_servo_start again");
        for (t = 0; t < 300; ++t) {
            frm_device_command command;
            frm_device_state exchanged;
            GOOD(frm_world_tick(world, 0.002f));
            memset(&command, 0, sizeof command);
            command.struct_size = sizeof command;
            memset(&exchanged, 0, sizeof exchanged);
            exchanged.struct_size = sizeof exchanged;
            GOOD(frm_device_exchange(device, &command, &exchanged));
        }
        GOOD(frm_recorder_get_stats(recorder, &stats));
        holds(stats.ticks == 300, "a recorder writes while the world ticks");
    }
    GOOD(frm_servo_stop(servo));
    GOOD(frm_servo_get_state(servo, &state));
    holds(!state.running, "a servo that was stopped does not run");
    GOOD(frm_servo_destroy(servo));
}

static void replay(const char *path) {
    frm_replay replay = 0;
    frm_replay_info info;
    frm_replay_step_result result;
    uint64_t ticks = 0;
    frm_status status;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    GOOD(frm_replay_open(context, path, &replay));
    GOOD(frm_replay_get_info(replay, &info));
    for (;;) {
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        status = frm_replay_step(replay, &result);
        if (status == FRM_ERROR_END) break;
        expect(status, FRM_OK, "frm_replay_step");
        holds(!result.diverged, "a tick replays to the same bits");
        ++ticks;
    }
    holds(!info.torn && ticks == info.ticks && ticks >= 100, "the recording is whole");
    GOOD(frm_replay_close(replay));
}

int main(int count, char **arguments) {
    char map_path[1024], path[1024];
    frm_context_def context_def;
    frm_world_def world_def;
    frm_body_def body_def;
    frm_device_safety_state safety;
    frm_map map = 0;
    frm_world world = 0;
    frm_body body = 0;
    frm_device device = 0;
    frm_recorder recorder = 0;
    if (count != 3) return 2;
    snprintf(map_path, sizeof map_path, "%s/v2.frm", arguments[1]);
    snprintf(path, sizeof path, "%s/threads.frmrec", arguments[2]);
    GOOD(frm_context_def_init(&context_def, sizeof context_def));
    GOOD(frm_context_create(&context_def, &context));
    GOOD(frm_map_open_file(context, map_path, &map));
    GOOD(frm_world_def_init(&world_def, sizeof world_def));
    GOOD(frm_world_create(context, &world_def, &world));
    GOOD(frm_body_def_init(&body_def, sizeof body_def));
    body_def.map = map;
    GOOD(frm_body_create(world, &body_def, &body));
    GOOD(frm_device_open_simulated(context, NULL, &device));

    possible(frm_device_engage(device), "frm_device_engage");
    memset(&safety, 0, sizeof safety);
    safety.struct_size = sizeof safety;
    GOOD(frm_device_get_safety(device, &safety));
    holds((safety.engaged != 0) == has_threads, "a device is engaged only if it was not refused");
    GOOD(frm_device_stop(device));

    GOOD(frm_recorder_create(world, path, NULL, &recorder));
    GOOD(frm_recorder_add_device(recorder, device));
    drive(device, body, world, recorder);
    GOOD(frm_recorder_close(recorder));
    replay(path);
    GOOD(frm_context_destroy(context));
    puts(has_threads ? "threads: servo, watchdog and recorder as they should be"
                     : "no threads: refused as it should be");
    return 0;
}
