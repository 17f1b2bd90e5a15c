#include "core/api/objects.h"

namespace frm::api {

std::uint64_t add_world(Context& context, std::shared_ptr<WorldObject> world) {
    WorldObject& object = *world;
    object.handle = context.add(Kind::world, std::move(world));
    return object.handle;
}

namespace {

frm_world_def default_world() {
    frm_world_def def{};
    const WorldDef defaults;
    def.model = FRM_MODEL_DEFAULT;
    def.surface = FRM_SURFACE_FLAT;
    def.gravity = defaults.fluid.gravity;
    def.density = defaults.fluid.density;
    def.viscosity = defaults.fluid.viscosity;
    def.level = defaults.level;
    def.skip = FRM_SKIP_DEFAULT;
    return def;
}

WorldDef checked(const frm_world_def& d) {
    if (d.model > FRM_MODEL_DEFAULT) throw Error(FRM_ERROR_ARGUMENT, "def.model = %u is not an frm_model", d.model);
    if (d.surface > FRM_SURFACE_NONE)
        throw Error(FRM_ERROR_ARGUMENT, "def.surface = %u is not an frm_surface", d.surface);
    require_range(static_cast<double>(d.gravity), 0, 1000, "def.gravity");
    require_range(static_cast<double>(d.density), 1e-3f, 1e5, "def.density");
    require_range(static_cast<double>(d.viscosity), 1e-9f, 1e2, "def.viscosity");
    require_range(d.level, -1e9, 1e9, "def.level");
    if (d.skip > FRM_SKIP_DEFAULT) throw Error(FRM_ERROR_ARGUMENT, "def.skip = %u is not a sum of frm_skip", d.skip);
    require_range(static_cast<double>(d.error_budget), 0, 1e9, "def.error_budget");
    require_range(static_cast<double>(d.time_budget), 0, 1e6, "def.time_budget");
    if (d.reserved != 0) throw Error(FRM_ERROR_ARGUMENT, "def.reserved is not 0");
    WorldDef out{d.model, d.surface == FRM_SURFACE_NONE, d.level, {d.gravity, d.density, d.viscosity}};
    out.skip = d.skip;
    out.error_budget = d.error_budget;
    out.time_budget = d.time_budget;
    return out;
}

}  // namespace
}  // namespace frm::api

using namespace frm;
using namespace frm::api;

frm_status FRM_CALL frm_world_def_init(frm_world_def* def, uint64_t size) {
    return init_def(def, size, default_world());
}

frm_status FRM_CALL frm_world_create(frm_context context, const frm_world_def* def, frm_world* world) {
    return with_context(context, [&](Context& c) {
        require_pointer(world, "world");
        const WorldDef checked_def = checked(read_def(def, default_world(), "def"));
        *world = add_world(c, c.make<WorldObject>(checked_def, c.threads(), c.memory()));
    });
}

frm_status FRM_CALL frm_world_get_def(frm_world world, frm_world_def* def) {
    return with<WorldObject>(world, [&](Context&, WorldObject& object) {
        require_out(def, "def");
        const WorldDef& d = object.world.def();
        frm_world_def out{};
        out.model = d.model;
        out.surface = d.everywhere ? FRM_SURFACE_NONE : FRM_SURFACE_FLAT;
        out.gravity = d.fluid.gravity;
        out.density = d.fluid.density;
        out.viscosity = d.fluid.viscosity;
        out.level = d.level;
        out.skip = d.skip;
        out.error_budget = d.error_budget;
        out.time_budget = d.time_budget;
        write_struct(def, out);
    });
}

frm_status FRM_CALL frm_world_destroy(frm_world world) {
    return with<WorldObject>(world, [&](Context& c, WorldObject& object) {
        if (object.users > 0 || object.replayed)
            throw Error(FRM_ERROR_STATE, "a recorder, a replay or a servo still uses this world");
        c.remove(world);
    });
}

frm_status FRM_CALL frm_world_tick(frm_world world, float dt) {
    return with<WorldObject>(world, [&](Context&, WorldObject& object) {
        require_changeable(object);
        require_range(static_cast<double>(dt), 1e-6f, 0.1f, "dt");
        if (!object.world.tick(dt))
            throw Error(FRM_ERROR_DIVERGED,
                        "a force was not a finite number; the water has been made calm (smaller dt, "
                        "larger cells or slower motion keep the waves small)");
    });
}

frm_status FRM_CALL frm_world_get_stats(frm_world world, frm_world_stats* stats) {
    return with<WorldObject>(world, [&](Context&, WorldObject& object) {
        require_out(stats, "stats");
        require_not_served(object);
        const World& w = object.world;
        frm_world_stats out{};
        out.bodies = static_cast<std::uint32_t>(w.bodies().size());
        out.ticks = w.ticks();
        out.time = w.time();
        out.water_substeps = w.substeps();
        for (const auto& body : w.bodies()) {
            out.wet_bodies += body->wet_sources > 0;
            out.wet_sources += body->wet_sources;
            out.clipped_triangles += body->clipped_triangles;
            out.frictionless_sources += body->skipped.friction;
            out.steady_sources += body->skipped.steady;
        }
        const World::Skipped& skipped = w.skipped();
        out.dry_bodies = skipped.dry_bodies;
        out.whole_bodies = skipped.whole_bodies;
        out.still_bodies = skipped.still_bodies;
        out.deep_bodies = skipped.deep_bodies;
        out.coarse_bodies = skipped.coarse_bodies;
        out.over_budget_bodies = skipped.over_budget_bodies;
        out.water_waits = skipped.water_waits;
        if (w.water()) out.active_cells = static_cast<std::uint32_t>(w.water()->field.active_cells());
        write_struct(stats, out);
    });
}

frm_status FRM_CALL frm_world_hash(frm_world world, uint64_t* hash) {
    return with<WorldObject>(world, [&](Context&, WorldObject& object) {
        require_pointer(hash, "hash");
        require_not_served(object);
        *hash = object.world.hash();
    });
}
