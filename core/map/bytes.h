// Little-endian fields, one at a time, never a struct image: the same file on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/error.h"
#include "core/math/vec.h"

namespace frm {

/// Appends to any vector of bytes.
template <typename Buffer>
class ByteWriter {
public:
    explicit ByteWriter(Buffer& out) : out_(out) {}

    void u8(std::uint8_t v) { out_.push_back(v); }
    void u32(std::uint32_t v) { integer(v); }
    void u64(std::uint64_t v) { integer(v); }
    void f32(float v) {
        std::uint32_t bits;
        std::memcpy(&bits, &v, sizeof bits);
        integer(bits);
    }
    void f64(double v) {
        std::uint64_t bits;
        std::memcpy(&bits, &v, sizeof bits);
        integer(bits);
    }
    void vec3(const Vec3f& v) { f32(v.x), f32(v.y), f32(v.z); }
    void bytes(const void* data, std::size_t size) {
        const auto* p = static_cast<const std::uint8_t*>(data);
        out_.insert(out_.end(), p, p + size);
    }

private:
    template <typename T>
    void integer(T v) {
        for (std::size_t i = 0; i < sizeof v; ++i) out_.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
    }

    Buffer& out_;
};

/// Reads from a range of bytes and never past it. `what` names the range in errors.
class ByteReader {
public:
    ByteReader(const std::uint8_t* data, std::size_t size, const char* what) : at_(data), left_(size), what_(what) {}

    std::size_t left() const { return left_; }
    const std::uint8_t* take(std::size_t size) {
        if (size > left_) throw Error(FRM_ERROR_CORRUPT, "%s: ends too early", what_);
        const std::uint8_t* p = at_;
        at_ += size;
        left_ -= size;
        return p;
    }
    std::uint8_t u8() { return *take(1); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(integer<4>()); }
    std::uint64_t u64() { return integer<8>(); }
    float f32() {
        const std::uint32_t bits = u32();
        float v;
        std::memcpy(&v, &bits, sizeof v);
        return v;
    }
    double f64() {
        const std::uint64_t bits = u64();
        double v;
        std::memcpy(&v, &bits, sizeof v);
        return v;
    }
    Vec3f vec3() {
        const float x = f32(), y = f32(), z = f32();
        return {x, y, z};
    }
    /// The range must be used up: what is left over means that the reader and the writer disagree.
    void end() const {
        if (left_ != 0) throw Error(FRM_ERROR_CORRUPT, "%s: %zu bytes too long", what_, left_);
    }

private:
    template <std::size_t N>
    std::uint64_t integer() {
        const std::uint8_t* p = take(N);
        std::uint64_t v = 0;
        for (std::size_t i = 0; i < N; ++i) v |= std::uint64_t{p[i]} << (8 * i);
        return v;
    }

    const std::uint8_t* at_;
    std::size_t left_;
    const char* what_;
};

}  // namespace frm
