// A SPIDAR-G in the same process, with access to what simulates it.
#pragma once

#include <random>

#include "device/simulated/simulated_transport.h"
#include "device/spidar_g/spidar_g.h"
#include "tests/support/catch.h"

namespace frm::test {

using namespace spidar_g;

struct SimulatedSpidar {
    explicit SimulatedSpidar(Configuration c = load_configuration(nullptr))
        : transport(new simulated::SimulatedTransport(c)), device(c, std::unique_ptr<Transport>(transport)) {
        REQUIRE(device.begin());
    }

    simulated::HandOnStrings& hand() { return transport->amplifier().hand(); }
    GripState run(int cycles, const GripWrench& wrench = {}) {
        GripState state;
        for (int i = 0; i < cycles; ++i) state = device.exchange(wrench);
        return state;
    }

    simulated::SimulatedTransport* transport;
    SpidarG device;
};

class Random {
public:
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
    Vec3d vector(double most) { return {(*this)(-most, most), (*this)(-most, most), (*this)(-most, most)}; }
    Vec3d direction() {
        for (;;) {
            const Vec3d v = vector(1);
            if (length(v) > 0.1 && length(v) < 1) return v / length(v);
        }
    }

private:
    std::mt19937 generator_{20060703};
};

constexpr double degree = 0.017453292519943295;

}  // namespace frm::test
