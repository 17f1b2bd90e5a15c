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
    std::uint32_t users = 0;  ///< recorders, replays and servos
    bool replayed = false;    ///< belongs to a replay, which alone may change it
    std::atomic<const void*> served{nullptr};  ///< while a servo runs it: that thread's this_thread()
};

/// An address that stands for the calling thread.
inline const void* this_thread() {
    static thread_local const char here = 0;
    return &here;
}

struct WaterObject : Object {
    explicit WaterObject(WorldObject& w) : world(w) {}
    WorldObject& world;
    Water& water() const { return *world.world.water(); }
};

struct BodyObject : Object {
    BodyObject(WorldObject& w, Body& b) : world(w), body(b) {}
    WorldObject& world;
    Body& body;
    std::uint32_t users = 0;  ///< servos
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

/// Not while a servo's thread has the world, unless it is that thread.
inline void require_not_served(const WorldObject& world) {
    const void* const servo = world.served.load(std::memory_order_acquire);
    if (servo && servo != this_thread())
        throw Error(FRM_ERROR_STATE, "a servo runs this world: read it through the servo or snapshots, or stop it");
}

inline void require_changeable(const WorldObject& world) {
    require_not_served(world);
    if (world.replayed) throw Error(FRM_ERROR_STATE, "this world belongs to a replay and can only be looked at");
}

/// Reads and checks a whole map; also for the maps inside a recording.
std::shared_ptr<const Map> read_map(Context& context, const std::uint8_t* data, std::size_t size);

/// Adds the handle of a world that was made, and of what is in it.
std::uint64_t add_world(Context& context, std::shared_ptr<WorldObject> world);
std::uint64_t add_water(Context& context, WorldObject& world);
std::uint64_t add_body(Context& context, WorldObject& world, Body& body);

}  // namespace frm::api
