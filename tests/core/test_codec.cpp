#include <cstring>
#include <random>

#include "core/error.h"
#include "core/map/codec.h"
#include "core/math/hash.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

std::vector<std::uint8_t> sample_file() {
    static const std::vector<std::uint8_t> file =
        encode_map(*test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 1, 16));
    return file;
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
    CHECK(accepted < 300);
}

TEST_CASE("another version is refused as such", "[codec]") {
    std::vector<std::uint8_t> file = sample_file();
    file[8] = 2;
    std::string text;
    CHECK(status_of(file, &text) == FRM_ERROR_VERSION);
    CHECK(text.find("version 2") != std::string::npos);
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
    CHECK(map->facts.quantisation_error < 2e-4f);
}
