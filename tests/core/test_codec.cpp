#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/error.h"
#include "core/map/codec.h"
#include "core/math/hash.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

/// Every chunk that there is.
const std::vector<std::uint8_t>& sample_file() {
    static const std::vector<std::uint8_t> file =
        encode_map(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 8));
    return file;
}

std::vector<std::uint8_t> golden(const char* name) {
    std::ifstream in(std::filesystem::path(FRM_TEST_DATA) / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

frm_status status_of(const std::vector<std::uint8_t>& file, std::string* text = nullptr) {
    Map map;
    try {
        decode_map(file.data(), file.size(), map);
        return FRM_OK;
    } catch (const Error& error) {
        if (text) *text = error.text();
        return error.status();
    }
}

/// Makes the header fit what was changed behind it, as someone who means harm would.
void mend_header(std::vector<std::uint8_t>& file) {
    const std::uint64_t hash = fnv1a(file.data() + format::header_bytes, file.size() - format::header_bytes),
                        size = file.size();
    for (int i = 0; i < 8; ++i) {
        file[16 + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(hash >> (8 * i));
        file[24 + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(size >> (8 * i));
    }
}

}  // namespace

TEST_CASE("a map comes back from its file as it was", "[codec]") {
    const auto original = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 2, 16);
    const std::vector<std::uint8_t> file = encode_map(*original);
    Map map;
    decode_map(file.data(), file.size(), map);
    CHECK(map.vertices == original->vertices);
    CHECK(map.triangles == original->triangles);
    CHECK(map.region_begin == original->region_begin);
    CHECK(map.step == original->step);
    CHECK(map.fluctuation == original->fluctuation);
    CHECK(map.directions.count() == original->directions.count());
    CHECK(map.provenance == original->provenance);
    CHECK(std::memcmp(map.mean.data(), original->mean.data(), map.mean.size() * sizeof map.mean[0]) == 0);
    CHECK(std::memcmp(&map.facts, &original->facts, sizeof map.facts) == 0);
    CHECK(encode_map(map) == file);
    CHECK(std::vector<std::uint8_t>(map.file.begin(), map.file.end()) == file);
    CHECK(map.shape.volume == Approx(0.006));
}

TEST_CASE("what is not in every map comes back too", "[codec]") {
    const Map original = test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.1));
    const std::vector<std::uint8_t> file = encode_map(original);
    Map map;
    decode_map(file.data(), file.size(), map);
    CHECK(map.format_version == 2);
    CHECK(map.directions.count() == 38);
    CHECK(map.fluctuation_directions.count() == 18);
    CHECK(map.speeds == original.speeds);
    CHECK(map.mean_step == original.mean_step);
    CHECK(std::memcmp(map.mean.data(), original.mean.data(), map.mean.size() * sizeof map.mean[0]) == 0);
    CHECK(map.fluctuation == original.fluctuation);
    CHECK(std::memcmp(&map.facts, &original.facts, sizeof map.facts) == 0);
    CHECK(map.spin.rate == original.spin.rate);
    CHECK(map.spin.centre == original.spin.centre);
    CHECK(std::memcmp(map.spin.force.data(), original.spin.force.data(),
                      original.spin.force.size() * sizeof map.spin.force[0]) == 0);
    CHECK(map.has_added_mass);
    CHECK(map.added_mass == original.added_mass);
    CHECK(map.log_speed == original.log_speed);
    CHECK(encode_map(map) == file);
}

TEST_CASE("a map of format version 1 is one of one speed and one set of directions", "[codec]") {
    const std::vector<std::uint8_t> file = golden("v1.frm");
    REQUIRE(!file.empty());
    Map map;
    decode_map(file.data(), file.size(), map);
    CHECK(map.format_version == 1);
    CHECK(map.one_direction_set());
    REQUIRE(map.speeds.size() == 1);
    CHECK(map.speeds[0] == map.facts.base_speed);
    CHECK(map.spin.rate == 0);
    CHECK(!map.has_added_mass);
    // Written anew, in the format of today, it is the same map.
    const std::vector<std::uint8_t> again = encode_map(map);
    Map second;
    decode_map(again.data(), again.size(), second);
    CHECK(second.format_version == 2);
    CHECK(std::memcmp(map.mean.data(), second.mean.data(), map.mean.size() * sizeof map.mean[0]) == 0);
    CHECK(map.fluctuation == second.fluctuation);
    CHECK(map.provenance == second.provenance);
}

