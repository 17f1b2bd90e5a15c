// From forces to a map: what rounding costs, and the raw tables that tell it.
#include <cmath>
#include <cstring>
#include <random>

#include "bake/map/raw.h"
#include "core/error.h"
#include "core/map/codec.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using namespace frm::bake;

namespace {

const Surface& surface() {
    static const Surface box = test::fine_box({0.2, 0.1, 0.3}, 0.1);
    return box;
}

/// The error of the whole force, worked out from a decoded file, source by source in double precision.
double error_found_otherwise(const Map& map, const Tables& tables, double peak) {
    const std::size_t sources = map.sources.size(), cells = map.directions.count() * sources;
    double mean = 0, fluctuation = 0;
    for (std::size_t k = 0; k < map.speeds.size(); ++k) {
        const double r = static_cast<double>(map.facts.base_speed) / static_cast<double>(map.speeds[k]);
        for (std::size_t d = 0; d < map.directions.count(); ++d) {
            Vec3d sum;
            for (std::size_t l = 0; l < sources; ++l) {
                const std::size_t at = k * cells + d * sources + l;
                sum += Vec3d(map.mean[at].pressure) - Vec3d(tables.mean[at].pressure) * (r * r) +
                       Vec3d(map.mean[at].friction) - Vec3d(tables.mean[at].friction) * r;
            }
            mean = std::max(mean, length(sum));
        }
    }
    for (std::size_t d = 0; d < map.step.size(); ++d) {
        for (std::size_t s = 0; s < map.samples; ++s) {
            Vec3d sum;
            for (std::size_t l = 0; l < sources; ++l) {
                const std::size_t at = (l * map.samples + s) * 6;
                for (int c = 0; c < 6; ++c)
                    sum[c % 3] +=
                        static_cast<double>(map.step[d]) *
                            map.fluctuation[d * sources * map.samples * 6 + at + static_cast<std::size_t>(c)] -
                        static_cast<double>(tables.fluctuation[d][at + static_cast<std::size_t>(c)]);
            }
            fluctuation = std::max(fluctuation, length(sum));
        }
    }
    return (mean + fluctuation) / peak;
}

double peak_of(const Map& map, const Tables& tables) {
    // formula_map's fluctuation is a tenth of the mean: the peak is at a baked direction's crest.
    const std::size_t sources = map.sources.size();
    double peak = 0;
    for (std::uint32_t d = 0; d < map.fluctuation_directions.count(); ++d) {
        const DirectionWeights e = map.directions.interpolate(Vec3f(map.fluctuation_directions.direction(d)));
        for (std::size_t s = 0; s < map.samples; ++s) {
            Vec3d sum;
            for (std::size_t l = 0; l < sources; ++l) {
                for (int k = 0; k < 3; ++k) {
                    const SourceForce& f = tables.mean[(map.base * map.directions.count() + e.index[k]) * sources + l];
                    sum += (Vec3d(f.pressure) + Vec3d(f.friction)) * static_cast<double>(e.weight[k]);
                }
                for (std::size_t c = 0; c < 6; ++c)
                    sum[static_cast<int>(c % 3)] +=
                        static_cast<double>(tables.fluctuation[d][(l * map.samples + s) * 6 + c]);
            }
            peak = std::max(peak, length(sum));
        }
    }
    for (std::size_t d = 0; d < map.directions.count(); ++d) {
        Vec3d sum;
        for (std::size_t l = 0; l < sources; ++l) {
            const SourceForce& f = tables.mean[(map.base * map.directions.count() + d) * sources + l];
            sum += Vec3d(f.pressure) + Vec3d(f.friction);
        }
        peak = std::max(peak, length(sum));
    }
    return peak;
}

}  // namespace

TEST_CASE("the error that a map states is the one that it has, and within the budget", "[tables]") {
    for (const double budget : {1e-2, 1e-3, 1e-4}) {
        Tables tables;
        const Map filled = test::full_map(surface(), 8, 16, budget, &tables);
        const std::vector<std::uint8_t> file = encode_map(filled);
        Map map;
        decode_map(file.data(), file.size(), map);
        const double stated = static_cast<double>(map.facts.quantisation_error);
        CHECK(stated <= budget * 1.0001);
        CHECK(stated > 0.05 * budget);
        CHECK(stated == Approx(error_found_otherwise(map, tables, peak_of(map, tables))).epsilon(1e-3));
        CHECK(rounding_error(map, tables) <= stated);
    }
}

