#include "core/api/context.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace frm::api {
namespace {

// A handle, from the top: generation (24 bits), kind (8), context (8), index (24).
constexpr std::uint32_t max_contexts = 64;

std::uint64_t make_handle(std::uint32_t generation, Kind kind, std::uint8_t context, std::uint32_t index) {
    return std::uint64_t{generation & 0xFFFFFFu} << 40 | std::uint64_t{static_cast<std::uint8_t>(kind)} << 32 |
           std::uint64_t{context} << 24 | index;
}

std::uint32_t index_in(std::uint64_t handle) { return static_cast<std::uint32_t>(handle & 0xFFFFFFu); }

// The only thing that contexts share: which of them exist. Generations go on from one context of a place to the next,
// so that an old handle never names a new object.
struct Place {
    std::atomic<Context*> context{nullptr};
    std::atomic<std::uint64_t> handle{0};
    std::atomic<std::uint32_t> generations{0};
};
Place places[max_contexts];
std::mutex places_lock;

std::uint32_t next_generation(std::atomic<std::uint32_t>& generations) {
    std::uint32_t generation;
    do {
        generation = (generations.fetch_add(1) + 1) & 0xFFFFFFu;
    } while (generation == 0);
    return generation;
}

void* FRM_CALL default_allocate(void*, std::uint64_t size, std::uint64_t alignment) {
    return ::operator new (static_cast<std::size_t>(size), std::align_val_t{static_cast<std::size_t>(alignment)},
                           std::nothrow);
}

void FRM_CALL default_release(void*, void* memory, std::uint64_t, std::uint64_t alignment) {
    ::operator delete (memory, std::align_val_t{static_cast<std::size_t>(alignment)});
}

frm_context_def default_context() {
    frm_context_def def{};
    def.axes = FRM_AXES_Z_UP_RIGHT;
    def.threads = 1;
    def.log_capacity = 64;
    return def;
}

}  // namespace

const char* name_of(Kind kind) {
    switch (kind) {
        case Kind::context:
            return "context";
        case Kind::map:
            return "map";
        case Kind::world:
            return "world";
        case Kind::water:
            return "water";
        case Kind::body:
            return "body";
        case Kind::device:
            return "device";
        case Kind::recorder:
            return "recorder";
        case Kind::replay:
            return "replay";
        case Kind::servo:
            return "servo";
        case Kind::none:
            break;
    }
    return "handle";
}

void* ContextMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
    void* memory = allocate_(user_, bytes, alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

void ContextMemory::do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) {
    release_(user_, memory, bytes, alignment);
}

Context::Context(const frm_context_def& def, std::uint8_t number, std::atomic<std::uint32_t>& generations)
    : memory_(def.allocate ? def.allocate : default_allocate, def.release ? def.release : default_release,
              def.allocator_user),
      axes_(def.axes),
      threads_(def.threads),
      number_(number),
      generations_(generations),
      messages_(def.log_capacity, Message(), &memory_) {}

Context::~Context() {
    // Who uses before what is used: a servo's thread ends, a recorder closes its file, a device is stopped.
    for (const Kind kind :
         {Kind::servo, Kind::recorder, Kind::replay, Kind::device, Kind::body, Kind::water, Kind::world, Kind::map})
        end(kind);
    for (auto& chunk : chunks_) {
        Chunk* c = chunk.load();
        if (!c) continue;
        std::pmr::polymorphic_allocator<Chunk> allocator(&memory_);
        c->~Chunk();
        allocator.deallocate(c, 1);
    }
}

void Context::end(Kind kind) {
    for (std::uint32_t i = 0; i < slots_; ++i) {
        const std::uint64_t handle = slot(i)->handle.load();
        if (handle != 0 && (handle >> 32 & 0xFF) == static_cast<std::uint64_t>(kind)) remove(handle);
    }
}

Context::Slot* Context::slot(std::uint32_t index) const {
    if (index >= chunk_slots * max_chunks) return nullptr;
    Chunk* chunk = chunks_[index / chunk_slots].load();
    return chunk ? &(*chunk)[index % chunk_slots] : nullptr;
}

