// Everything that decides a world's future, in a fixed order.
#include "core/world/world.h"

namespace frm {
namespace {

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
    if (body.footprint) body.footprint->hash(hash);
}

}  // namespace

std::uint64_t World::hash() const {
    StateHash hash;
    hash.value(def_.model);
    hash.value(static_cast<std::uint32_t>(def_.everywhere));
    hash.value(def_.level);
    hash.value(def_.fluid);
    hash.value(ticks_);
    hash.value(time_);
    if (water_) {
        water_->field.hash(hash);
        if (water_->pressure()) hash.words(water_->pressure(), water_->field.cells());
    }
    for (const auto& body : bodies_) hash_body(hash, *body);
    return hash.result();
}

}  // namespace frm
