// What frm bake and frm bake plan take alike: the mesh, in which unit, and how finely it is to be baked.
#pragma once

#include <string>

#include "bake/bake.h"
#include "cli/command.h"

namespace frm::cli {

struct BakeArguments {
    bake::BakeOptions bake;
    std::string quality = "standard";
    bool has_scale = false, yes = false;
};

/// The options; MESH itself is `required` or not.
void add_bake_arguments(CLI::App& command, BakeArguments& a, bool required);

/// After parsing: what the words given come to.
void complete(const CLI::App& command, BakeArguments& a);

/// settle_size() of the mesh, unless --scale or --yes was given.
void settle_unit(BakeArguments& a);

/// plan_bake(). Where the shape is refused, a file beside `out` shows the place.
bake::BakePlan make_plan(const BakeArguments& a, const std::string& out);

/// A plan's notes and what it will take, on standard error.
void print_plan(const bake::BakePlan& plan);

/// Cell updates of all tasks, and the memory of the largest.
struct Cost {
    double updates = 0;
    std::uint64_t bytes = 0;
};
Cost cost_of(const bake::BakePlan& plan);

}  // namespace frm::cli