TEST_CASE("a map of format version 1 that is damaged with a matching header does not crash", "[codec]") {
    const std::vector<std::uint8_t> file = golden("v1.frm");
    std::mt19937 random(8);
    int refused = 0;
    for (int i = 0; i < 500; ++i) {
        std::vector<std::uint8_t> other = file;
        other[format::header_bytes + random() % (other.size() - format::header_bytes)] =
            static_cast<std::uint8_t>(random());
        mend_header(other);
        refused += status_of(other) != FRM_OK;
    }
    CHECK(refused > 450);
}

TEST_CASE("what a map says together must fit", "[codec]") {
    const Map good = test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 8);
    const auto text_of = [&](auto&& change) {
        Map map = good;
        change(map);
        const std::vector<std::uint8_t> file = encode_map(map);
        std::string text;
        CHECK(status_of(file, &text) == FRM_ERROR_CORRUPT);
        return text;
    };
    const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
    CHECK(has(text_of([](Map& m) { m.speeds[2] = m.speeds[0]; }), "speeds are not positive and rising"));
    CHECK(has(text_of([](Map& m) { m.facts.base_speed *= 1.01f; }), "base speed is none of the speeds"));
    CHECK(has(text_of([](Map& m) { m.spin.rate = INFINITY; }), "spin's rate"));
    CHECK(has(text_of([](Map& m) { m.spin.centre.y = std::nanf(""); }), "spin's centre"));
    CHECK(has(text_of([](Map& m) { m.spin.force[7].friction.z = INFINITY; }), "spin table"));
    CHECK(has(text_of([](Map& m) { m.added_mass[8] = m.added_mass[13] = static_cast<double>(INFINITY); }),
              "added mass is not finite"));
    CHECK(has(text_of([](Map& m) { m.added_mass[35] = -1; }), "negative number on its diagonal"));
    CHECK(has(text_of([](Map& m) { m.facts.direction_error_worst = -1; }), "held-out"));
    CHECK(has(text_of([](Map& m) { m.facts.uncertainty = INFINITY; }), "uncertainty"));
    Map lopsided = good;
    lopsided.added_mass[1] += 1;
    CHECK_THROWS_AS(lopsided.complete(), Error);
}

TEST_CASE("a changed bit anywhere is noticed", "[codec]") {
    const std::vector<std::uint8_t> file = sample_file();
    std::mt19937 random(4);
    for (std::size_t i = 0; i < file.size(); i += i < 200 ? 1 : 37) {
        std::vector<std::uint8_t> other = file;
        other[i] = static_cast<std::uint8_t>(other[i] ^ (1u << (random() % 8)));
        INFO("byte " << i);
        REQUIRE(status_of(other) != FRM_OK);
    }
}

TEST_CASE("a cut-off or longer file is an error that says so", "[codec]") {
    const std::vector<std::uint8_t> file = sample_file();
    for (std::size_t size = 0; size < file.size(); size += 61)
        REQUIRE(status_of({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)}) == FRM_ERROR_CORRUPT);
    std::vector<std::uint8_t> longer = file;
    longer.push_back(0);
    std::string text;
    CHECK(status_of(longer, &text) == FRM_ERROR_CORRUPT);
    CHECK(text.find("cut off or has grown") != std::string::npos);
}

TEST_CASE("damage with a matching header does not crash", "[codec]") {
    const std::vector<std::uint8_t> file = sample_file();
    std::mt19937 random(5);
    int accepted = 0;
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::uint8_t> other = file;
        const int changes = 1 + static_cast<int>(random() % 3);
        for (int k = 0; k < changes; ++k)
            other[format::header_bytes + random() % (other.size() - format::header_bytes)] =
                static_cast<std::uint8_t>(random());
        if (i % 5 == 0) other.resize(format::header_bytes + random() % (other.size() - format::header_bytes));
        mend_header(other);
        accepted += status_of(other) == FRM_OK;
    }
    // Only the chunks' reserved fields and index of chunks that have none may change without notice.
    CHECK(accepted < 60);
}

TEST_CASE("another version is refused as such", "[codec]") {
    std::vector<std::uint8_t> file = sample_file();
    file[8] = 3;
    std::string text;
    CHECK(status_of(file, &text) == FRM_ERROR_VERSION);
    CHECK(text.find("version 3") != std::string::npos);
}

TEST_CASE("a chunk that is not known is passed over", "[codec]") {
    std::vector<std::uint8_t> file = sample_file();
    const std::uint8_t chunk[32] = {'X', 'T', 'R', 'A', 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 3};
    file.insert(file.end(), chunk, chunk + 32);
    file.insert(file.end(), {1, 2, 3});
    ++file[32];
    mend_header(file);
    CHECK(status_of(file) == FRM_OK);
}

TEST_CASE("the error of quantisation that the map states holds", "[codec]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 2, 16);
    CHECK(map->facts.quantisation_error > 0);
    CHECK(map->facts.quantisation_error <= 1e-4f);
}
