// Rows of the wave field.

static void wave_velocity_row(float* __restrict u, const float* __restrict h, std::ptrdiff_t behind,
                              std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) u[i] -= factor * (h[i] - h[i - behind]);
}

static void wave_height_row(float* __restrict h, const float* __restrict u, const float* __restrict below,
                            const float* __restrict above, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) h[i] -= factor * ((u[i + 1] - u[i]) + (above[i] - below[i]));
}
