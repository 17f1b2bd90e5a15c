#include "bake/flow/domain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "bake/flow/blocks.h"
#include "bake/flow/refinement.h"
#include "bake/mesh/roundness.h"
#include "bake/mesh/thickness.h"

namespace frm::bake::flow {
namespace {

constexpr double most_resolution = 512;

// The stream's speed on the lattice. Lower costs steps and makes drag worse at a given resolution; higher is
// compressible: the Mach number is 0.17 and the error of the force goes with its square.
constexpr double lattice_speed = 0.1;
// Molecular viscosity below which rounding, not physics, would set the flow; the sub-grid model rules long before.
// Sharp and round bodies, thin plates and sections ran stable down to 1e-6.
constexpr double least_viscosity = 5e-6;
// Creeping flow: the speed on the lattice is lowered to keep the viscosity under this, until steps get too many.
constexpr double most_viscosity = 0.05, least_speed = 1e-3;
constexpr double sample_rate = 32;  // samples while the stream travels one reference length
constexpr std::uint64_t most_steps = 50'000'000;
constexpr double sponge_share = 0.12;  // of the coarsest block's length
// In the turning frame water at rest moves the faster the farther it is from the axis. What it does there is exact, so
// that it may be faster than a stream, and the body with it.
constexpr double fastest_rest = 0.3;
constexpr double turning_sponge = 0.5;  // of the body's largest distance from the axis
constexpr double settling = 4;          // lengths until the fine grid has forgotten what it started from
// Where no edge says where the flow leaves a wall, its layer does, and a layer thinner than cells says it wrong: against
// the literature a sphere has 0.7 % more drag at Re 100 and 24 cells, and 13 to 15 % more at Re 1e4 and 24 to 54 cells.
constexpr double layer_error = 0.06, most_layer_error = 0.15;  // times (root of Re / cells)^1.5
constexpr double least_seconds = 1e-3;
constexpr double most_normal_flow = 0.05;  // share of a spinning wall's speed

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
    const bool spins = length(c.spin) > 0;
    require(finite(c.spin) && length(c.spin) < 1e6, "spin", text(c.spin), "under 1e6 rad/s");
    require(finite(c.spin_centre), "spin_centre", "not finite", "a point in metres");
    require(positive(c.speed, 1e-6, 1e4) || (spins && c.speed == 0), "speed", number(c.speed),
            "from 1e-6 to 1e4 m/s (0 where the body spins)");
    require(!c.turning || (spins && c.speed == 0), "turning", "true", "false unless spin alone drives the flow");
    require(positive(c.viscosity, 1e-12, 1e6), "viscosity", number(c.viscosity), "from 1e-12 to 1e6 m^2/s");
    require(positive(c.density, 1e-6, 1e6), "density", number(c.density), "from 1e-6 to 1e6 kg/m^3");
    require(positive(c.resolution, 4, most_resolution), "resolution", number(c.resolution), "from 4 to 512");
    require(c.reference_length == 0 || positive(c.reference_length, 1e-6, 1e6), "reference_length",
            number(c.reference_length), "0 (automatic) or from 1e-6 to 1e6 m");
    require(positive(c.start_up, 0.5, 1e4), "start_up", number(c.start_up), "from 0.5 to 10000 reference lengths");
    require(positive(c.duration, 0.5, 1e5), "duration", number(c.duration), "from 0.5 to 100000 reference lengths");
    require(c.threads >= 0 && c.threads <= 4096, "threads", std::to_string(c.threads), "from 0 (automatic) to 4096");
    require(std::isfinite(c.turn) && std::abs(c.turn) <= 360, "turn", number(c.turn), "from -360 to 360 degrees");
    require(c.confidence == 0 || positive(c.confidence, 1e-3, 1), "confidence", number(c.confidence),
            "0 (none) or a share from 0.001 to 1");
    require(c.seconds == 0 || positive(c.seconds, least_seconds, 1e9), "seconds", number(c.seconds),
            "0 (no limit) or from 0.001 to 1e9");
    if (!c.section) {
        require(c.slab == 0, "slab", number(c.slab), "0 where no section is solved");
        return;
    }
    require(!spins, "spin", text(c.spin), "zero for a section");
    require(c.turn == 0, "turn", number(c.turn), "0 for a section, whose cut it would change");
    require(c.slab == 0 || positive(c.slab, 0.1, 100), "slab", number(c.slab),
            "0 (two dimensions) or from 0.1 to 100 reference lengths");
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
        return frame;  // turned about the stream, the section would be another one
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
    const double angle = c.turn * (3.14159265358979323846 / 180), s = std::sin(angle), k = std::cos(angle);
    return {frame.x, frame.y * k + frame.z * s, frame.z * k - frame.y * s};
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

/// Of a section's extent across the stream, what lies between its parts.
double gaps_across(const std::vector<Segment>& segments) {
    std::vector<std::pair<double, double>> covered;
    covered.reserve(segments.size());
    for (const Segment& s : segments) covered.emplace_back(std::min(s.a.y, s.b.y), std::max(s.a.y, s.b.y));
    std::sort(covered.begin(), covered.end());
    double gaps = 0, end = covered.front().second;
    for (const auto& [low, high] : covered) {
        gaps += std::max(0.0, low - end);
        end = std::max(end, high);
    }
    return gaps;
}

/// Where the first node goes along an axis so that the body's middle is on a node or between two (a symmetric body gets
/// a symmetric lattice): whichever puts its outermost faces nearer to half-way between nodes, where a wall is sharpest.
double middle_offset(double extent_cells) {
    const auto distance = [](double v) { return std::abs(v - std::floor(v) - 0.5); };
    return distance(0.5 * extent_cells) <= distance(0.5 * extent_cells + 0.5) ? 0.0 : 0.5;
}

/// From the lattice's origin to finest cells from the finest block's first node.
Vec3d in_cells(const Vec3d& stream, const Domain& d) { return (stream - d.origin) / d.plan.cell - d.node(0, 0, 0, 0); }

Walls walls_of(const Surface& surface, const Domain& d) {
    Walls walls;
    walls.triangles = surface.triangles;
    walls.source.resize(surface.triangles.size());
    for (std::size_t t = 0; t < walls.source.size(); ++t) walls.source[t] = static_cast<std::uint32_t>(t);
    walls.vertices.reserve(surface.vertices.size());
    for (const Vec3d& v : surface.vertices) walls.vertices.push_back(in_cells(d.frame.to_stream(v), d));
    return walls;
}

Walls walls_of(const std::vector<Segment>& segments, const Domain& d) {
    Walls walls;
    for (const Segment& s : segments) {
        const auto first = static_cast<std::uint32_t>(walls.vertices.size());
        const Vec3d a = in_cells(s.a, d), b = in_cells(s.b, d);
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

/// The wall of a body that its own turning leaves where it is may move. Any other sweeps over nodes, and is solved in
/// the frame that turns with it, in which a stream would go round.
void plan_spin(const Surface& surface, const FlowCase& c, Domain& d) {
    const double rate = length(c.spin);
    if (rate == 0) return;
    double normal_flow = 0, area = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), e = surface.corner(t, 2);
        const Vec3d normal = cross(b - a, e - a) * 0.5, middle = (a + b + e) / 3.0 - c.spin_centre;
        const double size = length(normal), through = dot(normal, cross(c.spin, middle));
        if (size > 0) normal_flow += through * through / size;
        area += size;
        for (int i = 0; i < 3; ++i) {
            const Vec3d arm = surface.corner(t, i) - c.spin_centre;
            d.radius = std::max(d.radius, length(cross(c.spin, arm)) / rate);
        }
    }
    const double share = std::sqrt(normal_flow / area) / (rate * d.radius);
    const bool revolution = share <= most_normal_flow;
    if (!revolution && c.speed > 0) {
        throw BakeError(
            "flow: the body is not one of revolution about the axis of spin (its wall would move through "
            "the water at " +
            number(100 * share) +
            " % of its speed), and seen from such a body a stream goes round with every turn: only bodies of "
            "revolution "
            "spin in a stream; set speed to 0");
    }
    d.turning = c.speed == 0 && (c.turning || !revolution);
}

/// From the axis of spin to the nearest side of the outermost block: farther out the water is held at rest.
double reach_of(const Domain& d) {
    const int level = d.levels() - 1;
    const Grid& grid = d.blocks.back().grid;
    const Vec3d axis = d.spin_centre + d.node(0, 0, 0, 0), low = axis - d.node(level, 0, 0, 0),
                high = d.node(level, grid.nx - 1, grid.ny - 1, 0) - axis;
    return std::min(std::min(low.x, low.y), std::min(high.x, high.y));
}

/// z along the spin: the terms of a turning frame are then exact on the lattice. x and y fit the body's outline.
Frame turning_frame(const Surface& surface, const FlowCase& c) {
    FlowCase along = c;
    along.direction = c.spin / length(c.spin);
    const Frame f = stream_frame(surface, along);
    return {f.y, f.z, f.x};
}

}  // namespace

std::string advice(const Surface& surface, const FlowCase& c, const Domain& d) {
    const FlowPlan& plan = d.plan;
    std::string warning;
    const auto say = [&](const std::string& more) { warning += (warning.empty() ? "" : "; ") + more; };
    const double thickness = measure_thickness(surface).thinnest;
    if (thickness < 1.99 * plan.cell) {
        const double wanted = std::ceil(c.resolution * 2 * plan.cell / std::max(thickness, 1e-9));
        say("the body is " + number(thickness / plan.cell) +
            " cells thick where it is thinnest; below 2 the drag of thin parts is 10 to 15 % off face-on and up to "
            "twice as large edge-on: resolution " +
            (wanted > most_resolution ? "more than " + number(most_resolution) + " would be needed, which there is not"
                                      : number(wanted) + " would give 2"));
    }
    if (c.grid_error && !runs_coarse(c)) say("on under 8 cells what the grid does to the drag is not measured");
    const double span = plan.cell * d.finest().nz;
    if (c.slab > 0 && std::abs(span / plan.reference_length / c.slab - 1) > 0.05) {
        say("a slab of " + number(c.slab) + " reference lengths is solved as " + number(span / plan.reference_length) +
            ", whole cells of the coarsest block");
    }
    if (plan.reynolds_solved < 0.999 * plan.reynolds) {
        say("Reynolds number " + number(plan.reynolds) + " is solved as " + number(plan.reynolds_solved) +
            ", the most that this many cells carry");
    }
    return warning;
}

bool runs_coarse(const FlowCase& c) { return c.grid_error && c.resolution >= 8; }

FlowCase coarser(const FlowCase& c) {
    FlowCase coarse = c;
    coarse.grid_error = false;
    coarse.resolution = 0.5 * c.resolution;
    if (c.seconds > 0) coarse.seconds = std::max(least_seconds, 0.4 * c.seconds);
    coarse.pictures = false;
    return coarse;
}

Domain plan_domain(const Surface& surface, const FlowCase& c) {
    check(c);
    check(surface);
    Domain d;
    plan_spin(surface, c, d);
    d.frame = d.turning ? turning_frame(surface, c) : stream_frame(surface, c);
    std::vector<Segment> segments;
    Box body;
    if (c.section) {
        segments = outline(surface, d.frame, c.section_origin);
        if (segments.empty()) {
            throw BakeError("flow: the plane through section_origin " + text(c.section_origin) +
                            " does not cut the body; move it");
        }
        for (const Segment& s : segments) {
            body.add(s.a);
            body.add(s.b);
        }
    } else {
        body = bounds(surface.vertices, d.frame);
    }
    const Vec3d size = body.size();

    FlowPlan& plan = d.plan;
    plan.axes = {d.frame.x, d.frame.y, d.frame.z};
    plan.projected_area = c.section ? (size.y - gaps_across(segments)) * c.section_span
                                    : projected_area(surface, c.direction / length(c.direction));
    if (!(plan.projected_area > 0)) {
        throw BakeError("flow: the body has no area across the stream; check the surface and the direction");
    }
    double across = c.section ? size.y : std::sqrt(plan.projected_area);
    if (d.turning) across = std::min(across, 2 * d.radius);
    plan.reference_length = c.reference_length > 0 ? c.reference_length : across;
    plan.cell = plan.reference_length / c.resolution;
    d.length = c.resolution;

    // The lattice's origin is a node of every block, near the body's middle.
    const Vec3d extent = size / plan.cell, half = extent * 0.5;
    Vec3d middle{middle_offset(extent.x), middle_offset(extent.y), middle_offset(extent.z)};
    if (c.section) middle.z = 0;
    BlockRequest request;
    request.low = middle - half;
    request.high = middle + half;
    request.section = c.section;
    request.bulk = std::max(across / plan.cell, 4.0);
    request.still = c.speed == 0;
    if (d.turning) {
        request.radius = d.radius / plan.cell;
        request.axis = (d.frame.to_stream(c.spin_centre) - body.centre()) / plan.cell + middle;
    }
    if (c.slab > 0) {
        const double coarsest = 1 << (block_count(request.bulk, true) - 1);
        request.layers = static_cast<int>(std::max(1.0, std::round(c.slab * d.length / coarsest)) * coarsest);
    }
    d.bulk = request.bulk;
    d.blocks = plan_blocks(request);
    d.origin = body.centre() - middle * plan.cell;
    if (c.section) d.origin.z = dot(d.frame.z, c.section_origin);
    d.spin_centre = in_cells(d.frame.to_stream(c.spin_centre), d);
    if (d.turning) d.reach = reach_of(d);

    d.speed = std::max(c.speed, length(c.spin) * d.radius);
    plan.reynolds = d.speed * plan.reference_length / c.viscosity;
    // A relaxation time far above 1 would move interpolated walls, so a slow, thick fluid takes a lower lattice speed.
    const double fastest = d.turning ? fastest_rest * d.radius / (d.reach * plan.cell) : lattice_speed;
    d.lattice_speed = std::min(fastest, most_viscosity * plan.reynolds / d.length);
    if (d.lattice_speed < least_speed) {
        throw BakeError("flow: Reynolds number " + number(plan.reynolds) + " is too low for resolution " +
                        number(c.resolution) + "; it must be at least " +
                        number(least_speed * d.length / most_viscosity) + ": raise speed or lower viscosity");
    }
    d.stream_speed = d.lattice_speed * (c.speed / d.speed);
    plan.time_step = d.lattice_speed * plan.cell / d.speed;
    d.viscosity = std::max(least_viscosity, d.lattice_speed * d.length / plan.reynolds);
    plan.reynolds_solved = d.lattice_speed * d.length / d.viscosity;
    const double bulk = across / plan.cell;
    const double layer = std::sqrt(plan.reynolds * bulk / d.length) / bulk;
    d.layer_error = roundness(surface) * std::min(most_layer_error, layer_error * std::pow(layer, 1.5));

    d.spin = d.frame.to_stream(c.spin) * plan.time_step;

    const std::uint64_t limit = memory_limit_of(c);
    std::uint64_t bytes = 0, finest_steps_of_cells = 0;
    for (std::size_t l = 0; l < d.blocks.size(); ++l) {
        const Block& block = d.blocks[l];
        const Grid& grid = block.grid;
        FlowBlock shown;
        shown.cell = plan.cell * (1 << l);
        shown.cells = grid.cells();
        shown.low = d.origin + d.node(static_cast<int>(l), 0, 0, 0) * plan.cell;
        shown.high = d.origin + d.node(static_cast<int>(l), grid.nx - 1, grid.ny - 1, grid.nz - 1) * plan.cell;
        plan.blocks.push_back(shown);
        plan.cells += grid.cells();
        finest_steps_of_cells += grid.cells() >> l;
        // In floating point first: the product of three long sides may not fit an integer.
        const double expected = 2.0 * direction_count * sizeof(float) * grid.nx * (grid.ny + 2.0) * (grid.nz + 2.0);
        if (expected > static_cast<double>(limit)) refuse_memory(expected, limit);
        bytes += 2 * Populations::bytes(grid);
        if (l + 1 < d.blocks.size()) bytes += Refinement::bytes(grid);
    }
    const FlowBlock& box = plan.blocks.back();
    const double cross_section = (box.high.y - box.low.y) * (c.section ? c.section_span : box.high.z - box.low.z);
    plan.blockage = plan.projected_area / cross_section;
    const double coarse_radius = d.radius / (plan.cell * (1 << (d.levels() - 1)));
    d.sponge = d.turning ? turning_sponge * coarse_radius : sponge_share * d.blocks.back().grid.nx;
    const double unit = c.density * std::pow(plan.cell, 4) / (plan.time_step * plan.time_step);
    const double span_cells = c.section_span / (plan.cell * d.finest().nz);
    d.force_unit = c.section ? unit * span_cells : unit;
    d.drag_area = plan.projected_area / (plan.cell * plan.cell) / (c.section ? span_cells : 1);

    const double per_length = d.length / d.lattice_speed;
    const double interval = std::max(1.0, std::floor(per_length / sample_rate + 0.5));
    const double start = std::ceil(c.start_up * per_length);
    const double count = std::max(8.0, std::floor(c.duration * per_length / interval));
    if (start + count * interval > static_cast<double>(most_steps)) {
        throw BakeError("flow: start_up and duration together take " + number(start + count * interval) +
                        " steps; lower duration or resolution");
    }
    d.interval_steps = static_cast<std::uint32_t>(interval);
    d.start_steps = static_cast<std::uint64_t>(start);
    d.samples = static_cast<std::uint32_t>(count);
    d.ramp_steps = static_cast<std::uint64_t>(std::ceil(std::min(2.0, c.start_up / 3) * per_length));
    // Not a slab: half the resolution may keep its wake two-dimensional, and it takes a new start's time to lose that.
    if (runs_coarse(c) && c.slab == 0) {
        const std::uint64_t at_once = std::uint64_t{1} << (d.blocks.size() - 1);
        d.first_step = (d.ramp_steps + at_once - 1) / at_once * at_once;
        d.start_steps =
            d.first_step + static_cast<std::uint64_t>(std::ceil(std::min(settling, c.start_up) * per_length));
    }
    plan.steps = d.start_steps - d.first_step + std::uint64_t{d.interval_steps} * d.samples + 1;
    plan.updates = static_cast<double>(finest_steps_of_cells) * static_cast<double>(plan.steps);
    // Two copies of the populations, what is kept at borders, a flag a finest cell, and some two hundred bytes for each
    // cell of the body's surface.
    const double wetted =
        c.section ? 4 * (size.x + size.y) / plan.cell * d.finest().nz : measure(surface).area / (plan.cell * plan.cell);
    plan.bytes = bytes + d.finest().allocated() + static_cast<std::uint64_t>(wetted * 5 * 200);
    if (runs_coarse(c)) plan.bytes += plan_domain(surface, coarser(c)).plan.bytes;  // it waits for the fine one's start
    if (plan.bytes > limit) refuse_memory(static_cast<double>(plan.bytes), limit);
    d.walls = c.section ? walls_of(segments, d) : walls_of(surface, d);
    return d;
}

}  // namespace frm::bake::flow
