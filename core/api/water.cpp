#include "core/api/objects.h"

namespace frm::api {

std::uint64_t add_water(Context& context, WorldObject& world) {
    return context.add(Kind::water, context.make<WaterObject>(world), world.handle);
}

namespace {

frm_water_def default_water() {
    frm_water_def def{};
    def.nx = def.ny = 200;
    def.border = FRM_BORDER_ABSORBING;
    def.border_cells = 0;
    def.cell = 0.025f;
    def.depth = 0.5f;
    def.snapshot_interval = 1.0f / 60;
    def.order = 2;
    return def;
}

WaterDef checked(const frm_water_def& d) {
    require_range(d.nx, 8, 8192, "def.nx");
    require_range(d.ny, 8, 8192, "def.ny");
    if (d.border > FRM_BORDER_REFLECTING)
        throw Error(FRM_ERROR_ARGUMENT, "def.border = %u is not an frm_border", d.border);
    require_range(d.border_cells, 0, 64, "def.border_cells");
    if (d.border == FRM_BORDER_ABSORBING && (3 * d.border_cells >= d.nx || 3 * d.border_cells >= d.ny))
        throw Error(FRM_ERROR_ARGUMENT, "def.border_cells = %u is a third of nx = %u or ny = %u, or more",
                    d.border_cells, d.nx, d.ny);
    require_range(static_cast<double>(d.cell), 1e-4f, 1e3, "def.cell");
    require_range(static_cast<double>(d.depth), 1e-3f, 1e4, "def.depth");
    require_range(static_cast<double>(d.snapshot_interval), 0, 10, "def.snapshot_interval");
    require_range(d.centre_x, -1e9, 1e9, "def.centre_x");
    require_range(d.centre_y, -1e9, 1e9, "def.centre_y");
    if (d.order != 2 && d.order != 4) throw Error(FRM_ERROR_ARGUMENT, "def.order = %u is neither 2 nor 4", d.order);
    if (d.reserved != 0) throw Error(FRM_ERROR_ARGUMENT, "def.reserved is not 0");
    WaterDef def;
    def.field = {static_cast<std::int32_t>(d.nx),
                 static_cast<std::int32_t>(d.ny),
                 d.cell,
                 d.depth,
                 d.border == FRM_BORDER_ABSORBING ? Border::absorbing : Border::reflecting,
                 static_cast<std::int32_t>(d.border_cells),
                 static_cast<std::int32_t>(d.order)};
    def.centre_x = d.centre_x;
    def.centre_y = d.centre_y;
    def.snapshot_interval = d.snapshot_interval;
    return def;
}

void require_count(const Water& water, std::uint64_t count) {
    if (count != water.field.cells())
        throw Error(FRM_ERROR_ARGUMENT, "count = %llu; the water has %zu cells", static_cast<unsigned long long>(count),
                    water.field.cells());
}

void require_room(const frm_water_state& state, const Water& water) {
    if ((state.height || state.velocity_x || state.velocity_y) && state.capacity < water.field.cells())
        throw Error(FRM_ERROR_CAPACITY, "state.capacity = %llu; the water has %zu cells",
                    static_cast<unsigned long long>(state.capacity), water.field.cells());
}

/// The arrays lie at the end of the struct, so it must be whole.
frm_water_state checked(const frm_water_state* state, const Water& water) {
    require_out(state, "state");
    if (state->struct_size < sizeof(frm_water_state)) throw Error(FRM_ERROR_VERSION, "state.struct_size is too small");
    require_room(*state, water);
    frm_water_state out = *state;
    out.nx = static_cast<std::uint32_t>(water.field.def().nx);
    out.ny = static_cast<std::uint32_t>(water.field.def().ny);
    out.reserved = 0;
    return out;
}

}  // namespace
}  // namespace frm::api

using namespace frm;
using namespace frm::api;

frm_status FRM_CALL frm_water_def_init(frm_water_def* def, uint64_t size) {
    return init_def(def, size, default_water());
}

frm_status FRM_CALL frm_water_create(frm_world world, const frm_water_def* def, frm_water* water) {
    return with<WorldObject>(world, [&](Context& c, WorldObject& object) {
        require_pointer(water, "water");
        require_changeable(object);
        const WaterDef checked_def = checked(read_def(def, default_water(), "def"));
        if (object.world.water()) throw Error(FRM_ERROR_STATE, "this world has water already");
        if (object.world.def().everywhere)
            throw Error(FRM_ERROR_STATE, "this world's fluid has no surface (def.surface = FRM_SURFACE_NONE)");
        object.world.create_water(checked_def);
        try {
            *water = add_water(c, object);
        } catch (...) {
            object.world.destroy_water();
            throw;
        }
    });
}

