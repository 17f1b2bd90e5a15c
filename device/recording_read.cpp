#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/file.h"
#include "device/recording_columns.h"

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

void require_pose(const Pose& p) {
    const Quat<float>& q = p.rotation;
    require(within(p.position.x, -1e9, 1e9) && within(p.position.y, -1e9, 1e9) && within(p.position.z, -1e9, 1e9) &&
                within(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 0.99, 1.01),
            "a pose");
}

Pose read_pose(ByteReader& r) {
    Pose p;
    p.position.x = r.f64(), p.position.y = r.f64(), p.position.z = r.f64();
    p.rotation.x = r.f32(), p.rotation.y = r.f32(), p.rotation.z = r.f32(), p.rotation.w = r.f32();
    require_pose(p);
    return p;
}

void require_twist(const Twist& t) { require(within(t.linear, 1e4) && within(t.angular, 1e4), "a twist"); }

Twist read_twist(ByteReader& r) {
    Twist t;
    t.linear = r.vec3(), t.angular = r.vec3();
    require_twist(t);
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

/// From version 3 on the events of every tick are not among these.
Event read_event(ByteReader& r, std::uint32_t version) {
    const std::uint8_t type = r.u8();
    const auto in_columns = [&](EventType t) {
        return t == EventType::motion || t == EventType::tick || t == EventType::exchange;
    };
    const bool unknown =
        version < 3 ? type == static_cast<std::uint8_t>(EventType::gap) : in_columns(static_cast<EventType>(type));
    if (!unknown) switch (static_cast<EventType>(type)) {
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
            case EventType::gap:
                return event::Gap{r.u64()};
        }
    throw Error(FRM_ERROR_CORRUPT, "an event of type %u is not known", type);
}

constexpr std::size_t file_header_bytes = 16, old_block_header_bytes = 24, block_header_bytes = 40, tail_bytes = 16;

}  // namespace

RecordingReader::RecordingReader(const char* path) : path_(path), columns_(std::make_unique<ColumnReader>()) {
    file_ = open_file(path, "rb");
    if (!file_) throw Error(FRM_ERROR_FILE, "%s: %s", path, std::strerror(errno));
    try {
        if (std::fseek(file_, 0, SEEK_END) != 0 || std::ftell(file_) < 0)
            throw Error(FRM_ERROR_FILE, "%s: cannot be read", path);
        size_ = static_cast<std::uint64_t>(std::ftell(file_));
        std::uint8_t head[file_header_bytes] = {};
        if (size_ >= sizeof head) read(0, head, sizeof head);
        ByteReader r(head, sizeof head, path);
        if (size_ < sizeof head || std::memcmp(r.take(8), recording_magic, 8) != 0)
            throw Error(FRM_ERROR_CORRUPT, "%s: this is not a recording (its first bytes are not the format's)", path);
        version_ = r.u32();
        if (version_ < 1 || version_ > recording_version)
            throw Error(FRM_ERROR_VERSION, "%s: recording version %u; this library reads versions 1 to %u", path,
                        version_, recording_version);
        if (r.u32() != 0)
            throw Error(FRM_ERROR_VERSION, "%s: the header has flags that this library does not know", path);
        rewind();
    } catch (...) {
        std::fclose(file_);
        throw;
    }
}

RecordingReader::~RecordingReader() { std::fclose(file_); }

void RecordingReader::rewind() {
    at_file_ = file_header_bytes;
    at_raw_ = 0, blocks_ = tick_ = 0;
    time_ = 0;
    raw_.clear();
    events_left_ = 0;
    jumps_.clear();
    torn_ = ended_ = false;
}

void RecordingReader::damaged(const char* what) const {
    throw Error(FRM_ERROR_CORRUPT, "%s: block %llu (at byte %llu): %s", path_.c_str(),
                static_cast<unsigned long long>(blocks_), static_cast<unsigned long long>(at_file_), what);
}

