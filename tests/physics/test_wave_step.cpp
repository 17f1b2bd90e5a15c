// How the field is stepped: the same bits as the plain formulas, whatever goes through the rows together, is skipped or
// shared by threads.
#include <algorithm>
#include <cmath>
#include <random>

#include "core/kernels/kernels.h"
#include "core/math/floating_point.h"
#include "core/water/field.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

constexpr float g = 9.80665f;

/// Eqs. 7 and 8 as they are written, over whole arrays, with ghost cells: what Field must agree with to the bit.
class Plain {
public:
    explicit Plain(const FieldDef& def)
        : def_(def), h_(def.nx + 4, def.ny + 4), u_(def.nx + 5, def.ny + 4), v_(def.nx + 4, def.ny + 5) {}

    float& h(std::int32_t i, std::int32_t j) { return h_.at(i, j); }
    float& u(std::int32_t i, std::int32_t j) { return u_.at(i, j); }
    float& v(std::int32_t i, std::int32_t j) { return v_.at(i, j); }

    void step(float dt, const std::vector<Push>& pushes) {
        const std::int32_t nx = def_.nx, ny = def_.ny;
        const float slope = dt * g / def_.cell, divergence = dt * def_.depth / def_.cell;
        const float speed = std::sqrt(g * def_.depth);
        const float out = def_.border == Border::absorbing ? speed / def_.depth : 0.0f;
        for (const Push& p : pushes) {
            const float f = p.factor / def_.cell;
            const auto pressure = [&](std::int32_t i, std::int32_t j) { return p.pressure[j * p.columns + i]; };
            for (std::int32_t j = 0; j < p.rows; ++j)
                for (std::int32_t i = 0; i < p.columns; ++i) {
                    const std::int32_t x = i + p.di, y = j + p.dj;
                    if (x < 0 || y < 0 || x >= nx || y >= ny) continue;
                    if (i > 0 && x > 0) u(x, y) += f * (pressure(i, j) - pressure(i - 1, j));
                    if (j > 0 && y > 0) v(x, y) += f * (pressure(i, j) - pressure(i, j - 1));
                }
        }
        mirror_heights();
        const bool fourth = def_.order == 4;
        const float f1 = slope * (27.0f / 24), f3 = slope * (1.0f / 24);
        const float g1 = divergence * (27.0f / 24), g3 = divergence * (1.0f / 24);
        for (std::int32_t j = 0; j < ny; ++j)
            for (std::int32_t i = 1; i < nx; ++i)
                u(i, j) -= fourth ? f1 * (h(i, j) - h(i - 1, j)) - f3 * (h(i + 1, j) - h(i - 2, j))
                                  : slope * (h(i, j) - h(i - 1, j));
        for (std::int32_t j = 1; j < ny; ++j)
            for (std::int32_t i = 0; i < nx; ++i)
                v(i, j) -= fourth ? f1 * (h(i, j) - h(i, j - 1)) - f3 * (h(i, j + 1) - h(i, j - 2))
                                  : slope * (h(i, j) - h(i, j - 1));
        if (def_.border == Border::absorbing) {
            for (std::int32_t j = 0; j < ny; ++j) u(0, j) = -out * h(0, j), u(nx, j) = out * h(nx - 1, j);
            for (std::int32_t i = 0; i < nx; ++i) v(i, 0) = -out * h(i, 0), v(i, ny) = out * h(i, ny - 1);
        }
        for (std::int32_t j = 0; j < ny; ++j)
            u(-1, j) = 2 * u(0, j) - u(1, j), u(nx + 1, j) = 2 * u(nx, j) - u(nx - 1, j);
        for (std::int32_t i = 0; i < nx; ++i)
            v(i, -1) = 2 * v(i, 0) - v(i, 1), v(i, ny + 1) = 2 * v(i, ny) - v(i, ny - 1);
        for (std::int32_t j = 0; j < ny; ++j)
            for (std::int32_t i = 0; i < nx; ++i) {
                const float near = (u(i + 1, j) - u(i, j)) + (v(i, j + 1) - v(i, j));
                const float far = (u(i + 2, j) - u(i - 1, j)) + (v(i, j + 2) - v(i, j - 1));
                h(i, j) -= fourth ? g1 * near - g3 * far : divergence * near;
            }
        if (def_.border == Border::absorbing && def_.border_cells > 0) damp(dt, speed);
    }

private:
    struct Array {
        Array(std::int32_t columns, std::int32_t rows)
            : width(columns), data(static_cast<std::size_t>(columns * rows), 0.0f) {}
        float& at(std::int32_t i, std::int32_t j) { return data[static_cast<std::size_t>((j + 2) * width + i + 2)]; }
        std::int32_t width;
        std::vector<float> data;
    };

