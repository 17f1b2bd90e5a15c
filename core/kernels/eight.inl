// Eight numbers at once, by the compiler's own vectors where it has them: split into halves where the machine's are
// narrower, with the same bits.

#if defined(__GNUC__)
#define FRM_INLINE static inline __attribute__((always_inline))
typedef float Eight __attribute__((vector_size(32)));
typedef float Four __attribute__((vector_size(16)));
typedef std::int16_t EightWords __attribute__((vector_size(16)));
typedef std::int16_t FourWords __attribute__((vector_size(8)));
typedef std::int32_t EightInts __attribute__((vector_size(32)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));
FRM_INLINE void read(Eight& to, const float* from) { __builtin_memcpy(&to, from, sizeof to); }
FRM_INLINE void read(Four& to, const float* from) { __builtin_memcpy(&to, from, sizeof to); }
FRM_INLINE void read(Eight& to, const std::int16_t* from) {
    EightWords words;
    __builtin_memcpy(&words, from, sizeof words);
#if defined(__AVX2__)  // one instruction for which gcc 12 finds six
    to = __builtin_convertvector((EightInts)_mm256_cvtepi16_epi32((__m128i)words), Eight);
#else
    to = __builtin_convertvector(__builtin_convertvector(words, EightInts), Eight);
#endif
}
FRM_INLINE void read(Four& to, const std::int16_t* from) {
    FourWords words;
    __builtin_memcpy(&words, from, sizeof words);
    to = __builtin_convertvector(__builtin_convertvector(words, FourInts), Four);
}
FRM_INLINE void write(float* to, const Eight& from) { __builtin_memcpy(to, &from, sizeof from); }
FRM_INLINE void write(float* to, const Four& from) { __builtin_memcpy(to, &from, sizeof from); }
FRM_INLINE void fill(Eight& to, float first, float second) {
    to = Eight{first, first, first, first, second, second, second, second};
}
FRM_INLINE void fill(Four& to, float first, float) { to = Four{first, first, first, first}; }
FRM_INLINE void fetch(const void* at) { __builtin_prefetch(at); }
#else
#define FRM_INLINE static inline
template <int N>
struct Lanes {
    float v[N];
    Lanes& operator+=(const Lanes& o) {
        for (int i = 0; i < N; ++i) v[i] += o.v[i];
        return *this;
    }
    friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
    friend Lanes operator-(Lanes a, const Lanes& b) {
        for (int i = 0; i < N; ++i) a.v[i] -= b.v[i];
        return a;
    }
    friend Lanes operator*(Lanes a, const Lanes& b) {
        for (int i = 0; i < N; ++i) a.v[i] *= b.v[i];
        return a;
    }
    friend Lanes operator*(Lanes a, float b) {
        for (int i = 0; i < N; ++i) a.v[i] *= b;
        return a;
    }
};
typedef Lanes<8> Eight;
typedef Lanes<4> Four;
template <int N, typename T>
FRM_INLINE void read(Lanes<N>& to, const T* from) {
    for (int i = 0; i < N; ++i) to.v[i] = static_cast<float>(from[i]);
}
template <int N>
FRM_INLINE void write(float* to, const Lanes<N>& from) {
    for (int i = 0; i < N; ++i) to[i] = from.v[i];
}
template <int N>
FRM_INLINE void fill(Lanes<N>& to, float first, float second) {
    for (int i = 0; i < N; ++i) to.v[i] = i < 4 ? first : second;
}
FRM_INLINE void fetch(const void*) {}
#endif
