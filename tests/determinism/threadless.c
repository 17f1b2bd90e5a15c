/* What libfrm does where it was built without threads (WebAssembly): a servo and an engaged device, which need one, are
 * refused and leave all as it was; a recorder writes in the thread that ticks. Usage: threadless DATA WORK */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frm.h"

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

static void refused(frm_status got, const char *call) {
    char text[512] = "";
    uint64_t size = 0;
    expect(got, FRM_ERROR_UNSUPPORTED, call);
    GOOD(frm_context_last_error(context, text, sizeof text, &size));
    if (strstr(text, "without threads")) return;
    fprintf(stderr, "%s: the text does not say why: %s\n", call, text);
    exit(1);
}

int main(int count, char **arguments) {
    char map_path[1024], path[1024];
    frm_context_def context_def;
    frm_world_def world_def;
    frm_body_def body_def;
    frm_servo_def servo_def;
    frm_servo_state state;
    frm_device_safety_state safety;
    frm_recorder_stats before, after;
    frm_map map = 0;
    frm_world world = 0;
    frm_body body = 0;
    frm_device device = 0;
    frm_servo servo = 0;
    frm_recorder recorder = 0;
    FILE *file;
    int t;
    if (count != 3) return 2;
    snprintf(map_path, sizeof map_path, "%s/v2.frm", arguments[1]);
    snprintf(path, sizeof path, "%s/threadless.frmrec", arguments[2]);

    GOOD(frm_context_def_init(&context_def, sizeof context_def));
    GOOD(frm_context_create(&context_def, &context));
    GOOD(frm_map_open_file(context, map_path, &map));
    GOOD(frm_world_def_init(&world_def, sizeof world_def));
    GOOD(frm_world_create(context, &world_def, &world));
    GOOD(frm_body_def_init(&body_def, sizeof body_def));
    body_def.map = map;
    GOOD(frm_body_create(world, &body_def, &body));
    GOOD(frm_device_open_simulated(context, NULL, &device));

    refused(frm_device_engage(device), "frm_device_engage");
    memset(&safety, 0, sizeof safety);
    safety.struct_size = sizeof safety;
    GOOD(frm_device_get_safety(device, &safety));
    expect(safety.engaged == 0 ? FRM_OK : FRM_ERROR_STATE, FRM_OK, "a refused device is not engaged");

    GOOD(frm_servo_def_init(&servo_def, sizeof servo_def));
    servo_def.device = device;
    servo_def.body = body;
    GOOD(frm_servo_create(context, &servo_def, &servo));
    refused(frm_servo_start(servo), "frm_servo_start");
    refused(frm_servo_start(servo), "frm_servo_start again");
    memset(&state, 0, sizeof state);
    state.struct_size = sizeof state;
    GOOD(frm_servo_get_state(servo, &state));
    expect(state.running == 0 ? FRM_OK : FRM_ERROR_STATE, FRM_OK, "a refused servo does not run");
    GOOD(frm_servo_stop(servo));
    GOOD(frm_servo_destroy(servo));

    GOOD(frm_recorder_create(world, path, NULL, &recorder));
    GOOD(frm_recorder_add_device(recorder, device));
    memset(&before, 0, sizeof before);
    before.struct_size = sizeof before;
    after = before;
    GOOD(frm_recorder_get_stats(recorder, &before));
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
    GOOD(frm_recorder_get_stats(recorder, &after));
    expect(after.ticks == 300 && after.file_bytes > before.file_bytes ? FRM_OK : FRM_ERROR_STATE, FRM_OK,
           "a recorder writes while the world ticks");
    GOOD(frm_recorder_close(recorder));
    file = fopen(path, "rb");
    expect(file ? FRM_OK : FRM_ERROR_FILE, FRM_OK, "the recording has its name");
    fclose(file);
    GOOD(frm_context_destroy(context));
    puts("threadless: as it should be");
    return 0;
}
