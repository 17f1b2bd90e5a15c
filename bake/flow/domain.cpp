#include "bake/flow/domain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace frm::bake::flow {
namespace {

// The stream's speed on the lattice. Lower costs steps and makes drag worse at a given resolution; higher is
// compressible: the Mach number is 0.17 and the error of the force goes with its square.
constexpr double lattice_speed = 0.1;
// Molecular viscosity below which rounding, not physics, would set the flow; the sub-grid model rules long before.
// Sharp and round bodies, thin plates and sections ran stable down to 1e-6.
constexpr double least_viscosity = 5e-6;
// Creeping flow: the speed on the lattice is lowered to keep the viscosity under this, until steps get too many.
constexpr double most_viscosity = 0.2, least_speed = 1e-3;
constexpr double sample_rate = 32;  // samples while the stream travels one reference length
constexpr std::uint64_t most_steps = 50'000'000;

// The box, in body sizes (square root of the projected area). A larger one costs cells and gains little: 8 ahead, 10
// behind and a blockage of 1 % change the corrected drag of a sphere at Re 100 by 2 % and of a cube at Re 1e4 by 1 %,
// at 6 times the cost. In two dimensions a body is felt much farther: with 2.5 ahead a cylinder's drag was 19 % high,
// with 10 it is 3 %.
constexpr double upstream = 3.5, downstream = 6.0, section_upstream = 10, section_downstream = 12, sponge_share = 1.5;
constexpr double target_blockage = 0.03, section_blockage = 0.025;
constexpr double least_margin = 1.0;  // beside the body
constexpr double least_margin_cells = 6;

std::string number(double v) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", v);
    return digits;
}

std::string text(const Vec3d& v) { return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")"; }

bool finite(const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require(bool ok, const char* field, const std::string& value, const char* rule) {
    if (!ok) throw BakeError(std::string("flow: ") + field + " is " + value + "; it must be " + rule);
}

void check(const FlowCase& c) {
    const auto positive = [](double v, double low, double high) { return std::isfinite(v) && v >= low && v <= high; };
    require(finite(c.direction) && std::abs(length(c.direction) - 1) < 1e-3, "direction", text(c.direction),
            "a unit vector");
    require(positive(c.speed, 1e-6, 1e4), "speed", number(c.speed), "from 1e-6 to 1e4 m/s");
    require(positive(c.viscosity, 1e-12, 1e6), "viscosity", number(c.viscosity), "from 1e-12 to 1e6 m^2/s");
    require(positive(c.density, 1e-6, 1e6), "density", number(c.density), "from 1e-6 to 1e6 kg/m^3");
    require(positive(c.resolution, 4, 512), "resolution", number(c.resolution), "from 4 to 512");
    require(c.reference_length == 0 || positive(c.reference_length, 1e-6, 1e6), "reference_length",
            number(c.reference_length), "0 (automatic) or from 1e-6 to 1e6 m");
    require(positive(c.start_up, 0.5, 1e4), "start_up", number(c.start_up), "from 0.5 to 10000 reference lengths");
    require(positive(c.duration, 0.5, 1e5), "duration", number(c.duration), "from 0.5 to 100000 reference lengths");
    require(c.threads >= 0 && c.threads <= 4096, "threads", std::to_string(c.threads), "from 0 (automatic) to 4096");
    if (!c.section) return;
    require(finite(c.section_normal) && std::abs(length(c.section_normal) - 1) < 1e-3, "section_normal",
            text(c.section_normal), "a unit vector");
    require(std::abs(dot(c.section_normal, c.direction)) < 1e-3, "section_normal", "not across the direction",
            "at right angles to it");
    require(finite(c.section_origin), "section_origin", "not finite", "a point in metres");
    require(positive(c.section_span, 1e-6, 1e6), "section_span", number(c.section_span), "from 1e-6 to 1e6 m");
}

void check(const Surface& s) {
    if (s.triangles.empty()) throw BakeError("flow: the surface has no triangles");
    for (const Vec3d& v : s.vertices) {
        if (!finite(v)) throw BakeError("flow: the surface has a vertex that is not finite");
    }
    for (const Triangle& t : s.triangles) {
        for (const std::uint32_t corner : t) {
            if (corner < s.vertices.size()) continue;
            throw BakeError("flow: a triangle of the surface names a vertex that does not exist");
        }
    }
}

struct Box {
    static constexpr double far = std::numeric_limits<double>::max();
    Vec3d low{far, far, far}, high{-far, -far, -far};

    void add(const Vec3d& v) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], v[i]);
            high[i] = std::max(high[i], v[i]);
        }
    }
    Vec3d size() const { return high - low; }
    Vec3d centre() const { return (low + high) * 0.5; }
};

