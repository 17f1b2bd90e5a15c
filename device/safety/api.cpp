// The C entry points of the safety layer.
#include "device/device.h"

using namespace frm;
using namespace frm::api;
using frm::device::Device;

frm_status FRM_CALL frm_device_safety_def_init(frm_device_safety_def* def, uint64_t size) {
    return init_def(def, size, device::default_safety());
}

frm_status FRM_CALL frm_device_set_safety(frm_device device, const frm_device_safety_def* def) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.set_safety(read_def(def, device::default_safety(), "def"));
    });
}

frm_status FRM_CALL frm_device_get_safety(frm_device device, frm_device_safety_state* state) {
    return with<Device>(device, [&](Context&, Device& object) {
        require_out(state, "state");
        device::require_not_served(object);
        write_struct(state, object.safety());
    });
}

frm_status FRM_CALL frm_device_engage(frm_device device) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.prepare();
        object.engage();
    });
}

frm_status FRM_CALL frm_device_disengage(frm_device device) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.disengage();
    });
}

frm_status FRM_CALL frm_device_clear_fault(frm_device device) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.clear_fault();
    });
}
