// The events that come with every tick, as columns: one description of each for both directions.
#pragma once

#include "device/columns.h"
#include "device/recording.h"

namespace frm::device {

/// Bytes of frm_device_state that version 3 knows by name; what a later one has follows as words.
constexpr std::size_t named_state_bytes = 96;
constexpr std::uint32_t most_bodies = 65536, most_state_words = 1000;
/// The first of those words: the wrench achieved.
constexpr std::uint32_t achieved_words = 6;

template <typename Coder>
class EventColumns {
public:
    void restart() {
        columns_.restart();
        time_ = 0, negative_w_ = false;
    }
    Coder& coder() { return columns_.coder; }

    /// False if the event is not one of these (encoding), or its type is none of these (decoding).
    bool code(Event& event) {
        std::uint8_t type = 0;
        std::uint32_t object = 0;
        if constexpr (Coder::encodes) {
            if (const auto* motion = std::get_if<event::Motion>(&event))
                type = static_cast<std::uint8_t>(EventType::motion), object = motion->id;
            else if (std::holds_alternative<event::Tick>(event))
                type = static_cast<std::uint8_t>(EventType::tick);
            else if (const auto* exchange = std::get_if<event::Exchange>(&event))
                type = static_cast<std::uint8_t>(EventType::exchange), object = exchange->device;
            else
                return false;
        }
        columns_.begin(type, object);
        switch (static_cast<EventType>(type)) {
            case EventType::motion:
                if constexpr (!Coder::encodes) event = event::Motion{object, {}, {}};
                fields(std::get<event::Motion>(event));
                return true;
            case EventType::tick:
                if constexpr (!Coder::encodes)
                    if (!std::holds_alternative<event::Tick>(event)) event = event::Tick{};
                fields(std::get<event::Tick>(event));
                return true;
            case EventType::exchange:
                if constexpr (!Coder::encodes) event = event::Exchange{};
                std::get<event::Exchange>(event).device = object;
                fields(std::get<event::Exchange>(event));
                return true;
            default:
                return false;
        }
    }

private:
    void vector(float& x, float& y, float& z) { columns_.f32(x), columns_.f32(y), columns_.f32(z); }
    void vector(Vec3f& v) { vector(v.x, v.y, v.z); }
    void vector(frm_vec3& v) { vector(v.x, v.y, v.z); }
    template <typename P>
    void pose(P& p) {
        columns_.f64(p.position.x), columns_.f64(p.position.y), columns_.f64(p.position.z);
        auto& q = p.rotation;
        vector(q.x, q.y, q.z);
        const auto square = [](float f) { return static_cast<double>(f) * static_cast<double>(f); };
        const double rest = 1 - square(q.x) - square(q.y) - square(q.z);
        const float w = rest > 0 ? static_cast<float>(std::sqrt(rest)) : 0.0f;
        columns_.f32(q.w, negative_w_ ? -w : w);
        negative_w_ = q.w < 0;
    }
    void fields(event::Motion& e) { pose(e.pose), vector(e.twist.linear), vector(e.twist.angular); }

    void fields(event::Tick& e) {
        columns_.u64(e.tick);
        columns_.f32(e.dt);
        columns_.f64(e.time, time_ + static_cast<double>(e.dt));
        time_ = e.time;
        std::uint32_t has_hash = e.has_hash;
        columns_.u32(has_hash);
        e.has_hash = has_hash != 0;
        if (e.has_hash) columns_.random(e.hash);
        std::uint32_t checked = !e.checks.empty();
        columns_.u32(checked);
        auto count = static_cast<std::uint32_t>(checked ? e.checks.size() : e.forces.size());
        columns_.u32(count);
        if (count > most_bodies) throw Error(FRM_ERROR_CORRUPT, "a tick has more bodies than a context takes");
        e.forces.resize(checked ? 0 : count);
        e.checks.resize(checked ? count : 0);
        for (std::uint32_t& check : e.checks) columns_.random(check);
        for (Forces& f : e.forces) {
            for (Wrench* part : {&f.buoyancy, &f.pressure, &f.friction, &f.gravity})
                vector(part->force), vector(part->torque);
            total(f.total.force, f.buoyancy.force, f.pressure.force, f.friction.force, f.gravity.force);
            total(f.total.torque, f.buoyancy.torque, f.pressure.torque, f.friction.torque, f.gravity.torque);
        }
    }
    /// The sum, as a tick makes it (core/body/body.cpp).
    void total(Vec3f& t, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
        columns_.f32(t.x, ((a.x + b.x) + c.x) + d.x);
        columns_.f32(t.y, ((a.y + b.y) + c.y) + d.y);
        columns_.f32(t.z, ((a.z + b.z) + c.z) + d.z);
    }

    void fields(event::Exchange& e) {
        std::uint32_t has_wrenches = e.has_wrenches;
        columns_.u32(has_wrenches);
        e.has_wrenches = has_wrenches != 0;
        if (e.has_wrenches)
            vector(e.command.force), vector(e.command.torque);
        else
            columns_.skip(6);
        frm_device_state& s = e.state;
        s.struct_size = sizeof s;
        columns_.u32(s.status);
        pose(s.pose), vector(s.twist.linear), vector(s.twist.angular);
        columns_.f32(s.grip), columns_.u32(s.buttons), columns_.u64(s.time_ns), columns_.u64(s.sequence);
        more(s, e.has_wrenches ? 0 : achieved_words);
        auto size = static_cast<std::uint32_t>(e.raw.size());
        columns_.u32(size);
        if (size > largest_packet)
            throw Error(FRM_ERROR_CORRUPT, "a device's packet is longer than %u", largest_packet);
        e.raw.resize(size);
        columns_.packet(e.raw.data(), size);
    }
    /// What the struct of this library has beyond what is named above, as words; a reader whose struct is shorter passes
    /// over the rest, and one whose struct is longer has zeros.
    void more(frm_device_state& s, std::uint32_t first) {
        static_assert(sizeof(frm_device_state) >= named_state_bytes && sizeof(frm_device_state) % 4 == 0);
        constexpr std::uint32_t known = (sizeof(frm_device_state) - named_state_bytes) / 4;
        std::uint32_t words = known;
        columns_.u32(words);
        if (words > most_state_words) throw Error(FRM_ERROR_CORRUPT, "a device's state is longer than it can be");
        columns_.skip(std::min(first, words));
        auto* const bytes = reinterpret_cast<unsigned char*>(&s) + named_state_bytes;
        for (std::uint32_t i = first; i < words; ++i) {
            std::uint32_t word = 0;
            if (i < known) std::memcpy(&word, bytes + 4 * i, 4);
            columns_.u32(word);
            if (i < known) std::memcpy(bytes + 4 * i, &word, 4);
        }
    }

    Columns<Coder> columns_;
    double time_ = 0;
    bool negative_w_ = false;
};

class ColumnWriter : public EventColumns<RangeEncoder> {};
class ColumnReader : public EventColumns<RangeDecoder> {};

}  // namespace frm::device