void RecordingReader::read(std::uint64_t offset, void* data, std::size_t size) {
    if (std::fseek(file_, static_cast<long>(offset), SEEK_SET) != 0 || std::fread(data, 1, size, file_) != size)
        throw Error(FRM_ERROR_FILE, "%s: cannot be read", path_.c_str());
}

// False if the file ends inside the head or the contents: cut off.
bool RecordingReader::read_place(std::uint64_t offset, BlockPlace& place) {
    if (offset > size_ || size_ - offset < block_header_bytes) return false;
    std::uint8_t head[block_header_bytes];
    read(offset, head, sizeof head);
    ByteReader r(head, sizeof head, path_.c_str());
    const std::uint32_t mark = r.u32(), kind = r.u32();
    place.offset = offset;
    place.stored = r.u32(), place.raw = r.u32();
    place.tick = r.u64(), place.time = r.f64();
    if (r.u32() != check_of(head, block_header_bytes - 8)) {
        // A machine that lost its power leaves zeros where the file had grown.
        bool zero = true;
        std::uint8_t part[4096];
        for (std::uint64_t at = offset; zero && at < size_; at += sizeof part) {
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(sizeof part, size_ - at));
            read(at, part, count);
            zero = std::all_of(part, part + count, [](std::uint8_t byte) { return byte == 0; });
        }
        if (zero) return false;
        damaged("its head is damaged");
    }
    if (mark != block_mark || kind > static_cast<std::uint32_t>(BlockKind::index)) damaged("its kind is not known");
    place.kind = static_cast<BlockKind>(kind);
    if (place.stored > largest_block || place.raw > largest_block) damaged("it is too large");
    if (size_ - offset - block_header_bytes < place.stored) return false;
    stored_.resize(place.stored);
    read(offset + block_header_bytes, stored_.data(), stored_.size());
    if (r.u32() != check_of(stored_.data(), stored_.size())) damaged("its contents are damaged");
    return true;
}

void RecordingReader::unpack(const BlockPlace& place) {
    at_raw_ = 0;
    events_left_ = 0;
    raw_.clear();
    if (place.kind == BlockKind::bytes) {
        if (ZSTD_getFrameContentSize(stored_.data(), stored_.size()) != place.raw)
            damaged("it does not hold what its head says");
        raw_.resize(place.raw);
        const std::size_t size = ZSTD_decompress(raw_.data(), raw_.size(), stored_.data(), stored_.size());
        if (ZSTD_isError(size) || size != raw_.size()) damaged("it cannot be decompressed");
        return;
    }
    if (place.kind == BlockKind::first_columns) columns_->restart();
    if (place.raw > most_events) damaged("it has too many events");
    columns_->coder().start(stored_.data(), stored_.size());
    events_left_ = place.raw;
}

// The index is not trusted: a block must be what it says there.
void RecordingReader::jump() {
    if (jumps_.empty()) return;
    const BlockPlace to = jumps_.back();
    jumps_.pop_back();
    at_file_ = to.offset;
    BlockPlace place;
    if (to.offset < file_header_bytes || !read_place(to.offset, place) || place.kind != to.kind ||
        place.tick != to.tick)
        throw Error(FRM_ERROR_CORRUPT, "%s: its index does not fit", path_.c_str());
    tick_ = place.tick, time_ = place.time;
}

bool RecordingReader::next_block() {
    if (version_ < 3) return next_block_before_3();
    jump();
    BlockPlace place;
    if (!read_place(at_file_, place)) return false;
    if (place.kind == BlockKind::index) damaged("an index before the end of the recording");
    unpack(place);
    at_file_ += block_header_bytes + place.stored;
    ++blocks_;
    return true;
}

