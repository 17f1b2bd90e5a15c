#include "device/spidar_g/spidar_g.h"

#include <chrono>
#include <cmath>

namespace frm::spidar_g {
namespace {

std::uint32_t fault_of(Carried carried) {
    switch (carried) {
        case Carried::cut_off:
            return FRM_DEVICE_FAULT_SHORT_PACKET;
        case Carried::too_late:
            return FRM_DEVICE_FAULT_TIMEOUT;
        case Carried::refused:
            return FRM_DEVICE_FAULT_TRANSFER;
        case Carried::unplugged:
            return FRM_DEVICE_FAULT_UNPLUGGED;
        case Carried::whole:
            break;
    }
    return 0;
}

}  // namespace

std::uint64_t steady_now_ns() {
    using namespace std::chrono;
    return static_cast<std::uint64_t>(duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count());
}

SpidarG::SpidarG(Configuration configuration, std::unique_ptr<Transport> transport)
    : configuration_(std::move(configuration)),
      transport_(std::move(transport)),
      amplifier_(make_amplifier(configuration_.amplifier)),
      counters_(amplifier_->counter_range()),
      solver_(configuration_.limits),
      filter_(configuration_.velocity_window) {
    string_rows(configuration_.geometry, {}, rows_);
    reference_ = rows_.length;
}

bool SpidarG::begin() {
    transport_->recover();
    const Request opening = amplifier_->opening();
    if (opening.count > 0 && transport_->send(opening) != Carried::whole) return false;
    amplifier_->request({}, request_);
    if (transport_->cycle(request_, amplifier_->reply_size(), reply_) != Carried::whole) return false;
    amplifier_->read(reply_.bytes.data(), reading_);
    last_ns_ = transport_->now_ns();
    return true;
}

Digits SpidarG::digits_for(const Tensions& tensions, Tensions& told) const {
    Digits out{};
    for (std::size_t i = 0; i < string_count; ++i) {
        const double digits_per_newton = configuration_.motors[i].volts_per_newton * configuration_.digits_per_volt;
        if (broken_ >> i & 1u) {
            told[i] = 0;
            continue;
        }
        // Rounded to the nearest digit that is within the limits.
        const double low = std::ceil(configuration_.limits.low[i] * digits_per_newton);
        const double high = std::floor(configuration_.limits.high[i] * digits_per_newton);
        double digit = std::floor(tensions[i] * digits_per_newton + 0.5);
        if (!(digit > low)) digit = low;
        if (digit > high) digit = high;
        out[i] = static_cast<std::int16_t>(digit);
        told[i] = digit / digits_per_newton;
    }
    return out;
}

bool SpidarG::cycle(const Tensions& tensions, GripWrench* achieved) {
    if (state_.faults & FRM_DEVICE_FAULT_UNPLUGGED) return false;
    Tensions told{};
    amplifier_->request(digits_for(tensions, told), request_);
    if (achieved && calibrated_) *achieved = wrench_of(rows_, told, configuration_.geometry.lever);
    const Carried carried = transport_->cycle(request_, amplifier_->reply_size(), reply_);
    state_.time_ns = transport_->now_ns();
    if (carried != Carried::whole) {
        state_.faults |= fault_of(carried);
        return false;
    }
    amplifier_->read(reply_.bytes.data(), reading_);
    state_.buttons = reading_.pio & configuration_.button_mask;
    took(state_.time_ns);
    return true;
}

/// What a reply says of the grip.
void SpidarG::took(std::uint64_t now) {
    const double dt = static_cast<double>(now - last_ns_) * 1e-9;
    last_ns_ = now;
    if (!calibrated_) return;
    const auto& counts = counters_.add(reading_.counts);
    Lengths lengths;
    double unseen = 1e300;  // how far a string may go before its count says nothing
    for (std::size_t i = 0; i < string_count; ++i) {
        const double pulse = configuration_.motors[i].metres_per_pulse;
        lengths[i] = reference_[i] + static_cast<double>(counts[i]) * pulse;
        unseen = std::fmin(unseen, std::fabs(pulse) * static_cast<double>(amplifier_->counter_range()) / 2);
    }
    if (dt * configuration_.checks.string_speed > unseen) {
        state_.faults |= FRM_DEVICE_FAULT_LOST_COUNT;
        calibrated_ = false;
        return;
    }
    const PoseFit fit = fit_pose(configuration_.geometry, lengths, state_.pose);
    look_for_faults(fit, lengths, dt);
    if (fit.converged) {
        state_.pose = fit.pose;
        rows_ = fit.rows;
        // Two cycles in quick succession, after a pause, must not make a velocity out of one count.
        const double shortest = static_cast<double>(configuration_.period_ns) * 1e-10;
        state_.twist = filter_.add(state_.pose, std::fmax(dt, shortest));
    } else {
        state_.twist = {};
        filter_.reset();
    }
}

/// Which fault explains a residual. Eight lengths for six unknowns name the wrong string but for a partner that would
/// explain as much; of those the one is taken that has gone further since all was well.
std::uint32_t SpidarG::name_fault(const PoseFit& fit, const Lengths& lengths, double worst) {
    constexpr int still_cycles = 4;
    int moved = 0;
    for (std::size_t i = 0; i < string_count; ++i)
        moved += std::fabs(lengths[i] - well_[i]) > configuration_.checks.residual / 4;
    double furthest = -1;
    std::size_t suspect = 0;
    for (std::size_t i = 0; i < string_count; ++i) {
        if (std::fabs(fit.normalised_residual[i]) < 0.9 * worst) continue;
        // Where the grip moves, most strings do.
        if (still_[i] >= still_cycles && moved >= 4) return FRM_DEVICE_FAULT_STUCK_ENCODER;
        if (std::fabs(lengths[i] - well_[i]) > furthest) {
            furthest = std::fabs(lengths[i] - well_[i]);
            suspect = i;
        }
    }
    if (fit.normalised_residual[suspect] > 0) return FRM_DEVICE_FAULT_SLACK_STRING;
    broken_ |= 1u << suspect;
    return FRM_DEVICE_FAULT_BROKEN_STRING;
}

void SpidarG::look_for_faults(const PoseFit& fit, const Lengths& lengths, double dt) {
    const Checks& checks = configuration_.checks;
    std::uint32_t now = 0;
    for (std::size_t i = 0; i < string_count; ++i) {
        const double step = std::fabs(lengths[i] - lengths_[i]);
        still_[i] = step > 0 ? 0 : still_[i] + 1;
        if (dt > 0 && step > checks.string_speed * dt && step > checks.residual) {
            now |= FRM_DEVICE_FAULT_BROKEN_STRING;
            broken_ |= 1u << i;
        }
    }
    lengths_ = lengths;
    if (!fit.converged) now |= FRM_DEVICE_FAULT_BROKEN_STRING;
    double worst = 0;
    for (const double r : fit.normalised_residual) worst = std::fmax(worst, std::fabs(r));
    if (worst < checks.residual / 2) well_ = lengths;
    if (fit.converged && now == 0 && worst > checks.residual) now |= name_fault(fit, lengths, worst);
    // A slack string is wound up by its least tension and all is well again; the others stay until calibration.
    if (!(now & FRM_DEVICE_FAULT_SLACK_STRING) && (state_.faults & FRM_DEVICE_FAULT_SLACK_STRING)) {
        if (fit.converged && worst < checks.residual / 2)
            state_.faults &= ~static_cast<std::uint32_t>(FRM_DEVICE_FAULT_SLACK_STRING);
    }
    state_.faults |= now;
}

Tensions SpidarG::chosen(const GripWrench& wrench) {
    if (!displays()) return configuration_.limits.low;
    // The tensions hold for the cycle after the lengths were read, in which the strings turn by 1 % at 1 m/s: they are
    // for the middle of it.
    const double step = static_cast<double>(configuration_.period_ns) * 1e-9;
    const GripPose ahead{state_.pose.position + state_.twist.linear * (step / 2),
                         turned(state_.pose.rotation, state_.twist.angular * (step / 2))};
    StringRows rows;
    if (string_rows(configuration_.geometry, ahead, rows)) rows_ = rows;
    return solver_.solve(rows_, wrench, configuration_.geometry.lever).tensions;
}

GripState SpidarG::exchange(const GripWrench& wrench) {
    state_.achieved = {};
    cycle(chosen(wrench), &state_.achieved);
    GripState out = state_;
    if (!displays()) out.twist = {};
    if (!calibrated_) out.faults |= FRM_DEVICE_FAULT_UNCALIBRATED;
    return out;
}

bool SpidarG::calibrate() {
    if (state_.faults & FRM_DEVICE_FAULT_UNPLUGGED) return false;
    if (state_.faults != 0) transport_->recover();
    calibrated_ = false;
    broken_ = 0;
    state_ = {};
    state_.faults = 0;
    solver_.reset();
    filter_.reset();
    if (!cycle(configuration_.limits.low, nullptr)) return false;
    counters_.reset();
    counters_.add(reading_.counts);
    string_rows(configuration_.geometry, {}, rows_);
    lengths_ = reference_;
    well_ = reference_;
    still_ = {};
    calibrated_ = true;
    filter_.add({}, 0);
    return true;
}

void SpidarG::stop() {
    solver_.reset();
    cycle(configuration_.limits.low, nullptr);
}

}  // namespace frm::spidar_g
