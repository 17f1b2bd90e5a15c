/* every_function: calls each function of frm.h, well and badly, as a host would.
 *
 * usage: every_function MAP.frm DIRECTORY_TO_WRITE_IN (the map may be in the environment as FRM_TEST_MAP) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calls.h"

/* Larger than any struct of the header, with room for what a later version may add. */
enum { BUFFER = 1024, TAIL = 64 };

fixture f;
const float not_a_number = NAN;
const float infinity_f = INFINITY;

static int failures;
static int checks;

/* A check in a loop says the same many times over; twice is enough. */
static int said_enough(int line) {
    static int last_line, times;
    times = line == last_line ? times + 1 : 1;
    last_line = line;
    return times > 2;
}

void check(int ok, const char *file, int line, const char *what) {
    ++checks;
    if (ok) return;
    ++failures;
    if (said_enough(line)) return;
    printf("%s:%d: failed: %s\n", file, line, what);
    fflush(stdout);
}

static void last_error(char *text, uint64_t capacity) {
    uint64_t size = 0;
    text[0] = 0;
    if (frm_context_last_error(f.context, text, capacity, &size) != FRM_OK) strcpy(text, "(no text)");
}

void expect_status(frm_status got, frm_status expected, const char *file, int line, const char *call) {
    char text[1024];
    ++checks;
    if (got == expected) return;
    ++failures;
    if (said_enough(line)) return;
    last_error(text, sizeof text);
    printf("%s:%d: %s gave %s, not %s\n    last error: %s\n", file, line, call, frm_status_name(got),
           frm_status_name(expected), text);
    fflush(stdout);
}

uint64_t world_hash(void) {
    uint64_t hash = 0;
    if (f.world && frm_world_hash(f.world, &hash) != FRM_OK) check(0, __FILE__, __LINE__, "frm_world_hash");
    return hash;
}

void expect_refused(frm_status got, frm_status expected, uint64_t hash_before, const char *naming, const char *file,
                    int line, const char *call) {
    char text[1024];
    expect_status(got, expected, file, line, call);
    last_error(text, sizeof text);
    ++checks;
    if (naming && got == expected && !strstr(text, naming)) {
        ++failures;
        printf("%s:%d: %s: the error text does not name \"%s\": %s\n", file, line, call, naming, text);
    }
    ++checks;
    if (world_hash() != hash_before) {
        ++failures;
        printf("%s:%d: %s was refused but changed the world\n", file, line, call);
    }
    fflush(stdout);
}

static int all_are(const unsigned char *bytes, size_t count, unsigned char value) {
    size_t i;
    for (i = 0; i < count; ++i) {
        if (bytes[i] != value) return 0;
    }
    return 1;
}

/* Buffers are of 64-bit words so that every struct is aligned in them. */
void check_def(const char *name, uint64_t size, init_fn init, use_fn use) {
    uint64_t words[BUFFER / 8];
    unsigned char *bytes = (unsigned char *)words;
    uint64_t s;
    uint32_t written;
    const int failures_before = failures;

    EXPECT(FRM_ERROR_ARGUMENT, init(NULL, size));
    for (s = 0; s < 4; ++s) {
        memset(words, 0xAB, sizeof words);
        EXPECT(FRM_ERROR_ARGUMENT, init(bytes, s));
        CHECK(all_are(bytes, BUFFER, 0xAB));
    }
    for (s = 4; s <= size + TAIL; s += 4) {
        memset(words, 0xAB, sizeof words);
        OK(init(bytes, s));
        CHECK(all_are(bytes + s, BUFFER - s, 0xAB));
        memcpy(&written, bytes, sizeof written);
        CHECK(written == s);
    }

    OK(init(bytes, size));
    OK(use(bytes));

    /* A caller built against a later header, who uses nothing that is new there; and one who does. */
    memset(words, 0xAB, sizeof words);
    OK(init(bytes, size + TAIL));
    OK(use(bytes));
    for (s = size; s < size + TAIL; s += 21) {
        bytes[s] = 1;
        REFUSED(FRM_ERROR_VERSION, NULL, use(bytes));
        bytes[s] = 0;
    }
    OK(use(bytes));

    /* Sizes that are no size of any version: too short for a size, or memory that nobody filled. */
    for (s = 0; s < 6; ++s) {
        written = s < 4 ? (uint32_t)s : UINT32_MAX - (uint32_t)s * 0x01010101u;
        OK(init(bytes, size));
        memcpy(bytes, &written, sizeof written);
        CHECK(use(bytes) < 0);
    }
    if (failures != failures_before) printf("    (in the checks of %s)\n", name);
}

