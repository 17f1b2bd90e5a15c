#include <cmath>
#include <limits>
#include <random>

#include "device/event_queue.h"
#include "device/recording_columns.h"
#include "tests/support/catch.h"

using namespace frm;
using namespace frm::device;

namespace {

/// Numbers as they come, and those that do not: zeros of both signs, infinities, NaN, the smallest.
class Numbers {
public:
    float f() {
        static const float odd[] = {0.0f, -0.0f, INFINITY, -INFINITY, NAN, 1e-45f, -1e-45f, 3.4e38f, 1, -1};
        if (random_() % 4 == 0) return odd[random_() % 10];
        if (random_() % 2) return last_ += 0.001f;
        const auto bits = static_cast<std::uint32_t>(random_());
        float v;
        std::memcpy(&v, &bits, 4);
        return v;
    }
    double d() { return random_() % 3 ? static_cast<double>(f()) : std::ldexp(static_cast<double>(random_()), -70); }
    std::uint32_t u() { return random_() % 3 ? counter_++ : static_cast<std::uint32_t>(random_()); }
    void fill(void* data, std::size_t floats) {
        for (std::size_t i = 0; i < floats; ++i) {
            const float v = f();
            std::memcpy(static_cast<char*>(data) + 4 * i, &v, 4);
        }
    }

private:
    std::mt19937_64 random_{7};
    float last_ = 0.1f;
    std::uint32_t counter_ = 0;
};

Event any_event(Numbers& n, int i) {
    if (i % 3 == 0) {
        event::Motion m;
        m.id = n.u() % 3;
        m.pose.position = {n.d(), n.d(), n.d()};
        n.fill(&m.pose.rotation, 4);
        n.fill(&m.twist, 6);
        return m;
    }
    if (i % 3 == 1) {
        event::Tick t;
        t.tick = n.u(), t.time = n.d(), t.dt = n.f();
        const std::size_t bodies = n.u() % 4;
        if (n.u() % 2) {
            t.forces.resize(bodies);
            for (Forces& f : t.forces) n.fill(&f, 30);
        } else {
            for (std::size_t b = 0; b < bodies; ++b) t.checks.push_back(n.u());
        }
        t.has_hash = n.u() % 2 != 0;
        if (t.has_hash) t.hash = static_cast<std::uint64_t>(n.u()) << 32 | n.u();
        return t;
    }
    event::Exchange e;
    e.device = n.u() % 16;
    e.has_wrenches = n.u() % 2 != 0;
    if (e.has_wrenches) n.fill(&e.command, 6);
    e.state.struct_size = sizeof e.state;
    n.fill(&e.state.status, (sizeof e.state - 4) / 4);
    if (!e.has_wrenches)
        std::memset(reinterpret_cast<char*>(&e.state) + named_state_bytes, 0,
                    std::min<std::size_t>(sizeof e.state - named_state_bytes, 24));
    e.raw.resize(n.u() % (largest_packet + 1));
    for (std::uint8_t& byte : e.raw) byte = static_cast<std::uint8_t>(n.u() % 5 ? 7 : n.u());
    return e;
}

/// All that is in an event, as bytes.
std::vector<std::uint8_t> bytes_of(const Event& event) {
    std::vector<std::uint8_t> out;
    const auto add = [&](const void* data, std::size_t size) {
        const auto* p = static_cast<const std::uint8_t*>(data);
        out.insert(out.end(), p, p + size);
    };
    if (const auto* m = std::get_if<event::Motion>(&event))
        add(&m->id, 4), add(&m->pose, sizeof m->pose), add(&m->twist, sizeof m->twist);
    if (const auto* t = std::get_if<event::Tick>(&event)) {
        add(&t->tick, 8), add(&t->time, 8), add(&t->dt, 4);
        add(t->forces.data(), t->forces.size() * sizeof(Forces)), add(t->checks.data(), 4 * t->checks.size());
        out.push_back(t->has_hash);
        if (t->has_hash) add(&t->hash, 8);
    }
    if (const auto* e = std::get_if<event::Exchange>(&event)) {
        add(&e->device, 4), add(&e->command, sizeof e->command), add(&e->state, sizeof e->state);
        add(e->raw.data(), e->raw.size());
        out.push_back(e->has_wrenches);
    }
    return out;
}

}  // namespace

