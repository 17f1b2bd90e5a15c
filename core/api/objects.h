// The objects of core that have handles.
#pragma once

#include <memory>

#include "core/api/context.h"
#include "core/world/world.h"

namespace frm::api {

struct MapObject : Object {
    explicit MapObject(std::shared_ptr<const Map> m) : map(std::move(m)) {}
    std::shared_ptr<const Map> map;
};

struct WorldObject : Object {
    WorldObject(const WorldDef& def, std::uint32_t threads, std::pmr::memory_resource* memory)
        : world(def, threads, memory) {}
    World world;
    std::uint64_t handle = 0;
    std::uint32_t users = 0;  ///< recorders and replays
    bool replayed = false;    ///< belongs to a replay, which alone may change it
};

struct WaterObject : Object {
    explicit WaterObject(WorldObject& w) : world(w) {}
    WorldObject& world;
    Water& water() const { return *world.world.water(); }
};

struct BodyObject : Object {
    BodyObject(WorldObject& w, Body& b) : world(w), body(b) {}
    WorldObject& world;
    Body& body;
};

template <>
struct KindOf<MapObject> {
    static constexpr Kind kind = Kind::map;
};
template <>
struct KindOf<WorldObject> {
    static constexpr Kind kind = Kind::world;
};
template <>
struct KindOf<WaterObject> {
    static constexpr Kind kind = Kind::water;
};
template <>
struct KindOf<BodyObject> {
    static constexpr Kind kind = Kind::body;
};

inline void require_changeable(const WorldObject& world) {
    if (world.replayed) throw Error(FRM_ERROR_STATE, "this world belongs to a replay and can only be looked at");
}

/// Reads and checks a whole map; also for the maps inside a recording.
std::shared_ptr<const Map> read_map(Context& context, const std::uint8_t* data, std::size_t size);

/// Adds the handle of a world that was made, and of what is in it.
std::uint64_t add_world(Context& context, std::shared_ptr<WorldObject> world);
std::uint64_t add_water(Context& context, WorldObject& world);
std::uint64_t add_body(Context& context, WorldObject& world, Body& body);

}  // namespace frm::api
