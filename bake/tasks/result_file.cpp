// The file: magic (8 bytes), version, samples, regions, a zero (u32 each), key, size of the contents, hash of all that
// follows it (u64 each); then one zstd frame with its own checksum.
#include "bake/tasks/result_file.h"

#include <zstd.h>

#include <cmath>

#include "bake/tasks/version.h"
#include "core/map/bytes.h"
#include "core/map/codec.h"
#include "core/math/hash.h"

namespace frm::bake {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Writer = ByteWriter<Bytes>;

constexpr std::uint8_t magic[8] = {0x89, 'F', 'L', 'O', 'W', '\r', '\n', 0x1A};
constexpr std::uint32_t version = 2;
constexpr const char* what = "the flow's file";

// Bounds of what a file may claim, far above what a bake writes (some thousand samples, some hundred patches).
constexpr std::uint64_t most_values = std::uint64_t{1} << 28;  // floats of all series: 1 GiB
constexpr std::uint64_t most_rest = std::uint64_t{1} << 28;    // bytes of plan and slices
constexpr std::uint64_t most_blocks = 4096, most_slices = 64, most_text = 1 << 16;

[[noreturn]] void corrupt(const char* text) { throw Error(FRM_ERROR_CORRUPT, "%s: %s", what, text); }

void put(Writer& w, const Vec3d& v) { w.f64(v.x), w.f64(v.y), w.f64(v.z); }
Vec3d vec3(ByteReader& r) {
    const double x = r.f64(), y = r.f64(), z = r.f64();
    return {x, y, z};
}

void put(Writer& w, const std::vector<float>& values) {
    for (const float v : values) w.f32(v);
}

std::vector<float> floats(ByteReader& r, std::uint64_t count, bool finite) {
    if (count > r.left() / 4) corrupt("a series is longer than the file");
    std::vector<float> values(static_cast<std::size_t>(count));
    for (float& v : values) {
        v = r.f32();
        if (finite && !std::isfinite(v)) corrupt("a force is not a finite number");
    }
    return values;
}

std::uint32_t count_of(ByteReader& r, std::uint64_t most) {
    const std::uint32_t count = r.u32();
    if (count > most) corrupt("a count is out of range");
    return count;
}

// Each list of names below ends compilation when a field joins its struct: the file must hold that too, and its version
// must be raised.

void put(Writer& w, const FlowPlan& p) {
    const auto& [reference_length, projected_area, reynolds, reynolds_solved, blockage, cell, time_step, cells, steps,
                 updates, bytes, axes, blocks, warning] = p;
    for (const double v : {reference_length, projected_area, reynolds, reynolds_solved, blockage, cell, time_step})
        w.f64(v);
    w.u64(cells), w.u64(steps), w.f64(updates), w.u64(bytes);
    for (const Vec3d& axis : axes) put(w, axis);
    w.u32(static_cast<std::uint32_t>(blocks.size()));
    for (const FlowBlock& block : blocks) {
        const auto& [low, high, block_cell, block_cells] = block;
        put(w, low), put(w, high), w.f64(block_cell), w.u64(block_cells);
    }
    w.u32(static_cast<std::uint32_t>(warning.size()));
    w.bytes(warning.data(), warning.size());
}

FlowPlan plan(ByteReader& r) {
    FlowPlan p;
    for (double* v :
         {&p.reference_length, &p.projected_area, &p.reynolds, &p.reynolds_solved, &p.blockage, &p.cell, &p.time_step})
        *v = r.f64();
    p.cells = r.u64(), p.steps = r.u64(), p.updates = r.f64(), p.bytes = r.u64();
    for (Vec3d& axis : p.axes) axis = vec3(r);
    p.blocks.resize(count_of(r, most_blocks));
    for (FlowBlock& block : p.blocks) {
        block.low = vec3(r), block.high = vec3(r);
        block.cell = r.f64(), block.cells = r.u64();
    }
    const std::uint32_t size = count_of(r, most_text);
    p.warning.assign(reinterpret_cast<const char*>(r.take(size)), size);
    return p;
}

void put(Writer& w, const FlowSlice& slice) {
    const auto& [normal, low, spacing, columns, rows, speed, pressure] = slice;
    w.u32(static_cast<std::uint32_t>(normal));
    put(w, low), w.f64(spacing), w.u32(columns), w.u32(rows);
    put(w, speed), put(w, pressure);
}

FlowSlice slice(ByteReader& r) {
    FlowSlice s;
    s.normal = static_cast<int>(count_of(r, 2));
    s.low = vec3(r), s.spacing = r.f64(), s.columns = r.u32(), s.rows = r.u32();
    const std::uint64_t values = std::uint64_t{s.columns} * s.rows;
    s.speed = floats(r, values, false);  // NaN inside the body
    s.pressure = floats(r, values, false);
    return s;
}

Bytes contents(const TaskResult& result) {
    const auto& [flow_plan, ending, half, interval, samples, regions, pressure, friction, torque, uncertainty,
                 coarse_drag, slices, steps, seconds, mlups] = result;
    const auto& [statistics, grid, blockage] = uncertainty;
    Bytes raw;
    Writer w(raw);
    put(w, flow_plan);
    w.u8(static_cast<std::uint8_t>(ending)), w.u8(half ? 1 : 0), w.f64(interval), w.u64(steps);
    for (const double v : {statistics, grid, blockage, coarse_drag, seconds, mlups}) w.f64(v);
    put(w, pressure), put(w, friction), put(w, torque);
    w.u32(static_cast<std::uint32_t>(slices.size()));
    for (const FlowSlice& s : slices) put(w, s);
    return raw;
}

}  // namespace

