// The library through its own header, with a context that ends with the test.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/map/codec.h"
#include "frm.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

namespace frm::test {

struct Library {
    Library() { REQUIRE(frm_context_create(nullptr, &context) == FRM_OK); }
    ~Library() { frm_context_destroy(context); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    std::string error() const {
        char text[512] = {};
        std::uint64_t size = 0;
        frm_context_last_error(context, text, sizeof text, &size);
        return text;
    }

    frm_map map() const {
        static const auto file = encode_map(*map_of(fine_box({0.2, 0.1, 0.3}, 0.1), 8, 1, 16));
        frm_map m = 0;
        REQUIRE(frm_map_open_memory(context, file.data(), file.size(), &m) == FRM_OK);
        return m;
    }

    frm_context context = 0;
};

/// A folder of its own for each test, gone afterwards.
struct Folder {
    Folder() {
        path = std::filesystem::temp_directory_path() /
               ("frm-test-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)));
        std::filesystem::create_directories(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string file(const char* name) const { return (path / name).string(); }

    std::filesystem::path path;
};

}  // namespace frm::test