template <typename Points>
Box bounds(const Points& points, const Frame& frame) {
    Box box;
    for (const Vec3d& v : points) box.add(frame.to_stream(v));
    return box;
}

/// x along the stream; y and z turned so that the body's shadow fits the smallest rectangle, because the box is a
/// margin around it. The mesh's own axes win unless turning saves a tenth: modellers align flat faces with them, and a
/// wall along the lattice is solved best.
Frame stream_frame(const Surface& surface, const FlowCase& c) {
    Frame frame;
    frame.x = c.direction / length(c.direction);
    if (c.section) {
        const Vec3d n = c.section_normal - frame.x * dot(c.section_normal, frame.x);
        frame.z = n / length(n);
        frame.y = cross(frame.z, frame.x);
        return frame;
    }
    const Vec3d a{std::abs(frame.x.x), std::abs(frame.x.y), std::abs(frame.x.z)};
    const Vec3d least = a.z <= a.x && a.z <= a.y ? Vec3d{0, 0, 1} : a.y <= a.x ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d z = least - frame.x * dot(least, frame.x);
    const Vec3d z0 = z / length(z), y0 = cross(z0, frame.x);
    frame.y = y0;
    frame.z = z0;
    const auto cost = [&](const Frame& f) {
        const Vec3d size = bounds(surface.vertices, f).size();
        const double margins = 0.5 * (size.y + size.z);
        return size.y * size.z + margins * margins;
    };
    double best = 0.9 * cost(frame);
    for (int degree = 3; degree < 90; degree += 3) {
        const double angle = degree * (3.14159265358979323846 / 180), s = std::sin(angle), k = std::cos(angle);
        const Frame turned{frame.x, y0 * k + z0 * s, z0 * k - y0 * s};
        const double turned_cost = cost(turned);
        if (turned_cost < best) {
            best = turned_cost;
            frame = turned;
        }
    }
    return frame;
}

/// The outline of the body in the section's plane: where its triangles cross it, as segments with the water on the
/// right of the way from `a` to `b` when looking along -z.
struct Segment {
    Vec3d a, b;  // stream's frame, m
    std::uint32_t triangle;
};

std::vector<Segment> outline(const Surface& surface, const Frame& frame, const Vec3d& point) {
    std::vector<Segment> segments;
    const double level = dot(frame.z, point);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        Vec3d p[3];
        bool above[3];
        for (int i = 0; i < 3; ++i) {
            p[i] = frame.to_stream(surface.corner(t, i));
            above[i] = p[i].z >= level;
        }
        if (above[0] == above[1] && above[1] == above[2]) continue;
        const int lone = above[0] == above[1] ? 2 : above[0] == above[2] ? 1 : 0;
        const Vec3d &tip = p[lone], &next = p[(lone + 1) % 3], &last = p[(lone + 2) % 3];
        const auto cut = [&](const Vec3d& other) {
            return tip + (other - tip) * ((level - tip.z) / (other.z - tip.z));
        };
        Segment segment{cut(next), cut(last), static_cast<std::uint32_t>(t)};
        if (!above[lone]) std::swap(segment.a, segment.b);
        segments.push_back(segment);
    }
    return segments;
}

/// Where the first node goes along an axis so that the body's middle is on a node or between two (a symmetric body gets
/// a symmetric lattice): whichever puts its outermost faces nearer to half-way between nodes, where a wall is sharpest.
double middle_offset(double extent_cells) {
    const auto distance = [](double v) { return std::abs(v - std::floor(v) - 0.5); };
    return distance(0.5 * extent_cells) <= distance(0.5 * extent_cells + 0.5) ? 0.0 : 0.5;
}

int whole(double v) { return static_cast<int>(std::ceil(v)); }

Walls walls_of(const Surface& surface, const Domain& d) {
    Walls walls;
    walls.triangles = surface.triangles;
    walls.source.resize(surface.triangles.size());
    for (std::size_t t = 0; t < walls.source.size(); ++t) walls.source[t] = static_cast<std::uint32_t>(t);
    walls.vertices.reserve(surface.vertices.size());
    for (const Vec3d& v : surface.vertices) walls.vertices.push_back((d.frame.to_stream(v) - d.origin) / d.plan.cell);
    return walls;
}

