// The whole driver on the simulated SPIDAR-G: what is shown, what is told to the motors, and what goes wrong.
#include <cmath>
#include <cstring>

#include "tests/device/spidar_g.h"
#include "tests/support/library.h"

using namespace frm;
using namespace frm::test;

namespace {

/// A hand that leads the grip on an ellipse and turns it.
Configuration moving(AmplifierKind kind = AmplifierKind::sh4) {
    Configuration c = load_configuration(nullptr);
    c.amplifier = kind;
    c.hand.stiffness = 2000, c.hand.damping = 30;
    c.hand.turning_stiffness = 3;
    c.hand.cosine = {0.02, 0.01, 0}, c.hand.sine = {0, 0.015, 0.02};
    c.hand.turning = {0.2, 0.3, -0.1};
    c.hand.frequency = 2;
    return c;
}

double off(const GripPose& a, const GripPose& b) { return length(a.position - b.position); }

}  // namespace

TEST_CASE("the simulated grip is tracked on both amplifiers", "[spidar_g]") {
    for (const AmplifierKind kind : {AmplifierKind::sh4, AmplifierKind::simple}) {
        Configuration c = moving(kind);
        c.hand.cosine = {};
        c.hand.sine = {0, 0.015, 0.02};
        SimulatedSpidar s(c);
        CHECK(s.run(3).faults == FRM_DEVICE_FAULT_UNCALIBRATED);
        s.hand().place({});
        REQUIRE(s.device.calibrate());
        double worst = 0, worst_angle = 0, moved = 0;
        for (int k = 0; k < 2000; ++k) {
            const GripState state = s.device.exchange({{2, 0, 1}, {0, 0.02, 0}});
            REQUIRE(state.faults == 0);
            const GripPose truth = s.hand().pose();
            // Calibration took place a millisecond into the motion: a millimetre of offset is its own.
            worst = std::max(worst, off(state.pose, truth));
            worst_angle = std::max(worst_angle, length(rotation_between(truth.rotation, state.pose.rotation)));
            moved = std::max(moved, length(truth.position));
        }
        CHECK(moved > 0.02);
        CHECK(worst < 0.1e-3);
        CHECK(worst_angle < 0.4 * degree);
    }
}

TEST_CASE("the motors are told the wrench that is said to be achieved", "[spidar_g]") {
    Configuration c = moving();
    c.hand.cosine = {}, c.hand.sine = {0.018, 0.01, 0}, c.hand.frequency = 4;
    SimulatedSpidar s(c);
    s.hand().place({});
    REQUIRE(s.device.calibrate());
    const GripWrench asked{{3, -2, 1}, {0.02, 0.05, -0.03}};
    GripState state = s.run(600, asked);
    double fastest = 0;
    for (int k = 0; k < 300; ++k) {
        const GripPose before = s.hand().pose();
        state = s.device.exchange(asked);
        const auto displayed = [&](const GripPose& pose) {
            StringRows rows;
            REQUIRE(string_rows(c.geometry, pose, rows));
            return wrench_of(rows, s.transport->amplifier().tensions(), c.geometry.lever);
        };
        // What the hand felt in the cycle: of the tensions that the DAC had, at the poses where the grip was.
        const GripWrench first = displayed(before), last = displayed(s.hand().pose());
        const GripWrench real{(first.force + last.force) * 0.5, (first.torque + last.torque) * 0.5};
        fastest = std::max(fastest, length(s.hand().twist().linear));
        // A DAC digit is 6.6 mN.
        CHECK(length(state.achieved.force - asked.force) < 0.02);
        CHECK(length(state.achieved.torque - asked.torque) < 0.0005);
        CHECK(length(real.force - state.achieved.force) < 0.037);  // 1 % of what was asked for
        CHECK(length(real.torque - state.achieved.torque) < 0.001);
        for (const double t : s.transport->amplifier().tensions()) CHECK((t >= 0.3 && t <= 20));
    }
    CHECK(fastest > 0.5);
    // Beyond what strings can: less, and said so.
    for (int k = 0; k < 50; ++k) state = s.device.exchange({{200, 0, 0}, {}});
    CHECK(state.achieved.force.x < 60);
    CHECK(state.achieved.force.x > 10);
    for (const double t : s.transport->amplifier().tensions()) CHECK((t >= 0.3 && t <= 20));
    s.device.stop();
    for (const double t : s.transport->amplifier().tensions()) CHECK(t < 0.31);
}

