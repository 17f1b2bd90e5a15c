/* Sizes and offsets of every struct of frm.h, pinned: a binding in another language, or a host built against an older
 * header, relies on them. Where pointers have 64 bits they are the same on every platform. To change a line here is to
 * break the ABI; new fields go at the end of a struct, new structs anywhere. check_tables.py tells when one is missing. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "frm.h"

typedef struct row {
    const char *type;
    const char *field; /* null: the struct itself */
    size_t offset, size;
    size_t expected_offset, expected_size;
} row;

/* clang-format off */
#define STRUCT(type, size) {#type, NULL, 0, sizeof(type), 0, size},
#define FIELD(type, field, offset, size) {#type, #field, offsetof(type, field), sizeof(((type *)0)->field), offset, size},

/* (struct, size), and its (struct, field, offset, size) in order */
static const row rows[] = {
    STRUCT(frm_vec3, 12)
    FIELD(frm_vec3, x, 0, 4)
    FIELD(frm_vec3, y, 4, 4)
    FIELD(frm_vec3, z, 8, 4)
    STRUCT(frm_position, 24)
    FIELD(frm_position, x, 0, 8)
    FIELD(frm_position, y, 8, 8)
    FIELD(frm_position, z, 16, 8)
    STRUCT(frm_quaternion, 16)
    FIELD(frm_quaternion, x, 0, 4)
    FIELD(frm_quaternion, y, 4, 4)
    FIELD(frm_quaternion, z, 8, 4)
    FIELD(frm_quaternion, w, 12, 4)
    STRUCT(frm_pose, 40)
    FIELD(frm_pose, position, 0, 24)
    FIELD(frm_pose, rotation, 24, 16)
    STRUCT(frm_twist, 24)
    FIELD(frm_twist, linear, 0, 12)
    FIELD(frm_twist, angular, 12, 12)
    STRUCT(frm_wrench, 24)
    FIELD(frm_wrench, force, 0, 12)
    FIELD(frm_wrench, torque, 12, 12)
    STRUCT(frm_context_def, 40)
    FIELD(frm_context_def, struct_size, 0, 4)
    FIELD(frm_context_def, axes, 4, 4)
    FIELD(frm_context_def, threads, 8, 4)
    FIELD(frm_context_def, log_capacity, 12, 4)
    FIELD(frm_context_def, allocate, 16, 8)
    FIELD(frm_context_def, release, 24, 8)
    FIELD(frm_context_def, allocator_user, 32, 8)
    STRUCT(frm_map_info, 152)
    FIELD(frm_map_info, struct_size, 0, 4)
    FIELD(frm_map_info, format_version, 4, 4)
    FIELD(frm_map_info, file_bytes, 8, 8)
    FIELD(frm_map_info, content_hash, 16, 8)
    FIELD(frm_map_info, sources, 24, 4)
    FIELD(frm_map_info, directions, 28, 4)
    FIELD(frm_map_info, samples, 32, 4)
    FIELD(frm_map_info, triangles, 36, 4)
    FIELD(frm_map_info, period, 40, 4)
    FIELD(frm_map_info, base_speed, 44, 4)
    FIELD(frm_map_info, density, 48, 4)
    FIELD(frm_map_info, viscosity, 52, 4)
    FIELD(frm_map_info, reynolds, 56, 4)
    FIELD(frm_map_info, reynolds_solved, 60, 4)
    FIELD(frm_map_info, reference_length, 64, 4)
    FIELD(frm_map_info, quantisation_error, 68, 4)
    FIELD(frm_map_info, area, 72, 4)
    FIELD(frm_map_info, volume, 76, 4)
    FIELD(frm_map_info, centroid, 80, 12)
    FIELD(frm_map_info, bounds_low, 92, 12)
    FIELD(frm_map_info, bounds_high, 104, 12)
    FIELD(frm_map_info, reserved, 116, 4)
    FIELD(frm_map_info, fluctuation_directions, 120, 4)
    FIELD(frm_map_info, speeds, 124, 4)
    FIELD(frm_map_info, has_spin, 128, 4)
    FIELD(frm_map_info, has_added_mass, 132, 4)
    FIELD(frm_map_info, direction_error_rms, 136, 4)
    FIELD(frm_map_info, direction_error_worst, 140, 4)
    FIELD(frm_map_info, uncertainty, 144, 4)
    FIELD(frm_map_info, reserved_2, 148, 4)
    STRUCT(frm_map_source, 32)
    FIELD(frm_map_source, struct_size, 0, 4)
    FIELD(frm_map_source, area, 4, 4)
    FIELD(frm_map_source, position, 8, 12)
    FIELD(frm_map_source, normal, 20, 12)
    STRUCT(frm_world_def, 48)
    FIELD(frm_world_def, struct_size, 0, 4)
    FIELD(frm_world_def, model, 4, 4)
    FIELD(frm_world_def, surface, 8, 4)
    FIELD(frm_world_def, gravity, 12, 4)
    FIELD(frm_world_def, density, 16, 4)
    FIELD(frm_world_def, viscosity, 20, 4)
    FIELD(frm_world_def, level, 24, 8)
    FIELD(frm_world_def, skip, 32, 4)
    FIELD(frm_world_def, error_budget, 36, 4)
    FIELD(frm_world_def, time_budget, 40, 4)
    FIELD(frm_world_def, reserved, 44, 4)
    STRUCT(frm_world_stats, 80)
    FIELD(frm_world_stats, struct_size, 0, 4)
    FIELD(frm_world_stats, bodies, 4, 4)
    FIELD(frm_world_stats, ticks, 8, 8)
    FIELD(frm_world_stats, time, 16, 8)
    FIELD(frm_world_stats, wet_bodies, 24, 4)
    FIELD(frm_world_stats, wet_sources, 28, 4)
    FIELD(frm_world_stats, clipped_triangles, 32, 4)
    FIELD(frm_world_stats, water_substeps, 36, 4)
    FIELD(frm_world_stats, dry_bodies, 40, 4)
    FIELD(frm_world_stats, whole_bodies, 44, 4)
    FIELD(frm_world_stats, still_bodies, 48, 4)
    FIELD(frm_world_stats, deep_bodies, 52, 4)
    FIELD(frm_world_stats, coarse_bodies, 56, 4)
    FIELD(frm_world_stats, frictionless_sources, 60, 4)
    FIELD(frm_world_stats, steady_sources, 64, 4)
    FIELD(frm_world_stats, active_cells, 68, 4)
    FIELD(frm_world_stats, water_waits, 72, 8)
    STRUCT(frm_water_def, 56)
    FIELD(frm_water_def, struct_size, 0, 4)
    FIELD(frm_water_def, nx, 4, 4)
    FIELD(frm_water_def, ny, 8, 4)
    FIELD(frm_water_def, border, 12, 4)
    FIELD(frm_water_def, border_cells, 16, 4)
    FIELD(frm_water_def, cell, 20, 4)
    FIELD(frm_water_def, depth, 24, 4)
    FIELD(frm_water_def, snapshot_interval, 28, 4)
    FIELD(frm_water_def, centre_x, 32, 8)
    FIELD(frm_water_def, centre_y, 40, 8)
    FIELD(frm_water_def, order, 48, 4)
    FIELD(frm_water_def, reserved, 52, 4)
    STRUCT(frm_water_state, 64)
    FIELD(frm_water_state, struct_size, 0, 4)
    FIELD(frm_water_state, nx, 4, 4)
    FIELD(frm_water_state, ny, 8, 4)
    FIELD(frm_water_state, reserved, 12, 4)
    FIELD(frm_water_state, capacity, 16, 8)
    FIELD(frm_water_state, tick, 24, 8)
    FIELD(frm_water_state, time, 32, 8)
    FIELD(frm_water_state, height, 40, 8)
    FIELD(frm_water_state, velocity_x, 48, 8)
    FIELD(frm_water_state, velocity_y, 56, 8)
    STRUCT(frm_body_def, 96)
    FIELD(frm_body_def, struct_size, 0, 4)
    FIELD(frm_body_def, scale, 4, 4)
    FIELD(frm_body_def, map, 8, 8)
    FIELD(frm_body_def, mass, 16, 4)
    FIELD(frm_body_def, centre_of_mass, 20, 12)
    FIELD(frm_body_def, pose, 32, 40)
    FIELD(frm_body_def, twist, 72, 24)
    STRUCT(frm_forces, 128)
    FIELD(frm_forces, struct_size, 0, 4)
    FIELD(frm_forces, reserved, 4, 4)
    FIELD(frm_forces, total, 8, 24)
    FIELD(frm_forces, buoyancy, 32, 24)
    FIELD(frm_forces, pressure, 56, 24)
    FIELD(frm_forces, friction, 80, 24)
    FIELD(frm_forces, gravity, 104, 24)
    STRUCT(frm_body_state, 88)
    FIELD(frm_body_state, struct_size, 0, 4)
    FIELD(frm_body_state, wet_area, 4, 4)
    FIELD(frm_body_state, displaced_volume, 8, 4)
    FIELD(frm_body_state, relative_speed, 12, 4)
    FIELD(frm_body_state, reynolds, 16, 4)
    FIELD(frm_body_state, wet_sources, 20, 4)
    FIELD(frm_body_state, pose, 24, 40)
    FIELD(frm_body_state, twist, 64, 24)
    STRUCT(frm_source_state, 56)
    FIELD(frm_source_state, position, 0, 24)
    FIELD(frm_source_state, force, 24, 12)
    FIELD(frm_source_state, relative_velocity, 36, 12)
    FIELD(frm_source_state, wet_ratio, 48, 4)
    FIELD(frm_source_state, map_time, 52, 4)
    STRUCT(frm_device_info, 88)
    FIELD(frm_device_info, struct_size, 0, 4)
    FIELD(frm_device_info, serial, 4, 4)
    FIELD(frm_device_info, max_force, 8, 4)
    FIELD(frm_device_info, max_torque, 12, 4)
    FIELD(frm_device_info, period_ns, 16, 8)
    FIELD(frm_device_info, name, 24, 64)
    STRUCT(frm_device_command, 40)
    FIELD(frm_device_command, struct_size, 0, 4)
    FIELD(frm_device_command, reserved, 4, 4)
    FIELD(frm_device_command, wrench, 8, 24)
    FIELD(frm_device_command, deadline_ns, 32, 8)
    STRUCT(frm_device_state, 128)
    FIELD(frm_device_state, struct_size, 0, 4)
    FIELD(frm_device_state, status, 4, 4)
    FIELD(frm_device_state, pose, 8, 40)
    FIELD(frm_device_state, twist, 48, 24)
    FIELD(frm_device_state, grip, 72, 4)
    FIELD(frm_device_state, buttons, 76, 4)
    FIELD(frm_device_state, time_ns, 80, 8)
    FIELD(frm_device_state, sequence, 88, 8)
    FIELD(frm_device_state, achieved, 96, 24)
    FIELD(frm_device_state, faults, 120, 4)
    FIELD(frm_device_state, reserved, 124, 4)
    STRUCT(frm_device_driver, 64)
    FIELD(frm_device_driver, struct_size, 0, 4)
    FIELD(frm_device_driver, reserved, 4, 4)
    FIELD(frm_device_driver, enumerate, 8, 8)
    FIELD(frm_device_driver, open, 16, 8)
    FIELD(frm_device_driver, close, 24, 8)
    FIELD(frm_device_driver, info, 32, 8)
    FIELD(frm_device_driver, calibrate, 40, 8)
    FIELD(frm_device_driver, exchange, 48, 8)
    FIELD(frm_device_driver, stop, 56, 8)
    STRUCT(frm_recorder_def, 8)
    FIELD(frm_recorder_def, struct_size, 0, 4)
    FIELD(frm_recorder_def, hash_interval, 4, 4)
    STRUCT(frm_replay_info, 40)
    FIELD(frm_replay_info, struct_size, 0, 4)
    FIELD(frm_replay_info, torn, 4, 4)
    FIELD(frm_replay_info, ticks, 8, 8)
    FIELD(frm_replay_info, time, 16, 8)
    FIELD(frm_replay_info, bodies, 24, 4)
    FIELD(frm_replay_info, devices, 28, 4)
    FIELD(frm_replay_info, has_water, 32, 4)
    FIELD(frm_replay_info, maps, 36, 4)
    STRUCT(frm_replay_step_result, 24)
    FIELD(frm_replay_step_result, struct_size, 0, 4)
    FIELD(frm_replay_step_result, diverged, 4, 4)
    FIELD(frm_replay_step_result, tick, 8, 8)
    FIELD(frm_replay_step_result, body, 16, 4)
    FIELD(frm_replay_step_result, part, 20, 4)
};
/* clang-format on */

