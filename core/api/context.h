// What stands behind the handles: contexts, the objects in them, and the way into every function of the interface.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <new>
#include <vector>

#include "core/api/axes.h"
#include "core/error.h"
#include "core/math/floating_point.h"
#include "frm.h"

namespace frm::api {

enum class Kind : std::uint8_t { none = 0, context, map, world, water, body, device, recorder, replay, servo };

const char* name_of(Kind kind);

/// Anything that has a handle.
class Object {
public:
    virtual ~Object() = default;
};

/// The caller's allocator, as the standard library's containers want it.
class ContextMemory : public std::pmr::memory_resource {
public:
    ContextMemory(frm_allocate_fn take, frm_free_fn give_back, void* user)
        : allocate_(take), release_(give_back), user_(user) {}

private:
    void* do_allocate(std::size_t bytes, std::size_t alignment) override;
    void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override;
    bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

    frm_allocate_fn allocate_;
    frm_free_fn release_;
    void* user_;
};

class Context {
public:
    Context(const frm_context_def& def, std::uint8_t number, std::atomic<std::uint32_t>& generations);
    ~Context();

    const Axes& axes() const { return axes_; }
    std::uint32_t threads() const { return threads_; }
    std::pmr::memory_resource* memory() { return &memory_; }

    /// Gives an object a handle. `parent` is the handle whose end is this one's end too; 0 for none.
    std::uint64_t add(Kind kind, std::shared_ptr<Object> object, std::uint64_t parent = 0);
    /// Null if the handle is stale or of another kind. [any]
    Object* find(std::uint64_t handle, Kind kind) const;
    /// Ends an object and its children.
    void remove(std::uint64_t handle);
    /// The handle of the first object of a kind that `is` the one; 0 if none is.
    template <typename Predicate>
    std::uint64_t find_handle(Kind kind, Predicate&& is) const {
        for (std::uint32_t i = 0; i < slots_; ++i) {
            const std::uint64_t handle = slot(i)->handle.load();
            const Object* object = find(handle, kind);
            if (object && is(*object)) return handle;
        }
        return 0;
    }

    template <typename T, typename... Arguments>
    std::shared_ptr<T> make(Arguments&&... arguments) {
        return std::allocate_shared<T>(std::pmr::polymorphic_allocator<T>(&memory_),
                                       std::forward<Arguments>(arguments)...);
    }

    void fail(const char* text);
    void copy_error(char* text, std::size_t capacity, std::uint64_t& size);
    [[gnu::format(FRM_PRINTF, 3, 4)]] void log(frm_log_level level, const char* format, ...);
    void poll_log(std::uint32_t* level, char* text, std::uint64_t capacity, std::uint64_t* size);

private:
    struct Slot {
        std::atomic<Object*> object{nullptr};  ///< what [any] calls read
        std::atomic<std::uint64_t> handle{0};
        std::shared_ptr<Object> owner;
        std::uint64_t parent = 0;
    };
    struct Message {
        std::uint32_t level = 0;
        char text[240] = {};
    };
    static constexpr std::uint32_t chunk_slots = 256, max_chunks = 256;
    using Chunk = std::array<Slot, chunk_slots>;

    Slot* slot(std::uint32_t index) const;
    std::uint32_t free_slot();
    void end(Kind kind);

    ContextMemory memory_;
    Axes axes_;
    std::uint32_t threads_;
    std::uint8_t number_;
    std::atomic<std::uint32_t>& generations_;
    std::array<std::atomic<Chunk*>, max_chunks>
        chunks_{};  ///< never move, so that other threads may look while one adds
    std::uint32_t slots_ = 0;
    std::mutex error_lock_;
    char error_[400] = {};
    std::pmr::vector<Message> messages_;
    std::size_t first_message_ = 0, message_count_ = 0;
};

/// The context of a handle of any kind, or null. [any]
Context* context_of(std::uint64_t handle);

/// Runs one function of the interface: floating-point modes set, every exception turned into a status and the
/// last-error text.
template <typename Function>
frm_status guarded(Context* context, Function&& function) noexcept {
    const FloatingPointGuard modes;
    try {
        function();
        return FRM_OK;
    } catch (const Error& error) {
        if (context) context->fail(error.text());
        return error.status();
    } catch (const std::bad_alloc&) {
        if (context) context->fail("out of memory");
        return FRM_ERROR_MEMORY;
    } catch (...) {
        if (context) context->fail("an unexpected error inside the library");
        return FRM_ERROR_INTERNAL;
    }
}

template <typename T>
struct KindOf;

/// As guarded(), with the object of a handle: function(Context&, T&).
template <typename T, typename Function>
frm_status with(std::uint64_t handle, Function&& function) noexcept {
    Context* context = context_of(handle);
    if (!context) return FRM_ERROR_HANDLE;
    return guarded(context, [&] {
        Object* object = context->find(handle, KindOf<T>::kind);
        if (!object) throw Error(FRM_ERROR_HANDLE, "this is not a %s, or it is no more", name_of(KindOf<T>::kind));
        function(*context, static_cast<T&>(*object));
    });
}

/// With a context handle itself: function(Context&).
template <typename Function>
frm_status with_context(frm_context handle, Function&& function) noexcept {
    Context* context = context_of(handle);
    if (!context || (handle >> 32 & 0xFF) != static_cast<std::uint64_t>(Kind::context)) return FRM_ERROR_HANDLE;
    return guarded(context, [&] { function(*context); });
}

}  // namespace frm::api

#include "core/api/arguments.h"
