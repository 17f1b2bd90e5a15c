// Worlds drawn by chance, through the interface alone: whatever a host does within the stated ranges, numbers stay finite
// and within what physics allows, bad input changes nothing, and the same calls give the same bits.
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/stress/seed.h"
#include "tests/support/library.h"

using namespace frm::test;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

/// The two maps, and how much larger than rho / 2 u^2 A their pressure can be: 1 where the stream meets a face, 0.1 of
/// that as fluctuation, twice as much between directions; the full map's means are up to three times that.
struct StressMap {
    std::vector<std::uint8_t> file;
    double coefficient;
    double area, volume, radius, size;
    bool spins;
};

const StressMap& stress_map(int which) {
    static const auto make = [](const frm::Map& map, double coefficient) {
        return StressMap{encode_map(map),
                         coefficient,
                         map.shape.area,
                         map.shape.volume,
                         static_cast<double>(map.clusters.radius + length(map.clusters.centre)),
                         static_cast<double>(2 * map.clusters.radius),
                         map.spin.rate > 0};
    };
    static const StressMap maps[2] = {make(*map_of(fine_box({0.3, 0.2, 0.25}, 0.06), 12, 2, 16), 1.3),
                                      make(full_map(fine_box({0.2, 0.04, 0.3}, 0.06)), 3.6)};
    return maps[which];
}

struct Motion {
    frm_pose pose{};
    frm_twist twist{};
};

/// One drawn world. Everything it does follows from its seed.
class Drawn {
public:
    Drawn(std::uint64_t seed, const std::string& recording) : random_(seed) {
        REQUIRE(frm_context_create(nullptr, &context_) == FRM_OK);
        for (int k = 0; k < 2; ++k) {
            const StressMap& m = stress_map(k);
            REQUIRE(frm_map_open_memory(context_, m.file.data(), m.file.size(), &map_[k]) == FRM_OK);
        }
        draw_world();
        if (!recording.empty()) REQUIRE(frm_recorder_create(world_, recording.c_str(), nullptr, &recorder_) == FRM_OK);
        draw_bodies();
    }
    ~Drawn() { frm_context_destroy(context_); }
    Drawn(const Drawn&) = delete;
    Drawn& operator=(const Drawn&) = delete;

    void run() {
        const std::uint32_t ticks = bodies_.size() > 50 ? 12 : 20 + random_.below(60);
        for (std::uint32_t t = 0; t < ticks; ++t) {
            if (random_.once_in(12)) change_bodies();
            for (Body& body : bodies_) move(body);
            if (random_.once_in(8)) refuse();
            tick();
            check();
        }
    }

    void close_recorder() { REQUIRE(frm_recorder_close(recorder_) == FRM_OK); }

    std::uint64_t hash() const {
        std::uint64_t h = 0;
        REQUIRE(frm_world_hash(world_, &h) == FRM_OK);
        return h;
    }

private:
    struct Body {
        frm_body handle;
        int map;
        double scale, density;
        Motion motion;
        double speed, rate;  ///< the most that it moves by
    };

    void draw_world() {
        frm_world_def_init(&def_, sizeof def_);
        if (random_.once_in(3)) def_.skip = FRM_SKIP_NOTHING;
        if (random_.once_in(6)) def_.model = random_.below(32);
        if (random_.once_in(4)) def_.error_budget = static_cast<float>(random_.range(1e-3, 1e3));
        if (random_.once_in(6)) def_.time_budget = static_cast<float>(random_.range(1, 100));
        if (random_.once_in(4)) def_.density = static_cast<float>(random_.range(1, 1e4));
        def_.level = random_.once_in(3) ? random_.uniform(-50, 50) : 0;
        REQUIRE(frm_world_create(context_, &def_, &world_) == FRM_OK);
        frm_water_def_init(&water_def_, sizeof water_def_);
        water_def_.nx = 16 + random_.below(64);
        water_def_.ny = 16 + random_.below(64);
        water_def_.border = random_.below(2);
        water_def_.border_cells = random_.below(5);
        water_def_.order = random_.once_in(4) ? 4 : 2;
        water_def_.depth = static_cast<float>(random_.range(0.05, 100));
        water_def_.cell = static_cast<float>(random_.range(0.01, 2));
        if (random_.once_in(5)) return;  // a flat surface
        REQUIRE(frm_water_create(world_, &water_def_, &water_) == FRM_OK);
    }

    void draw_bodies() {
        const std::uint32_t count = random_.once_in(12) ? 300 : 1 + random_.below(6);
        for (std::uint32_t k = 0; k < count; ++k) add_body();
    }

