#include "cli/bench_record.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "cli/command.h"
#include "cli/frm_object.h"
#include "cli/tick_times.h"

namespace frm::cli {
namespace {

constexpr double dt = 1e-3;

/// A device held by a hand.
class Hand {
public:
    frm_status exchange(const frm_device_command& command, frm_device_state& state) {
        const double t = dt * static_cast<double>(cycles_);
        double value[6];
        for (std::size_t i = 0; i < 6; ++i) {
            const double slow = i < 3 ? 0.08 : 0.4, tremor = i < 3 ? 1e-4 : 2e-3,
                         f = 0.3 + 0.11 * static_cast<double>(i);
            value[i] = slow * (std::sin(6.28 * f * t) + 0.4 * std::sin(6.28 * 2.3 * f * t + 1)) +
                       tremor * std::sin(6.28 * (8 + static_cast<double>(i)) * t);
        }
        value[2] += 0.02;
        counters(value);
        // Eight lengths rounded to a step of 16.7 um leave so much in a pose (root mean square).
        for (std::size_t i = 0; i < 6; ++i) {
            const double measured = value[i] + (i < 3 ? 5e-6 : 2.5e-4) * noise();
            const double raw_rate = cycles_ > 0 ? (measured - measured_[i]) / dt : 0;
            rate_[i] += (raw_rate - rate_[i]) * (1 - std::exp(-6.28 * 50 * dt));
            measured_[i] = measured;
        }
        state.status = FRM_DEVICE_READY;
        state.pose.position = {measured_[0], measured_[1], measured_[2]};
        const double angle =
            std::sqrt(measured_[3] * measured_[3] + measured_[4] * measured_[4] + measured_[5] * measured_[5]);
        const double s = angle > 1e-9 ? std::sin(angle / 2) / angle : 0.5;
        state.pose.rotation = {static_cast<float>(s * measured_[3]), static_cast<float>(s * measured_[4]),
                               static_cast<float>(s * measured_[5]), static_cast<float>(std::cos(angle / 2))};
        state.twist.linear = {static_cast<float>(rate_[0]), static_cast<float>(rate_[1]), static_cast<float>(rate_[2])};
        state.twist.angular = {static_cast<float>(rate_[3]), static_cast<float>(rate_[4]),
                               static_cast<float>(rate_[5])};
        state.sequence = cycles_;
        state.time_ns = 1'000'000 * cycles_ + static_cast<std::uint64_t>(400 * (1 + noise()));
        put_force(command.wrench);
        ++cycles_;
        return FRM_OK;
    }
    std::uint32_t raw(std::uint8_t* data, std::uint32_t capacity) const {
        const std::uint32_t size = std::min<std::uint32_t>(capacity, sizeof packet_);
        std::memcpy(data, packet_, size);
        return size;
    }

private:
    /// Near enough normal, of variance 1.
    double noise() {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            seed_ = seed_ * 6364136223846793005u + 1442695040888963407u;
            sum += static_cast<double>(seed_ >> 33) / 2147483648.0 * 2 - 1;
        }
        return sum;
    }
    void put(std::size_t at, int value) {
        packet_[at] = static_cast<std::uint8_t>(value);
        packet_[at + 1] = static_cast<std::uint8_t>(value >> 8);
    }
    void counters(const double* value) {
        for (std::size_t i = 0; i < 8; ++i) {
            const double x = (i & 1 ? 0.06 : -0.06) - value[0], y = (i & 2 ? 0.076 : -0.076) - value[1],
                         z = (i & 4 ? 0.06 : -0.06) - value[2];
            const double turned = 0.0225 * (value[3 + i % 3]);
            put(16 + 2 * i, static_cast<int>(-std::floor((std::sqrt(x * x + y * y + z * z) + turned) / 1.66555e-5)));
        }
    }
    void put_force(const frm_wrench& w) {
        for (std::size_t i = 0; i < 8; ++i) {
            const float tension = 1 + 0.25f * ((i & 1 ? w.force.x : -w.force.x) + (i & 2 ? w.force.y : -w.force.y) +
                                               (i & 4 ? w.force.z : -w.force.z));
            const int digit = static_cast<int>(151.6f * std::clamp(tension, 0.3f, 20.0f));
            put(2 * i, digit);
            put(32 + 2 * i, static_cast<int>(digit * 0.41 + 1.5 * noise()));
        }
        put(48, 0x3A50);
    }

    std::uint64_t cycles_ = 0, seed_ = 1;
    double measured_[6] = {}, rate_[6] = {};
    std::uint8_t packet_[512] = {};
};

frm_status FRM_CALL enumerate(void*, frm_device_info*, std::uint32_t, std::uint32_t* count) {
    *count = 1;
    return FRM_OK;
}
frm_status FRM_CALL open(void* user, std::uint32_t, void** instance) {
    *instance = user;
    return FRM_OK;
}
frm_status FRM_CALL nothing(void*, void*) { return FRM_OK; }
frm_status FRM_CALL info(void*, void*, frm_device_info* out) {
    std::strcpy(out->name, "hand");
    return FRM_OK;
}
frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command* command, frm_device_state* state) {
    return static_cast<Hand*>(instance)->exchange(*command, *state);
}
frm_status FRM_CALL raw(void*, void* instance, std::uint8_t* data, std::uint32_t capacity, std::uint32_t* size) {
    *size = static_cast<Hand*>(instance)->raw(data, capacity);
    return FRM_OK;
}

