// What the series of a flow run says: means, coefficients, the frequency of the shedding; as JSON and as CSV.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bake/flow/flow.h"

namespace frm::cli {

/// NaN (null in JSON) where a number does not exist: coefficients of the stream where there is none, and so on.
struct FlowResults {
    Vec3d force_mean, force_rms, torque_mean;  ///< N, N m; of a section for a metre of span
    double length = 0;                         ///< of the Reynolds and Strouhal numbers, m
    double speed = 0;                          ///< of the stream, m/s; spin alone: of the body's fastest point
    double reynolds = 0, reynolds_solved = 0;
    double cd = 0, cd_coarse = 0;       ///< drag coefficient; cd_coarse: on half the resolution
    double cl = 0, cl_rms = 0;          ///< of the mean force across the stream; of all that swings across it
    double cl_amplitude = 0;            ///< of a sine with the rms of the lift along `lift_axis`
    double strouhal = 0;                ///< of the lift along `lift_axis`
    double torque_coefficient = 0;      ///< 2 T / (density w^2 a^5); of a section 2 T / (density w^2 a^4)
    Vec3d lift_axis;                    ///< unit; across the stream, where the force swings most; 0: it does not
    double travelled = 0, longest = 0;  ///< reference lengths of the solver, recorded and at most
};

/// `length`: of the Reynolds and Strouhal numbers; 0: the root of the projected area, of a section its extent across
/// the stream.
FlowResults evaluate(const bake::Surface& surface, const bake::FlowCase& flow_case, const bake::FlowSeries& flow,
                     double length);

/// That length, with the choice made.
double length_of(const bake::FlowCase& flow_case, const bake::FlowPlan& plan, double length);

const char* word_for(bake::FlowEnding ending);

nlohmann::ordered_json json_of(const bake::FlowSeries& flow, const FlowResults& results);
nlohmann::ordered_json json_of(const Vec3d& v);

/// Time, force, its parts, and torque about the mesh's origin; a row a sample.
std::string csv_of(const bake::FlowSeries& flow);

}  // namespace frm::cli
