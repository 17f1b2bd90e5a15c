// Lives a recording again and holds every answer against the recorded one, bit for bit.
#pragma once

#include <memory>
#include <vector>

#include "core/api/objects.h"
#include "device/recording.h"

namespace frm::device {

class Replay : public api::Object {
public:
    Replay(api::Context& context, const char* path);
    ~Replay() override;

    frm_replay_info info() const { return info_; }
    frm_replay_step_result step();
    void set_tolerance(const frm_replay_tolerance& tolerance) { tolerance_ = tolerance; }

    /// Handles, 0 where there is nothing now.
    std::uint64_t world() const { return world_ ? world_->handle : 0; }
    std::uint64_t water() const { return water_; }
    std::uint64_t body(std::uint32_t index) const { return index < bodies_.size() ? bodies_[index].handle : 0; }
    std::uint64_t map(std::uint32_t index) const { return index < maps_.size() ? maps_[index].handle : 0; }

private:
    struct ReplayedMap {
        std::shared_ptr<const Map> map;
        std::uint64_t handle = 0;
    };
    struct ReplayedBody {
        Body* body = nullptr;
        std::uint64_t handle = 0;
    };

    void survey();
    void release();
    void advance_to_tick();
    void apply(const event::World& e);
    void apply(const event::Map& e);
    void apply(const event::Water& e);
    void apply(const event::WaterEnd& e);
    void apply(const event::Height& e);
    void apply(const event::Pressure& e);
    void apply(const event::Body& e);
    void apply(const event::BodyEnd& e);
    void apply(const event::Motion& e);
    void apply(const event::Tick& e) { next_tick_ = e, has_tick_ = true; }
    void apply(const event::Device&) {}
    void apply(const event::Exchange&) {}
    void apply(const event::End&) {}
    void apply(const event::Gap&) { gap_ = true; }
    void compare(const event::Tick& e, frm_replay_step_result& result) const;
    bool differs(std::uint32_t body, const Wrench& now, const Wrench& then) const;
    World& the_world();
    ReplayedBody& the_body(std::uint32_t id);

    api::Context& context_;
    RecordingReader reader_;
    frm_replay_info info_{};
    std::shared_ptr<api::WorldObject> world_;
    std::uint64_t water_ = 0;
    std::vector<ReplayedMap> maps_;
    std::vector<ReplayedBody> bodies_;
    event::Tick next_tick_;  ///< all before it has been applied
    bool has_tick_ = false, stepped_ = false, gap_ = false;
    frm_replay_tolerance tolerance_{};
    struct Peak {
        float force = 0, torque = 0;
    };
    std::vector<Peak> peaks_;  ///< of the total on each body, by its id
};

}  // namespace frm::device

template <>
struct frm::api::KindOf<frm::device::Replay> {
    static constexpr Kind kind = Kind::replay;
};