std::uint32_t Context::free_slot() {
    for (std::uint32_t i = 0; i < slots_; ++i)
        if (slot(i)->handle.load() == 0) return i;
    if (slots_ == chunk_slots * max_chunks)
        throw Error(FRM_ERROR_LIMIT, "a context takes %u objects", chunk_slots * max_chunks);
    if (slots_ % chunk_slots == 0) {
        std::pmr::polymorphic_allocator<Chunk> allocator(&memory_);
        chunks_[slots_ / chunk_slots].store(new (allocator.allocate(1)) Chunk());
    }
    return slots_++;
}

std::uint64_t Context::add(Kind kind, std::shared_ptr<Object> object, std::uint64_t parent) {
    const std::uint32_t index = free_slot();
    Slot& s = *slot(index);
    const std::uint64_t handle = make_handle(next_generation(generations_), kind, number_, index);
    s.owner = std::move(object);
    s.parent = parent;
    s.object.store(s.owner.get());
    s.handle.store(handle);
    return handle;
}

Object* Context::find(std::uint64_t handle, Kind kind) const {
    if ((handle >> 32 & 0xFF) != static_cast<std::uint64_t>(kind)) return nullptr;
    const Slot* s = slot(index_in(handle));
    return s && s->handle.load() == handle ? s->object.load() : nullptr;
}

void Context::remove(std::uint64_t handle) {
    Slot* const found = slot(index_in(handle));
    if (handle == 0 || !found || found->handle.load() != handle) return;  // never had one, or is no more
    Slot& s = *found;
    s.handle.store(0);
    s.object.store(nullptr);
    for (std::uint32_t i = 0; i < slots_; ++i) {
        Slot& child = *slot(i);
        if (child.parent == handle && child.handle.load() != 0) remove(child.handle.load());
    }
    s.parent = 0;
    s.owner.reset();
}

void Context::fail(const char* text) {
    const std::lock_guard<std::mutex> lock(error_lock_);
    std::snprintf(error_, sizeof error_, "%s", text);
}

void Context::copy_error(char* text, std::size_t capacity, std::uint64_t& size) {
    const std::lock_guard<std::mutex> lock(error_lock_);
    write_text(error_, std::strlen(error_), text, capacity, &size);
}

void Context::log(frm_log_level level, const char* format, ...) {
    if (messages_.empty()) return;
    if (message_count_ == messages_.size()) {
        first_message_ = (first_message_ + 1) % messages_.size();
        --message_count_;
    }
    Message& message = messages_[(first_message_ + message_count_) % messages_.size()];
    ++message_count_;
    message.level = static_cast<std::uint32_t>(level);
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(message.text, sizeof message.text, format, arguments);
    va_end(arguments);
}

void Context::poll_log(std::uint32_t* level, char* text, std::uint64_t capacity, std::uint64_t* size) {
    require_pointer(size, "size");
    if (message_count_ == 0) {
        *size = 0;
        return;
    }
    const Message& message = messages_[first_message_];
    write_text(message.text, std::strlen(message.text), text, capacity, size);
    if (level) *level = message.level;
    if (!text) return;
    first_message_ = (first_message_ + 1) % messages_.size();
    --message_count_;
}

Context* context_of(std::uint64_t handle) {
    const auto number = static_cast<std::uint32_t>(handle >> 24 & 0xFF);
    if (handle == 0 || number >= max_contexts) return nullptr;
    if ((handle >> 32 & 0xFF) == static_cast<std::uint64_t>(Kind::context) && places[number].handle.load() != handle)
        return nullptr;
    return places[number].context.load();
}

}  // namespace frm::api

using namespace frm;
using namespace frm::api;

