// What is known of one SPIDAR-G: its strings, its amplifier, where it is found. From a JSON file (docs/devices.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/spidar_g/geometry.h"
#include "device/spidar_g/wrench_range.h"

namespace frm::spidar_g {

enum class AmplifierKind { sh4, simple };
enum class BusKind { usb, hid };

struct Motor {
    double metres_per_pulse = 0;  ///< negative where a longer string counts down
    double volts_per_newton = 0;
};

struct Checks {
    double residual = 0.003;   ///< m; a string that is this far from what the others say is a fault
    double string_speed = 10;  ///< m/s; faster than any hand
};

/// Of the simulated device only: a hand that holds the grip by a spring and a damper, and leads it along an ellipse.
struct Hand {
    double mass = 0.3;                                       ///< kg, grip and hand
    double inertia = 2e-4;                                   ///< kg m^2, about any axis
    double stiffness = 200, damping = 8;                     ///< N/m, N s/m
    double turning_stiffness = 0.5, turning_damping = 0.01;  ///< N m/rad, N m s/rad
    Vec3d centre, cosine, sine;  ///< where it leads: centre + cosine cos(wt) + sine sin(wt), m
    Vec3d turning;               ///< rad, a rotation vector that swings with sin(wt), below 1
    double frequency = 0.5;      ///< w / 2 pi, Hz
};

struct Configuration {
    std::string name;
    Geometry geometry;
    std::array<Motor, string_count> motors;
    TensionLimits limits;  ///< N
    AmplifierKind amplifier = AmplifierKind::sh4;
    double digits_per_volt = 415;
    BusKind bus = BusKind::usb;
    std::uint16_t vendor = 0, product = 0;
    std::uint32_t button_mask = 0x0F;
    std::uint32_t report_bytes = 64;                      ///< of HID
    std::vector<std::uint8_t> report_start, report_stop;  ///< HID: sent once on opening, on closing
    std::uint64_t period_ns = 1'000'000;
    std::uint64_t timeout_ns = 10'000'000;  ///< for one exchange
    std::uint32_t velocity_window = 8;      ///< poses
    Checks checks;
    Hand hand;
    WrenchRange range;  ///< at the reference pose
};

/// Reads and checks a file; null: the built-in SpidarG6X3R. Throws Error that names the file and the place in it:
/// FRM_ERROR_FILE, FRM_ERROR_CORRUPT (not such a file), FRM_ERROR_ARGUMENT (a number that cannot be, strings that
/// cannot display a wrench of every direction).
Configuration load_configuration(const char* path);

/// The same of a text; `where` begins its errors.
Configuration parse_configuration(const std::string& text, const std::string& where);

}  // namespace frm::spidar_g
