// The whole bake, small.
#include "bake/bake.h"

#include <filesystem>

#include "bake/map/formula.h"
#include "core/map/codec.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

BakeOptions small_bake() {
    BakeOptions o;
    o.mesh = (std::filesystem::path(__FILE__).parent_path() / "../../samples/meshes/box.glb").string();
    o.quality = Quality::draft;
    o.directions = 6;
    o.sources = 6;
    o.resolution = 4;
    o.threads = 1;
    return o;
}

}  // namespace

TEST_CASE("a bake is the same bytes again, with any number of threads, and pushes along the stream", "[bake]") {
    BakeOptions options = small_bake();
    std::vector<std::uint8_t> first;
    for (const int threads : {1, 2}) {
        options.threads = threads;
        BakePlan plan = plan_bake(options);
        BakeReport report;
        const std::unique_ptr<Map> map = bake::bake(plan, nullptr, report);
        const auto file = encode_map(*map);
        if (first.empty()) {
            first = file;
            REQUIRE(report.directions.size() == 6);
            for (std::uint32_t d = 0; d < 6; ++d) {
                const Vec3d e = map->directions.direction(d);
                Vec3d sum;
                for (std::uint32_t l = 0; l < 6; ++l)
                    sum += Vec3d(map->mean[d * 6 + l].pressure) + Vec3d(map->mean[d * 6 + l].friction);
                CHECK(dot(sum, e) > 0);
                CHECK(length(sum - e * dot(sum, e)) < 0.25 * dot(sum, e));
                // A box face-on: 1 to 1.3 in the literature; four cells across are coarse.
                CHECK(report.directions[d].drag_coefficient > 0.8);
                CHECK(report.directions[d].drag_coefficient < 1.8);
            }
            CHECK(map->facts.quantisation_error < 0.004f);
            CHECK(map->shape.volume == Approx(0.024).epsilon(1e-4));
        }
        CHECK(file == first);
    }
}

TEST_CASE("a bake can be cancelled", "[bake]") {
    const BakeOptions options = small_bake();
    BakePlan plan = plan_bake(options);
    BakeReport report;
    CHECK_THROWS_AS(bake::bake(
                        plan, [](double share, const std::string&) { return share < 0.05; }, report),
                    FlowCancelled);
}

TEST_CASE("options that cannot be are named", "[bake]") {
    const auto text_of = [](const BakeOptions& o) -> std::string {
        try {
            plan_bake(o);
        } catch (const BakeError& error) {
            return error.what();
        }
        return "";
    };
    BakeOptions o = small_bake();
    o.directions = 7;
    CHECK(text_of(o).find("--directions 7") != std::string::npos);
    o = small_bake();
    o.sources = 5000;
    CHECK(text_of(o).find("--sources 5000") != std::string::npos);
    o = small_bake();
    o.mesh = "/nowhere/mesh.glb";
    CHECK(text_of(o).find("/nowhere/mesh.glb") == 0);
    CHECK(frequency_of(18) == 2);
    CHECK(frequency_of(26) == 0);
}

TEST_CASE("a map from a formula drags along the stream", "[bake]") {
    const Map map = formula_map(test::box({0.1, 0.2, 0.3}), 6, 2, 16);
    for (std::uint32_t d = 0; d < map.directions.count(); ++d) {
        Vec3d sum;
        for (std::uint32_t l = 0; l < 6; ++l) sum += Vec3d(map.mean[d * 6 + l].pressure);
        CHECK(dot(sum, map.directions.direction(d)) > 0);
    }
}
