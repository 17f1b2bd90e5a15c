// Writes the map that the tests of the interface, the binding and the program use.
#include <cstdio>

#include "bake/map/formula.h"
#include "bake/regions/tessellate.h"
#include "core/map/codec.h"
#include "tests/support/shapes.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const frm::bake::Surface box = frm::bake::tessellate(frm::test::box({0.2, 0.04, 0.3}), 0.06, 400).surface;
    const auto file = frm::encode_map(frm::bake::formula_map(box, 12, 2, 32));
    std::FILE* out = std::fopen(argv[1], "wb");
    const bool good = out && std::fwrite(file.data(), 1, file.size(), out) == file.size();
    return out && std::fclose(out) == 0 && good ? 0 : 1;
}