    void mirror_heights() {
        const std::int32_t nx = def_.nx, ny = def_.ny;
        for (std::int32_t k = 0; k < 2; ++k) {
            for (std::int32_t j = 0; j < ny; ++j) h(-1 - k, j) = h(k, j), h(nx + k, j) = h(nx - 1 - k, j);
            for (std::int32_t i = 0; i < nx; ++i) h(i, -1 - k) = h(i, k), h(i, ny + k) = h(i, ny - 1 - k);
        }
    }

    void damp(float dt, float speed) {
        const std::int32_t nx = def_.nx, ny = def_.ny;
        const auto width = static_cast<float>(def_.border_cells);
        const float rate = speed / (width * def_.cell);
        const auto keep = [&](std::int32_t k, float offset) {
            const float x = 1.0f - (static_cast<float>(k) + offset) / width;
            return x > 0 ? 1.0f / (1.0f + dt * rate * x * x) : 1.0f;
        };
        for (std::int32_t j = 0; j <= ny; ++j)
            for (std::int32_t i = 0; i <= nx; ++i) {
                const std::int32_t ci = std::min(i, nx - 1 - i), cj = std::min(j, ny - 1 - j);
                const std::int32_t fi = std::min(i, nx - i), fj = std::min(j, ny - j);
                if (i < nx && j < ny) h(i, j) = h(i, j) * keep(cj, 0.5f) * keep(ci, 0.5f);
                if (j < ny) u(i, j) = u(i, j) * keep(cj, 0.5f) * keep(fi, 0.0f);
                if (i < nx) v(i, j) = v(i, j) * keep(fj, 0.0f) * keep(ci, 0.5f);
            }
    }

    FieldDef def_;
    Array h_, u_, v_;
};

std::vector<float> rough(std::size_t count, unsigned seed, float size) {
    std::minstd_rand random(seed);
    std::vector<float> x(count);
    for (float& v : x) v = size * (static_cast<float>(random() % 20001) - 10000.0f) * 1e-4f;
    return x;
}

std::vector<float> hill(std::int32_t n, float x, float y, float width, float height) {
    std::vector<float> h;
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i) {
            const float dx = static_cast<float>(i) - x, dy = static_cast<float>(j) - y;
            const float r2 = (dx * dx + dy * dy) / (width * width);
            h.push_back(r2 < 1 ? height * (1 - r2) * (1 - r2) : 0.0f);
        }
    return h;
}

FieldDef def_of(std::int32_t nx, std::int32_t ny, Border border, std::int32_t layer, std::int32_t order) {
    FieldDef def;
    def.nx = nx, def.ny = ny, def.cell = 0.05f, def.depth = 0.5f;
    def.border = border, def.border_cells = layer, def.order = order;
    return def;
}

std::uint64_t hash_of(const Field& field) {
    StateHash hash;
    field.hash(hash);
    return hash.result();
}

/// Largest difference of heights, and of velocities as heights of waves.
float difference(const Field& a, const Field& b) {
    const float wave = std::sqrt(a.def().depth / g);
    float most = 0;
    for (std::int32_t j = 0; j < a.def().ny; ++j)
        for (std::int32_t i = 0; i < a.def().nx; ++i) {
            most = std::fmax(most, std::fabs(a.height_row(j)[i] - b.height_row(j)[i]));
            most = std::fmax(most, wave * std::fabs(a.velocity_x_row(j)[i] - b.velocity_x_row(j)[i]));
            most = std::fmax(most, wave * std::fabs(a.velocity_y_row(j)[i] - b.velocity_y_row(j)[i]));
        }
    return most;
}

}  // namespace

