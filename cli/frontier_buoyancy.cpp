#include "cli/frontier_buoyancy.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <memory_resource>

#include "cli/frontier_maps.h"
#include "core/body/body.h"
#include "core/map/codec.h"
#include "core/water/water.h"

namespace frm::cli {
namespace {

constexpr double pi = 3.14159265358979323846, rho_g = 1000 * 9.80665;
constexpr std::size_t poses = 96, poses_a_turn = 16;
const Vec3d hull{0.6, 0.25, 0.2};

/// Where the hull is: all that differs between poses.
struct Placed {
    Pose pose;
    Rotation<double> rotation;
};

Placed place(std::size_t n) {
    const double s = 2 * pi * static_cast<double>(n) / static_cast<double>(poses);
    const double roll = 0.5 * std::sin(3 * s), pitch = 0.2 * std::sin(2 * s + 1);
    const double cr = std::cos(roll / 2), sr = std::sin(roll / 2), cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
    const Quat<double> q{sr * cp, cr * sp, sr * sp, cr * cp};
    Placed out;
    out.pose.position = {0.3 * std::sin(s), 0.2 * std::cos(s), 0.1 * std::sin(5 * s)};
    out.pose.rotation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                         static_cast<float>(q.w)};
    out.rotation = Rotation<double>(q);
    return out;
}

/// Waves twice as long as the hull, 64 cells each, steepness 0.2.
std::unique_ptr<Water> make_water() {
    WaterDef def;
    def.field = {160, 160, 0.0375f, 1.0f, Border::reflecting, 0};
    auto water = std::make_unique<Water>(def, std::pmr::get_default_resource());
    std::vector<float> heights(water->field.cells());
    for (std::size_t c = 0; c < heights.size(); ++c) {
        const auto x = static_cast<double>(c % 160), y = static_cast<double>(c / 160);
        heights[c] = static_cast<float>(0.0764 * std::sin(2 * pi * (0.8 * x + 0.6 * y) / 64));
    }
    water->field.set_heights(heights.data());
    return water;
}

SurfaceView view_of(const Water* water, const Placed& p) {
    SurfaceView view;
    view.level = static_cast<float>(-p.pose.position.z);
    view.still = false;
    if (!water) return view;
    view.field = &water->field;
    view.origin = water->origin_at(p.pose.position.x, p.pose.position.y);
    view.cells_per_metre = 1.0f / water->def().field.cell;
    return view;
}

/// frm's own.
class Clip {
public:
    Clip(std::uint32_t n, const Water* water) : water_(water) {
        LawMap settings;
        settings.sources = 20;
        settings.frequency = 1;
        const MapFile file = law_map(ellipsoid_surface(hull, n), settings);
        const auto map = std::make_shared<Map>();
        decode_map(file->data(), file->size(), *map);
        BodyDef def;
        def.map = map;
        body_ = std::make_unique<Body>(def, 0, std::pmr::get_default_resource());
    }
    Reading at(const Placed& p) {
        body_->def.pose = p.pose;
        body_->rotation = Rotation<float>(p.pose.rotation);
        measure_wet_surface(*body_, view_of(water_, p), Fluid());
        const Wrench& b = body_->forces.buoyancy;
        return {Vec3d(b.force), Vec3d(b.torque)};
    }

private:
    const Water* water_;
    std::unique_ptr<Body> body_;
};

/// Each point that is under water lifts by its volume; smoothed: by the part of its lattice cell's height that is, as if
/// the cell stood upright.
class Points {
public:
    Points(std::uint32_t count, bool smoothed, const Water* water)
        : body_(point_body(hull, count)), smoothed_(smoothed), water_(water) {}

    Reading at(const Placed& p) {
        const Rotation<float> rotation(p.pose.rotation);
        const SurfaceView view = view_of(water_, p);
        const auto per_height = static_cast<float>(1 / body_.height);
        float sum = 0, x = 0, y = 0;
        for (const Vec3f& point : body_.points) {
            const Vec3f r = rotation.to_world(point);
            float depth = view.level - r.z;
            if (view.field)
                depth += view.field->height_at(view.origin, r.x * view.cells_per_metre, r.y * view.cells_per_metre);
            const float wet =
                smoothed_ ? std::min(1.0f, std::max(0.0f, depth * per_height + 0.5f)) : (depth > 0 ? 1.0f : 0.0f);
            sum += wet;
            x += wet * r.x;
            y += wet * r.y;
        }
        const double each = rho_g * body_.volume;
        return {{0, 0, each * static_cast<double>(sum)},
                {each * static_cast<double>(y), -each * static_cast<double>(x), 0}};
    }
    std::size_t count() const { return body_.points.size(); }

private:
    PointBody body_;
    bool smoothed_;
    const Water* water_;
};

Reading exact_at(const Placed& p) {
    const Vec3d up = p.rotation.to_body({0, 0, 1});
    const Cap cap = cap_below(hull, up, -p.pose.position.z);
    const Vec3d force(0, 0, rho_g * cap.volume);
    return {force, cross(p.rotation.to_world(cap.centroid), force)};
}

struct Candidate {
    BuoyancyWay way;
    std::function<Reading(const Placed&)> at;
};

/// Turns of some poses each, as play_in_turns() does.
void measure(std::vector<Candidate>& candidates, std::uint32_t repeats) {
    std::vector<Placed> placed;
    for (std::size_t n = 0; n < poses; ++n) placed.push_back(place(n));
    for (Candidate& c : candidates)
        for (const Placed& p : placed) c.way.readings.push_back(c.at(p));
    Vec3d sum;  // that nothing is left out
    for (std::uint32_t r = 0; r < repeats; ++r) {
        for (Candidate& c : candidates) c.way.repeat_us.push_back(0);
        for (std::size_t begin = 0; begin < poses; begin += poses_a_turn)
            for (Candidate& c : candidates) {
                c.at(placed[begin]);
                // So often that the clock does not count, the least of five: what was not interrupted.
                double least = 1e30;
                for (int tries = 0; tries < 5; ++tries) {
                    const auto start = std::chrono::steady_clock::now();
                    for (std::size_t n = begin; n < begin + poses_a_turn; ++n) sum += c.at(placed[n]).force;
                    const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - start;
                    least = std::min(least, us.count());
                }
                c.way.repeat_us.back() += least / static_cast<double>(poses);
            }
    }
    for (Candidate& c : candidates) c.way.us = quantile_of(c.way.repeat_us, 0.5);
    volatile double keep = sum.z;
    static_cast<void>(keep);
}

}  // namespace