Walls walls_of(const std::vector<Segment>& segments, const Domain& d) {
    Walls walls;
    for (const Segment& s : segments) {
        const auto first = static_cast<std::uint32_t>(walls.vertices.size());
        const Vec3d a = (s.a - d.origin) / d.plan.cell, b = (s.b - d.origin) / d.plan.cell;
        walls.vertices.insert(walls.vertices.end(),
                              {{a.x, a.y, -0.5}, {b.x, b.y, -0.5}, {b.x, b.y, 0.5}, {a.x, a.y, 0.5}});
        walls.triangles.push_back({first, first + 1, first + 2});
        walls.triangles.push_back({first, first + 2, first + 3});
        walls.source.insert(walls.source.end(), {s.triangle, s.triangle});
    }
    return walls;
}

[[noreturn]] void refuse_memory(double bytes, std::uint64_t limit) {
    constexpr double mib = 1 << 20;
    throw BakeError("flow: about " + number(bytes / mib) + " MiB are needed and the limit (memory_limit) is " +
                    number(static_cast<double>(limit) / mib) + " MiB; lower the resolution");
}

void advise(const Surface& surface, const Vec3d& size, const FlowCase& c, FlowPlan& plan) {
    const auto say = [&](const std::string& more) { plan.warning += (plan.warning.empty() ? "" : "; ") + more; };
    double thickness = 0;
    if (c.section) {
        thickness = std::min(size.x, size.y);
    } else {
        const SurfaceProperties properties = measure(surface);
        thickness = properties.area > 0 ? 2 * properties.volume / properties.area : 0;
    }
    if (thickness < 2 * plan.cell) {
        say("the body is about " + number(thickness / plan.cell) +
            " cells thick (twice its volume over its surface); below 2 the drag of thin parts is 10 to 15 % off "
            "face-on "
            "and up to twice as large edge-on: resolution " +
            number(std::ceil(c.resolution * 2 * plan.cell / std::max(thickness, 1e-9))) + " would give 2");
    }
    if (plan.reynolds_solved < 0.999 * plan.reynolds) {
        say("Reynolds number " + number(plan.reynolds) + " is solved as " + number(plan.reynolds_solved) +
            ", the most that this many cells carry");
    }
}

}  // namespace

