#include "cli/frontier_play.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "cli/frm_object.h"

namespace frm::cli {
namespace {

constexpr double turn = 0.2;            ///< s of the scene
constexpr std::size_t cold = 3;         ///< first ticks of a turn
constexpr double most_of_median = 2.0;  ///< that a tick counts

Vec3d vec(const frm_vec3& v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }

/// One world of one setting, as far as it has been played.
class Player {
public:
    Player(const Session& session, const PlayScene& scene, const Setup& setup)
        : session_(session), scene_(scene), setup_(setup) {
        every_ = ticks_in(scene.sample);
        ticks_ = ticks_in(scene.seconds);
    }

    void begin() {
        session_.check(frm_world_create(session_.context(), &setup_.world, &world_));
        if (setup_.water) {
            session_.check(frm_water_create(world_, &*setup_.water, &water_));
            if (scene_.height) set_heights();
        }
        frm_body_def def;
        session_.check(frm_body_def_init(&def, sizeof def));
        if (scene_.bodies > 0 && !map_)
            session_.check(frm_map_open_memory(session_.context(), setup_.map->data(), setup_.map->size(), &map_));
        def.map = map_;
        for (std::uint32_t i = 0; i < scene_.bodies; ++i) {
            scene_.motion(0, i, def.pose, def.twist);
            bodies_.push_back(0);
            session_.check(frm_body_create(world_, &def, &bodies_.back()));
        }
        times_.emplace_back();
        times_.back().reserve(ticks_);
        tick_ = 0;
    }

    /// Some ticks; their times.
    void advance() {
        const std::size_t end = std::min(ticks_, tick_ + ticks_in(turn));
        for (std::size_t n = 0; tick_ < end; ++n, ++tick_) {
            const double time = static_cast<double>(tick_) * setup_.dt;
            for (std::uint32_t i = 0; i < scene_.bodies; ++i) {
                frm_pose pose;
                frm_twist twist;
                scene_.motion(time, i, pose, twist);
                session_.check(frm_body_set_motion(bodies_[i], &pose, &twist));
            }
            const auto start = std::chrono::steady_clock::now();
            session_.check(frm_world_tick(world_, static_cast<float>(setup_.dt)));
            const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - start;
            times_.back().push_back(n < cold && ticks_in(turn) > 2 * cold ? -1 : us.count());
            if (times_.size() == 1 && tick_ % every_ == 0 && time > scene_.settle) look();
        }
    }

    bool at_end() const { return tick_ >= ticks_; }

    void end() {
        session_.check(frm_world_destroy(world_));
        bodies_.clear();
    }

    Play result() const {
        Play out;
        out.readings = readings_;
        if (scene_.exact_height) out.waves = waves();
        std::vector<double> sums(times_.size(), 0.0);
        std::size_t count = 0;
        for (std::size_t n = 0; n < ticks_; ++n) {
            if (times_.front()[n] < 0) continue;
            std::vector<double> all;
            for (const std::vector<double>& repeat : times_) all.push_back(repeat[n]);
            const double median = quantile_of(all, 0.5);
            out.tick_us += median;
            for (std::size_t r = 0; r < times_.size(); ++r) sums[r] += std::min(times_[r][n], most_of_median * median);
            ++count;
        }
        out.tick_us /= static_cast<double>(count);
        for (const double sum : sums) out.repeat_us.push_back(sum / static_cast<double>(count));
        return out;
    }

private:
    std::size_t ticks_in(double seconds) const { return static_cast<std::size_t>(std::lround(seconds / setup_.dt)); }

    /// The middles of all cells.
    template <typename Use>
    void each_cell(const Use& use) const {
        const frm_water_def& def = *setup_.water;
        const auto cell = static_cast<double>(def.cell);
        for (std::uint32_t j = 0; j < def.ny; ++j)
            for (std::uint32_t i = 0; i < def.nx; ++i)
                use(std::size_t{j} * def.nx + i, def.centre_x + cell * (i + 0.5 - 0.5 * def.nx),
                    def.centre_y + cell * (j + 0.5 - 0.5 * def.ny));
    }

    void set_heights() {
        std::vector<float> heights(std::size_t{setup_.water->nx} * setup_.water->ny);
        each_cell([&](std::size_t c, double x, double y) { heights[c] = static_cast<float>(scene_.height(x, y)); });
        session_.check(frm_water_set_height(water_, heights.data(), heights.size()));
    }

    void look() {
        for (const frm_body body : bodies_) {
            frm_forces forces{};
            forces.struct_size = sizeof forces;
            session_.check(frm_body_get_forces(body, &forces));
            readings_.push_back({vec(forces.total.force), vec(forces.total.torque)});
        }
        if (!scene_.exact_height) return;
        std::vector<float> heights(std::size_t{setup_.water->nx} * setup_.water->ny);
        frm_water_state state{};
        state.struct_size = sizeof state;
        state.capacity = heights.size();
        state.height = heights.data();
        session_.check(frm_water_read(water_, &state));
        each_cell([&](std::size_t c, double x, double y) {
            const double exact = scene_.exact_height(x, y, state.time);
            const double off = static_cast<double>(heights[c]) - exact;
            off_squared_ += off * off;
            exact_squared_ += exact * exact;
            worst_ = std::max(worst_, std::fabs(off));
            peak_ = std::max(peak_, std::fabs(exact));
        });
    }

    Measure waves() const { return {std::sqrt(off_squared_ / exact_squared_), worst_ / peak_}; }

    const Session& session_;
    const PlayScene& scene_;
    const Setup& setup_;
    std::size_t every_ = 1, ticks_ = 0, tick_ = 0;
    frm_map map_ = 0;
    frm_world world_ = 0;
    frm_water water_ = 0;
    std::vector<frm_body> bodies_;
    Readings readings_;
    double off_squared_ = 0, exact_squared_ = 0, worst_ = 0, peak_ = 0;
    std::vector<std::vector<double>> times_;  ///< [repeat][tick], us; -1: not counted
};

}  // namespace

Setup::Setup() { frm_world_def_init(&world, sizeof world); }

std::vector<Play> play_in_turns(const PlayScene& scene, const std::vector<const Setup*>& setups,
                                std::uint32_t repeats) {
    const Session session;
    std::vector<Player> players;
    players.reserve(setups.size());
    for (const Setup* setup : setups) players.emplace_back(session, scene, *setup);
    for (std::uint32_t r = 0; r < repeats; ++r) {
        for (Player& player : players) player.begin();
        const auto playing = [](const Player& player) { return !player.at_end(); };
        while (std::any_of(players.begin(), players.end(), playing))
            for (Player& player : players) player.advance();
        for (Player& player : players) player.end();
    }
    std::vector<Play> out;
    for (const Player& player : players) out.push_back(player.result());
    return out;
}

}  // namespace frm::cli
