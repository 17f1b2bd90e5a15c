// The steps of a wave field, row by row.
#pragma once

#include "core/kernels/kernels.h"
#include "core/water/field.h"

namespace frm {

/// One call of Field::advance. A row's turn in a step: its own velocities u(r), the faces v(r + lead) above it, then its
/// heights, then the absorbing layer's part of what no later row needs as it was. It reads what the step before left up
/// to row r + lag - 1, so that a step can be `lag` rows behind the one before in one sweep over the rows.
class WaveStep {
public:
    WaveStep(Field& field, float dt, float gravity, const Push* pushes, std::size_t push_count);

    void one(std::uint32_t threads);
    /// All in one sweep.
    void together(std::uint32_t steps);

private:
    /// Faces (rows of v) that a range of rows moves itself, and those that it damps itself.
    struct Own {
        std::int32_t faces_end, damp_begin, damp_end;
    };

    std::int32_t lead() const { return fourth_ ? 2 : 1; }
    std::int32_t lag() const { return fourth_ ? 4 : 2; }

    void turn(std::int32_t r, const Own& own);
    void rows(std::int32_t first, std::int32_t end, const Own& own);
    void fetch(std::int32_t r, std::int32_t part, std::int32_t parts) const;
    void move(const Block& block, std::int32_t r, std::int32_t rows, bool with_faces, const WaveDamp* damp);
    void faces(std::int32_t m);
    void damp_row(const Block& block, std::int32_t r);
    void damp_faces(std::int32_t m);
    void damp(const Block& block, float* x, bool along, float across);
    const Block* block_of_faces(std::int32_t m) const;

    Field& field_;
    const Kernels& kernel_;
    const Push* pushes_;
    std::size_t push_count_;
    bool fourth_, damps_ = false;
    float slope_, divergence_, outflow_ = 0;
};

}  // namespace frm