    void add_body() {
        Body body{};
        body.map = static_cast<int>(random_.below(2));
        const StressMap& m = stress_map(body.map);
        body.scale = random_.range(0.01, 100) / m.size;
        const double volume = m.volume * std::pow(body.scale, 3);
        const double mass =
            std::min(1e6, std::max(1e-3, random_.range(0.01, 20) * static_cast<double>(def_.density) * volume));
        body.speed = random_.range(0.01, 100);
        body.rate = random_.range(0.01, 200);
        body.motion.pose.rotation.w = 1;
        place(body.motion, body.scale * m.size);
        frm_body_def def;
        frm_body_def_init(&def, sizeof def);
        def.map = map_[body.map];
        def.scale = static_cast<float>(body.scale);
        def.mass = static_cast<float>(mass);
        def.pose = body.motion.pose;
        REQUIRE(frm_body_create(world_, &def, &body.handle) == FRM_OK);
        bodies_.push_back(body);
    }

    void change_bodies() {
        if (bodies_.size() > 1 && random_.once_in(2)) {
            const std::size_t k = random_.below(static_cast<std::uint32_t>(bodies_.size()));
            REQUIRE(frm_body_destroy(bodies_[k].handle) == FRM_OK);
            put_in(bodies_[k]);  // what it displaced flows back
            bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(k));
        } else {
            add_body();
        }
    }

    double width() const { return static_cast<double>(water_def_.cell) * water_def_.nx; }

    /// Anywhere in, over, under and around the water.
    void place(Motion& m, double size) {
        m.pose.position = {
            random_.uniform(-0.7, 0.7) * width(), random_.uniform(-0.7, 0.7) * width(),
            def_.level + random_.uniform(-1, 1) * (random_.once_in(2) ? size : static_cast<double>(water_def_.depth))};
        float* q = &m.pose.rotation.x;
        do {
            for (int k = 0; k < 4; ++k) q[k] = static_cast<float>(random_.uniform(-1, 1));
        } while (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] < 0.01f);
    }

    void move(Body& body) {
        Motion& m = body.motion;
        const double size = body.scale * stress_map(body.map).size;
        double* p = &m.pose.position.x;
        switch (random_.below(16)) {
            case 0:
                place(m, size);
                break;
            case 1:  // along one axis, and far outside
                p[random_.below(3)] += random_.uniform(-1, 1) * (random_.once_in(3) ? 1e6 : width());
                break;
            case 2:
                return;
            default: {
                const double step = random_.range(1e-6, 1);
                for (int k = 0; k < 3; ++k) p[k] += random_.uniform(-1, 1) * step * size;
                break;
            }
        }
        for (int k = 0; k < 3; ++k) {
            if (std::fabs(p[k]) > 1e8) p[k] = 0;
            (&m.twist.linear.x)[k] = static_cast<float>(random_.uniform(-1, 1) * body.speed * 0.57);
            (&m.twist.angular.x)[k] = static_cast<float>(random_.uniform(-1, 1) * body.rate * 0.57);
        }
        REQUIRE(frm_body_set_motion(body.handle, &m.pose, &m.twist) == FRM_OK);
    }

    void tick() {
        const float dt = random_.once_in(8) ? 0.1f : static_cast<float>(random_.range(1e-5, 0.1));
        const std::uint64_t before = hash();
        ++ticks_;
        const frm_status status = frm_world_tick(world_, dt);
        if (status == FRM_ERROR_LIMIT) {  // more than 1024 wave steps: refused, and nothing has changed
            REQUIRE(hash() == before);
            dt_ = 1e-5f;
            REQUIRE(frm_world_tick(world_, dt_) == FRM_OK);
        } else {
            INFO("model " << def_.model << " skip " << def_.skip << " density " << def_.density << " " << water_def_.nx
                          << " x " << water_def_.ny << " cells of " << water_def_.cell << " m, depth "
                          << water_def_.depth << ", border " << water_def_.border << " of " << water_def_.border_cells
                          << ", order " << water_def_.order << ", " << bodies_.size() << " bodies, tick " << ticks_
                          << " of " << dt << " s");
            REQUIRE(status == FRM_OK);
            dt_ = dt;
        }
        waited_ += static_cast<double>(dt_);
    }

    void refuse() {
        const std::uint64_t before = hash();
        frm_pose pose = bodies_[0].motion.pose;
        frm_twist twist = bodies_[0].motion.twist;
        pose.position.y = random_.once_in(2) ? static_cast<double>(not_a_number) : 1e300;
        REQUIRE(frm_body_set_motion(bodies_[0].handle, &pose, &twist) == FRM_ERROR_ARGUMENT);
        pose = bodies_[0].motion.pose;
        pose.rotation = {0, not_a_number, 0, 1};
        REQUIRE(frm_body_set_motion(bodies_[0].handle, &pose, nullptr) == FRM_ERROR_ARGUMENT);
        twist.angular.z = random_.once_in(2) ? infinite : 1e30f;
        REQUIRE(frm_body_set_motion(bodies_[0].handle, &bodies_[0].motion.pose, &twist) == FRM_ERROR_ARGUMENT);
        for (const float dt : {0.0f, -0.01f, 0.11f, 1e-7f, not_a_number, infinite})
            REQUIRE(frm_world_tick(world_, dt) == FRM_ERROR_ARGUMENT);
        if (water_) {
            std::vector<float> heights(std::size_t{water_def_.nx} * water_def_.ny, 0.0f);
            heights[heights.size() / 2] = not_a_number;
            REQUIRE(frm_water_set_height(water_, heights.data(), heights.size()) == FRM_ERROR_ARGUMENT);
            REQUIRE(frm_water_set_pressure(water_, heights.data(), heights.size()) == FRM_ERROR_ARGUMENT);
        }
        REQUIRE(hash() == before);
    }

    /// The energy's square root is a norm, which a tick's changes can raise by their own norm at most. A body's thickness
    /// is nowhere more than its diameter, so that of two poses is at most sqrt(rho g / 2 * 2 r V), twice.
    void put_in(const Body& body) {
        const StressMap& m = stress_map(body.map);
        const double volume = m.volume * std::pow(body.scale, 3), radius = m.radius * body.scale;
        norm_ += 2 * std::sqrt(0.5 * density() * gravity() * 2 * radius * volume);
        level_ += 2 * volume / (width() * static_cast<double>(water_def_.cell) * water_def_.ny);
    }

    /// A pressure p on an area A moves the faces by dt grad p / rho, with grad p at most 2 p / cell.
    void push_on(const Body& body, double pressure) {
        const double area = stress_map(body.map).area * body.scale * body.scale,
                     cell = static_cast<double>(water_def_.cell);
        const double waited = std::max(waited_, static_cast<double>(dt_));
        norm_ += std::sqrt(0.5 * density() * static_cast<double>(water_def_.depth) * 2 * (area + 100 * cell * cell)) *
                 waited * 2 * pressure / (density() * cell);
    }

    double density() const { return static_cast<double>(def_.density); }
    double gravity() const { return static_cast<double>(def_.gravity); }

    void check() {
        double high = 0, fast = 0;
        if (water_) look_at_water(high, fast);
        // As high as before or after the tick, and by what bodies laid or took in between, each at most its diameter.
        double stood = std::max(high, high_before_);
        if (water_)
            for (const Body& body : bodies_) stood += 4 * stress_map(body.map).radius * body.scale;
        high_before_ = high;
        for (const Body& body : bodies_) {
            const StressMap& m = stress_map(body.map);
            const double s = body.scale, area = m.area * s * s, volume = m.volume * s * s * s;
            frm_forces f{};
            f.struct_size = sizeof f;
            REQUIRE(frm_body_get_forces(body.handle, &f) == FRM_OK);
            const auto size_of = [](const frm_vec3& v) {
                return std::sqrt(static_cast<double>(v.x) * static_cast<double>(v.x) +
                                 static_cast<double>(v.y) * static_cast<double>(v.y) +
                                 static_cast<double>(v.z) * static_cast<double>(v.z));
            };
            const double buoyancy = size_of(f.buoyancy.force), drag = size_of(f.pressure.force);
            for (const frm_wrench* w : {&f.total, &f.buoyancy, &f.pressure, &f.friction, &f.gravity})
                REQUIRE(std::isfinite(size_of(w->force) + size_of(w->torque)));
            // Archimedes; where water stands so high over the calm surface, the pressure is rho g times that more, on all of the
            // area.
            REQUIRE(buoyancy <= (1 + 1e-3) * density() * gravity() * (volume + area * stood) + 1e-6);
            // No faster than the body, its own turning, and the water, which bodies do not feel run faster than waves do.
            const double speed = size_of(body.motion.twist.linear) + m.radius * s * size_of(body.motion.twist.angular) +
                                 (water_ ? std::sqrt(gravity() * static_cast<double>(water_def_.depth)) : 0.0);
            double most = m.coefficient * 0.5 * density() * speed * speed * area;
            // The spin table of full_map: 0.01 (i + 1) N on sources i of 48, at 2 rad/s, 1000 kg/m^3 and size 1.
            if (m.spins)
                most += 48 * 0.48 * 2.5 * std::pow(size_of(body.motion.twist.angular) / 2, 2) * density() / 1000 *
                        std::pow(s, 4);
            REQUIRE(drag <= (1 + 1e-3) * most + 1e-6);
            if (water_) {
                put_in(body);
                push_on(body, 4 * most / area);  // on sources whose mean normal is shorter than one
            }
            check_coefficients(body);
        }
        if (water_) waited_ = 0;
    }

    void check_coefficients(const Body& body) {
        frm_coefficients c{};
        c.struct_size = sizeof c;
        REQUIRE(frm_body_get_coefficients(body.handle, &c) == FRM_OK);
        REQUIRE((c.wet_share >= 0 && c.wet_share <= 1.001f));
        double x[6], work = 0, size = 0;
        for (double& v : x) v = random_.uniform(-1, 1);
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                REQUIRE(std::isfinite(c.damping[6 * i + j] + c.added_mass[6 * i + j]));
                work += x[i] * c.damping[6 * i + j] * x[j];
                size += std::fabs(x[i] * c.damping[6 * i + j] * x[j]);
            }
        REQUIRE(work >= -1e-9 * size);
    }

    void look_at_water(double& high, double& fast) {
        const std::size_t cells = std::size_t{water_def_.nx} * water_def_.ny;
        h_.resize(cells), u_.resize(cells), v_.resize(cells);
        frm_water_state state{};
        state.struct_size = sizeof state;
        state.capacity = cells;
        state.height = h_.data(), state.velocity_x = u_.data(), state.velocity_y = v_.data();
        REQUIRE(frm_water_read(water_, &state) == FRM_OK);
        double energy = 0;
        for (std::size_t i = 0; i < cells; ++i) {
            const auto h = static_cast<double>(h_[i]), u = static_cast<double>(u_[i]), v = static_cast<double>(v_[i]);
            REQUIRE(std::isfinite(h + u + v));
            REQUIRE(h_[i] >= -water_def_.depth);
            high = std::max(high, std::fabs(h));
            fast = std::max(fast, std::sqrt(u * u + v * v));
            energy += 0.5 * density() * (gravity() * h * h + static_cast<double>(water_def_.depth) * (u * u + v * v));
        }
        const double cell = static_cast<double>(water_def_.cell);
        // Between steps a body sees heights and velocities ahead of these: no further than those of a wave as high.
        high *= 4, fast = 4 * (fast + high * std::sqrt(gravity() / static_cast<double>(water_def_.depth)));
        // The leapfrog's own energy is that of heights and velocities half a step apart: up to 1 / (1 - 0.9) times less.
        const double level = level_ * std::sqrt(0.5 * density() * gravity() * width() * cell * water_def_.ny);
        if ((def_.model & FRM_MODEL_DISPLACEMENT) && ticked_)
            REQUIRE(std::sqrt(energy * cell * cell) <= 10 * (norm_ + level) + 1e-3);
        ticked_ = true;
    }

    Random random_;
    frm_context context_ = 0;
    frm_map map_[2] = {};
    frm_world_def def_{};
    frm_water_def water_def_{};
    frm_world world_ = 0;
    frm_water water_ = 0;
    frm_recorder recorder_ = 0;
    std::vector<Body> bodies_;
    std::vector<float> h_, u_, v_;
    float dt_ = 0;
    double waited_ = 0, norm_ = 0, level_ = 0, high_before_ = 0;
    bool ticked_ = false;
    std::uint32_t ticks_ = 0;
};

}  // namespace