TEST_CASE("steps are Eqs. 7 and 8 to the bit, at any size, border and order", "[wave_step]") {
    for (const std::int32_t order : {2, 4})
        for (const auto& [nx, ny] : {std::pair(8, 9), std::pair(31, 40), std::pair(64, 33), std::pair(97, 70),
                                     std::pair(127, 66), std::pair(128, 96), std::pair(143, 35)})
            for (const std::int32_t layer : {-1, 0, 2, 10, 17}) {
                if (3 * layer >= std::min(nx, ny)) continue;
                const FieldDef def =
                    def_of(nx, ny, layer < 0 ? Border::reflecting : Border::absorbing, std::max(layer, 0), order);
                INFO(nx << " x " << ny << ", layer " << layer << ", order " << order);
                Field field(def, test::memory());
                field.go_together_from(0);
                Plain plain(def);
                const std::vector<float> h = rough(field.cells(), 3, 0.1f), p = rough(20 * 12, 5, 40);
                field.set_heights(h.data());
                for (std::int32_t j = 0; j < ny; ++j)
                    for (std::int32_t i = 0; i < nx; ++i) plain.h(i, j) = h[static_cast<std::size_t>(j * nx + i)];
                std::vector<Push> pushes;
                pushes.push_back({p.data(), 20, 12, {0, 0, 20, 12}, -3, 2, 1e-5f});
                pushes.push_back({p.data(), 20, 12, {0, 0, 20, 12}, nx - 11, ny - 8, 1e-5f});
                for (const std::uint32_t steps : {1u, 3u, 12u, 1u}) {
                    field.advance(0.007f, g, steps, pushes.data(), pushes.size(), 1);
                    for (std::uint32_t s = 0; s < steps; ++s) plain.step(0.007f, pushes);
                }
                int differ = 0;
                const auto same = [](float a, float b) { return a == b; };
                for (std::int32_t j = 0; j < ny; ++j)
                    for (std::int32_t i = 0; i < nx; ++i) differ += !same(field.height_row(j)[i], plain.h(i, j));
                for (std::int32_t j = 0; j < ny; ++j)
                    for (std::int32_t i = 0; i <= nx; ++i) differ += !same(field.velocity_x_row(j)[i], plain.u(i, j));
                for (std::int32_t j = 0; j <= ny; ++j)
                    for (std::int32_t i = 0; i < nx; ++i) differ += !same(field.velocity_y_row(j)[i], plain.v(i, j));
                CHECK(differ == 0);
            }
}

TEST_CASE("every instruction set steps rows to the same bits", "[wave_step]") {
    const Kernels* sets[max_kernel_sets];
    const std::size_t count = every_kernel_set(sets);
    constexpr std::ptrdiff_t stride = 192, rows = 8;
    for (const std::int32_t columns : {32, 33, 47, 48, 63, 64, 100, 127, 128})
        for (const bool fourth : {false, true}) {
            std::vector<std::vector<float>> results;
            for (std::size_t k = 0; k < count; ++k) {
                const std::vector<float> start = rough(3 * stride * (rows + 8), 11, 1);
                std::vector<float> memory(start.size() + 16);
                void* begin = memory.data();
                std::size_t room = memory.size() * sizeof(float);
                auto* const x = static_cast<float*>(std::align(64, 64, begin, room));
                std::copy(start.begin(), start.end(), x);
                WaveRows w{};
                w.height = x + 3 * stride + 16;
                w.velocity_x = w.height + (rows + 8) * stride;
                w.velocity_y = w.velocity_x + (rows + 8) * stride;
                w.stride = stride, w.rows = rows, w.count = columns, w.with_faces = true;
                w.wall_left = w.wall_right = true, w.outflow = 0.3f;
                if (fourth)
                    sets[k]->wave_rows_4(w, 0.2f, 0.01f, 0.3f, 0.02f);
                else
                    sets[k]->wave_rows(w, 0.2f, 0.3f);
                // Only what belongs to the rows: lanes beyond them differ with the width of a vector.
                std::vector<float> result;
                for (std::ptrdiff_t j = 0; j < rows; ++j) {
                    result.insert(result.end(), w.height + j * stride, w.height + j * stride + columns);
                    result.insert(result.end(), w.velocity_x + j * stride, w.velocity_x + j * stride + columns + 1);
                    result.insert(result.end(), w.velocity_y + j * stride, w.velocity_y + j * stride + columns);
                }
                results.push_back(std::move(result));
            }
            for (const std::vector<float>& r : results) CHECK(r == results[0]);
        }
}

TEST_CASE("steps that go through the rows together give the bits of one after the other", "[wave_step]") {
    for (const std::int32_t order : {2, 4})
        for (const Border border : {Border::absorbing, Border::reflecting}) {
            const FieldDef def = def_of(150, 130, border, 10, order);
            Field together(def, test::memory()), apart(def, test::memory());
            together.go_together_from(0);
            const std::vector<float> h = hill(150, 60, 50, 12, 0.05f), p = rough(40 * 40, 9, 30);
            const auto heights = std::vector<float>(h.begin(), h.begin() + 150 * 130);
            together.set_heights(heights.data());
            apart.set_heights(heights.data());
            const Push push{p.data(), 40, 40, {5, 5, 35, 35}, 30, 70, 2e-5f};
            for (int t = 0; t < 20; ++t) {
                together.advance(0.008f, g, 13, &push, 1, 1);
                for (int s = 0; s < 13; ++s) apart.advance(0.008f, g, 1, &push, 1, 1);
                REQUIRE(hash_of(together) == hash_of(apart));
            }
        }
}

