/* A recording and its replay, and the replay of a recording that another machine made. */
#include <stdio.h>
#include <string.h>

#include "tests/determinism/scene.h"

/* Replays to the end; every tick must give the recorded bits. */
static void replay(Scene *scene, const char *path) {
    frm_replay replay = 0;
    frm_replay_info info;
    frm_world world = 0;
    uint64_t ticks = 0;
    MUST(scene, frm_replay_open(scene->context, path, &replay));
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    MUST(scene, frm_replay_get_info(replay, &info));
    covers(info.ticks > 0 && info.bodies > 0 && !info.torn, "a recording is empty or torn");
    see_u64(scene, info.ticks);
    see_double(scene, info.time);
    see_u32(scene, info.bodies);
    see_u32(scene, info.maps);
    MUST(scene, frm_replay_get_world(replay, &world));
    for (;;) {
        frm_replay_step_result result;
        frm_status status;
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        status = frm_replay_step(replay, &result);
        if (status == FRM_ERROR_END) break;
        MUST(scene, status);
        ++ticks;
        if (result.diverged) {
            fprintf(stderr, "%s: tick %lu differs: body %u, part %u\n", path, (unsigned long)result.tick,
                    (unsigned)result.body, (unsigned)result.part);
        }
        see_u32(scene, result.diverged);
        if (ticks % 10 == 0) see_world(scene, world);
    }
    covers(ticks == info.ticks, "a replay ended early");
    see_world(scene, world);
    MUST(scene, frm_replay_close(replay));
}

/* Twice by one name, which is not ASCII: the second takes the place of the first. */
void section_recording(Scene *scene) {
    char path[1024];
    int round;
    work_path(scene,
              "d\xC3\xA9"
              "terminisme.frmrec",
              path);
    for (round = 0; round < 2; ++round) {
        const frm_world_def def = world_def();
        const frm_world world = make_world(scene, &def);
        const frm_water water = make_water(scene, world, 64, 72, FRM_BORDER_ABSORBING, 2);
        frm_body body = make_body(scene, world, scene->full_map, 1, 1), other = 0;
        const Path way = {{0.1, 0, 0}, {0.3f, 0.2f, 0.1f}, 0.4 + 0.1 * round, 0.5f, 3.0f};
        const Path still = {{-0.4, -0.2, -0.1}, {0, 0, 0}, 1, 0, 0};
        frm_recorder_def recording;
        frm_recorder recorder = 0;
        frm_device device = 0;
        float heights[64 * 72];
        int t;
        for (t = 0; t < 64 * 72; ++t) heights[t] = 0.0002f * (float)(t % 17 - 8);
        MUST(scene, frm_recorder_def_init(&recording, sizeof recording));
        recording.hash_interval = 10;
        MUST(scene, frm_recorder_create(world, path, &recording, &recorder));
        MUST(scene, frm_device_open_null(scene->context, &device));
        MUST(scene, frm_recorder_add_device(recorder, device));
        for (t = 0; t < 150; ++t) {
            frm_forces forces;
            frm_device_command command;
            frm_device_state state;
            if (t == 40) MUST(scene, frm_water_set_height(water, heights, 64 * 72));
            if (t == 60) other = make_body(scene, world, scene->many_map, 0.7f, 1);
            if (t >= 60) place(scene, other, &still, 0);
            if (t == 80) MUST(scene, frm_water_set_pressure(water, heights, 64 * 72));
            place(scene, body, &way, 0.002 * (double)t);
            MUST(scene, frm_world_tick(world, 0.002f));
            memset(&forces, 0, sizeof forces);
            forces.struct_size = sizeof forces;
            MUST(scene, frm_body_get_forces(body, &forces));
            memset(&command, 0, sizeof command);
            command.struct_size = sizeof command;
            command.wrench = forces.total;
            memset(&state, 0, sizeof state);
            state.struct_size = sizeof state;
            MUST(scene, frm_device_exchange(device, &command, &state));
            see_u64(scene, state.sequence);
            see_u64(scene, state.time_ns);
            see_body(scene, body);
        }
        MUST(scene, frm_recorder_close(recorder));
        MUST(scene, frm_device_close(device));
        see_world(scene, world);
        replay(scene, path);
    }
}

void section_golden(Scene *scene) {
    char path[1024];
    data_path(scene, "recordings/two_way.frmrec", path);
    replay(scene, path);
}
