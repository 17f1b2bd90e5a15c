// frm device: which there are, what one says, calibrating it, recording it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <thread>
#include <utility>

#include "cli/command.h"
#include "cli/device_sources.h"
#include "cli/file.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

struct Options {
    std::string device, output;
    std::uint32_t index = 0;
    double rate = 10, seconds = 0;
    std::uint32_t force_interval = 16;
    bool calibrate = false, json = false;
};

nlohmann::ordered_json json_of_device(const frm_device_info& info) {
    return {{"name", std::string(info.name)},
            {"serial", info.serial},
            {"max_force", info.max_force},
            {"max_torque", info.max_torque},
            {"period_ns", info.period_ns}};
}

void list(const Options& o) {
    const Session session;
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    // Of all drivers, one that cannot be asked says why, and the others are listed.
    const auto add = [&](const std::string& name, bool alone) {
        std::vector<frm_device_info> found;
        try {
            found = list_devices(session, name);
        } catch (const Failure& failure) {
            if (alone) throw;
            return print_note(name + ": " + failure.what());
        }
        for (std::size_t i = 0; i < found.size(); ++i) {
            all.push_back({{"device", name}, {"index", i}});
            all.back().update(json_of_device(found[i]));
            if (!o.json)
                std::printf("%s --index %zu: %s, serial %u, up to %g N and %g N m\n", name.c_str(), i, found[i].name,
                            found[i].serial, static_cast<double>(found[i].max_force),
                            static_cast<double>(found[i].max_torque));
        }
        if (found.empty() && !o.json) std::printf("%s: no device\n", name.c_str());
    };
    if (!o.device.empty()) add(o.device, true);
    for (const DeviceSource& source : device_sources()) {
        if (!o.device.empty()) break;
        if (!*source.argument || *source.argument == '[')
            add(source.name, false);
        else if (!o.json)
            std::printf("%s:%s: %s\n", source.name, source.argument, source.what);
    }
    if (o.json) std::printf("%s\n", nlohmann::ordered_json{{"devices", all}}.dump(2).c_str());
}

/// Waits for the next of evenly spaced moments. One that was missed is counted, and time goes on from now.
class Pace {
public:
    explicit Pace(double rate)
        : step_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate))),
          next_(Clock::now()) {}
    void wait() {
        next_ += step_;
        const auto now = Clock::now();
        if (now < next_) return std::this_thread::sleep_until(next_);
        if (now > next_ + step_) ++late_, next_ = now;
    }
    std::uint64_t late() const { return late_; }

private:
    using Clock = std::chrono::steady_clock;
    Clock::duration step_;
    Clock::time_point next_;
    std::uint64_t late_ = 0;
};

/// The bits of a device's faults by name.
std::vector<std::string> fault_names(std::uint32_t faults) {
    static const char* const names[] = {"uncalibrated", "short packet",  "timeout",      "transfer",      "unplugged",
                                        "lost count",   "stuck encoder", "slack string", "broken string", "deadline"};
    std::vector<std::string> out;
    for (std::size_t bit = 0; bit < 32; ++bit)
        if (faults >> bit & 1u) out.push_back(bit < std::size(names) ? names[bit] : "bit " + std::to_string(bit));
    return out;
}

const char* status_name(std::uint32_t status) {
    return status == FRM_DEVICE_READY ? "ready" : status == FRM_DEVICE_UNCALIBRATED ? "uncalibrated" : "fault";
}

/// False where a recording has no more to give.
bool exchange(const Session& session, frm_device device, frm_device_state& state) {
    state.struct_size = sizeof state;
    const frm_status status = frm_device_exchange(device, nullptr, &state);
    if (status == FRM_ERROR_END) return false;
    session.check(status);
    return true;
}

