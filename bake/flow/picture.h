// Slices through the flow, for a person to look at.
#pragma once

#include <vector>

#include "bake/flow/domain.h"
#include "bake/flow/flow.h"
#include "bake/flow/nest.h"

namespace frm::bake::flow {

class Picture {
public:
    explicit Picture(const Domain& domain);

    /// Adds the flow as it is now to the means.
    void add(const Nest& nest);
    /// Means of all that was added; empty if nothing was.
    std::vector<FlowSlice> slices() const;

private:
    Vec3d point(const FlowSlice& slice, std::uint32_t row, std::uint32_t column) const;

    const Domain& domain_;
    std::vector<FlowSlice> sums_;
    unsigned count_ = 0;
};

}  // namespace frm::bake::flow