const char* FRM_CALL frm_status_name(frm_status status) {
    switch (status) {
        case FRM_OK:
            return "FRM_OK";
        case FRM_ERROR_ARGUMENT:
            return "FRM_ERROR_ARGUMENT";
        case FRM_ERROR_HANDLE:
            return "FRM_ERROR_HANDLE";
        case FRM_ERROR_STATE:
            return "FRM_ERROR_STATE";
        case FRM_ERROR_VERSION:
            return "FRM_ERROR_VERSION";
        case FRM_ERROR_MEMORY:
            return "FRM_ERROR_MEMORY";
        case FRM_ERROR_FILE:
            return "FRM_ERROR_FILE";
        case FRM_ERROR_CORRUPT:
            return "FRM_ERROR_CORRUPT";
        case FRM_ERROR_CAPACITY:
            return "FRM_ERROR_CAPACITY";
        case FRM_ERROR_LIMIT:
            return "FRM_ERROR_LIMIT";
        case FRM_ERROR_DEVICE:
            return "FRM_ERROR_DEVICE";
        case FRM_ERROR_END:
            return "FRM_ERROR_END";
        case FRM_ERROR_DIVERGED:
            return "FRM_ERROR_DIVERGED";
        case FRM_ERROR_UNSUPPORTED:
            return "FRM_ERROR_UNSUPPORTED";
        case FRM_ERROR_INTERNAL:
            return "FRM_ERROR_INTERNAL";
        default:
            return "FRM_UNKNOWN";
    }
}

frm_status FRM_CALL frm_version(uint32_t* major, uint32_t* minor, uint32_t* patch) {
    if (major) *major = FRM_VERSION_MAJOR;
    if (minor) *minor = FRM_VERSION_MINOR;
    if (patch) *patch = FRM_VERSION_PATCH;
    return FRM_OK;
}

frm_status FRM_CALL frm_context_def_init(frm_context_def* def, uint64_t size) {
    return init_def(def, size, default_context());
}

frm_status FRM_CALL frm_context_create(const frm_context_def* def, frm_context* context) {
    return guarded(nullptr, [&] {
        require_pointer(context, "context");
        const frm_context_def d = read_def(def, default_context(), "def");
        if (d.axes > FRM_AXES_Z_UP_LEFT) throw Error(FRM_ERROR_ARGUMENT, "def.axes = %u is not an frm_axes", d.axes);
        require_range(d.threads, 1, 64, "def.threads");
        require_range(d.log_capacity, 0, 4096, "def.log_capacity");
        if (!d.allocate != !d.release) throw Error(FRM_ERROR_ARGUMENT, "def.allocate and def.release go together");

        const std::lock_guard<std::mutex> lock(places_lock);
        for (std::uint32_t i = 0; i < max_contexts; ++i) {
            Place& place = places[i];
            if (place.context.load()) continue;
            place.context.store(new Context(d, static_cast<std::uint8_t>(i), place.generations));
            place.handle.store(
                make_handle(next_generation(place.generations), Kind::context, static_cast<std::uint8_t>(i), 0));
            *context = place.handle.load();
            return;
        }
        throw Error(FRM_ERROR_LIMIT, "there are %u contexts already", max_contexts);
    });
}

frm_status FRM_CALL frm_context_destroy(frm_context context) {
    return with_context(context, [&](Context& c) {
        // Its place is taken until it is gone, but nobody waits for its files and drivers.
        Place& place = places[context >> 24 & 0xFF];
        place.handle.store(0);
        delete &c;
        place.context.store(nullptr);
    });
}

frm_status FRM_CALL frm_context_last_error(frm_context context, char* text, uint64_t capacity, uint64_t* size) {
    // Not an error of its own: what it reports must stay.
    Context* c = context_of(context);
    if (!c || (context >> 32 & 0xFF) != static_cast<std::uint64_t>(Kind::context)) return FRM_ERROR_HANDLE;
    return guarded(nullptr, [&] {
        require_pointer(size, "size");
        c->copy_error(text, static_cast<std::size_t>(capacity), *size);
    });
}

frm_status FRM_CALL frm_context_poll_log(frm_context context, uint32_t* level, char* text, uint64_t capacity,
                                         uint64_t* size) {
    return with_context(context, [&](Context& c) { c.poll_log(level, text, capacity, size); });
}
