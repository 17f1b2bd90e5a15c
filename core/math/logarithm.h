// The natural logarithm, from + - * / alone: libm's differs between machines, ours gives the same bits on all.
#pragma once

#include <cstdint>
#include <cstring>

namespace frm {

/// ln(x) for normal positive x; absolute error below 2e-7 plus 1e-7 of the result (test_math.cpp). Anything below the
/// smallest normal number, zero, negative or NaN gives that number's logarithm, -87.34; infinity gives 88.72.
inline float logarithm(float x) {
    constexpr float smallest = 1.17549435e-38f, largest = 3.40282347e+38f;
    if (!(x > smallest)) x = smallest;
    if (x > largest) x = largest;
    std::uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    // x = 2^n m with m from 1/sqrt(2) to sqrt(2): counted from the bits of 1/sqrt(2), the exponent rounds by itself.
    constexpr std::uint32_t half_root = 0x3F3504F3u;
    const std::int32_t n = static_cast<std::int32_t>(bits - half_root) >> 23;
    bits -= static_cast<std::uint32_t>(n) << 23;
    float m;
    std::memcpy(&m, &bits, sizeof m);
    // ln m = 2 artanh z, z = (m - 1) / (m + 1), |z| <= 0.172: the first term left out, 2 z^11 / 11, is below 8e-10.
    const float z = (m - 1.0f) / (m + 1.0f), q = z * z;
    const float p = 2.0f * z * (1.0f + q * (1.0f / 3 + q * (1.0f / 5 + q * (1.0f / 7 + q * (1.0f / 9)))));
    // ln 2 in two parts (Cody and Waite), so that n ln 2 does not round away what p adds.
    const auto e = static_cast<float>(n);
    return (p + e * -2.12194440e-4f) + e * 0.693359375f;
}

}  // namespace frm
