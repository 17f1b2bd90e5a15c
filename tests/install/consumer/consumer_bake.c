/* A stranger's pipeline: plans a bake, with the bake's library alone. */
#include <stdio.h>

#include <frm_bake.h>

int main(int argc, char **argv) {
    uint32_t major, minor, patch;
    frm_bake bake;
    frm_bake_def def;
    frm_bake_plan_info info = {sizeof info};
    frm_status status = frm_bake_create(&bake);
    if (status == FRM_OK) status = frm_bake_def_init(&def, sizeof def);
    def.mesh = argc > 1 ? argv[1] : "";
    def.quality = FRM_BAKE_DRAFT;
    if (status == FRM_OK) status = frm_bake_plan(bake, &def, &info);
    if (status == FRM_OK) status = frm_bake_destroy(bake);
    if (status == FRM_OK) status = frm_bake_version(&major, &minor, &patch);
    if (status != FRM_OK || info.flows == 0) {
        printf("status %d\n", (int)status);
        return 1;
    }
    printf("frm %u.%u.%u\n", (unsigned)major, (unsigned)minor, (unsigned)patch);
    return 0;
}
