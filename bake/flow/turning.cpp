#include "bake/flow/turning.h"

namespace frm::bake::flow {

void to_middle(const Turning& turning, const Line& cells, std::size_t count, float* ux, float* uy) {
    for (std::size_t n = 0; n < count; ++n) {
        const float at = static_cast<float>(n);
        const Turning::Kick kick = turning.kick(ux[n], uy[n], cells.x + at * cells.step_x, cells.y + at * cells.step_y);
        ux[n] += 0.5f * kick.x;
        uy[n] += 0.5f * kick.y;
    }
}

void from_middle(const Turning& turning, const Line& cells, std::size_t count, float* ux, float* uy) {
    for (std::size_t n = 0; n < count; ++n) {
        const float at = static_cast<float>(n), x = cells.x + at * cells.step_x, y = cells.y + at * cells.step_y;
        const float gain_x = turning.gain_x(uy[n], x, y), gain_y = turning.gain_y(ux[n], x, y);
        ux[n] += 0.5f * gain_x;
        uy[n] += 0.5f * gain_y;
    }
}

}  // namespace frm::bake::flow