std::uint64_t hash_of_body(const Surface& surface, const Regions& patches) {
    Bytes bytes;
    Writer w(bytes);
    w.bytes(solver_version, std::strlen(solver_version));
    for (const Vec3d& v : surface.vertices) put(w, v);
    for (const Triangle& triangle : surface.triangles)
        for (const std::uint32_t corner : triangle) w.u32(corner);
    for (const std::uint32_t region : patches.region) w.u32(region);
    w.u32(patches.count);
    return fnv1a(bytes.data(), bytes.size());
}

std::uint64_t key_of(std::uint64_t body, const FlowCase& flow_case) {
    const auto& [direction, speed, viscosity, density, resolution, reference_length, start_up, duration, turn,
                 confidence, time_limit, grid_error, pictures, section, section_normal, section_origin, section_span,
                 slab, spin, spin_centre, turning, threads, memory_limit] = flow_case;
    static_cast<void>(threads), static_cast<void>(memory_limit);  // no bit depends on them
    Bytes bytes;
    Writer w(bytes);
    w.u64(body);
    for (const Vec3d& v : {direction, section_normal, section_origin, spin, spin_centre}) put(w, v);
    for (const double v : {speed, viscosity, density, resolution, reference_length, start_up, duration, turn,
                           confidence, time_limit, section_span, slab})
        w.f64(v);
    for (const bool v : {grid_error, pictures, section, turning}) w.u8(v ? 1 : 0);
    return fnv1a(bytes.data(), bytes.size());
}

std::vector<std::uint8_t> encode_result(const TaskResult& result, std::uint64_t key) {
    const Bytes raw = contents(result);
    const Bytes stored = compress(raw, 3);
    Bytes file;
    Writer w(file);
    w.bytes(magic, sizeof magic);
    w.u32(version), w.u32(result.samples), w.u32(result.regions), w.u32(0);
    w.u64(key), w.u64(raw.size());
    w.u64(fnv1a(stored.data(), stored.size()));
    w.bytes(stored.data(), stored.size());
    return file;
}

TaskResult decode_result(const std::uint8_t* data, std::size_t size, std::uint64_t key, std::uint32_t regions) {
    ByteReader head(data, size, what);
    if (size < sizeof magic || std::memcmp(head.take(sizeof magic), magic, sizeof magic) != 0)
        corrupt("its first bytes are not the format's");
    const std::uint32_t found = head.u32();
    if (found != version)
        throw Error(FRM_ERROR_VERSION, "%s: version %u; this program reads version %u", what, found, version);
    TaskResult result;
    result.samples = head.u32();
    result.regions = head.u32();
    if (head.u32() != 0) corrupt("its reserved field is not 0");
    if (head.u64() != key || result.regions != regions) corrupt("it is of another mesh, case or version of the solver");
    const std::uint64_t values = std::uint64_t{result.samples} * regions * 3;
    const std::uint64_t raw_size = head.u64();
    if (values > most_values || raw_size < 8 * values || raw_size > 8 * values + most_rest)
        corrupt("its size does not match its counts");
    const std::uint64_t hash = head.u64();
    const std::uint8_t* stored = head.take(0);
    const std::size_t stored_size = head.left();
    if (fnv1a(stored, stored_size) != hash) corrupt("it is damaged: the hash of its contents does not match");
    if (ZSTD_getFrameContentSize(stored, stored_size) != raw_size) corrupt("its compressed frame has another size");
    Bytes raw(static_cast<std::size_t>(raw_size));
    const std::size_t got = ZSTD_decompress(raw.data(), raw.size(), stored, stored_size);
    if (ZSTD_isError(got)) corrupt(ZSTD_getErrorName(got));
    if (got != raw.size()) corrupt("it decompresses to another size");

    ByteReader r(raw.data(), raw.size(), what);
    result.plan = plan(r);
    const std::uint8_t ending = r.u8();
    // A cancelled run is not a result.
    if (ending >= static_cast<std::uint8_t>(FlowEnding::cancelled)) corrupt("it is of a run that was not finished");
    result.ending = static_cast<FlowEnding>(ending);
    result.half = r.u8() != 0;
    result.interval = r.f64();
    result.steps = r.u64();
    for (double* v : {&result.uncertainty.statistics, &result.uncertainty.grid, &result.uncertainty.blockage,
                      &result.coarse_drag, &result.seconds, &result.mlups})
        *v = r.f64();
    if (!(result.interval > 0) || !std::isfinite(result.interval) || result.samples == 0) corrupt("it has no samples");
    result.pressure = floats(r, values, true);
    result.friction = floats(r, values, true);
    result.torque = floats(r, std::uint64_t{3} * result.samples, true);
    const std::uint32_t slices = count_of(r, most_slices);
    for (std::uint32_t i = 0; i < slices; ++i) result.slices.push_back(slice(r));
    r.end();
    return result;
}

}  // namespace frm::bake