void print(const Options& o, const frm_device_state& s) {
    if (o.json) {
        const nlohmann::ordered_json j{
            {"sequence", s.sequence},
            {"time_ns", s.time_ns},
            {"status", status_name(s.status)},
            {"position", {s.pose.position.x, s.pose.position.y, s.pose.position.z}},
            {"rotation", {s.pose.rotation.x, s.pose.rotation.y, s.pose.rotation.z, s.pose.rotation.w}},
            {"linear", json_of(s.twist.linear)},
            {"angular", json_of(s.twist.angular)},
            {"grip", s.grip},
            {"buttons", s.buttons},
            {"faults", fault_names(s.faults)}};
        std::printf("%s\n", j.dump().c_str());
    } else {
        // That it is not calibrated is its status.
        std::string text;
        for (const std::string& name : fault_names(s.faults & ~std::uint32_t{FRM_DEVICE_FAULT_UNCALIBRATED}))
            text += (text.empty() ? "  " : ", ") + name;
        std::printf(
            "%8llu  %-12s  position %8.4f %8.4f %8.4f m  rotation %7.4f %7.4f %7.4f %7.4f  speed %.3f m/s  "
            "grip %.2f  buttons %x%s\n",
            static_cast<unsigned long long>(s.sequence), status_name(s.status), s.pose.position.x, s.pose.position.y,
            s.pose.position.z, static_cast<double>(s.pose.rotation.x), static_cast<double>(s.pose.rotation.y),
            static_cast<double>(s.pose.rotation.z), static_cast<double>(s.pose.rotation.w),
            std::sqrt(static_cast<double>(s.twist.linear.x * s.twist.linear.x + s.twist.linear.y * s.twist.linear.y +
                                          s.twist.linear.z * s.twist.linear.z)),
            static_cast<double>(s.grip), s.buttons, text.c_str());
    }
    std::fflush(stdout);
}

std::uint64_t cycles_of(const Options& o) {
    return o.seconds > 0 ? static_cast<std::uint64_t>(std::max(1.0, std::round(o.seconds * o.rate)))
                         : ~std::uint64_t{0};
}

frm_device open(const Session& session, const Options& o) {
    const frm_device device = open_device(session, o.device, o.index);
    if (o.calibrate) session.check(frm_device_calibrate(device), o.device);
    return device;
}

void monitor(const Options& o) {
    const Session session;
    const frm_device device = open(session, o);
    const ProgressBar signals("monitor");  // Ctrl-C ends it in good order
    Pace pace(o.rate);
    frm_device_state state{};
    for (std::uint64_t n = 0, cycles = cycles_of(o); n < cycles && !interrupted(); ++n) {
        if (!exchange(session, device, state)) break;
        print(o, state);
        if (n + 1 < cycles) pace.wait();
    }
    session.check(frm_device_close(device));
}

void calibrate(const Options& o) {
    const Session session;
    const frm_device device = open_device(session, o.device, o.index);
    session.check(frm_device_calibrate(device));
    frm_device_state state{};
    const bool said = exchange(session, device, state);
    session.check(frm_device_close(device));
    const char* const status = said ? status_name(state.status) : "ready";
    if (o.json)
        std::printf("%s\n", nlohmann::ordered_json{{"device", o.device}, {"status", status}}.dump(2).c_str());
    else
        std::printf("%s: calibrated where it is held; it says %s\n", o.device.c_str(), status);
    if (said && state.status != FRM_DEVICE_READY) throw Unsuccessful();
}

/// A recording that is not finished leaves nothing.
class Recording {
public:
    Recording(const Session& session, const std::string& path, std::uint32_t force_interval)
        : session_(session), path_(path) {
        session.check(frm_world_create(session.context(), nullptr, &world));
        frm_recorder_def def;
        session.check(frm_recorder_def_init(&def, sizeof def));
        def.force_interval = force_interval;
        session.check(frm_recorder_create(world, path.c_str(), &def, &recorder));
    }
    ~Recording() {
        if (recorder) std::remove((path_ + ".part").c_str());
    }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;
    void close() { session_.check(frm_recorder_close(std::exchange(recorder, 0))); }

    frm_world world = 0;
    frm_recorder recorder = 0;

private:
    const Session& session_;
    std::string path_;
};