TEST_CASE("threads step large water to the same bits, at either order", "[wave_step]") {
    for (const std::int32_t order : {2, 4}) {
        const auto run = [&](std::uint32_t threads) {
            Field field(def_of(544, 544, Border::absorbing, 16, order), test::memory());
            field.set_heights(rough(field.cells(), 4, 0.05f).data());
            field.advance(0.007f, g, 30, nullptr, 0, threads);
            return hash_of(field);
        };
        const std::uint64_t one = run(1);
        CHECK(run(2) == one);
        CHECK(run(3) == one);
    }
}

#if defined(__SSE2__)
TEST_CASE("threads that a host has had in modes of its own step water to the same bits", "[wave_step]") {
    constexpr int threads = 3;
    const auto every_thread = [](unsigned modes) {
#pragma omp parallel num_threads(threads)
        _mm_setcsr(modes);
    };
    const auto run = [](std::uint32_t count) {
        const FloatingPointGuard modes;
        Field field(def_of(544, 544, Border::reflecting, 0, 2), test::memory());
        field.set_heights(rough(field.cells(), 4, 1e-38f).data());  // steps change it by denormal numbers
        field.advance(0.007f, g, 5, nullptr, 0, count);
        return hash_of(field);
    };
    const unsigned before = _mm_getcsr();
    const std::uint64_t one = run(1);
    every_thread(0x1F80 | 0x8040 | 0x6000);  // flush to zero, round towards zero
    CHECK(run(threads) == one);
    unsigned after[threads] = {};
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int t = 0; t < threads; ++t) after[t] = _mm_getcsr();
    every_thread(before);
    for (const unsigned modes : after) CHECK((modes & ~0x3Fu) == (0x1F80 | 0x8040 | 0x6000));
}
#endif

TEST_CASE("calm tiles rest, wake, and change nothing above their threshold", "[wave_step]") {
    for (const std::int32_t order : {2, 4}) {
        FieldDef def = def_of(512, 512, Border::absorbing, 16, order);
        Field skips(def, test::memory());
        def.skip_calm_tiles = false;
        Field all(def, test::memory());
        CHECK(skips.active_cells() == 0);
        CHECK(all.active_cells() == all.cells());
        const float still = 1e-6f * 0.5f;  // of the depth
        const std::vector<float> h = hill(512, 200, 260, 10, 0.05f);
        skips.set_heights(h.data());
        all.set_heights(h.data());
        skips.advance(0.008f, g, 8, nullptr, 0, 1);
        all.advance(0.008f, g, 8, nullptr, 0, 1);
        CHECK(skips.active_cells() <= 36 * 1024);
        std::size_t most = 0;
        float worst = 0;
        for (int t = 0; t < 250; ++t) {
            skips.advance(0.008f, g, 8, nullptr, 0, 1);
            all.advance(0.008f, g, 8, nullptr, 0, 1);
            most = std::max(most, skips.active_cells());
            worst = std::fmax(worst, difference(skips, all));
        }
        UNSCOPED_INFO("order " << order << ": worst " << worst << ", most active " << most);
        CHECK(worst < still);
        CHECK(worst > 0);  // something rested
        CHECK(most > 100 * 1024);
        // What is left of the pulse runs out, and then all of it rests.
        for (int t = 0; t < 3000 && skips.active_cells() > 0; ++t) skips.advance(0.008f, g, 8, nullptr, 0, 1);
        CHECK(skips.active_cells() == 0);
        const Field calm(skips.def(), test::memory());
        CHECK(hash_of(skips) == hash_of(calm));
    }
}

TEST_CASE("a body wakes the water that it enters, and only that", "[wave_step]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.3, 0.1}, 0.05));
    const auto run = [&](bool skip, std::size_t& active) {
        WaterDef def = test::water_of(1024, 0.05f, 0.5f);
        def.field.skip_calm_tiles = skip;
        World world = test::world_of();
        Water& water = world.create_water(def);
        Body& body = world.create_body(test::body_of(map, {3, -2, 0.3}));
        Vec3d force;
        for (int t = 0; t < 200; ++t) {
            const double z = 0.05 - 0.0005 * t;
            world.set_motion(body, {{3, -2, z}, {}}, {{0, 0, -0.25f}, {}});
            world.tick(0.002f);
            force += Vec3d(body.forces.total.force);
        }
        active = water.field.active_cells();
        return force;
    };
    std::size_t some = 0, all = 0;
    const Vec3d with = run(true, some), without = run(false, all);
    CHECK(all == 1024 * 1024);
    CHECK(some > 0);
    CHECK(some < 100 * 1024);
    CHECK(length(with - without) < 1e-6 * length(without));
}
