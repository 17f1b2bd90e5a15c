// Checking what a caller hands in: pointers, numbers, growable structs, buffers of the two-call rule.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/error.h"
#include "frm.h"

namespace frm::api {

/// Structs larger than this are memory that nobody filled, not a later version.
constexpr std::uint32_t largest_struct = 4096;

inline void require_pointer(const void* pointer, const char* name) {
    if (!pointer) throw Error(FRM_ERROR_ARGUMENT, "%s is null", name);
}

inline void require_range(double value, double low, double high, const char* name) {
    if (!(value >= low && value <= high))
        throw Error(FRM_ERROR_ARGUMENT, "%s = %g is not within %g to %g", name, value, low, high);
}

/// What a later version has beyond our struct must be zero: we would pass over it.
template <typename T>
void require_known(const T* value, const char* name) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(value);
    for (std::size_t i = sizeof(T); i < value->struct_size; ++i)
        if (bytes[i] != 0) throw Error(FRM_ERROR_VERSION, "%s uses a field that this library does not know", name);
}

template <typename T>
void require_size(const T* value, const char* name) {
    if (value->struct_size < sizeof(std::uint32_t) || value->struct_size > largest_struct)
        throw Error(FRM_ERROR_VERSION, "%s.struct_size = %u is not a size: set it, or call the _def_init", name,
                    value->struct_size);
}

/// Fills a def, never past the caller's size.
template <typename T>
frm_status init_def(T* def, std::uint64_t size, T defaults) {
    if (!def || size < sizeof(std::uint32_t) || size > largest_struct) return FRM_ERROR_ARGUMENT;
    const std::size_t known = size < sizeof(T) ? static_cast<std::size_t>(size) : sizeof(T);
    defaults.struct_size = static_cast<std::uint32_t>(size);
    std::memset(static_cast<void*>(def), 0, static_cast<std::size_t>(size));
    std::memcpy(def, &defaults, known);
    return FRM_OK;
}

/// Reads a def of any version: what the caller's lacks keeps its default, what we do not know must be zero. Null: all
/// defaults.
template <typename T>
T read_def(const T* def, T defaults, const char* name) {
    defaults.struct_size = sizeof(T);
    if (!def) return defaults;
    require_size(def, name);
    const std::size_t known = def->struct_size < sizeof(T) ? def->struct_size : sizeof(T);
    std::memcpy(&defaults, def, known);
    require_known(def, name);
    defaults.struct_size = sizeof(T);
    return defaults;
}

/// Writes a result struct, never past the caller's size.
template <typename T>
void write_struct(T* out, T value) {
    const std::uint32_t size = out->struct_size;
    value.struct_size = size;
    std::memcpy(out, &value, size < sizeof(T) ? size : sizeof(T));
}

/// Checks before anything is changed that write_struct can follow.
template <typename T>
void require_out(const T* out, const char* name) {
    require_pointer(out, name);
    require_size(out, name);
    require_known(out, name);
}

/// The two-call rule for text.
inline void write_text(const char* from, std::size_t length, char* text, std::uint64_t capacity, std::uint64_t* size) {
    require_pointer(size, "size");
    *size = length + 1;
    if (!text) return;
    if (capacity < length + 1)
        throw Error(FRM_ERROR_CAPACITY, "the buffer takes %llu bytes; %llu are needed",
                    static_cast<unsigned long long>(capacity), static_cast<unsigned long long>(length + 1));
    std::memcpy(text, from, length);
    text[length] = 0;
}

}  // namespace frm::api
