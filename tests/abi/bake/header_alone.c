/* The header by itself, as ../header_alone.c does for frm.h. */
#include "frm_bake.h"
#include "frm_bake.h" /* twice does no harm */

frm_status header_alone(frm_bake bake);
frm_status header_alone(frm_bake bake) {
    frm_bake_def def;
    frm_status status = frm_bake_def_init(&def, sizeof def);
    if (status == FRM_OK) status = frm_bake_plan(bake, &def, 0);
    return status;
}
