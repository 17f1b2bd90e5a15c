// Writes the maps that the tests of the interface, the binding and the program use: FILE, from a formula, with added
// mass; and with a second argument, STEM.frm, which has all that a map can have, and STEM.frmraw, its unrounded tables; and
// with a third, MANY, a rounded body of many sources that has all of it too (tests/data/many.frm).
#include <cstdio>
#include <string>

#include "bake/map/raw.h"
#include "core/map/codec.h"
#include "tests/support/worlds.h"

namespace {

bool write(const std::string& path, const std::vector<std::uint8_t>& bytes) {
    std::FILE* out = std::fopen(path.c_str(), "wb");
    const bool good = out && std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
    return out && std::fclose(out) == 0 && good;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 4) return 2;
    using namespace frm;
    const bake::Surface box = test::fine_box({0.2, 0.04, 0.3}, 0.06);
    bake::Tables tables;
    const Map full = test::full_map(box, 8, 16, 3e-3, &tables);
    Map map = bake::formula_map(box, 12, 2, 32);
    map.has_added_mass = true;
    map.added_mass = full.added_mass;
    map.complete();
    bool good = write(argv[1], encode_map(map));
    if (argc >= 3) {
        const std::string stem = argv[2];
        good =
            write(stem + ".frm", encode_map(full)) && write(stem + ".frmraw", bake::encode_raw(full, tables)) && good;
    }
    if (argc == 4) {
        bake::Surface egg = test::icosphere(1, 3);
        for (Vec3d& v : egg.vertices) v = {0.11 * v.x + 0.01 * v.y, 0.05 * v.y, 0.16 * v.z + 0.02 * v.x};
        Map many = test::full_map(egg, 150, 8, 3e-3);
        // A third of the sources are steady, as in a map of a flow they may be.
        const std::size_t all = many.source_count(), each = many.samples * Map::components;
        for (std::size_t i = 0; i < many.fluctuation.size(); ++i)
            if (i / each % all >= all * 2 / 3) many.fluctuation[i] = 0;
        many.complete();
        good = write(argv[3], encode_map(many)) && good;
    }
    return good ? 0 : 1;
}
