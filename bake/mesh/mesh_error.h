// A refusal of a shape that knows the place: problem.h draws it over the surface.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bake/error.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// Places on a surface, in metres, in the mesh file's frame.
struct Marks {
    std::vector<Vec3d> points;
    std::vector<std::array<Vec3d, 2>> edges;
    std::vector<std::array<Vec3d, 3>> triangles;
};

class MeshError : public BakeError {
public:
    /// `text` names the file, what is wrong, where, and what to do.
    MeshError(const std::string& text, const Surface& surface, Marks marks)
        : BakeError(text), detail_(std::make_shared<const Detail>(Detail{surface, std::move(marks)})) {}

    const Surface& surface() const { return detail_->surface; }  ///< as the file has it
    const Marks& marks() const { return detail_->marks; }

private:
    struct Detail {
        Surface surface;
        Marks marks;
    };
    std::shared_ptr<const Detail> detail_;  // an exception is copied as it is passed on
};

}  // namespace frm::bake
