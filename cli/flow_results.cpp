#include "cli/flow_results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "bake/series/spectrum.h"

namespace frm::cli {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
// Lift that swings by less than this share of the drag is the solver's own noise, not shedding.
constexpr double least_swing = 0.005;
constexpr double least_cycles = 4;

Vec3d sum_of(const std::vector<float>& values, std::size_t sample, std::size_t regions) {
    Vec3d sum;
    for (std::size_t i = sample * regions * 3; i < (sample + 1) * regions * 3; ++i)
        sum[static_cast<int>(i % 3)] += static_cast<double>(values[i]);
    return sum;
}

Vec3d force_at(const bake::FlowSeries& flow, std::size_t sample) {
    return sum_of(flow.pressure, sample, flow.regions) + sum_of(flow.friction, sample, flow.regions);
}

/// The direction across the stream in which the force swings most, by power iteration on its covariance.
Vec3d swing(const std::vector<Vec3d>& lift) {
    Vec3d axis(0.4, 0.5, 0.6);
    for (int i = 0; i < 50; ++i) {
        Vec3d next;
        for (const Vec3d& v : lift) next += v * dot(v, axis);
        const double size = length(next);
        if (!(size > 0)) return {0, 0, 0};
        axis = next / size;
    }
    return axis;
}

double largest_radius(const bake::Surface& surface, const Vec3d& centre, const Vec3d& axis) {
    double square = 0;
    for (const Vec3d& v : surface.vertices) {
        const Vec3d arm = v - centre - axis * dot(v - centre, axis);
        square = std::max(square, dot(arm, arm));
    }
    return std::sqrt(square);
}

void measure_lift(const bake::FlowSeries& flow, const std::vector<Vec3d>& lift, double drag, double unit,
                  FlowResults& r) {
    r.lift_axis = swing(lift);
    std::vector<float> signal;
    double square = 0, along = 0;
    for (const Vec3d& v : lift) {
        const double value = dot(v, r.lift_axis);
        signal.push_back(static_cast<float>(value));
        square += dot(v, v) / flow.samples;
        along += value * value / flow.samples;
    }
    r.cl_rms = std::sqrt(square) / unit;
    r.cl_amplitude = std::sqrt(2 * along) / unit;
    const bake::Peak peak = bake::strongest_peak(signal, flow.interval);
    // A frequency wants some cycles: one or two are a drift.
    const bool cycles = peak.frequency * flow.interval * flow.samples >= least_cycles;
    if (cycles && peak.amplitude > least_swing * std::fabs(drag)) r.strouhal = peak.frequency * r.length / r.speed;
}

nlohmann::ordered_json parts_of(const bake::FlowUncertainty& u) {
    return {{"grid", u.grid < 0 ? none : u.grid}, {"statistics", u.statistics}, {"blockage", u.blockage}};
}

}  // namespace

double length_of(const bake::FlowCase& c, const bake::FlowPlan& plan, double length) {
    return length > 0 ? length : c.section ? plan.reference_length : std::sqrt(plan.projected_area);
}