Domain plan_domain(const Surface& surface, const FlowCase& c) {
    check(c);
    check(surface);
    Domain d;
    d.frame = stream_frame(surface, c);
    std::vector<Segment> segments;
    Box body;
    if (c.section) {
        segments = outline(surface, d.frame, c.section_origin);
        if (segments.empty()) throw BakeError("flow: the plane through section_origin does not cut the body; move it");
        for (const Segment& s : segments) {
            body.add(s.a);
            body.add(s.b);
        }
    } else {
        body = bounds(surface.vertices, d.frame);
    }
    const Vec3d size = body.size();

    FlowPlan& plan = d.plan;
    plan.projected_area = c.section ? size.y * c.section_span : projected_area(surface, d.frame.x);
    if (!(plan.projected_area > 0)) {
        throw BakeError("flow: the body has no area across the stream; check the surface and the direction");
    }
    const double across = c.section ? size.y : std::sqrt(plan.projected_area);
    plan.reference_length = c.reference_length > 0 ? c.reference_length : across;
    plan.cell = plan.reference_length / c.resolution;
    plan.reynolds = c.speed * plan.reference_length / c.viscosity;
    d.length = c.resolution;
    // A relaxation time far above 1 would move interpolated walls, so a slow, thick fluid takes a lower lattice speed.
    d.stream_speed = std::min(lattice_speed, most_viscosity * plan.reynolds / d.length);
    if (d.stream_speed < least_speed) {
        throw BakeError("flow: Reynolds number " + number(plan.reynolds) + " is too low for resolution " +
                        number(c.resolution) + "; it must be at least " +
                        number(least_speed * d.length / most_viscosity) + ": raise speed or lower viscosity");
    }
    plan.time_step = d.stream_speed * plan.cell / c.speed;
    d.viscosity = std::max(least_viscosity, d.stream_speed * d.length / plan.reynolds);
    plan.reynolds_solved = d.stream_speed * d.length / d.viscosity;

    // The box: margins beside the body until it blocks no more than the target; a margin counts cells when the body is
    // small.
    const double cell = plan.cell, bulk = std::max(across / cell, 4.0);
    const double wide = size.y / cell, high = size.z / cell, least = std::max(least_margin * bulk, least_margin_cells);
    double margin = least;
    if (c.section) {
        margin = std::max(margin, 0.5 * wide * (1 / section_blockage - 1));
    } else {
        const double wanted = plan.projected_area / (cell * cell) / target_blockage;
        const double half = 0.5 * (wide + high);  // (wide + 2 m) (high + 2 m) = wanted
        const double root = std::sqrt(half * half - wide * high + wanted);
        margin = std::max(margin, 0.5 * (root - half));
    }
    const double before = std::max((c.section ? section_upstream : upstream) * bulk, least);
    const double after = std::max((c.section ? section_downstream : downstream) * bulk, 2 * least);
    const double cells_x = size.x / cell + before + after;
    const double expected = cells_x * (wide + 2 * margin) * (c.section ? 1 : high + 2 * margin);
    const double copies = 2.0 * direction_count * sizeof(float);
    const double longest = std::max({cells_x, wide + 2 * margin, high + 2 * margin});
    if (!(expected * copies < static_cast<double>(c.memory_limit)) || longest > 1e6) {
        refuse_memory(expected * copies, c.memory_limit);
    }

    Grid& grid = d.grid;
    grid.section = c.section;
    const int lanes = static_cast<int>(Grid::lanes);
    grid.nx = (whole(cells_x) + 2 + lanes - 1) / lanes * lanes - 2;
    const auto place = [&](double extent, double room, int& count) {
        const double offset = middle_offset(extent);
        const int half = whole(0.5 * extent + room);
        count = offset == 0.0 ? 2 * half + 1 : 2 * half;
        return offset == 0.0 ? static_cast<double>(half) : half - 0.5;
    };
    const Vec3d centre = body.centre();
    const double node_y = place(wide, margin, grid.ny);
    double node_z = 0;
    grid.nz = 1;
    if (!c.section) node_z = place(high, margin, grid.nz);
    const double middle_x = std::floor(before + 0.5 * size.x / cell) + middle_offset(size.x / cell);
    d.origin = centre - Vec3d{middle_x, node_y, node_z} * cell;

    d.sponge = sponge_share * bulk;
    d.cross_section = static_cast<double>(grid.ny) * cell * (c.section ? c.section_span : grid.nz * cell);
    plan.blockage = plan.projected_area / d.cross_section;
    const double unit = c.density * std::pow(cell, 4) / (plan.time_step * plan.time_step);
    d.force_unit = c.section ? unit * (c.section_span / cell) : unit;

    const double per_length = d.length / d.stream_speed;
    const double interval = std::max(1.0, std::floor(per_length / sample_rate + 0.5));
    const double start = std::ceil(c.start_up * per_length);
    const double count = std::max(8.0, std::floor(c.duration * per_length / interval));
    if (start + count * interval > static_cast<double>(most_steps)) {
        throw BakeError("flow: start_up and duration together take " + number(start + count * interval) +
                        " steps; lower duration or resolution");
    }
    d.interval_steps = static_cast<std::uint32_t>(interval);
    d.start_steps = static_cast<std::uint32_t>(start);
    d.samples = static_cast<std::uint32_t>(count);
    d.ramp_steps = static_cast<std::uint32_t>(std::ceil(std::min(2.0, c.start_up / 3) * per_length));
    plan.steps = d.start_steps + std::uint64_t{d.interval_steps} * d.samples + 1;
    plan.cells = grid.cells();
    d.walls = c.section ? walls_of(segments, d) : walls_of(surface, d);
    // Two copies of the populations, a flag a cell, and some two hundred bytes for each cell of the body's surface.
    const double wetted = c.section ? 4 * (size.x + size.y) / cell : measure(surface).area / (cell * cell);
    plan.bytes = 2 * Populations::bytes(grid) + grid.allocated() + static_cast<std::uint64_t>(wetted * 5 * 200);
    if (plan.bytes > c.memory_limit) refuse_memory(static_cast<double>(plan.bytes), c.memory_limit);
    advise(surface, size, c, plan);
    return d;
}

}  // namespace frm::bake::flow
