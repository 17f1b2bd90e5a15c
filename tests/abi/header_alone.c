/* The header by itself, before any other include: it must bring what it needs. Compiled for syntax only, as C and as
 * C++, from the oldest standard to a new one. */
#include "frm.h"
#include "frm.h" /* twice does no harm */

/* Uses of what a caller writes: a def, a handle, a callback. */
frm_status header_alone(frm_context context, const frm_device_driver *driver);
frm_status header_alone(frm_context context, const frm_device_driver *driver) {
    frm_body_def def;
    frm_body body = 0;
    frm_device device = 0;
    frm_status status = frm_body_def_init(&def, sizeof def);
    if (status == FRM_OK) status = frm_body_create(0, &def, &body);
    if (status == FRM_OK) status = frm_device_open(context, driver, 0, 0, &device);
    return status;
}
