// An array of floats that begins on a cache line: rows of whole vectors are then read and written without crossing one.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <vector>

namespace frm {

class AlignedFloats {
public:
    explicit AlignedFloats(std::pmr::memory_resource* memory) : lines_(memory) {}
    AlignedFloats(std::size_t size, float value, std::pmr::memory_resource* memory) : lines_(memory) {
        assign(size, value);
    }

    void assign(std::size_t size, float value) {
        Line line;
        for (float& x : line.v) x = value;
        lines_.assign((size + floats - 1) / floats, line);
        size_ = size;
    }
    std::size_t size() const { return size_; }
    float* data() { return reinterpret_cast<float*>(lines_.data()); }
    const float* data() const { return reinterpret_cast<const float*>(lines_.data()); }
    float& operator[](std::size_t i) { return data()[i]; }
    float operator[](std::size_t i) const { return data()[i]; }
    float* begin() { return data(); }
    float* end() { return data() + size_; }

private:
    static constexpr std::size_t floats = 16;
    struct alignas(64) Line {
        float v[floats];
    };
    std::pmr::vector<Line> lines_;
    std::size_t size_ = 0;
};

}  // namespace frm
