#include <zstd.h>

#include <cerrno>
#include <cstring>

#include "core/file.h"
#include "device/recording.h"

namespace frm::device {
namespace {

using Writer = ByteWriter<std::vector<std::uint8_t>>;

void put(Writer& w, const Pose& p) {
    w.f64(p.position.x), w.f64(p.position.y), w.f64(p.position.z);
    w.f32(p.rotation.x), w.f32(p.rotation.y), w.f32(p.rotation.z), w.f32(p.rotation.w);
}

void put(Writer& w, const Twist& t) { w.vec3(t.linear), w.vec3(t.angular); }
void put(Writer& w, const Wrench& v) { w.vec3(v.force), w.vec3(v.torque); }
void put(Writer& w, const frm_vec3& v) { w.f32(v.x), w.f32(v.y), w.f32(v.z); }

void put(Writer& w, const std::vector<float>& values) {
    w.u64(values.size());
    for (const float v : values) w.f32(v);
}

struct Encode {
    Writer& w;

    void type(EventType t) const { w.u8(static_cast<std::uint8_t>(t)); }

    void operator()(const event::World& e) const {
        type(EventType::world);
        w.u32(e.def.model), w.u32(e.def.everywhere), w.f64(e.def.level);
        w.f32(e.def.fluid.gravity), w.f32(e.def.fluid.density), w.f32(e.def.fluid.viscosity);
        w.u32(e.hash_interval), w.u32(e.axes);
        w.u32(e.def.skip), w.f32(e.def.error_budget), w.f32(e.def.time_budget);
    }
    void operator()(const event::Map& e) const {
        type(EventType::map);
        w.u64(e.file.size());
        w.bytes(e.file.data(), e.file.size());
    }
    void operator()(const event::Water& e) const {
        type(EventType::water);
        const FieldDef& f = e.def.field;
        w.u32(static_cast<std::uint32_t>(f.nx)), w.u32(static_cast<std::uint32_t>(f.ny)), w.f32(f.cell), w.f32(f.depth);
        w.u32(f.border == Border::reflecting), w.u32(static_cast<std::uint32_t>(f.border_cells));
        w.f64(e.def.centre_x), w.f64(e.def.centre_y), w.f32(e.def.snapshot_interval);
        w.u32(static_cast<std::uint32_t>(f.order));
    }
    void operator()(const event::WaterEnd&) const { type(EventType::water_end); }
    void operator()(const event::Height& e) const { type(EventType::height), put(w, e.values); }
    void operator()(const event::Pressure& e) const { type(EventType::pressure), put(w, e.values); }
    void operator()(const event::Body& e) const {
        type(EventType::body);
        w.u32(e.id), w.u32(e.map), w.f32(e.def.scale), w.f32(e.def.mass), w.vec3(e.def.centre_of_mass);
        put(w, e.def.pose), put(w, e.def.twist);
    }
    void operator()(const event::BodyEnd& e) const { type(EventType::body_end), w.u32(e.id); }
    void operator()(const event::Motion& e) const {
        type(EventType::motion);
        w.u32(e.id), put(w, e.pose), put(w, e.twist);
    }
    void operator()(const event::Tick& e) const {
        type(EventType::tick);
        w.f32(e.dt);
        w.u32(static_cast<std::uint32_t>(e.forces.size()));
        for (const Forces& f : e.forces)
            for (const Wrench* part : {&f.buoyancy, &f.pressure, &f.friction, &f.gravity, &f.total}) put(w, *part);
        w.u8(e.has_hash);
        if (e.has_hash) w.u64(e.hash);
    }
    void operator()(const event::Device& e) const {
        type(EventType::device);
        w.u32(e.serial), w.f32(e.max_force), w.f32(e.max_torque);
        w.u8(static_cast<std::uint8_t>(e.name.size()));
        w.bytes(e.name.data(), e.name.size());
    }
    void operator()(const event::Exchange& e) const {
        type(EventType::exchange);
        w.u32(e.device);
        put(w, e.command.force), put(w, e.command.torque);
        const frm_device_state& s = e.state;
        w.u32(s.status), w.f64(s.pose.position.x), w.f64(s.pose.position.y), w.f64(s.pose.position.z);
        w.f32(s.pose.rotation.x), w.f32(s.pose.rotation.y), w.f32(s.pose.rotation.z), w.f32(s.pose.rotation.w);
        put(w, s.twist.linear), put(w, s.twist.angular);
        w.f32(s.grip), w.u32(s.buttons), w.u64(s.time_ns), w.u64(s.sequence);
    }
    void operator()(const event::End& e) const { type(EventType::end), w.u64(e.ticks); }
};

constexpr std::uint32_t ticks_a_block = 64;
constexpr std::size_t bytes_a_block = std::size_t{1} << 18;

}  // namespace

RecordingWriter::RecordingWriter(const char* path) : path_(path), part_(path_ + ".part") {
    file_ = open_file(part_.c_str(), "wb");
    if (!file_) throw Error(FRM_ERROR_FILE, "%s: %s", part_.c_str(), std::strerror(errno));
    Writer w(raw_);
    w.bytes(recording_magic, sizeof recording_magic);
    w.u32(recording_version);
    w.u32(0);
    put(raw_.data(), raw_.size());
    raw_.clear();
}

RecordingWriter::~RecordingWriter() {
    if (file_) std::fclose(file_);
}

void RecordingWriter::write(const Event& event) {
    Writer w(raw_);
    std::visit(Encode{w}, event);
    ticks_ += std::holds_alternative<event::Tick>(event);
    if (ticks_ == ticks_a_block || raw_.size() >= bytes_a_block) flush();
}

void RecordingWriter::flush() {
    ticks_ = 0;
    if (raw_.empty()) return;
    stored_.resize(ZSTD_compressBound(raw_.size()));
    ZSTD_CCtx* context = ZSTD_createCCtx();
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 3);
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    const std::size_t size = ZSTD_compress2(context, stored_.data(), stored_.size(), raw_.data(), raw_.size());
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(size)) throw Error(FRM_ERROR_INTERNAL, "zstd: %s", ZSTD_getErrorName(size));
    std::vector<std::uint8_t> head;
    Writer w(head);
    w.u32(block_mark);
    w.u32(0);
    w.u64(size);
    w.u64(raw_.size());
    put(head.data(), head.size());
    put(stored_.data(), size);
    if (std::fflush(file_) != 0 && failure_ == 0) failure_ = errno;
    raw_.clear();
}

void RecordingWriter::put(const void* data, std::size_t size) {
    if (failure_ == 0 && std::fwrite(data, 1, size, file_) != size) failure_ = errno;
}

void RecordingWriter::close() {
    flush();
    if (std::fclose(file_) != 0 && failure_ == 0) failure_ = errno;
    file_ = nullptr;
    if (failure_ == 0) failure_ = replace_file(part_.c_str(), path_.c_str());
    if (failure_ != 0)
        throw Error(FRM_ERROR_FILE, "%s: %s; what was written is in %s", path_.c_str(), std::strerror(failure_),
                    part_.c_str());
}

}  // namespace frm::device