bool RecordingReader::next_block_before_3() {
    const std::uint64_t left = size_ - at_file_;
    if (left < old_block_header_bytes) return false;
    std::uint8_t head[old_block_header_bytes];
    read(at_file_, head, sizeof head);
    ByteReader r(head, sizeof head, path_.c_str());
    if (r.u32() != block_mark || r.u32() != 0) damaged("its head is damaged");
    const std::uint64_t stored = r.u64(), raw = r.u64();
    if (stored > left - old_block_header_bytes) return false;
    if (raw > largest_block) damaged("it is too large");
    stored_.resize(static_cast<std::size_t>(stored));
    read(at_file_ + old_block_header_bytes, stored_.data(), stored_.size());
    BlockPlace place;
    place.raw = static_cast<std::uint32_t>(raw);
    unpack(place);
    at_file_ += old_block_header_bytes + stored;
    ++blocks_;
    return true;
}

bool RecordingReader::next(Event& event) {
    if (ended_ || torn_) return false;
    while (events_left_ == 0 && at_raw_ == raw_.size()) {
        if (!next_block()) {
            torn_ = true;
            return false;
        }
    }
    try {
        if (events_left_ > 0) {
            if (!columns_->code(event) || columns_->coder().beyond())
                throw Error(FRM_ERROR_CORRUPT, "its events cannot be read");
            if (--events_left_ == 0 && !columns_->coder().whole())
                throw Error(FRM_ERROR_CORRUPT, "its events do not end with it");
            if (const auto* motion = std::get_if<event::Motion>(&event))
                require_pose(motion->pose), require_twist(motion->twist);
        } else {
            ByteReader r(raw_.data() + at_raw_, raw_.size() - at_raw_, "an event");
            event = read_event(r, version_);
            at_raw_ = raw_.size() - r.left();
        }
    } catch (const Error& error) {
        throw Error(error.status(), "%s: block %llu: %s", path_.c_str(), static_cast<unsigned long long>(blocks_ - 1),
                    error.text());
    }
    if (auto* tick = std::get_if<event::Tick>(&event)) {
        if (version_ < 3) tick->tick = tick_ + 1, tick->time = time_ + static_cast<double>(tick->dt);
        tick_ = tick->tick, time_ = tick->time;
    }
    ended_ = std::holds_alternative<event::End>(event);
    return true;
}

bool RecordingReader::read_index(std::vector<BlockPlace>& index) {
    if (size_ < file_header_bytes + tail_bytes) return false;
    std::uint8_t tail[tail_bytes];
    read(size_ - tail_bytes, tail, sizeof tail);
    ByteReader r(tail, sizeof tail, path_.c_str());
    const std::uint64_t at = r.u64();
    if (std::memcmp(r.take(8), index_magic, 8) != 0 || at < file_header_bytes || at >= size_) return false;
    BlockPlace place;
    if (!read_place(at, place) || place.kind != BlockKind::index || place.stored != std::uint64_t{place.raw} * 32)
        return false;
    ByteReader entries(stored_.data(), stored_.size(), "the index");
    for (std::uint32_t i = 0; i < place.raw; ++i) {
        BlockPlace entry;
        entry.offset = entries.u64(), entry.tick = entries.u64(), entry.time = entries.f64();
        entry.kind = entries.u64() == 0 ? BlockKind::bytes : BlockKind::first_columns;
        index.push_back(entry);
    }
    return true;
}

void RecordingReader::scan(std::vector<BlockPlace>& index) {
    BlockPlace place;
    for (std::uint64_t at = file_header_bytes; read_place(at, place); at += block_header_bytes + place.stored)
        if (place.kind == BlockKind::first_columns || place.kind == BlockKind::bytes) index.push_back(place);
}

bool RecordingReader::seek(std::uint64_t tick, double time) {
    rewind();
    if (version_ < 3) return false;  // its blocks do not say where they are
    std::vector<BlockPlace> index;
    const bool had = read_index(index);
    if (!had) scan(index);
    std::size_t best = index.size();
    for (std::size_t i = 0; i < index.size(); ++i)
        if (index[i].kind == BlockKind::first_columns && index[i].tick <= tick && index[i].time < time) best = i;
    if (best == index.size()) return had;
    jumps_.push_back(index[best]);
    for (std::size_t i = best; i-- > 0;)
        if (index[i].kind == BlockKind::bytes) jumps_.push_back(index[i]);
    return had;
}

}  // namespace frm::device