int main(void) {
    int failures = 0;
    size_t i, end = 0, structs = 0;
    const row *owner = NULL;

    if (sizeof(void *) != 8) {
        printf("the table is for 64-bit pointers; nothing compared\n");
        return 77;
    }
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        const row *r = &rows[i];
        if (r->offset != r->expected_offset || r->size != r->expected_size) {
            printf("wrong: %s%s%s is at %zu with size %zu, not at %zu with size %zu\n", r->type, r->field ? "." : "",
                   r->field ? r->field : "", r->offset, r->size, r->expected_offset, r->expected_size);
            ++failures;
        }
        /* Implicit padding would carry undefined bytes into files and hashes: each field begins where the one before
         * it ended, and the last ends where the struct ends. */
        if (r->field && r->offset != end) {
            printf("wrong: padding before %s.%s\n", r->type, r->field);
            ++failures;
        }
        if (!r->field) {
            if (owner && end != owner->size) {
                printf("wrong: padding at the end of %s\n", owner->type);
                ++failures;
            }
            owner = r;
            end = 0;
            ++structs;
        } else {
            end = r->offset + r->size;
        }
    }
    if (owner && end != owner->size) {
        printf("wrong: padding at the end of %s\n", owner->type);
        ++failures;
    }
    printf("%zu structs, %zu fields: %d failures\n", structs, sizeof rows / sizeof rows[0] - structs, failures);
    return failures ? 1 : 0;
}