TEST_CASE("a coarser budget makes a smaller file", "[tables]") {
    CHECK(encode_map(test::full_map(surface(), 8, 16, 1e-2)).size() <
          encode_map(test::full_map(surface(), 8, 16, 1e-4)).size());
}

TEST_CASE("tables that do not fit are refused by name", "[tables]") {
    Tables tables;
    Map map = test::full_map(surface(), 8, 16, 1e-3, &tables);
    const auto text_of = [&](const Tables& t) -> std::string {
        try {
            fill_tables(map, t, 1e-3);
        } catch (const Error& error) {
            return error.text();
        }
        return "";
    };
    Tables other = tables;
    other.mean.pop_back();
    CHECK(text_of(other).find("the means do not match") != std::string::npos);
    other = tables;
    other.fluctuation.pop_back();
    CHECK(text_of(other).find("the fluctuations do not match") != std::string::npos);
    other = tables;
    other.fluctuation[3].pop_back();
    CHECK(text_of(other).find("a fluctuation does not match") != std::string::npos);
    other = tables;
    other.fluctuation[3][5] = std::nanf("");
    CHECK(text_of(other).find("a fluctuation is not finite") != std::string::npos);
    other = tables;
    other.mean[5].friction.z = INFINITY;
    CHECK(text_of(other).find("a mean is not finite") != std::string::npos);
}

TEST_CASE("no force at all is a map too", "[tables]") {
    Tables tables;
    Map map = test::full_map(surface(), 8, 16, 1e-3, &tables);
    for (SourceForce& f : tables.mean) f = {};
    for (Fluctuation& f : tables.fluctuation) std::fill(f.begin(), f.end(), 0.0f);
    fill_tables(map, tables, 1e-3);
    map.complete();
    CHECK(map.facts.quantisation_error == 0);
    const std::vector<std::uint8_t> file = encode_map(map);
    Map again;
    decode_map(file.data(), file.size(), again);
    CHECK(again.mean[7].pressure == Vec3f());
}

TEST_CASE("raw tables come back from their file, and tell another map's", "[tables]") {
    Tables tables;
    const Map map = test::full_map(surface(), 8, 16, 1e-3, &tables);
    const std::vector<std::uint8_t> file = encode_raw(map, tables);
    const Tables back = decode_raw(file.data(), file.size(), map);
    REQUIRE(back.mean.size() == tables.mean.size());
    CHECK(std::memcmp(back.mean.data(), tables.mean.data(), back.mean.size() * sizeof back.mean[0]) == 0);
    CHECK(back.fluctuation == tables.fluctuation);
    // The same tables, rounded otherwise, are of the same raw file.
    const Map coarser = test::full_map(surface(), 8, 16, 1e-2);
    CHECK(rounding_error(coarser, decode_raw(file.data(), file.size(), coarser)) <=
          static_cast<double>(coarser.facts.quantisation_error));
    CHECK(rounding_error(coarser, back) > static_cast<double>(map.facts.quantisation_error));

    const auto status_of = [](const std::vector<std::uint8_t>& bytes, const Map& of) {
        try {
            decode_raw(bytes.data(), bytes.size(), of);
        } catch (const Error& error) {
            return error.status();
        }
        return FRM_OK + 0;
    };
    CHECK(status_of(file, test::full_map(surface(), 9, 16)) == FRM_ERROR_ARGUMENT);
    CHECK(status_of(file, test::full_map(test::fine_box({0.2, 0.1, 0.31}, 0.1), 8, 16)) == FRM_ERROR_ARGUMENT);
    std::vector<std::uint8_t> newer = file;
    newer[8] = 2;
    CHECK(status_of(newer, map) == FRM_ERROR_VERSION);
    // A changed bit is noticed, or it is one that says nothing in a zstd frame.
    std::mt19937 random(9);
    int noticed = 0, all = 0;
    for (std::size_t i = 0; i < file.size(); i += i < 64 ? 1 : 97) {
        std::vector<std::uint8_t> other = file;
        other[i] = static_cast<std::uint8_t>(other[i] ^ (1u << (random() % 8)));
        INFO("byte " << i);
        ++all;
        if (status_of(other, map) != FRM_OK)
            ++noticed;
        else
            REQUIRE(decode_raw(other.data(), other.size(), map).fluctuation == tables.fluctuation);
    }
    CHECK(noticed > 0.9 * all);
    for (std::size_t size = 0; size < file.size(); size += 211)
        REQUIRE(status_of({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)}, map) == FRM_ERROR_CORRUPT);
}
