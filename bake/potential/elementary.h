// atanh and atan2 in double from + - * / alone: libm's differ between machines, these give the same bits on all.
#pragma once

#include <cstdint>
#include <cstring>

namespace frm::bake {

/// log(x) for normal x > 0, absolute error below 1e-15 + 1e-15 |log x|.
inline double logarithm(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    auto exponent = static_cast<int>(bits >> 52) - 1023;
    bits = (bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull;
    double m;
    std::memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++exponent;
    }
    // log m = 2 atanh s with |s| < 0.172: the tenth term of the series is below 1e-17.
    const double s = (m - 1) / (m + 1), q = s * s;
    const double p =
        1 +
        q * (1. / 3 +
             q * (1. / 5 +
                  q * (1. / 7 +
                       q * (1. / 9 + q * (1. / 11 + q * (1. / 13 + q * (1. / 15 + q * (1. / 17 + q * (1. / 19)))))))));
    return 2 * s * p + exponent * 0.69314718055994530942;
}

/// atanh(x), 0 <= x < 1.
inline double area_tangent(double x) {
    if (x < 0.125) {  // where the logarithm would lose digits
        const double q = x * x;
        return x *
               (1 + q * (1. / 3 +
                         q * (1. / 5 + q * (1. / 7 + q * (1. / 9 + q * (1. / 11 + q * (1. / 13 + q * (1. / 15))))))));
    }
    return 0.5 * logarithm((1 + x) / (1 - x));
}

/// The angle of the point (x, y), -pi to pi; 0 at the origin.
inline double angle_of(double y, double x) {
    const double pi = 3.14159265358979323846;
    const double ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
    const double most = ax > ay ? ax : ay, least = ax > ay ? ay : ax;
    if (!(most > 0)) return 0;
    double t = least / most, base = 0;
    // tan(a - b) = (tan a - tan b) / (1 + tan a tan b), with b = pi / 4 or pi / 8, leaves |t| < 0.243.
    if (t > 0.61) {
        t = (t - 1) / (1 + t);
        base = pi / 4;
    } else if (t > 0.2) {
        t = (t - 0.41421356237309503) / (1 + t * 0.41421356237309503);  // tan(pi / 8)
        base = pi / 8;
    }
    const double q = t * t;
    // The twelfth term is below 1e-15.
    double a =
        base +
        t * (1 -
             q * (1. / 3 -
                  q * (1. / 5 -
                       q * (1. / 7 - q * (1. / 9 - q * (1. / 11 -
                                                        q * (1. / 13 -
                                                             q * (1. / 15 -
                                                                  q * (1. / 17 - q * (1. / 19 - q * (1. / 21)))))))))));
    if (ay > ax) a = pi / 2 - a;
    if (x < 0) a = pi - a;
    return y < 0 ? -a : a;
}

}  // namespace frm::bake