frm_status FRM_CALL frm_water_destroy(frm_water water) {
    return with<WaterObject>(water, [&](Context& c, WaterObject& object) {
        require_changeable(object.world);
        object.world.world.destroy_water();
        c.remove(water);
    });
}

frm_status FRM_CALL frm_water_get_def(frm_water water, frm_water_def* def) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        require_out(def, "def");
        const WaterDef& d = object.water().def();
        frm_water_def out{};
        out.nx = static_cast<std::uint32_t>(d.field.nx);
        out.ny = static_cast<std::uint32_t>(d.field.ny);
        out.border = d.field.border == Border::absorbing ? FRM_BORDER_ABSORBING : FRM_BORDER_REFLECTING;
        out.border_cells = static_cast<std::uint32_t>(d.field.border_cells);
        out.cell = d.field.cell;
        out.depth = d.field.depth;
        out.snapshot_interval = d.snapshot_interval;
        out.order = static_cast<std::uint32_t>(d.field.order);
        out.centre_x = d.centre_x;
        out.centre_y = d.centre_y;
        write_struct(def, out);
    });
}

frm_status FRM_CALL frm_water_read(frm_water water, frm_water_state* state) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        require_not_served(object.world);
        frm_water_state out = checked(state, object.water());
        out.tick = object.world.world.water_stepped_at();
        out.time = object.world.world.time() - static_cast<double>(object.world.world.water_behind());
        copy_to_centres(object.water().field, out.height, out.velocity_x, out.velocity_y);
        write_struct(state, out);
    });
}

frm_status FRM_CALL frm_water_read_snapshot(frm_water water, frm_water_state* state) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        frm_water_state out = checked(state, object.water());
        object.water().snapshots.read([&](const WaterSnapshot& snapshot) {
            out.tick = snapshot.tick;
            out.time = snapshot.time;
            const std::size_t bytes = snapshot.height.size() * sizeof(float);
            if (out.height) std::memcpy(out.height, snapshot.height.data(), bytes);
            if (out.velocity_x) std::memcpy(out.velocity_x, snapshot.velocity_x.data(), bytes);
            if (out.velocity_y) std::memcpy(out.velocity_y, snapshot.velocity_y.data(), bytes);
        });
        write_struct(state, out);
    });
}

frm_status FRM_CALL frm_water_set_height(frm_water water, const float* height, uint64_t count) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        require_pointer(height, "height");
        require_changeable(object.world);
        require_count(object.water(), count);
        const float depth = object.water().field.def().depth;
        for (std::uint64_t i = 0; i < count; ++i)
            if (!(std::fabs(height[i]) <= depth))
                throw Error(FRM_ERROR_ARGUMENT, "height[%llu] is not within the depth of %g m",
                            static_cast<unsigned long long>(i), static_cast<double>(depth));
        object.world.world.set_height(height);
    });
}

frm_status FRM_CALL frm_water_set_pressure(frm_water water, const float* pressure, uint64_t count) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        require_changeable(object.world);
        if (pressure) {
            require_count(object.water(), count);
            for (std::uint64_t i = 0; i < count; ++i)
                if (!(std::fabs(pressure[i]) <= 1e9f))
                    throw Error(FRM_ERROR_ARGUMENT, "pressure[%llu] is not finite or beyond 1e9 Pa",
                                static_cast<unsigned long long>(i));
        } else if (count != 0) {
            throw Error(FRM_ERROR_ARGUMENT, "pressure is null and count is not 0");
        }
        object.world.world.set_pressure(pressure);
    });
}

frm_status FRM_CALL frm_water_get_height(frm_water water, double x, double y, double* height) {
    return with<WaterObject>(water, [&](Context&, WaterObject& object) {
        require_pointer(height, "height");
        require_range(x, -1e9, 1e9, "x");
        require_range(y, -1e9, 1e9, "y");
        require_not_served(object.world);
        const Water& w = object.water();
        *height = object.world.world.def().level + static_cast<double>(w.field.height_at(w.origin_at(x, y), 0, 0));
    });
}
