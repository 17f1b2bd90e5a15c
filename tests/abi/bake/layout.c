/* Sizes and offsets of every struct of frm_bake.h, pinned as ../layout.c pins those of frm.h. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "frm_bake.h"

typedef struct row {
    const char *type;
    const char *field; /* null: the struct itself */
    size_t offset, size;
    size_t expected_offset, expected_size;
} row;

/* clang-format off */
#define STRUCT(type, size) {#type, NULL, 0, sizeof(type), 0, size},
#define FIELD(type, field, offset, size) {#type, #field, offsetof(type, field), sizeof(((type *)0)->field), offset, size},

static const row rows[] = {
    STRUCT(frm_bake_def, 112)
    FIELD(frm_bake_def, struct_size, 0, 4)
    FIELD(frm_bake_def, quality, 4, 4)
    FIELD(frm_bake_def, mesh, 8, 8)
    FIELD(frm_bake_def, work, 16, 8)
    FIELD(frm_bake_def, scale, 24, 8)
    FIELD(frm_bake_def, density, 32, 8)
    FIELD(frm_bake_def, viscosity, 40, 8)
    FIELD(frm_bake_def, speed, 48, 8)
    FIELD(frm_bake_def, speeds, 56, 8)
    FIELD(frm_bake_def, speed_count, 64, 4)
    FIELD(frm_bake_def, spin, 68, 4)
    FIELD(frm_bake_def, added_mass, 72, 4)
    FIELD(frm_bake_def, symmetry, 76, 4)
    FIELD(frm_bake_def, resolution, 80, 8)
    FIELD(frm_bake_def, directions, 88, 4)
    FIELD(frm_bake_def, sources, 92, 4)
    FIELD(frm_bake_def, triangles, 96, 4)
    FIELD(frm_bake_def, threads, 100, 4)
    FIELD(frm_bake_def, threshold, 104, 8)
    STRUCT(frm_bake_plan_info, 152)
    FIELD(frm_bake_plan_info, struct_size, 0, 4)
    FIELD(frm_bake_plan_info, flows, 4, 4)
    FIELD(frm_bake_plan_info, flows_done, 8, 4)
    FIELD(frm_bake_plan_info, most_flows, 12, 4)
    FIELD(frm_bake_plan_info, directions, 16, 4)
    FIELD(frm_bake_plan_info, sources, 20, 4)
    FIELD(frm_bake_plan_info, triangles, 24, 4)
    FIELD(frm_bake_plan_info, isometries, 28, 4)
    FIELD(frm_bake_plan_info, updates, 32, 8)
    FIELD(frm_bake_plan_info, flow_bytes, 40, 8)
    FIELD(frm_bake_plan_info, extent, 48, 8)
    FIELD(frm_bake_plan_info, symmetry, 56, 96)
    STRUCT(frm_bake_progress, 104)
    FIELD(frm_bake_progress, struct_size, 0, 4)
    FIELD(frm_bake_progress, stage, 4, 4)
    FIELD(frm_bake_progress, share, 8, 8)
    FIELD(frm_bake_progress, seconds_left, 16, 8)
    FIELD(frm_bake_progress, flows, 24, 4)
    FIELD(frm_bake_progress, flows_done, 28, 4)
    FIELD(frm_bake_progress, drag, 32, 4)
    FIELD(frm_bake_progress, uncertainty, 36, 4)
    FIELD(frm_bake_progress, flow, 40, 64)
};
/* clang-format on */

int main(void) {
    int failures = 0;
    size_t i, end = 0;
    if (sizeof(void *) != 8) {
        printf("the table is for 64-bit pointers; nothing compared\n");
        return 77;
    }
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        const row *r = &rows[i];
        const int last = i + 1 == sizeof rows / sizeof rows[0] || !rows[i + 1].field;
        if (r->offset != r->expected_offset || r->size != r->expected_size) {
            printf("wrong: %s.%s is at %zu with size %zu, not at %zu with size %zu\n", r->type,
                   r->field ? r->field : "", r->offset, r->size, r->expected_offset, r->expected_size);
            ++failures;
        }
        if (!r->field) {
            end = 0;
            continue;
        }
        if (r->offset != end) {
            printf("wrong: padding before %s.%s\n", r->type, r->field);
            ++failures;
        }
        end = r->offset + r->size;
        if (last) {
            size_t k = i;
            while (rows[k].field) --k;
            if (end != rows[k].size) {
                printf("wrong: padding at the end of %s\n", r->type);
                ++failures;
            }
        }
    }
    printf("%zu structs and fields: %d failures\n", sizeof rows / sizeof rows[0], failures);
    return failures ? 1 : 0;
}