void check_filled(const char *name, uint32_t size, fill_fn fill) {
    uint64_t words[BUFFER / 8];
    unsigned char *bytes = (unsigned char *)words;
    uint32_t s;
    frm_status status;
    const int failures_before = failures;

    for (s = 0; s <= size; s += s < 4 ? 1 : 4) {
        const uint64_t hash_before = world_hash();
        memset(words, 0, sizeof words);
        memset(bytes + (s < 4 ? 4 : s), 0xAB, BUFFER - (s < 4 ? 4 : s));
        memcpy(bytes, &s, sizeof s);
        status = fill(bytes);
        /* Smaller than the first version is an error or filled in part; never is there a write past the end. */
        if (s < 4) CHECK(status < 0);
        if (s == size) CHECK(status == FRM_OK);
        CHECK(all_are(bytes + (s < 4 ? 4 : s), BUFFER - (s < 4 ? 4 : s), 0xAB));
        CHECK(memcmp(bytes, &s, sizeof s) == 0);
        CHECK(status != FRM_OK || world_hash() == hash_before);
    }
    memset(words, 0, sizeof words);
    s = size + TAIL;
    memcpy(bytes, &s, sizeof s);
    OK(fill(bytes));
    CHECK(all_are(bytes + size, TAIL, 0));
    bytes[size + TAIL - 1] = 1;
    REFUSED(FRM_ERROR_VERSION, NULL, fill(bytes));
    memset(bytes, 0xAB, size + TAIL);
    CHECK(fill(bytes) < 0);
    CHECK(all_are(bytes, size + TAIL, 0xAB));
    if (failures != failures_before) printf("    (in the checks of %s)\n", name);
}

static frm_body make_body(frm_world world) {
    frm_body body = 0;
    frm_body_def def;
    OK(frm_body_def_init(&def, sizeof def));
    def.map = f.map;
    def.mass = 1.5f;
    def.pose.position.z = -0.1;
    OK(frm_body_create(world, &def, &body));
    return body;
}

static void make_fixture(void) {
    frm_water_def def;
    OK(frm_context_create(NULL, &f.stale_context));
    OK(frm_context_destroy(f.stale_context));
    OK(frm_context_create(NULL, &f.context));
    OK(frm_map_open_file(f.context, f.map_path, &f.stale_map));
    OK(frm_map_close(f.stale_map));
    OK(frm_map_open_file(f.context, f.map_path, &f.map));

    OK(frm_world_create(f.context, NULL, &f.stale_world));
    OK(frm_world_destroy(f.stale_world));
    OK(frm_world_create(f.context, NULL, &f.world));
    OK(frm_water_def_init(&def, sizeof def));
    def.nx = 48;
    def.ny = 40;
    def.border_cells = 8;
    OK(frm_water_create(f.world, &def, &f.stale_water));
    OK(frm_water_destroy(f.stale_water));
    OK(frm_water_create(f.world, &def, &f.water));
    f.stale_body = make_body(f.world);
    OK(frm_body_destroy(f.stale_body));
    f.body = make_body(f.world);
}

static void destroy_fixture(void) {
    uint64_t hash;
    frm_forces forces = {sizeof forces};
    frm_map_info info = {sizeof info};
    frm_water_state state = {sizeof state};
    const frm_world world = f.world;
    frm_context next;
    frm_world next_world;

    OK(frm_context_destroy(f.context));
    f.world = 0;
    EXPECT(FRM_ERROR_HANDLE, frm_context_destroy(f.context));
    /* An old handle does not name what has taken its place, either. */
    OK(frm_context_create(NULL, &next));
    OK(frm_world_create(next, NULL, &next_world));
    CHECK(next != f.context && next_world != world);
    EXPECT(FRM_ERROR_HANDLE, frm_context_destroy(f.context));
    EXPECT(FRM_ERROR_HANDLE, frm_world_tick(world, 0.002f));
    EXPECT(FRM_ERROR_HANDLE, frm_world_hash(world, &hash));
    EXPECT(FRM_ERROR_HANDLE, frm_body_get_forces(f.body, &forces));
    EXPECT(FRM_ERROR_HANDLE, frm_map_get_info(f.map, &info));
    EXPECT(FRM_ERROR_HANDLE, frm_water_read(f.water, &state));
    OK(frm_context_destroy(next));
}

int main(int argc, char **argv) {
    f.map_path = argc > 1 ? argv[1] : getenv("FRM_TEST_MAP");
    f.directory = argc > 2 ? argv[2] : ".";
    if (!f.map_path) {
        printf("usage: every_function MAP.frm DIRECTORY\n");
        return 2;
    }
    call_status();
    make_fixture();
    if (failures) {
        printf("no fixture, no test\n");
        return 1;
    }
    call_context();
    call_map();
    call_world();
    call_water();
    call_body();
    call_device();
    call_servo();
    call_recording();
    destroy_fixture();
    printf("%d checks: %d failures\n", checks, failures);
    return failures ? 1 : 0;
}