FlowResults evaluate(const bake::Surface& surface, const bake::FlowCase& c, const bake::FlowSeries& flow,
                     double length) {
    FlowResults r;
    const bake::FlowPlan& plan = flow.plan;
    r.length = length_of(c, plan, length);
    r.speed = plan.reynolds * c.viscosity / plan.reference_length;
    r.reynolds = plan.reynolds * r.length / plan.reference_length;
    r.reynolds_solved = plan.reynolds_solved * r.length / plan.reference_length;
    r.travelled = flow.samples * flow.interval * r.speed / plan.reference_length;
    r.longest = c.duration;
    r.cd = r.cd_coarse = r.cl = r.cl_rms = r.cl_amplitude = r.strouhal = r.torque_coefficient = none;

    std::vector<Vec3d> force(flow.samples);
    for (std::size_t s = 0; s < flow.samples; ++s) {
        force[s] = force_at(flow, s);
        r.force_mean += force[s] / static_cast<double>(flow.samples);
        r.torque_mean += sum_of(flow.torque, s, 1) / static_cast<double>(flow.samples);
    }
    std::vector<Vec3d> lift(flow.samples);
    Vec3d square;
    for (std::size_t s = 0; s < flow.samples; ++s) {
        const Vec3d change = force[s] - r.force_mean;
        for (int k = 0; k < 3; ++k) square[k] += change[k] * change[k] / flow.samples;
        lift[s] = change - c.direction * dot(change, c.direction);
    }
    for (int k = 0; k < 3; ++k) r.force_rms[k] = std::sqrt(square[k]);

    if (c.speed > 0) {
        const double unit = 0.5 * c.density * c.speed * c.speed * plan.projected_area;
        const double drag = dot(r.force_mean, c.direction);
        r.cd = drag / unit;
        if (flow.coarse_drag != 0) r.cd_coarse = flow.coarse_drag / unit;
        r.cl = frm::length(r.force_mean - c.direction * drag) / unit;
        measure_lift(flow, lift, drag, unit, r);
    }
    const double rate = frm::length(c.spin);
    if (rate > 0) {
        const Vec3d axis = c.spin / rate;
        const double torque = dot(r.torque_mean - cross(c.spin_centre, r.force_mean), axis);
        const double radius = largest_radius(surface, c.spin_centre, axis);
        r.torque_coefficient =
            2 * std::fabs(torque) / (c.density * rate * rate * std::pow(radius, c.section ? 4 : 5) * c.section_span);
    }
    return r;
}

const char* word_for(bake::FlowEnding ending) {
    switch (ending) {
        case bake::FlowEnding::confidence:
            return "confidence";
        case bake::FlowEnding::seconds:
            return "seconds";
        case bake::FlowEnding::cancelled:
            return "cancelled";
        default:
            return "duration";
    }
}

nlohmann::ordered_json json_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json json_of(const bake::FlowSeries& flow, const FlowResults& r) {
    const bake::FlowPlan& plan = flow.plan;
    nlohmann::ordered_json j;
    j["force_mean"] = json_of(r.force_mean);
    j["force_rms"] = json_of(r.force_rms);
    j["torque_mean"] = json_of(r.torque_mean);
    j["area"] = plan.projected_area;
    j["length"] = r.length;
    j["reynolds"] = r.reynolds;
    j["reynolds_solved"] = r.reynolds_solved;
    j["cd"] = r.cd;
    j["cd_coarse"] = r.cd_coarse;
    j["cl"] = r.cl;
    j["cl_rms"] = r.cl_rms;
    j["cl_amplitude"] = r.cl_amplitude;
    j["strouhal"] = r.strouhal;
    j["torque_coefficient"] = r.torque_coefficient;
    j["uncertainty"] = flow.uncertainty.total();
    j["uncertainty_parts"] = parts_of(flow.uncertainty);
    j["ending"] = word_for(flow.ending);
    j["half_resolution"] = flow.half;
    j["samples"] = flow.samples;
    j["interval"] = flow.interval;
    j["blockage"] = plan.blockage;
    j["bytes"] = plan.bytes;
    j["blocks"] = nlohmann::ordered_json::array();
    for (const bake::FlowBlock& block : plan.blocks)
        j["blocks"].push_back(
            {{"low", json_of(block.low)}, {"high", json_of(block.high)}, {"cell", block.cell}, {"cells", block.cells}});
    j["cells"] = plan.cells;
    j["steps"] = flow.steps;
    j["mlups"] = flow.mlups;
    j["seconds"] = flow.seconds;
    return j;
}

std::string csv_of(const bake::FlowSeries& flow) {
    std::string text =
        "time,fx,fy,fz,fx_pressure,fy_pressure,fz_pressure,fx_friction,fy_friction,fz_friction,tx,ty,tz\n";
    for (std::size_t s = 0; s < flow.samples; ++s) {
        const Vec3d total = force_at(flow, s), pressure = sum_of(flow.pressure, s, flow.regions);
        const Vec3d friction = total - pressure, torque = sum_of(flow.torque, s, 1);
        char line[320];
        std::snprintf(line, sizeof line, "%.9g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g\n",
                      static_cast<double>(s) * flow.interval, total.x, total.y, total.z, pressure.x, pressure.y,
                      pressure.z, friction.x, friction.y, friction.z, torque.x, torque.y, torque.z);
        text += line;
    }
    return text;
}

}  // namespace frm::cli