TEST_CASE("a push is felt by the simulated hand", "[spidar_g]") {
    SimulatedSpidar s;
    REQUIRE(s.device.calibrate());
    const GripState state = s.run(3000, {{4, 0, 0}, {}});
    // 4 N on a spring of 200 N/m.
    CHECK(std::fabs(state.pose.position.x - 0.02) < 0.001);
    CHECK(length(state.twist.linear) < 0.01);
}

TEST_CASE("faults of the bus are latched until calibration, and forces are off", "[spidar_g]") {
    const struct {
        Carried failing;
        std::uint32_t fault;
    } cases[] = {{Carried::cut_off, FRM_DEVICE_FAULT_SHORT_PACKET},
                 {Carried::too_late, FRM_DEVICE_FAULT_TIMEOUT},
                 {Carried::refused, FRM_DEVICE_FAULT_TRANSFER},
                 {Carried::unplugged, FRM_DEVICE_FAULT_UNPLUGGED}};
    for (const auto& c : cases) {
        SimulatedSpidar s(moving());
        REQUIRE(s.device.calibrate());
        const GripWrench asked{{5, 0, 0}, {}};
        const GripState before = s.run(800, asked);
        REQUIRE(before.faults == 0);
        s.transport->failing = c.failing;
        GripState state = s.device.exchange(asked);
        CHECK((state.faults & c.fault) != 0);
        CHECK(off(state.pose, before.pose) < 1e-12);
        CHECK(length(state.twist.linear) == 0);
        s.transport->failing = Carried::whole;
        state = s.run(5, asked);
        CHECK((state.faults & c.fault) != 0);
        const bool gone = c.failing == Carried::unplugged;
        for (const double t : s.transport->amplifier().tensions()) CHECK((gone || t < 0.31));
        s.hand().place({});
        CHECK(s.device.calibrate() == !gone);
        CHECK((s.run(5, asked).faults == 0) == !gone);
    }
}

TEST_CASE("strings and encoders that fail are noticed", "[spidar_g]") {
    int named_broken = 0, named_stuck = 0;
    for (int string = 0; string < string_count; ++string) {
        {
            SimulatedSpidar s(moving());
            REQUIRE(s.device.calibrate());
            REQUIRE(s.run(300).faults == 0);
            s.hand().faults.stuck = string;
            const std::uint32_t faults = s.run(1000).faults;
            CHECK((faults & (FRM_DEVICE_FAULT_STUCK_ENCODER | FRM_DEVICE_FAULT_BROKEN_STRING |
                             FRM_DEVICE_FAULT_SLACK_STRING)) != 0);
            named_stuck += (faults & FRM_DEVICE_FAULT_STUCK_ENCODER) != 0;
        }
        {
            SimulatedSpidar s(moving());
            REQUIRE(s.device.calibrate());
            REQUIRE(s.run(300).faults == 0);
            s.hand().faults.broken = string;
            int cycles = 0;
            std::uint32_t faults = 0;
            while (faults == 0 && cycles++ < 100) faults = s.run(1).faults;
            CHECK(cycles < 30);
            named_broken += (faults & FRM_DEVICE_FAULT_BROKEN_STRING) != 0;
        }
        {
            SimulatedSpidar s;
            REQUIRE(s.device.calibrate());
            const GripWrench asked{{3, 0, 0}, {}};
            REQUIRE(s.run(800, asked).faults == 0);
            s.hand().faults.slack = string;
            GripState state = s.run(20, asked);
            CHECK(state.faults != 0);
            for (const double t : s.transport->amplifier().tensions()) CHECK(t < 0.31);
        }
    }
    INFO(named_stuck << " stuck and " << named_broken << " broken of 8 are named as such");
    CHECK(named_stuck >= 6);
    CHECK(named_broken >= 6);
}

