#include "device/spidar_g/amplifier.h"

#include "device/spidar_g/sh4.h"
#include "device/spidar_g/simple.h"

namespace frm::spidar_g {

std::unique_ptr<Amplifier> make_amplifier(AmplifierKind kind) {
    if (kind == AmplifierKind::sh4) return std::make_unique<Sh4>();
    return std::make_unique<Simple>();
}

const std::array<std::int64_t, string_count>& CounterExtension::add(const Counters& counts) {
    if (first_) {
        first_ = false;
        last_ = counts;
        total_ = {};
    }
    for (std::size_t i = 0; i < string_count; ++i) {
        std::int64_t step = (std::int64_t{counts[i]} - last_[i]) % range_;
        if (step >= range_ / 2) step -= range_;
        if (step < -range_ / 2) step += range_;
        total_[i] += step;
    }
    last_ = counts;
    return total_;
}

}  // namespace frm::spidar_g
