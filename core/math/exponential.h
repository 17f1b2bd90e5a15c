// exp for arguments in [-80, 0], from + - * / alone: libm's differs between machines, ours gives the same bits on all.
#pragma once

#include <cstdint>
#include <cstring>

namespace frm {

/// exp(x), relative error below 3e-7 (test_math.cpp). Arguments below -80 give 0, above 0 give 1.
inline float exponential(float x) {
    if (!(x > -80.0f)) return 0.0f;
    if (x >= 0.0f) return 1.0f;
    // x = n ln 2 + r, |r| <= ln 2 / 2; ln 2 in two parts (Cody and Waite) keeps r exact.
    const float n = static_cast<float>(static_cast<std::int32_t>(x * 1.44269504f - 0.5f));
    const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    // Taylor to the sixth power: the remainder is below r^7 / 7! = 1.2e-7 at the end of the interval.
    const float p =
        1.0f + r * (1.0f + r * (0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720))))));
    const std::uint32_t bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(n) + 127) << 23;
    float power;
    std::memcpy(&power, &bits, sizeof power);
    return p * power;
}

}  // namespace frm