TEST_CASE("a slack string that tightens lets forces come again", "[spidar_g]") {
    SimulatedSpidar s;
    REQUIRE(s.device.calibrate());
    REQUIRE(s.run(800).faults == 0);
    s.hand().faults.slack = 3;
    s.hand().faults.slack_length = 0.012;
    CHECK(s.run(20).faults == FRM_DEVICE_FAULT_SLACK_STRING);
    s.hand().faults.slack = -1;
    CHECK(s.run(20).faults == 0);
    const GripState state = s.run(700, {{3, 0, 0}, {}});
    CHECK(state.faults == 0);
    CHECK(length(state.achieved.force - Vec3d(3, 0, 0)) < 0.05);
}

TEST_CASE("counters that may have wrapped unseen need a calibration", "[spidar_g]") {
    SimulatedSpidar s;
    REQUIRE(s.device.calibrate());
    REQUIRE(s.run(10).faults == 0);
    s.transport->lose(40);  // 41 ms at 10 m/s: below half of 1.09 m
    CHECK(s.run(1).faults == 0);
    s.transport->lose(60);
    CHECK((s.run(1).faults & (FRM_DEVICE_FAULT_LOST_COUNT | FRM_DEVICE_FAULT_UNCALIBRATED)) ==
          (FRM_DEVICE_FAULT_LOST_COUNT | FRM_DEVICE_FAULT_UNCALIBRATED));
    REQUIRE(s.device.calibrate());
    CHECK(s.run(1).faults == 0);
    // 24 bits are never in doubt.
    SimulatedSpidar simple(moving(AmplifierKind::simple));
    REQUIRE(simple.device.calibrate());
    simple.transport->lose(60);
    CHECK(simple.run(1).faults == 0);
}

TEST_CASE("numbers that are none do not reach the motors", "[spidar_g]") {
    SimulatedSpidar s;
    REQUIRE(s.device.calibrate());
    s.run(800, {{2, 0, 0}, {}});
    const GripState state = s.run(3, {{std::nan(""), INFINITY, 0}, {0, 0, -INFINITY}});
    CHECK(std::isfinite(length(state.achieved.force)));
    for (const double t : s.transport->amplifier().tensions()) CHECK((t >= 0.3 && t < 0.31));
    CHECK(s.run(3).faults == 0);
}

namespace {

/// Answers with anything.
class Noise final : public Transport {
public:
    void recover() override {}
    Carried send(const Request&) override { return Carried::whole; }
    Carried cycle(const Request& request, std::size_t size, Packet& reply) override {
        for (std::size_t i = 0; i < request.count; ++i) last = request.packets[i];
        for (auto& byte : reply.bytes) byte = static_cast<std::uint8_t>(random(0, 256));
        reply.size = size;
        return Carried::whole;
    }
    std::uint64_t now_ns() override { return now += static_cast<std::uint64_t>(random(0, 2e6)); }
    bool runs_by_itself() const override { return true; }

    Random random;
    Packet last;
    std::uint64_t now = 0;
};

}  // namespace

TEST_CASE("replies of any bytes do no harm", "[spidar_g]") {
    auto* noise = new Noise;
    SpidarG device(load_configuration(nullptr), std::unique_ptr<Transport>(noise));
    REQUIRE(device.begin());
    int faulty = 0;
    for (int k = 0; k < 3000; ++k) {
        if (k % 10 == 0) device.calibrate();
        const GripState state = device.exchange({{3, 4, 5}, {0.1, 0, 0}});
        REQUIRE(std::isfinite(length(state.pose.position)));
        REQUIRE(length(state.pose.position) < 1e6);
        REQUIRE(length(state.twist.linear) < 1e4);
        REQUIRE(length(state.twist.angular) < 1e4);
        REQUIRE(std::isfinite(length(state.achieved.force)));
        faulty += state.faults != 0;
        for (std::size_t i = 0; i < string_count; ++i) {
            const int digit =
                static_cast<std::int16_t>(noise->last.bytes[2 + 2 * i] | noise->last.bytes[3 + 2 * i] << 8);
            REQUIRE((digit >= 0 && digit <= 3032));
        }
    }
    CHECK(faulty > 2900);
}