Cap cap_below(const Vec3d& half_axes, const Vec3d& up, double level) {
    // y = x / half axes turns the ellipsoid into the unit sphere and the plane into dot(m, y) < level.
    const Vec3d m(up.x * half_axes.x, up.y * half_axes.y, up.z * half_axes.z);
    const double size = length(m), t = std::clamp(level / size, -1.0, 1.0);
    const double volume = pi * (2.0 / 3 + t - t * t * t / 3);
    const double moment = pi * (t * t / 2 - t * t * t * t / 4 - 0.25);
    Cap cap;
    cap.volume = volume * half_axes.x * half_axes.y * half_axes.z;
    if (!(volume > 0)) return cap;
    const Vec3d y = m * (moment / volume / size);
    cap.centroid = {y.x * half_axes.x, y.y * half_axes.y, y.z * half_axes.z};
    return cap;
}

PointBody point_body(const Vec3d& half_axes, std::uint32_t count) {
    const double whole = 4.0 / 3 * pi * half_axes.x * half_axes.y * half_axes.z;
    PointBody out;
    out.height = std::cbrt(whole / count);
    const auto cells = [&](double half) { return static_cast<int>(std::ceil(half / out.height)); };
    const int nx = cells(half_axes.x), ny = cells(half_axes.y), nz = cells(half_axes.z);
    for (int i = -nx; i < nx; ++i)
        for (int j = -ny; j < ny; ++j)
            for (int k = -nz; k < nz; ++k) {
                const Vec3d p((i + 0.5) * out.height, (j + 0.5) * out.height, (k + 0.5) * out.height);
                const Vec3d y(p.x / half_axes.x, p.y / half_axes.y, p.z / half_axes.z);
                if (dot(y, y) < 1) out.points.push_back(Vec3f(p));
            }
    out.volume = whole / static_cast<double>(std::max<std::size_t>(1, out.points.size()));
    return out;
}

BuoyancyScene measure_buoyancy(bool waves, std::uint32_t repeats, bool quick) {
    const std::unique_ptr<Water> water = waves ? make_water() : nullptr;
    std::vector<Candidate> candidates;
    const auto add = [&](const char* knob, double value, std::function<Reading(const Placed&)> at) {
        Candidate c;
        c.way.knob = knob;
        c.way.value = value;
        c.at = std::move(at);
        candidates.push_back(std::move(c));
    };
    for (const std::uint32_t n :
         quick ? std::vector<std::uint32_t>{3, 8, 16} : std::vector<std::uint32_t>{2, 3, 5, 8, 11, 16, 24, 32}) {
        const auto clip = std::make_shared<Clip>(n, water.get());
        add("triangles", 8.0 * n * n, [clip](const Placed& p) { return clip->at(p); });
        candidates.back().way.standard = n == 16;
    }
    for (const bool smoothed : {false, true})
        for (const std::uint32_t count : quick ? std::vector<std::uint32_t>{8, 100, 1000}
                                               : std::vector<std::uint32_t>{8, 16, 32, 64, 128, 256, 512, 1000}) {
            const auto points = std::make_shared<Points>(count, smoothed, water.get());
            add(smoothed ? "points smoothed" : "points counted", static_cast<double>(points->count()),
                [points](const Placed& p) { return points->at(p); });
        }
    measure(candidates, repeats);

    BuoyancyScene out;
    const auto finest = waves ? std::make_unique<Clip>(64, water.get()) : nullptr;
    for (std::size_t n = 0; n < poses; ++n) out.reference.push_back(waves ? finest->at(place(n)) : exact_at(place(n)));
    for (Candidate& c : candidates) out.ways.push_back(std::move(c.way));
    return out;
}

}  // namespace frm::cli