TEST_CASE("worlds drawn by chance stay finite, within bounds and the same", "[stress]") {
    Turns turns(24);
    Folder folder;
    std::uint64_t seed = stress_seed();
    std::size_t worlds = 0, recorded = 0;
    for (; turns.more(); ++seed, ++worlds) {
        INFO("FRM_STRESS_SEED=" << seed << " draws this world first");
        const bool record = worlds % 4 == 1;
        const std::string path = record ? folder.file("world.frmrec") : std::string();
        std::uint64_t hash = 0;
        {
            Drawn first(seed, path);
            first.run();
            hash = first.hash();
            if (record) first.close_recorder();
        }
        Drawn second(seed, {});
        second.run();
        REQUIRE(second.hash() == hash);
        if (!record) continue;
        Library library;
        frm_replay replay = 0;
        REQUIRE(frm_replay_open(library.context, path.c_str(), &replay) == FRM_OK);
        frm_replay_step_result step{};
        step.struct_size = sizeof step;
        frm_status status;
        while ((status = frm_replay_step(replay, &step)) == FRM_OK) {
            INFO("tick " << step.tick << " body " << step.body << " part " << step.part);
            REQUIRE(step.diverged == 0);
        }
        REQUIRE(status == FRM_ERROR_END);
        ++recorded;
    }
    std::printf("stress: %zu worlds, %zu of them recorded and replayed\n", worlds, recorded);
}