TEST_CASE("two simulated devices give the same bits", "[spidar_g]") {
    SimulatedSpidar a(moving()), b(moving());
    REQUIRE(a.device.calibrate());
    REQUIRE(b.device.calibrate());
    for (int k = 0; k < 500; ++k) {
        const GripWrench wrench{{0.01 * k, 1, -2}, {0.01, 0, 1e-4 * k}};
        const GripState x = a.device.exchange(wrench), y = b.device.exchange(wrench);
        CHECK(std::memcmp(&x.pose, &y.pose, sizeof x.pose) == 0);
        CHECK(std::memcmp(&x.twist, &y.twist, sizeof x.twist) == 0);
    }
}

TEST_CASE("a simulated device through the C interface, in every host's axes", "[spidar_g]") {
    for (const std::uint32_t axes :
         {FRM_AXES_Z_UP_RIGHT, FRM_AXES_Y_UP_RIGHT, FRM_AXES_Y_UP_LEFT, FRM_AXES_Z_UP_LEFT}) {
        frm_context_def def{};
        REQUIRE(frm_context_def_init(&def, sizeof def) == FRM_OK);
        def.axes = axes;
        frm_context context = 0;
        REQUIRE(frm_context_create(&def, &context) == FRM_OK);
        frm_device device = 0;
        REQUIRE(frm_device_open_simulated(context, nullptr, &device) == FRM_OK);
        frm_device_info info{};
        info.struct_size = sizeof info;
        REQUIRE(frm_device_get_info(device, &info) == FRM_OK);
        CHECK(std::string(info.name) == "SpidarG6X3R (simulated)");
        CHECK(info.max_force > 20);
        CHECK(info.period_ns == 1000000);
        frm_device_state state{};
        state.struct_size = sizeof state;
        frm_device_command command{};
        command.struct_size = sizeof command;
        REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
        CHECK(state.status == FRM_DEVICE_UNCALIBRATED);
        REQUIRE(frm_device_calibrate(device) == FRM_OK);
        frm_device_safety_def safety;
        REQUIRE(frm_device_safety_def_init(&safety, sizeof safety) == FRM_OK);
        safety.deadline_ns = 10'000'000'000;  // a busy machine is no stalled host
        REQUIRE(frm_device_set_safety(device, &safety) == FRM_OK);
        REQUIRE(frm_device_engage(device) == FRM_OK);
        command.wrench.force = {1, 2, 3};
        for (int k = 0; k < 3000; ++k) REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
        CHECK(state.status == FRM_DEVICE_READY);
        CHECK(state.faults == 0);
        CHECK(state.sequence == 3000);
        CHECK(state.time_ns > 2900000000u);
        // The grip goes where the force points, in the host's own axes: F / 200 N/m.
        CHECK(std::fabs(state.pose.position.x - 0.005) < 5e-4);
        CHECK(std::fabs(state.pose.position.y - 0.010) < 5e-4);
        CHECK(std::fabs(state.pose.position.z - 0.015) < 5e-4);
        CHECK(std::fabs(state.achieved.force.z - 3) < 0.03);
        command.wrench = {{0, 0, 0}, {0.05f, 0, 0}};
        for (int k = 0; k < 3000; ++k) REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
        // 0.05 N m on 0.5 N m/rad: 0.1 rad about the host's x, by the host's own sense of turning.
        CHECK(std::fabs(2 * state.pose.rotation.x - 0.1) < 0.01);
        CHECK(std::fabs(state.pose.rotation.y) < 0.005);
        CHECK(std::fabs(state.achieved.torque.x - 0.05f) < 0.001);
        REQUIRE(frm_device_stop(device) == FRM_OK);
        frm_context_destroy(context);
    }
}