void record(const Options& o) {
    require_other_file(o.output, o.device);
    const Session session;
    const frm_device device = open(session, o);
    require_writable(o.output);
    Recording recording(session, o.output, o.force_interval);
    session.check(frm_recorder_add_device(recording.recorder, device));
    std::uint64_t n = 0;
    std::uint64_t late = 0;
    {
        ProgressBar bar("record");
        Pace pace(o.rate);
        frm_device_state state{};
        for (const std::uint64_t cycles = cycles_of(o); n < cycles && !interrupted();) {
            if (!exchange(session, device, state)) break;
            session.check(frm_world_tick(recording.world, static_cast<float>(1 / o.rate)));
            if (++n == cycles) break;
            pace.wait();
            if (o.seconds > 0 && n % 1024 == 0)
                bar.update(static_cast<double>(n) / static_cast<double>(cycles), std::to_string(n) + " cycles");
        }
        late = pace.late();
    }
    frm_recorder_stats stats{};
    stats.struct_size = sizeof stats;
    session.check(frm_recorder_get_stats(recording.recorder, &stats));
    session.check(frm_device_close(device));
    recording.close();
    if (o.json)
        std::printf("%s\n", nlohmann::ordered_json{{"recording", o.output},
                                                   {"cycles", n},
                                                   {"seconds", static_cast<double>(n) / o.rate},
                                                   {"late_cycles", late},
                                                   {"lost_events", stats.lost_events}}
                                .dump(2)
                                .c_str());
    else
        std::printf("%s: %llu cycles at %g Hz, %llu of them late\n", o.output.c_str(),
                    static_cast<unsigned long long>(n), o.rate, static_cast<unsigned long long>(late));
}

CLI::App* add(CLI::App& parent, const char* name, const char* what, const std::shared_ptr<Options>& options,
              void (*run)(const Options&)) {
    CLI::App* command = parent.add_subcommand(name, what);
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options, run] { run(*options); });
    return command;
}

void add_device_options(CLI::App& command, Options& o) {
    command.add_option("DEVICE", o.device, "a name from frm device list: null, replay:FILE, sim, spidar")
        ->required()
        ->check(not_empty())
        ->type_name("");
    command.add_option("--index", o.index, "which of the driver's devices")->capture_default_str()->type_name("N");
}

void add_rate(CLI::App& command, Options& o, double rate) {
    command.add_flag("--calibrate", o.calibrate, "the grip is at its reference pose now");
    o.rate = rate;
    command.add_option("--rate", o.rate, "exchanges a second")
        ->check(number_within(10, 10000))
        ->capture_default_str()
        ->type_name("HZ");
    command.add_option("--seconds", o.seconds, "for so long (default: until Ctrl-C, or a recording's end)")
        ->check(positive())
        ->type_name("S");
}

}  // namespace

void add_device(CLI::App& app) {
    CLI::App* command = app.add_subcommand("device", "Haptic devices: which there are, what they say, recording them.");
    command->require_subcommand(1);
    const auto make = [] { return std::make_shared<Options>(); };

    auto o = make();
    CLI::App* one = add(*command, "list", "Lists the devices of the drivers that are built in.", o, list);
    one->add_option("DEVICE", o->device, "of this driver alone: null, replay:FILE, sim, spidar")
        ->check(not_empty())
        ->type_name("");

    o = make();
    one = add(*command, "monitor", "Shows where the grip is, without any force; --json: a line of JSON each.", o,
              monitor);
    add_device_options(*one, *o);
    add_rate(*one, *o, 10);

    o = make();
    one = add(*command, "calibrate",
              "Tries whether a device can be calibrated: its grip is at the reference pose now. SPIDAR-G\n"
              "forgets it when it is closed; give --calibrate to the command that uses it.",
              o, calibrate);
    add_device_options(*one, *o);

    o = make();
    one = add(*command, "record",
              "Records a device without any force: states and raw packets, in a world that is empty. What comes\n"
              "out is a recording as any: frm replay --device-csv shows it, replay:FILE moves as it did.",
              o, record);
    add_device_options(*one, *o);
    add_rate(*one, *o, 1000);
    one->add_option("-o,--output", o->output, "the recording")->required()->check(not_empty())->type_name("FILE");
    one->add_option("--force-interval", o->force_interval, "exchanges between two whose wrenches are kept")
        ->check(whole_within(1, 1000000))
        ->capture_default_str()
        ->type_name("N");
}

}  // namespace frm::cli
