#include <zstd.h>

#include <cerrno>
#include <cstring>

#include "core/file.h"
#include "device/recording_columns.h"

namespace frm::device {
namespace {

using Writer = ByteWriter<std::vector<std::uint8_t>>;

void put(Writer& w, const Pose& p) {
    w.f64(p.position.x), w.f64(p.position.y), w.f64(p.position.z);
    w.f32(p.rotation.x), w.f32(p.rotation.y), w.f32(p.rotation.z), w.f32(p.rotation.w);
}

void put(Writer& w, const Twist& t) { w.vec3(t.linear), w.vec3(t.angular); }

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
    void operator()(const event::Device& e) const {
        type(EventType::device);
        w.u32(e.serial), w.f32(e.max_force), w.f32(e.max_torque);
        w.u8(static_cast<std::uint8_t>(e.name.size()));
        w.bytes(e.name.data(), e.name.size());
    }
    void operator()(const event::End& e) const { type(EventType::end), w.u64(e.ticks); }
    void operator()(const event::Gap& e) const { type(EventType::gap), w.u64(e.events); }
    // These are columns.
    void operator()(const event::Motion&) const {}
    void operator()(const event::Tick&) const {}
    void operator()(const event::Exchange&) const {}
};

constexpr std::size_t bytes_a_block = std::size_t{1} << 18;

void put_place(Writer& w, const BlockPlace& place) {
    w.u32(block_mark), w.u32(static_cast<std::uint32_t>(place.kind)), w.u32(place.stored), w.u32(place.raw);
    w.u64(place.tick), w.f64(place.time);
}

}  // namespace

RecordingWriter::RecordingWriter(const char* path)
    : path_(path), part_(path_ + ".part"), columns_(std::make_unique<ColumnWriter>()) {
    file_ = open_file(part_.c_str(), "wb");
    if (!file_) throw Error(FRM_ERROR_FILE, "%s: %s", part_.c_str(), std::strerror(errno));
    std::vector<std::uint8_t> head;
    Writer w(head);
    w.bytes(recording_magic, sizeof recording_magic);
    w.u32(recording_version);
    w.u32(0);
    put(head.data(), head.size());
}

RecordingWriter::~RecordingWriter() {
    if (file_) std::fclose(file_);
}

void RecordingWriter::write(const Event& event) {
    const bool in_columns = std::holds_alternative<event::Tick>(event) ||
                            std::holds_alternative<event::Motion>(event) ||
                            std::holds_alternative<event::Exchange>(event);
    if (!in_columns) {
        if (events_ > 0) flush();
        if (const auto* end = std::get_if<event::BodyEnd>(&event)) motions_.erase(end->id);
        Writer w(raw_);
        std::visit(Encode{w}, event);
        if (raw_.size() >= bytes_a_block) flush();
        return;
    }
    if (!raw_.empty()) flush();
    if (events_ == 0 && fresh_) start_run();
    // It is not changed: encoding only reads.
    columns_->code(const_cast<Event&>(event));
    ++events_;
    if (const auto* motion = std::get_if<event::Motion>(&event)) motions_[motion->id] = *motion;
    if (const auto* tick = std::get_if<event::Tick>(&event)) {
        tick_ = tick->tick;
        time_ = tick->time;
        if (tick_ - block_tick_ >= frame_ticks || time_ - block_time_ >= frame_seconds) flush();
    }
    if (events_ >= frame_events || columns_->coder().size() >= bytes_a_block) flush();
}

// Whoever starts reading here knows where every body is.
void RecordingWriter::start_run() {
    columns_->restart();
    run_tick_ = tick_, run_time_ = time_;
    for (const auto& [id, motion] : motions_) {
        Event again = motion;
        columns_->code(again);
        ++events_;
    }
}

void RecordingWriter::flush() {
    if (!raw_.empty()) {
        stored_.resize(ZSTD_compressBound(raw_.size()));
        ZSTD_CCtx* context = ZSTD_createCCtx();
        if (!context) throw std::bad_alloc();
        ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 3);
        ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
        const std::size_t size = ZSTD_compress2(context, stored_.data(), stored_.size(), raw_.data(), raw_.size());
        ZSTD_freeCCtx(context);
        if (ZSTD_isError(size)) throw Error(FRM_ERROR_INTERNAL, "zstd: %s", ZSTD_getErrorName(size));
        stored_.resize(size);
        put_block(BlockKind::bytes, raw_.size(), stored_);
        raw_.clear();
    } else if (events_ > 0) {
        stored_.clear();
        columns_->coder().finish(stored_);
        put_block(fresh_ ? BlockKind::first_columns : BlockKind::columns, events_, stored_);
        fresh_ = tick_ - run_tick_ >= run_ticks || time_ - run_time_ >= run_seconds;
        events_ = 0;
    }
    block_tick_ = tick_, block_time_ = time_;
}

void RecordingWriter::put_block(BlockKind kind, std::size_t raw, const std::vector<std::uint8_t>& contents) {
    if (contents.size() > largest_block || raw > largest_block)
        throw Error(FRM_ERROR_LIMIT, "%s: a block of a recording takes 2^31 bytes", path_.c_str());
    const BlockPlace place{offset_,
                           block_tick_,
                           block_time_,
                           kind,
                           static_cast<std::uint32_t>(contents.size()),
                           static_cast<std::uint32_t>(raw)};
    if (kind == BlockKind::first_columns || kind == BlockKind::bytes) index_.push_back(place);
    std::vector<std::uint8_t> block;
    Writer w(block);
    put_place(w, place);
    w.u32(check_of(block.data(), block.size()));
    w.u32(check_of(contents.data(), contents.size()));
    w.bytes(contents.data(), contents.size());
    put(block.data(), block.size());
    if (failure_ == 0 && std::fflush(file_) != 0) failure_ = errno;
}

// The places from which a reader can start, and at the very end of the file where they are.
void RecordingWriter::write_index() {
    const std::uint64_t at = offset_;
    std::vector<std::uint8_t> contents;
    Writer w(contents);
    for (const BlockPlace& place : index_)
        w.u64(place.offset), w.u64(place.tick), w.f64(place.time), w.u64(static_cast<std::uint64_t>(place.kind));
    put_block(BlockKind::index, index_.size(), contents);
    std::vector<std::uint8_t> tail;
    Writer end(tail);
    end.u64(at);
    end.bytes(index_magic, sizeof index_magic);
    put(tail.data(), tail.size());
}

void RecordingWriter::put(const void* data, std::size_t size) {
    offset_ += size;
    if (failure_ == 0 && std::fwrite(data, 1, size, file_) != size) failure_ = errno;
}

void RecordingWriter::close() {
    flush();
    write_index();
    if (failure_ == 0 && std::fflush(file_) != 0) failure_ = errno;
    if (std::fclose(file_) != 0 && failure_ == 0) failure_ = errno;
    file_ = nullptr;
    if (failure_ == 0) failure_ = replace_file(part_.c_str(), path_.c_str());
    if (failure_ != 0)
        throw Error(FRM_ERROR_FILE, "%s: %s; what was written is in %s", path_.c_str(), std::strerror(failure_),
                    part_.c_str());
}

}  // namespace frm::device
