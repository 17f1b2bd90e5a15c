#include <zstd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/file.h"
#include "device/recording.h"

namespace frm::device {
namespace {

// What the interface refuses from a host (core/api) a recording cannot hold either: a tick counts on it.
void require(bool good, const char* what) {
    if (!good) throw Error(FRM_ERROR_CORRUPT, "%s is out of range", what);
}

template <typename T>
bool within(T value, double low, double high) {
    return static_cast<double>(value) >= low && static_cast<double>(value) <= high;  // false for NaN
}

bool within(const Vec3f& v, double limit) {
    return within(v.x, -limit, limit) && within(v.y, -limit, limit) && within(v.z, -limit, limit);
}

Pose read_pose(ByteReader& r) {
    Pose p;
    p.position.x = r.f64(), p.position.y = r.f64(), p.position.z = r.f64();
    p.rotation.x = r.f32(), p.rotation.y = r.f32(), p.rotation.z = r.f32(), p.rotation.w = r.f32();
    const Quat<float>& q = p.rotation;
    require(within(p.position.x, -1e9, 1e9) && within(p.position.y, -1e9, 1e9) && within(p.position.z, -1e9, 1e9) &&
                within(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 0.99, 1.01),
            "a pose");
    return p;
}

Twist read_twist(ByteReader& r) {
    Twist t;
    t.linear = r.vec3(), t.angular = r.vec3();
    require(within(t.linear, 1e4) && within(t.angular, 1e4), "a twist");
    return t;
}

Wrench read_wrench(ByteReader& r) {
    Wrench w;
    w.force = r.vec3(), w.torque = r.vec3();
    return w;
}

frm_vec3 read_plain(ByteReader& r) {
    const Vec3f v = r.vec3();
    return {v.x, v.y, v.z};
}

std::vector<float> read_values(ByteReader& r) {
    const std::uint64_t count = r.u64();
    if (count > r.left() / 4) throw Error(FRM_ERROR_CORRUPT, "an array is longer than its block");
    std::vector<float> values(static_cast<std::size_t>(count));
    for (float& v : values) v = r.f32();
    return values;
}

event::World read_world(ByteReader& r, std::uint32_t version) {
    event::World e;
    e.def.model = r.u32(), e.def.everywhere = r.u32() != 0, e.def.level = r.f64();
    e.def.fluid.gravity = r.f32(), e.def.fluid.density = r.f32(), e.def.fluid.viscosity = r.f32();
    e.hash_interval = r.u32(), e.axes = r.u32();
    e.def.skip = skip_nothing;  // there were no such rules in version 1
    if (version > 1) e.def.skip = r.u32(), e.def.error_budget = r.f32(), e.def.time_budget = r.f32();
    require(e.def.model <= FRM_MODEL_DEFAULT && within(e.def.level, -1e9, 1e9) &&
                within(e.def.fluid.gravity, 0, 1000) && within(e.def.fluid.density, 1e-3f, 1e5) &&
                within(e.def.fluid.viscosity, 1e-9f, 1e2) && e.axes <= FRM_AXES_Z_UP_LEFT &&
                e.def.skip <= FRM_SKIP_DEFAULT && within(e.def.error_budget, 0, 1e9) &&
                within(e.def.time_budget, 0, 1e6),
            "the world's definition");
    return e;
}

event::Map read_map(ByteReader& r) {
    const std::uint64_t size = r.u64();
    if (size > r.left()) throw Error(FRM_ERROR_CORRUPT, "a map is longer than its block");
    const std::uint8_t* bytes = r.take(static_cast<std::size_t>(size));
    return {{bytes, bytes + size}};
}

event::Water read_water(ByteReader& r, std::uint32_t version) {
    event::Water e;
    FieldDef& f = e.def.field;
    f.nx = static_cast<std::int32_t>(r.u32()), f.ny = static_cast<std::int32_t>(r.u32()), f.cell = r.f32(),
    f.depth = r.f32();
    f.border = r.u32() ? Border::reflecting : Border::absorbing, f.border_cells = static_cast<std::int32_t>(r.u32());
    e.def.centre_x = r.f64(), e.def.centre_y = r.f64(), e.def.snapshot_interval = r.f32();
    if (version > 1) f.order = static_cast<std::int32_t>(r.u32());
    // The absorbing layer must fit: Field::damp counts on it.
    const bool layer = f.border == Border::reflecting || (3 * f.border_cells < f.nx && 3 * f.border_cells < f.ny);
    require(f.nx >= 8 && f.nx <= 8192 && f.ny >= 8 && f.ny <= 8192 && f.border_cells >= 0 && f.border_cells <= 64 &&
                layer && within(f.cell, 1e-4f, 1e3) && within(f.depth, 1e-3f, 1e4) &&
                within(e.def.centre_x, -1e9, 1e9) && within(e.def.centre_y, -1e9, 1e9) &&
                within(e.def.snapshot_interval, 0, 10) && (f.order == 2 || f.order == 4),
            "the water's size");
    return e;
}

event::Body read_body(ByteReader& r) {
    event::Body e;
    e.id = r.u32(), e.map = r.u32(), e.def.scale = r.f32(), e.def.mass = r.f32(), e.def.centre_of_mass = r.vec3();
    e.def.pose = read_pose(r), e.def.twist = read_twist(r);
    require(within(e.def.scale, 1e-3f, 1e3) && within(e.def.mass, 0, 1e9) && within(e.def.centre_of_mass, 1e6),
            "a body's scale, mass or centre of mass");
    return e;
}

event::Motion read_motion(ByteReader& r) {
    event::Motion e;
    e.id = r.u32(), e.pose = read_pose(r), e.twist = read_twist(r);
    return e;
}

event::Tick read_tick(ByteReader& r) {
    event::Tick e;
    e.dt = r.f32();
    const std::uint32_t bodies = r.u32();
    if (bodies > r.left() / 120) throw Error(FRM_ERROR_CORRUPT, "a tick has more bodies than its block");
    e.forces.resize(bodies);
    for (Forces& f : e.forces)
        for (Wrench* part : {&f.buoyancy, &f.pressure, &f.friction, &f.gravity, &f.total}) *part = read_wrench(r);
    e.has_hash = r.u8() != 0;
    if (e.has_hash) e.hash = r.u64();
    return e;
}

event::Device read_device(ByteReader& r) {
    event::Device e;
    e.serial = r.u32(), e.max_force = r.f32(), e.max_torque = r.f32();
    const std::size_t length = r.u8();
    e.name.assign(reinterpret_cast<const char*>(r.take(length)), length);
    return e;
}

event::Exchange read_exchange(ByteReader& r) {
    event::Exchange e;
    e.device = r.u32();
    e.command.force = read_plain(r), e.command.torque = read_plain(r);
    frm_device_state& s = e.state;
    s.struct_size = sizeof s;
    s.status = r.u32();
    s.pose.position.x = r.f64(), s.pose.position.y = r.f64(), s.pose.position.z = r.f64();
    s.pose.rotation.x = r.f32(), s.pose.rotation.y = r.f32(), s.pose.rotation.z = r.f32(), s.pose.rotation.w = r.f32();
    s.twist.linear = read_plain(r), s.twist.angular = read_plain(r);
    s.grip = r.f32(), s.buttons = r.u32(), s.time_ns = r.u64(), s.sequence = r.u64();
    return e;
}

Event read_event(ByteReader& r, std::uint32_t version) {
    const std::uint8_t type = r.u8();
    switch (static_cast<EventType>(type)) {
        case EventType::world:
            return read_world(r, version);
        case EventType::map:
            return read_map(r);
        case EventType::water:
            return read_water(r, version);
        case EventType::water_end:
            return event::WaterEnd{};
        case EventType::height:
            return event::Height{read_values(r)};
        case EventType::pressure:
            return event::Pressure{read_values(r)};
        case EventType::body:
            return read_body(r);
        case EventType::body_end:
            return event::BodyEnd{r.u32()};
        case EventType::motion:
            return read_motion(r);
        case EventType::tick:
            return read_tick(r);
        case EventType::device:
            return read_device(r);
        case EventType::exchange:
            return read_exchange(r);
        case EventType::end:
            return event::End{r.u64()};
    }
    throw Error(FRM_ERROR_CORRUPT, "an event of type %u is not known", type);
}

constexpr std::size_t file_header_bytes = 16, block_header_bytes = 24;
constexpr std::uint64_t largest_block = std::uint64_t{1} << 31;

}  // namespace

RecordingReader::RecordingReader(const char* path) : path_(path) {
    std::FILE* file = open_file(path, "rb");
    if (!file) throw Error(FRM_ERROR_FILE, "%s: %s", path, std::strerror(errno));
    std::uint8_t block[1 << 16];
    std::size_t got;
    while ((got = std::fread(block, 1, sizeof block, file)) > 0) file_.insert(file_.end(), block, block + got);
    const bool bad = std::ferror(file) != 0;
    std::fclose(file);
    if (bad) throw Error(FRM_ERROR_FILE, "%s: cannot be read", path);
    ByteReader r(file_.data(), file_.size(), path);
    if (file_.size() < file_header_bytes || std::memcmp(r.take(8), recording_magic, 8) != 0)
        throw Error(FRM_ERROR_CORRUPT, "%s: this is not a recording (its first bytes are not the format's)", path);
    version_ = r.u32();
    if (version_ < 1 || version_ > recording_version)
        throw Error(FRM_ERROR_VERSION, "%s: recording version %u; this library reads versions 1 to %u", path, version_,
                    recording_version);
    if (r.u32() != 0) throw Error(FRM_ERROR_VERSION, "%s: the header has flags that this library does not know", path);
    rewind();
}

void RecordingReader::rewind() {
    at_file_ = file_header_bytes;
    at_raw_ = blocks_ = 0;
    raw_.clear();
    torn_ = ended_ = false;
}

bool RecordingReader::next_block() {
    const std::size_t left = file_.size() - at_file_;
    if (left < block_header_bytes) return false;
    ByteReader r(file_.data() + at_file_, left, path_.c_str());
    if (r.u32() != block_mark) throw Error(FRM_ERROR_CORRUPT, "%s: block %zu is damaged", path_.c_str(), blocks_);
    if (r.u32() != 0)
        throw Error(FRM_ERROR_CORRUPT, "%s: block %zu: its reserved field is not 0", path_.c_str(), blocks_);
    const std::uint64_t stored = r.u64(), raw = r.u64();
    if (stored > r.left()) return false;
    if (raw > largest_block) throw Error(FRM_ERROR_CORRUPT, "%s: block %zu is too large", path_.c_str(), blocks_);
    const std::uint8_t* data = r.take(static_cast<std::size_t>(stored));
    if (ZSTD_getFrameContentSize(data, static_cast<std::size_t>(stored)) != raw)
        throw Error(FRM_ERROR_CORRUPT, "%s: block %zu is damaged", path_.c_str(), blocks_);
    raw_.resize(static_cast<std::size_t>(raw));
    const std::size_t size = ZSTD_decompress(raw_.data(), raw_.size(), data, static_cast<std::size_t>(stored));
    if (ZSTD_isError(size) || size != raw_.size())
        throw Error(FRM_ERROR_CORRUPT, "%s: block %zu is damaged (%s)", path_.c_str(), blocks_,
                    ZSTD_isError(size) ? ZSTD_getErrorName(size) : "size");
    at_file_ += block_header_bytes + static_cast<std::size_t>(stored);
    at_raw_ = 0;
    ++blocks_;
    return true;
}

bool RecordingReader::next(Event& event) {
    if (ended_ || torn_) return false;
    while (at_raw_ == raw_.size()) {
        if (!next_block()) {
            torn_ = true;
            return false;
        }
    }
    ByteReader r(raw_.data() + at_raw_, raw_.size() - at_raw_, "an event");
    try {
        event = read_event(r, version_);
    } catch (const Error& error) {
        throw Error(error.status(), "%s: block %zu: %s", path_.c_str(), blocks_ - 1, error.text());
    }
    at_raw_ = raw_.size() - r.left();
    ended_ = std::holds_alternative<event::End>(event);
    return true;
}

}  // namespace frm::device
