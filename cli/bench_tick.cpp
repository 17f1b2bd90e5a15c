#include "cli/bench_tick.h"

#include <chrono>
#include <cmath>

#include "bake/map/formula.h"
#include "bake/regions/tessellate.h"
#include "cli/frm_object.h"
#include "core/map/codec.h"

namespace frm::cli {

std::vector<std::uint8_t> bench_map(std::uint32_t sources, std::uint32_t triangles) {
    bake::Surface box;
    for (int i = 0; i < 8; ++i) box.vertices.emplace_back(i & 1 ? 0.1 : -0.1, i & 2 ? 0.01 : -0.01, i & 4 ? 0.3 : -0.3);
    for (const bake::Triangle& t : {bake::Triangle{0, 2, 1},
                                    {1, 2, 3},
                                    {4, 5, 6},
                                    {5, 7, 6},
                                    {0, 1, 4},
                                    {1, 5, 4},
                                    {2, 6, 3},
                                    {3, 6, 7},
                                    {0, 4, 2},
                                    {2, 4, 6},
                                    {1, 3, 5},
                                    {3, 7, 5}})
        box.triangles.push_back(t);
    return encode_map(bake::formula_map(bake::tessellate(box, 1e-4, triangles).surface, sources, 4, 128));
}

TickTimes measure_ticks(const std::vector<std::uint8_t>& map_file, const TickScene& scene, double seconds,
                        std::size_t ticks) {
    const Session session;
    frm_world world = 0;
    session.check(frm_world_create(session.context(), nullptr, &world));
    if (scene.cells > 0) {
        frm_water_def water_def;
        session.check(frm_water_def_init(&water_def, sizeof water_def));
        water_def.nx = water_def.ny = scene.cells;
        frm_water water = 0;
        session.check(frm_water_create(world, &water_def, &water));
    }
    std::vector<frm_body> bodies;
    if (scene.bodies + scene.dry > 0) {
        frm_map map = 0;
        session.check(frm_map_open_memory(session.context(), map_file.data(), map_file.size(), &map));
        frm_body_def def;
        session.check(frm_body_def_init(&def, sizeof def));
        def.map = map;
        def.mass = 1;
        for (std::uint32_t i = 0; i < scene.bodies + scene.dry; ++i) {
            def.pose.position.z = i < scene.bodies ? scene.height : 10;
            frm_body body = 0;
            session.check(frm_body_create(world, &def, &body));
            if (i < scene.bodies) bodies.push_back(body);
        }
    }
    TickTimes times;
    const auto now = [] { return std::chrono::steady_clock::now(); };
    const auto begin = now();
    constexpr std::size_t warm = 50;
    for (std::size_t n = 0;
         n < 2 * warm || (n < ticks + warm && std::chrono::duration<double>(now() - begin).count() < seconds); ++n) {
        const double phase = 2 * scene.dt * static_cast<double>(n), lean = 0.2 * std::sin(phase);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            // In a row across the water, so that none lies in another.
            const double y = 0.5 * (static_cast<double>(i) - 0.5 * static_cast<double>(bodies.size() - 1));
            const frm_pose pose{
                {0.3 * std::sin(phase), y, scene.height},
                {static_cast<float>(std::sin(0.5 * lean)), 0, 0, static_cast<float>(std::cos(0.5 * lean))}};
            const frm_twist twist{{static_cast<float>(0.6 * std::cos(phase)), 0, 0},
                                  {static_cast<float>(0.4 * std::cos(phase)), 0, 0}};
            session.check(frm_body_set_motion(bodies[i], &pose, scene.moving ? &twist : nullptr));
        }
        const auto start = now();
        session.check(frm_world_tick(world, static_cast<float>(scene.dt)));
        const double us = std::chrono::duration<double, std::micro>(now() - start).count();
        if (n >= warm) times.add(us);
    }
    return times;
}

}  // namespace frm::cli
