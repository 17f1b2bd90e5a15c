// What a pressure of separate weights in x and y adds to a grid.

static void add_product(float* __restrict to, std::ptrdiff_t stride, const float* __restrict x,
                        const float* __restrict y, std::ptrdiff_t columns, std::ptrdiff_t rows, float factor) {
    for (std::ptrdiff_t j = 0; j < rows; ++j, to += stride) {
        const float row = factor * y[j];
        for (std::ptrdiff_t i = 0; i < columns; ++i) to[i] += row * x[i];
    }
}
