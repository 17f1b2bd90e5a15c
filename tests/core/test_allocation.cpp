// A tick allocates nothing: every operator new of this program is counted.
#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

namespace {
std::atomic<std::size_t> allocations{0};
}

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size ? size : 1)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto a = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++allocations;
    return std::malloc(size ? size : 1);
}
// As the context's default allocator calls it: else the sanitizers' own would give what the ones below take back.
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    ++allocations;
    const auto a = static_cast<std::size_t>(alignment);
    return std::aligned_alloc(a, (size + a - 1) / a * a);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

TEST_CASE("a tick and a motion allocate nothing", "[allocation]") {
    using namespace frm;
    World world = test::world_of();
    world.create_water(test::water_of(100, 0.025f, 0.5f));
    Body& body = world.create_body(test::body_of(test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05))));
    const auto full = std::make_shared<Map>(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.05)));
    Body& other = world.create_body(test::body_of(full, {0.5, 0.2, 0}, {}, {{0.1f, 0, 0}, {0, 1, 2}}));
    world.tick(0.002f);
    const std::size_t before = allocations.load();
    for (int t = 0; t < 200; ++t) {
        world.set_motion(body, {{0.004 * t, 0, 0.1 - 0.001 * t}, test::turned({1, 0, 0}, 0.01 * t)},
                         {{2, 0, -0.5f}, {5, 0, 0}});
        world.tick(0.002f);
    }
    CHECK(allocations.load() == before);
    CHECK(body.wet_sources > 0);
    CHECK(other.wet_sources > 0);
    std::vector<int> seen(3);
    CHECK(allocations.load() > before);
}
