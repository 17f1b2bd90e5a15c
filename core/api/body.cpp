#include <cstring>

#include "core/api/objects.h"
#include "core/body/coefficients.h"

namespace frm::api {

std::uint64_t add_body(Context& context, WorldObject& world, Body& body) {
    return context.add(Kind::body, context.make<BodyObject>(world, body), world.handle);
}

namespace {

frm_body_def default_body() {
    frm_body_def def{};
    def.scale = 1;
    def.pose.rotation.w = 1;
    return def;
}

BodyDef checked(Context& context, const frm_body_def& d) {
    BodyDef def;
    Object* map = context.find(d.map, Kind::map);
    if (!map) throw Error(FRM_ERROR_HANDLE, "def.map is not a map of this context, or it is no more");
    def.map = static_cast<MapObject*>(map)->map;
    require_range(static_cast<double>(d.scale), 1e-3f, 1e3, "def.scale");
    require_range(static_cast<double>(d.mass), 0, 1e9, "def.mass");
    for (const float v : {d.centre_of_mass.x, d.centre_of_mass.y, d.centre_of_mass.z})
        require_range(static_cast<double>(v), -1e6, 1e6, "def.centre_of_mass");
    def.scale = d.scale;
    def.mass = d.mass;
    def.centre_of_mass = context.axes().body_in(d.centre_of_mass);
    def.pose = context.axes().pose_in(d.pose, "def.pose");
    def.twist = context.axes().twist_in(d.twist, "def.twist");
    return def;
}

}  // namespace
}  // namespace frm::api

using namespace frm;
using namespace frm::api;

frm_status FRM_CALL frm_body_def_init(frm_body_def* def, uint64_t size) { return init_def(def, size, default_body()); }

frm_status FRM_CALL frm_body_create(frm_world world, const frm_body_def* def, frm_body* body) {
    return with<WorldObject>(world, [&](Context& c, WorldObject& object) {
        require_pointer(def, "def");
        require_pointer(body, "body");
        require_changeable(object);
        const BodyDef checked_def = checked(c, read_def(def, default_body(), "def"));
        Body& created = object.world.create_body(checked_def);
        try {
            *body = add_body(c, object, created);
        } catch (...) {
            object.world.destroy_body(created);
            throw;
        }
    });
}

frm_status FRM_CALL frm_body_get_def(frm_body body, frm_body_def* def) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_out(def, "def");
        require_not_served(object.world);
        const BodyDef& d = object.body.def;
        frm_body_def out{};
        out.scale = d.scale;
        out.map =
            c.find_handle(Kind::map, [&](const Object& o) { return static_cast<const MapObject&>(o).map == d.map; });
        out.mass = d.mass;
        out.centre_of_mass = c.axes().body_out(d.centre_of_mass);
        out.pose = c.axes().pose_out(d.pose);
        out.twist = c.axes().twist_out(d.twist);
        write_struct(def, out);
    });
}

frm_status FRM_CALL frm_body_destroy(frm_body body) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_changeable(object.world);
        if (object.users > 0) throw Error(FRM_ERROR_STATE, "a servo uses this body: destroy it first");
        object.world.world.destroy_body(object.body);
        c.remove(body);
    });
}

frm_status FRM_CALL frm_body_set_motion(frm_body body, const frm_pose* pose, const frm_twist* twist) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_pointer(pose, "pose");
        require_changeable(object.world);
        const Pose p = c.axes().pose_in(*pose, "pose");
        const Twist t = twist ? c.axes().twist_in(*twist, "twist") : Twist();
        object.world.world.set_motion(object.body, p, t);
    });
}

frm_status FRM_CALL frm_body_get_forces(frm_body body, frm_forces* forces) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_out(forces, "forces");
        require_not_served(object.world);
        const Forces& f = object.body.forces;
        frm_forces out{};
        out.total = c.axes().wrench_out(f.total);
        out.buoyancy = c.axes().wrench_out(f.buoyancy);
        out.pressure = c.axes().wrench_out(f.pressure);
        out.friction = c.axes().wrench_out(f.friction);
        out.gravity = c.axes().wrench_out(f.gravity);
        write_struct(forces, out);
    });
}

frm_status FRM_CALL frm_body_get_state(frm_body body, frm_body_state* state) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_out(state, "state");
        require_not_served(object.world);
        const Body& b = object.body;
        frm_body_state out{};
        out.wet_area = b.wet_area;
        out.displaced_volume = b.displaced_volume;
        out.relative_speed = b.relative_speed;
        out.reynolds = b.relative_speed * b.def.map->facts.reference_length * b.def.scale /
                       object.world.world.def().fluid.viscosity;
        out.wet_sources = b.wet_sources;
        out.pose = c.axes().pose_out(b.def.pose);
        out.twist = c.axes().twist_out(b.def.twist);
        write_struct(state, out);
    });
}

frm_status FRM_CALL frm_body_get_coefficients(frm_body body, frm_coefficients* coefficients) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_out(coefficients, "coefficients");
        require_not_served(object.world);
        const Coefficients found = coefficients_of(object.body, object.world.world.def().fluid);
        const auto added_mass = c.axes().matrix_out(found.added_mass), damping = c.axes().matrix_out(found.damping);
        frm_coefficients out{};
        out.wet_share = found.wet_share;
        std::memcpy(out.added_mass, added_mass.data(), sizeof out.added_mass);
        std::memcpy(out.damping, damping.data(), sizeof out.damping);
        write_struct(coefficients, out);
    });
}

frm_status FRM_CALL frm_body_get_sources(frm_body body, frm_source_state* sources, uint32_t capacity, uint32_t* count) {
    return with<BodyObject>(body, [&](Context& c, BodyObject& object) {
        require_pointer(count, "count");
        require_not_served(object.world);
        const Body& b = object.body;
        *count = static_cast<std::uint32_t>(b.sources.size());
        if (!sources) return;
        if (capacity < b.sources.size())
            throw Error(FRM_ERROR_CAPACITY, "the buffer takes %u sources; the body has %zu", capacity,
                        b.sources.size());
        for (std::size_t l = 0; l < b.sources.size(); ++l) {
            const SourceState& state = b.sources[l];
            const SourceReading s = read_source(b, static_cast<std::uint32_t>(l));
            frm_source_state out{};
            out.position = c.axes().position_out(b.def.pose.position + Vec3d(s.position));
            out.force = c.axes().vector_out(s.pressure + s.friction);
            out.relative_velocity = c.axes().vector_out(s.relative_velocity);
            out.wet_ratio = state.wet_ratio;
            out.map_time = state.map_time + b.map_time_owed;
            sources[l] = out;
        }
    });
}
