#include "cli/problem_file.h"

#include <filesystem>
#include <fstream>

#include "bake/mesh/problem.h"
#include "cli/file.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

// The generator stands in the JSON at the file's beginning.
bool is_problem_file(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(256, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head.compare(0, 4, "glTF") == 0 && head.find(bake::kProblemGenerator) != std::string::npos;
}

// The first name that is free or has an older problem file; never that of an output, which stays as it was.
fs::path free_name(const std::string& mesh, const std::string& out) {
    const fs::path folder = fs::path(out).parent_path();
    const std::string stem = fs::path(mesh).stem().string();
    for (int i = 1; i <= 9; ++i) {
        fs::path path = folder / (stem + ".problem" + (i > 1 ? "-" + std::to_string(i) : "") + ".glb");
        const bool is_output = !out.empty() && path.lexically_normal() == fs::path(out).lexically_normal();
        const fs::file_status status = fs::symlink_status(path);
        if (!is_output && (!fs::exists(status) || (fs::is_regular_file(status) && is_problem_file(path)))) return path;
    }
    throw Failure("there are files " + stem + ".problem.glb to " + stem + ".problem-9.glb already");
}

}  // namespace

std::string write_problem_file(const bake::MeshError& error, const std::string& mesh, const std::string& out) {
    try {
        const fs::path path = free_name(mesh, out);
        write_file(path.string(), bake::problem_glb(error));
        return "; the place is marked red in " + path.string();
    } catch (const std::exception& e) {
        return std::string("; no file with the place marked could be written: ") + e.what();
    }
}

}  // namespace frm::cli
