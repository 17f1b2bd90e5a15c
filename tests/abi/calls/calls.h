/* What the parts of every_function share: a context with a map, a world, water and a body in it, and checks that say
 * what was expected of which call. A plain C program: it uses the library as any host would. */
#ifndef FRM_TESTS_ABI_CALLS_H
#define FRM_TESTS_ABI_CALLS_H

#include <stddef.h>
#include <stdint.h>

#include "frm.h"

typedef struct fixture {
    const char *map_path;
    const char *directory; /* for files that the tests write */
    frm_context context;
    frm_map map;
    frm_world world;
    frm_water water;
    frm_body body;
    /* Handles that were good once. */
    frm_context stale_context;
    frm_map stale_map;
    frm_world stale_world;
    frm_water stale_water;
    frm_body stale_body;
} fixture;

extern fixture f;
extern const float not_a_number, infinity_f;

/* What a result must be. */
void check(int ok, const char *file, int line, const char *what);
void expect_status(frm_status got, frm_status expected, const char *file, int line, const char *call);
#define CHECK(condition) check((condition) != 0, __FILE__, __LINE__, #condition)
#define EXPECT(expected, call) expect_status((call), (expected), __FILE__, __LINE__, #call)
#define OK(call) EXPECT(FRM_OK, call)

/* A call that must be refused with this status, leave the world as it was, and, if `naming` is not null, leave an
 * error text that names what was wrong. */
uint64_t world_hash(void);
void expect_refused(frm_status got, frm_status expected, uint64_t hash_before, const char *naming, const char *file,
                    int line, const char *call);
#define REFUSED(expected, naming, call)                                                        \
    do {                                                                                       \
        const uint64_t hash_before_ = world_hash();                                            \
        expect_refused((call), (expected), hash_before_, (naming), __FILE__, __LINE__, #call); \
    } while (0)

/* Refused for every kind of bad handle; the call names it h. */
#define REFUSED_HANDLES(stale, wrong_type, call)                                                \
    do {                                                                                        \
        const uint64_t bad_[] = {0, 1, UINT64_MAX, 0x8000000000000000u, (stale), (wrong_type)}; \
        size_t bad_index_;                                                                      \
        for (bad_index_ = 0; bad_index_ < sizeof bad_ / sizeof bad_[0]; ++bad_index_) {         \
            const uint64_t h = bad_[bad_index_];                                                \
            REFUSED(FRM_ERROR_HANDLE, NULL, call);                                              \
        }                                                                                       \
    } while (0)

/* Every def goes through the same: sizes that are smaller and larger than what the library knows. */
typedef frm_status (*init_fn)(void *def, uint64_t size);
typedef frm_status (*use_fn)(const void *def); /* makes an object by the def and destroys it again */
void check_def(const char *name, uint64_t size, init_fn init, use_fn use);

/* Every struct that the library fills: a struct_size that is too small, or zero, or larger. */
typedef frm_status (*fill_fn)(void *result);
void check_filled(const char *name, uint32_t size, fill_fn fill);

/* The parts, one for each section of the header. */
void call_status(void);
void call_context(void);
void call_map(void);
void call_world(void);
void call_water(void);
void call_body(void);
void call_device(void);
void call_servo(void);
void call_recording(void);

#endif
