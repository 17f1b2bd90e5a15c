/* A stranger's first program: a world that ticks, and the version of the library that runs. */
#include <stdio.h>

#include <frm.h>

int main(void) {
    uint32_t major, minor, patch;
    frm_context context;
    frm_world world;
    frm_water water;
    frm_status status = frm_context_create(NULL, &context);
    if (status == FRM_OK) status = frm_world_create(context, NULL, &world);
    if (status == FRM_OK) status = frm_water_create(world, NULL, &water);
    if (status == FRM_OK) status = frm_world_tick(world, 0.002f);
    if (status == FRM_OK) status = frm_context_destroy(context);
    if (status == FRM_OK) status = frm_version(&major, &minor, &patch);
    if (status != FRM_OK) {
        printf("%s\n", frm_status_name(status));
        return 1;
    }
    printf("frm %u.%u.%u\n", (unsigned)major, (unsigned)minor, (unsigned)patch);
    return 0;
}