TEST_CASE("columns give back every bit, of odd numbers too, in pieces", "[columns]") {
    Numbers numbers;
    ColumnWriter writer;
    std::vector<Event> events;
    std::vector<std::vector<std::uint8_t>> pieces;
    for (int i = 0; i < 3000; ++i) {
        events.push_back(any_event(numbers, i));
        REQUIRE(writer.code(events.back()));
        if (i % 100 == 99) pieces.emplace_back(), writer.coder().finish(pieces.back());
        if (i == 1499) writer.restart();
    }
    ColumnReader reader;
    Event event;
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (i % 100 == 0) reader.coder().start(pieces[i / 100].data(), pieces[i / 100].size());
        if (i == 1500) reader.restart();
        REQUIRE(reader.code(event));
        REQUIRE(bytes_of(event) == bytes_of(events[i]));
        if (i % 100 == 99) REQUIRE(reader.coder().whole());
    }
}

TEST_CASE("bytes that are no columns are refused or end, and never crash", "[columns]") {
    std::mt19937_64 random(3);
    for (int n = 0; n < 300; ++n) {
        std::vector<std::uint8_t> bytes(random() % 400);
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
        ColumnReader reader;
        reader.coder().start(bytes.data(), bytes.size());
        Event event;
        try {
            for (int i = 0; i < 50 && reader.code(event) && !reader.coder().beyond(); ++i) {
            }
        } catch (const Error& error) {
            REQUIRE(error.status() == FRM_ERROR_CORRUPT);
        }
    }
}

TEST_CASE("a smooth motion takes a few bytes a tick, one that stands still less than one", "[columns]") {
    const auto bytes_a_tick = [](bool moves) {
        ColumnWriter writer;
        std::vector<std::uint8_t> out;
        for (int i = 0; i < 2000; ++i) {
            const double t = moves ? 0.001 * i : 1;
            Event motion = event::Motion{0, {{std::sin(t), 0.25, std::cos(t)}, {0, 0, 0, 1}}, {}};
            event::Tick tick;
            tick.tick = static_cast<std::uint64_t>(i + 1), tick.dt = 0.001f;
            tick.time = 0.001 * (i + 1);
            Event e = tick;
            writer.code(motion), writer.code(e);
        }
        writer.coder().finish(out);
        return static_cast<double>(out.size()) / 2000;
    };
    CHECK(bytes_a_tick(true) < 12);  // two doubles of 16 bytes
    CHECK(bytes_a_tick(false) < 1);
}

TEST_CASE("the queue gives what was put, around its end, and refuses what has no room", "[queue]") {
    EventQueue queue(1);
    CHECK(queue.capacity() == 1 << 16);
    std::uint32_t put = 0, taken = 0;
    const auto put_one = [&] {
        const std::size_t size = 4 + put * 37 % 700;
        return queue.put(1 + put % 3, size, [&](std::uint8_t* to) {
            std::memset(to, static_cast<int>(put & 0xFF), size);
            std::memcpy(to, &put, 4);
            return size;
        });
    };
    const auto take_one = [&] {
        return queue.take([&](std::uint32_t type, const std::uint8_t* data, std::size_t size) {
            std::uint32_t number;
            std::memcpy(&number, data, 4);
            REQUIRE(number == taken);
            REQUIRE(type == 1 + taken % 3);
            REQUIRE(size == 4 + taken * 37 % 700);
            REQUIRE((size == 4 || data[size - 1] == (taken & 0xFF)));
        });
    };
    for (int round = 0; round < 50; ++round) {
        while (put_one()) ++put;
        CHECK(queue.used() <= queue.capacity());
        for (int k = 0; k < 20 + round; ++k, ++taken) REQUIRE(take_one());
    }
    while (take_one()) ++taken;
    CHECK(taken == put);
    CHECK(put > 2000);
    CHECK(queue.used() == 0);
    CHECK_FALSE(queue.put(1, queue.capacity(), [](std::uint8_t*) { return std::size_t{0}; }));
}
