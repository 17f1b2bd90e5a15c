/* Every constant of frm.h, pinned: recordings, bindings and hosts hold these numbers. A line here may be added, never
 * changed. check_tables.py tells when one is missing. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "frm.h"

typedef struct row {
    const char *name;
    int64_t value, expected;
} row;

/* clang-format off */
#define VALUE(name, expected) {#name, (int64_t)(name), expected},

static const row rows[] = {
    VALUE(FRM_OK, 0)
    VALUE(FRM_ERROR_ARGUMENT, -1)
    VALUE(FRM_ERROR_HANDLE, -2)
    VALUE(FRM_ERROR_STATE, -3)
    VALUE(FRM_ERROR_VERSION, -4)
    VALUE(FRM_ERROR_MEMORY, -5)
    VALUE(FRM_ERROR_FILE, -6)
    VALUE(FRM_ERROR_CORRUPT, -7)
    VALUE(FRM_ERROR_CAPACITY, -8)
    VALUE(FRM_ERROR_LIMIT, -9)
    VALUE(FRM_ERROR_DEVICE, -10)
    VALUE(FRM_ERROR_END, -11)
    VALUE(FRM_ERROR_INTERNAL, -12)
    VALUE(FRM_ERROR_DIVERGED, -13)
    VALUE(FRM_ERROR_UNSUPPORTED, -14)
    VALUE(FRM_AXES_Z_UP_RIGHT, 0)
    VALUE(FRM_AXES_Y_UP_RIGHT, 1)
    VALUE(FRM_AXES_Y_UP_LEFT, 2)
    VALUE(FRM_AXES_Z_UP_LEFT, 3)
    VALUE(FRM_LOG_ERROR, 0)
    VALUE(FRM_LOG_WARNING, 1)
    VALUE(FRM_LOG_INFO, 2)
    VALUE(FRM_MODEL_PAPER, 0)
    VALUE(FRM_MODEL_DISPLACEMENT, 1)
    VALUE(FRM_MODEL_OWN_WAVES, 2)
    VALUE(FRM_MODEL_FLUCTUATION, 4)
    VALUE(FRM_MODEL_SPEEDS, 8)
    VALUE(FRM_MODEL_SPIN, 16)
    VALUE(FRM_SKIP_NOTHING, 0)
    VALUE(FRM_SKIP_FRICTION, 1)
    VALUE(FRM_SKIP_STEADY, 2)
    VALUE(FRM_SKIP_DRY_BODIES, 4)
    VALUE(FRM_SKIP_WET_BODIES, 8)
    VALUE(FRM_SKIP_CALM_WATER, 16)
    VALUE(FRM_SKIP_WAVE_STEPS, 32)
    VALUE(FRM_SKIP_DEEP_BODIES, 64)
    VALUE(FRM_SKIP_STILL_BODIES, 128)
    VALUE(FRM_SKIP_DEFAULT, 255)
    VALUE(FRM_MODEL_DEFAULT, 31)
    VALUE(FRM_SURFACE_FLAT, 0)
    VALUE(FRM_SURFACE_NONE, 1)
    VALUE(FRM_BORDER_ABSORBING, 0)
    VALUE(FRM_BORDER_REFLECTING, 1)
    VALUE(FRM_DEVICE_READY, 0)
    VALUE(FRM_DEVICE_UNCALIBRATED, 1)
    VALUE(FRM_DEVICE_FAULT, 2)
    VALUE(FRM_DEVICE_FAULT_NONE, 0)
    VALUE(FRM_DEVICE_FAULT_UNCALIBRATED, 1)
    VALUE(FRM_DEVICE_FAULT_SHORT_PACKET, 2)
    VALUE(FRM_DEVICE_FAULT_TIMEOUT, 4)
    VALUE(FRM_DEVICE_FAULT_TRANSFER, 8)
    VALUE(FRM_DEVICE_FAULT_UNPLUGGED, 16)
    VALUE(FRM_DEVICE_FAULT_LOST_COUNT, 32)
    VALUE(FRM_DEVICE_FAULT_STUCK_ENCODER, 64)
    VALUE(FRM_DEVICE_FAULT_SLACK_STRING, 128)
    VALUE(FRM_DEVICE_FAULT_BROKEN_STRING, 256)
    VALUE(FRM_DEVICE_FAULT_DEADLINE, 512)
    VALUE(FRM_DEVICE_FAULT_COMMAND, 65536)
    VALUE(FRM_DEVICE_FAULT_STEP, 131072)
    VALUE(FRM_DEVICE_FAULT_SPEED, 262144)
    VALUE(FRM_DEVICE_FAULT_STATE, 1048576)
    VALUE(FRM_DEVICE_FAULT_JUMP, 2097152)
    VALUE(FRM_DEVICE_FAULT_STALE, 4194304)
    VALUE(FRM_DEVICE_FAULT_DRIVER, 8388608)
    VALUE(FRM_SERVO_TICK, 0)
    VALUE(FRM_SERVO_LATE, 1)
    VALUE(FRM_PART_NONE, 0)
    VALUE(FRM_PART_BUOYANCY, 1)
    VALUE(FRM_PART_PRESSURE, 2)
    VALUE(FRM_PART_FRICTION, 3)
    VALUE(FRM_PART_GRAVITY, 4)
    VALUE(FRM_PART_TOTAL, 5)
    VALUE(FRM_PART_WORLD, 6)
};
/* clang-format on */

int main(void) {
    const size_t count = sizeof rows / sizeof rows[0];
    int failures = 0;
    uint32_t major = 99, minor = 99, patch = 99;
    size_t i;

    for (i = 0; i < count; ++i) {
        const row *r = &rows[i];
        const int is_status = strcmp(r->name, "FRM_OK") == 0 || strncmp(r->name, "FRM_ERROR_", 10) == 0;
        if (r->value != r->expected) {
            printf("wrong: %s is %lld, not %lld\n", r->name, (long long)r->value, (long long)r->expected);
            ++failures;
        }
        if (is_status && strcmp(frm_status_name((frm_status)r->value), r->name) != 0) {
            printf("wrong: the library calls %s \"%s\"\n", r->name, frm_status_name((frm_status)r->value));
            ++failures;
        }
    }
    /* The library that is linked is of this header's version, also where only the SONAME was compared. */
    if (frm_version(&major, &minor, &patch) != FRM_OK || major != FRM_VERSION_MAJOR || minor != FRM_VERSION_MINOR ||
        patch != FRM_VERSION_PATCH) {
        printf("wrong: the library says version %u.%u.%u\n", major, minor, patch);
        ++failures;
    }
    printf("%zu constants: %d failures\n", count, failures);
    return failures ? 1 : 0;
}
