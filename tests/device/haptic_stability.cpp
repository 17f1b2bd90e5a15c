// haptic_stability NAME=MAP.frm ...: where the loop of hand, device, servo, map and waves is stable, as JSON lines.
// scripts/haptic-stability draws them. First the paper's scenes at 500 Hz (maps: sphere, plate, paddle), then borders: for
// paddle and sphere, each hand and rate the force is scaled up until a limit cycle appears. Each with and without what
// frm_device_safety_def.passivity turns on.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "core/map/codec.h"
#include "tests/support/haptic_scenes.h"

namespace {

using namespace frm;
using namespace frm::test;

constexpr NamedHand hands[] = {light_hand, firm_hand};
constexpr double rates[] = {100, 200, 500, 1000, 2000, 5000};

std::shared_ptr<const Map> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    auto map = std::make_shared<Map>();
    decode_map(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), *map);
    return map;
}

HapticCase stroke(const std::shared_ptr<const Map>& map, const Hand& hand, double rate) {
    HapticCase c;
    c.map = map;
    c.rate = rate;
    c.device.hand = hand;
    c.device.delay = 1;
    c.device.max_force = 200;
    c.speed = 0.5;
    // As heavy as the water that it displaces: what is scaled up is drag, not a lift that throws it out.
    {
        World world = world_of(WorldDef());
        Body& body = world.create_body(body_of(map, {0, -0.5, -0.2}));
        world.tick(0.001f);
        c.mass = body.forces.total.force.z / world.def().fluid.gravity;
    }
    c.start = {0, -0.5, -0.2};
    c.cells = 100;
    return c;
}

/// Residual motion that is the loop's: more than the same stroke has where the loop is as good as it gets.
bool swings(const HapticResult& r, const HapticResult& best) {
    return r.faults != 0 || r.amplitude > 2 * std::min(best.amplitude, 0.001) + 2e-4;
}

void print_scenes(std::map<std::string, std::shared_ptr<const Map>> maps) {
    if (!maps.count("sphere") || !maps.count("plate") || !maps.count("paddle")) return;
    maps["lure"] = map_of(fine_box({0.02, 0.08, 0.03}, 0.01), 30, 2, 32);
    for (const PaperScene& scene : paper_scenes(maps, FRM_TEST_SAMPLES "/paddle_stroke.json"))
        for (const NamedHand& hand : {light_hand, firm_hand, stick_hand}) {
            HapticCase c = held_by(scene.haptic, hand);
            const HapticResult best = run_haptic_case(ideal(c));
            c.passivity = false;
            const HapticResult without = run_haptic_case(c);
            c.passivity = true;
            const HapticResult with = run_haptic_case(c);
            const auto numbers = [](const HapticResult& r) {
                char text[160];
                std::snprintf(text, sizeof text, "[%.6g,%.6g,%.6g,%.6g]", r.worst, r.worst_spin, r.mean_size,
                              r.mean_torque);
                return std::string(text);
            };
            std::printf("{\"scene\":\"%s\",\"hand\":\"%s\",\"best\":%s,\"without\":%s,\"with\":%s}\n",
                        scene.name.c_str(), hand.name, numbers(best).c_str(), numbers(without).c_str(),
                        numbers(with).c_str());
            std::fflush(stdout);
        }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: haptic_stability NAME=MAP.frm ...\n"), 2;
    std::map<std::string, std::shared_ptr<const Map>> maps;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const std::size_t equals = argument.find('=');
        maps[argument.substr(0, equals)] = read(argument.substr(equals + 1));
    }
    print_scenes(maps);
    for (const char* const name : {"paddle", "sphere"}) {
        if (!maps.count(name)) continue;
        const auto map = maps.at(name);
        for (const NamedHand& hand : hands) {
            std::map<double, HapticResult> best;  // by scale: the same for all rates
            const HapticResult unit = run_haptic_case(ideal(stroke(map, hand.hand, 5000)));
            for (const double rate : rates)
                for (const bool passivity : {false, true}) {
                    // What is stable is followed up by steps of half an octave to the first that is not.
                    double stable = 0, left = 0;
                    HapticResult at;
                    bool found = false;
                    for (double scale = 1.0 / 16; scale < 65; scale *= std::sqrt(2.0)) {
                        HapticCase c = stroke(map, hand.hand, rate);
                        c.force_scale = static_cast<float>(scale);
                        c.passivity = passivity;
                        const HapticResult r = run_haptic_case(c);
                        if (!best.count(scale)) best[scale] = run_haptic_case(ideal(c));
                        if (swings(r, best[scale])) {
                            found = true;
                            left = r.amplitude;
                            break;
                        }
                        stable = scale;
                        at = r;
                    }
                    std::printf(
                        "{\"map\":\"%s\",\"hand\":\"%s\",\"mass\":%g,\"damping\":%g,\"stiffness\":%g,\"rate\":%g,"
                        "\"passivity\":%d,\"speed\":0.5,\"unit_force\":%.6g,\"scale\":%.6g,\"ended\":%d,"
                        "\"beyond\":%.6g,\"force\":%.6g,\"gain\":%.4g}\n",
                        name, hand.name, hand.hand.mass, hand.hand.damping, hand.hand.stiffness, rate, passivity,
                        unit.mean_force, stable, found, left, at.mean_force, at.quick_gain);
                    std::fflush(stdout);
                }
        }
    }
    return 0;
}
