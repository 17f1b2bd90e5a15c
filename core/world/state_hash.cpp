// Everything that decides a world's future, in a fixed order. Of the accounts of energy (wave_account.h) what they lack: what
// they hold limits a push at most, and without it recordings from before the accounts replay.
#include "core/world/world.h"

namespace frm {
namespace {

void hash_water(StateHash& hash, const Water& water) {
    const FieldDef& f = water.def().field;
    hash.value(f.nx);
    hash.value(f.ny);
    hash.value(f.cell);
    hash.value(f.depth);
    hash.value(static_cast<std::uint32_t>(f.border));
    hash.value(f.border_cells);
    hash.value(f.order);
    hash.value(water.def().centre_x);
    hash.value(water.def().centre_y);
    hash.value(static_cast<std::uint32_t>(water.starts()));
    water.field.hash(hash);
    if (water.pressure()) hash.words(water.pressure(), water.field.cells());
    if (water.owed_pressure()) hash.words(water.owed_pressure(), water.field.cells());
}

void hash_body(StateHash& hash, const Body& body) {
    hash.value(body.id);
    hash.value(body.def.map->content_hash);
    hash.value(body.def.scale);
    hash.value(body.def.mass);
    hash.value(body.def.centre_of_mass);
    hash.value(body.def.pose.position);
    hash.value(body.def.pose.rotation);
    hash.value(body.def.twist);
    hash.value(body.forces);
    for (const SourceState& source : body.sources) hash.value(source.map_time);
    if (body.map_time_owed > 0) hash.value(body.map_time_owed);
    hash.value(body.laid_at);
    hash.value(body.laid_rotation.row0);
    hash.value(body.laid_rotation.row1);
    hash.value(body.laid_rotation.row2);
    if (body.footprint) body.footprint->hash(hash);
    if (body.account && body.account->credit < 0) hash.value(body.account->credit);
}

}  // namespace

std::uint64_t World::hash() const {
    StateHash hash;
    hash.value(def_.model);
    hash.value(static_cast<std::uint32_t>(def_.everywhere));
    hash.value(def_.level);
    hash.value(def_.fluid);
    hash.value(def_.skip);
    hash.value(def_.error_budget);
    hash.value(def_.time_budget);
    hash.value(ticks_);
    hash.value(time_);
    clock_.hash(hash);
    if (water_) hash_water(hash, *water_);
    for (const auto& body : bodies_) hash_body(hash, *body);
    return hash.result();
}

}  // namespace frm