frm_device_driver hand_driver() {
    frm_device_driver driver{};
    driver.struct_size = sizeof driver;
    driver.enumerate = enumerate, driver.open = open, driver.close = nothing, driver.info = info;
    driver.calibrate = nothing, driver.exchange = exchange, driver.stop = nothing, driver.raw = raw;
    return driver;
}

class Scene {
public:
    Scene(const std::vector<std::uint8_t>& map_file, double height, bool water) {
        const frm_context context = session_.context();
        session_.check(frm_world_create(context, nullptr, &world_));
        frm_water field = 0;
        if (water) session_.check(frm_water_create(world_, nullptr, &field));
        frm_map map = 0;
        session_.check(frm_map_open_memory(context, map_file.data(), map_file.size(), &map));
        frm_body_def def;
        session_.check(frm_body_def_init(&def, sizeof def));
        def.map = map, def.mass = 1, def.pose.position.z = height;
        session_.check(frm_body_create(world_, &def, &body_));
        const frm_device_driver driver = hand_driver();
        session_.check(frm_device_open(context, &driver, &hand_, 0, &device_));
        height_ = height;
    }
    void record(const std::string& path) {
        frm_recorder_def def;
        session_.check(frm_recorder_def_init(&def, sizeof def));
        def.force_interval = 16;
        session_.check(frm_recorder_create(world_, path.c_str(), &def, &recorder_));
        session_.check(frm_recorder_add_device(recorder_, device_));
    }
    void tick() {
        frm_device_command command{};
        command.struct_size = sizeof command;
        command.wrench = forces_.total;
        frm_device_state state{};
        state.struct_size = sizeof state;
        session_.check(frm_device_exchange(device_, &command, &state));
        state.pose.position.z += height_;
        session_.check(frm_body_set_motion(body_, &state.pose, &state.twist));
        session_.check(frm_world_tick(world_, static_cast<float>(dt)));
        forces_.struct_size = sizeof forces_;
        session_.check(frm_body_get_forces(body_, &forces_));
    }
    frm_recorder_stats stats() const {
        frm_recorder_stats out{};
        out.struct_size = sizeof out;
        session_.check(frm_recorder_get_stats(recorder_, &out));
        return out;
    }
    void close() { session_.check(frm_recorder_close(recorder_)); }

private:
    Session session_;
    Hand hand_;
    frm_world world_ = 0;
    frm_body body_ = 0;
    frm_device device_ = 0;
    frm_recorder recorder_ = 0;
    frm_forces forces_{};
    double height_ = 0;
};

}  // namespace

RecordCost measure_recording(const std::vector<std::uint8_t>& map_file, double seconds) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("frm-bench-" + std::to_string(getpid()) + ".frmrec")).string();
    RecordCost cost;
    const auto now = [] { return std::chrono::steady_clock::now(); };
    {
        // Of a body far above the water, whose tick is nothing. In turns, so that both see the same machine, and no faster
        // than the writer can follow.
        Scene with(map_file, 10, false), without(map_file, 10, false);
        with.record(path);
        TickTimes recorded, plain;
        const auto begin = now();
        constexpr int batch = 20;
        while (recorded.count() < 16 || std::chrono::duration<double>(now() - begin).count() < seconds) {
            usleep(1000);
            for (int k = 0; k < batch / 4; ++k) with.tick(), without.tick();
            const auto start = now();
            for (int k = 0; k < batch; ++k) with.tick();
            const auto middle = now();
            for (int k = 0; k < batch; ++k) without.tick();
            const auto end = now();
            recorded.add(std::chrono::duration<double, std::micro>(middle - start).count() / batch);
            plain.add(std::chrono::duration<double, std::micro>(end - middle).count() / batch);
        }
        cost.us_per_tick = recorded.quantile(0.5) - plain.quantile(0.5);
        cost.lost = static_cast<double>(with.stats().lost_events);
        with.close();
    }
    {
        Scene scene(map_file, 0, true);
        scene.record(path);
        const double before = static_cast<double>(scene.stats().file_bytes);
        constexpr int ticks = 20000;
        for (int t = 0; t < ticks; ++t) {
            scene.tick();
            // As far behind as one second of 1 kHz, never further.
            while (t % 256 == 0 && static_cast<std::uint64_t>(t) > scene.stats().ticks + 1000) usleep(1000);
        }
        cost.lost += static_cast<double>(scene.stats().lost_events);
        scene.close();
        cost.kb_per_s = (static_cast<double>(std::filesystem::file_size(path)) - before) / 1e3 / (dt * ticks);
    }
    std::filesystem::remove(path);
    return cost;
}

}  // namespace frm::cli
