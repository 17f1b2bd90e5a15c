// Vectors as wide as the instruction set's registers, by the compiler's vector extension (gcc, clang): for loops that
// keep neighbours in registers, which no compiler finds by itself. Lane by lane it is the same arithmetic at any width.

#if defined(__AVX512F__)
#define FRM_LANES 16
#elif defined(__AVX2__)
#define FRM_LANES 8
#else
#define FRM_LANES 4
#endif

typedef float Lanes __attribute__((vector_size(4 * FRM_LANES), may_alias));
typedef int LaneNumbers __attribute__((vector_size(4 * FRM_LANES), may_alias));

/// x[i - 1], x[i - 2], x[i + 1], x[i + 2] from a vector and its neighbour.
#if FRM_LANES == 16
#define FRM_FROM_LEFT(left, x) \
    __builtin_shufflevector(left, x, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30)
#define FRM_FROM_LEFT_2(left, x) \
    __builtin_shufflevector(left, x, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29)
#define FRM_FROM_RIGHT(x, right) \
    __builtin_shufflevector(x, right, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)
#define FRM_FROM_RIGHT_2(x, right) \
    __builtin_shufflevector(x, right, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17)
#define FRM_LANE_NUMBERS \
    { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 }
#elif FRM_LANES == 8
#define FRM_FROM_LEFT(left, x) __builtin_shufflevector(left, x, 7, 8, 9, 10, 11, 12, 13, 14)
#define FRM_FROM_LEFT_2(left, x) __builtin_shufflevector(left, x, 6, 7, 8, 9, 10, 11, 12, 13)
#define FRM_FROM_RIGHT(x, right) __builtin_shufflevector(x, right, 1, 2, 3, 4, 5, 6, 7, 8)
#define FRM_FROM_RIGHT_2(x, right) __builtin_shufflevector(x, right, 2, 3, 4, 5, 6, 7, 8, 9)
#define FRM_LANE_NUMBERS \
    { 0, 1, 2, 3, 4, 5, 6, 7 }
#else
#define FRM_FROM_LEFT(left, x) __builtin_shufflevector(left, x, 3, 4, 5, 6)
#define FRM_FROM_LEFT_2(left, x) __builtin_shufflevector(left, x, 2, 3, 4, 5)
#define FRM_FROM_RIGHT(x, right) __builtin_shufflevector(x, right, 1, 2, 3, 4)
#define FRM_FROM_RIGHT_2(x, right) __builtin_shufflevector(x, right, 2, 3, 4, 5)
#define FRM_LANE_NUMBERS \
    { 0, 1, 2, 3 }
#endif

typedef int NumbersAnywhere __attribute__((vector_size(4 * FRM_LANES), may_alias, aligned(4)));

/// The bits of floats that begin anywhere.
static inline LaneNumbers load_numbers(const float* p) { return *reinterpret_cast<const NumbersAnywhere*>(p); }
static inline Lanes load(const float* p) { return *reinterpret_cast<const Lanes*>(p); }
static inline void store(float* p, Lanes x) { *reinterpret_cast<Lanes*>(p) = x; }
static inline Lanes all_lanes(float x) { return x - Lanes{}; }
/// x in the first `count` lanes, 0 in the others.
static inline Lanes first_lanes(Lanes x, std::ptrdiff_t count) {
    const LaneNumbers lane = FRM_LANE_NUMBERS;
    return lane < static_cast<int>(count) ? x : Lanes{};
}
/// x in the lanes of a mask (all bits set), 0 in the others; x and y together, where one of them is 0.
static inline Lanes only(Lanes x, LaneNumbers mask) { return (Lanes)((LaneNumbers)x & mask); }
static inline Lanes either(Lanes x, Lanes y) { return (Lanes)((LaneNumbers)x | (LaneNumbers)y); }
/// x with `value` in one lane.
static inline Lanes with_lane(Lanes x, std::ptrdiff_t at, float value) {
    const LaneNumbers lane = FRM_LANE_NUMBERS;
    return lane == static_cast<int>(at) ? all_lanes(value) : x;
}
