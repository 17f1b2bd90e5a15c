/* Calls every function of frm_bake.h well and badly, from plain C.
 *
 * usage: abi_bake_every_function MESH DIRECTORY */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "frm_bake.h"

static int failures = 0;
static frm_bake bake;

static void check(int ok, int line, const char *what) {
    if (ok) return;
    printf("wrong: line %d: %s\n", line, what);
    ++failures;
}
#define CHECK(condition) check((condition) != 0, __LINE__, #condition)

static const char *last_error(void) {
    static char text[1024];
    uint64_t size = 0;
    text[0] = 0;
    frm_bake_last_error(bake, text, sizeof text, &size);
    return text;
}

static void expect(frm_status got, frm_status expected, const char *naming, int line, const char *call) {
    if (got != expected || (naming && !strstr(last_error(), naming))) {
        printf("wrong: line %d: %s gave %d, not %d: %s\n", line, call, (int)got, (int)expected, last_error());
        ++failures;
    }
}
#define EXPECT(expected, naming, call) expect((call), (expected), (naming), __LINE__, #call)
#define OK(call) EXPECT(FRM_OK, NULL, call)

static void rest(void) {
    const struct timespec t = {0, 20000000};
    nanosleep(&t, NULL);
}

static void small(frm_bake_def *def, const char *mesh) {
    OK(frm_bake_def_init(def, sizeof *def));
    def->mesh = mesh;
    def->quality = FRM_BAKE_DRAFT;
    def->directions = 6;
    def->symmetry = 0; /* six flows */
    def->sources = 6;
    def->resolution = 4;
}

static void without_a_bake(void) {
    uint32_t major = 99, minor = 99, patch = 99;
    frm_bake_def def;
    frm_bake many[64], one_more = 42;
    const frm_bake bad[] = {0, 1, UINT64_MAX, bake + 1, bake ^ 0x100000000u, bake ^ 0x10000};
    uint64_t size;
    size_t i, made = 0;
    frm_bake_progress progress = {sizeof progress};
    OK(frm_bake_version(NULL, NULL, NULL));
    OK(frm_bake_version(&major, &minor, &patch));
    CHECK(major == FRM_VERSION_MAJOR && minor == FRM_VERSION_MINOR && patch == FRM_VERSION_PATCH);
    EXPECT(FRM_ERROR_ARGUMENT, NULL, frm_bake_def_init(NULL, sizeof def));
    EXPECT(FRM_ERROR_ARGUMENT, NULL, frm_bake_def_init(&def, 3));
    memset(&def, 0x55, sizeof def);
    OK(frm_bake_def_init(&def, 8));
    CHECK(def.struct_size == 8 && def.quality == FRM_BAKE_STANDARD && def.threads == 0x55555555u);
    OK(frm_bake_def_init(&def, sizeof def));
    CHECK(!def.mesh && !def.work && def.scale == 1 && def.speed == 0.5 && def.density == 1000 &&
          def.viscosity == 1e-6 && def.resolution == 0 && def.directions == 0 && def.sources == 0 &&
          def.triangles == 0 && def.threads == 0 && !def.speeds && def.speed_count == 0 && def.spin == 0 &&
          def.added_mass == 1 && def.symmetry == 1 && def.threshold == 2e-4);
    EXPECT(FRM_ERROR_ARGUMENT, NULL, frm_bake_create(NULL));
    while (made < 64 && frm_bake_create(&many[made]) == FRM_OK) ++made;
    CHECK(made == 63); /* and `bake` */
    EXPECT(FRM_ERROR_LIMIT, NULL, frm_bake_create(&one_more));
    CHECK(one_more == 42);
    for (i = 0; i < made; ++i) OK(frm_bake_destroy(many[i]));
    EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_start(many[0])); /* stale */
    EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_destroy(many[0]));
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_last_error(bad[i], NULL, 0, &size));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_plan(bad[i], &def, NULL));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_get_notes(bad[i], NULL, 0, &size));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_start(bad[i]));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_get_progress(bad[i], &progress));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_cancel(bad[i]));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_wait(bad[i]));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_get_map(bad[i], NULL, 0, &size));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_get_report(bad[i], NULL, 0, &size));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_write_map(bad[i], "x"));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_clear_work(bad[i]));
        EXPECT(FRM_ERROR_HANDLE, NULL, frm_bake_destroy(bad[i]));
    }
}

static void too_early(void) {
    uint64_t size = 42;
    OK(frm_bake_cancel(bake));
    EXPECT(FRM_ERROR_STATE, "frm_bake_plan", frm_bake_start(bake));
    EXPECT(FRM_ERROR_STATE, "frm_bake_start", frm_bake_wait(bake));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_get_map(bake, NULL, 0, &size));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_get_report(bake, NULL, 0, &size));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_write_map(bake, "nothing.frm"));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_clear_work(bake));
    CHECK(size == 42);
    OK(frm_bake_get_notes(bake, NULL, 0, &size));
    CHECK(size == 1);
}

#define BAD(field, value, naming)                                            \
    do {                                                                     \
        small(&def, mesh);                                                   \
        def.field = (value);                                                 \
        EXPECT(FRM_ERROR_ARGUMENT, naming, frm_bake_plan(bake, &def, NULL)); \
    } while (0)

static void bad_defs(const char *mesh) {
    static const double speeds[] = {0.1, 0, 1}, same[] = {0.1, 0.1000000001};
    struct {
        frm_bake_def def;
        uint64_t more;
    } later;
    frm_bake_def def;
    frm_bake_plan_info info = {sizeof info};
    EXPECT(FRM_ERROR_ARGUMENT, "def is null", frm_bake_plan(bake, NULL, &info));
    BAD(mesh, NULL, "def.mesh is null");
    BAD(mesh, "/nowhere/mesh.glb", "/nowhere/mesh.glb");
    BAD(quality, 3, "def.quality = 3");
    BAD(scale, 0, "def.scale");
    BAD(scale, NAN, "def.scale");
    BAD(speed, -1, "def.speed");
    BAD(density, INFINITY, "def.density");
    BAD(viscosity, 0, "def.viscosity");
    BAD(resolution, 3, "def.resolution");
    BAD(directions, 7, "def.directions = 7");
    BAD(sources, 4097, "def.sources");
    BAD(triangles, 3, "def.triangles");
    BAD(spin, 2, "def.spin = 2");
    BAD(added_mass, 2, "def.added_mass = 2");
    BAD(symmetry, 0x55555555u, "def.symmetry");
    BAD(threshold, 1.5, "def.threshold");
    BAD(speed_count, 1, "def.speeds is null");
    BAD(speed_count, 16, "def.speed_count");
    small(&def, mesh);
    def.speeds = speeds;
    def.speed_count = 3;
    EXPECT(FRM_ERROR_ARGUMENT, "def.speeds[1]", frm_bake_plan(bake, &def, NULL));
    def.speeds = same;
    def.speed_count = 2;
    EXPECT(FRM_ERROR_ARGUMENT, "speeds: two are too near", frm_bake_plan(bake, &def, NULL));
    BAD(threads, 257, "def.threads");
    small(&def, mesh);
    def.struct_size = 3;
    EXPECT(FRM_ERROR_VERSION, "struct_size", frm_bake_plan(bake, &def, NULL));
    memset(&later, 0, sizeof later);
    small(&later.def, mesh);
    later.def.struct_size = sizeof later;
    later.more = 1;
    EXPECT(FRM_ERROR_VERSION, "does not know", frm_bake_plan(bake, &later.def, NULL));
    small(&def, mesh);
    info.struct_size = 0;
    EXPECT(FRM_ERROR_VERSION, "info", frm_bake_plan(bake, &def, &info));
    def.work = "/proc/nowhere/work";
    EXPECT(FRM_ERROR_FILE, "/proc/nowhere/work", frm_bake_plan(bake, &def, NULL));
}

/* What the options make of the plan. */
static void plans(const char *mesh) {
    static const double speeds[] = {2, 0.5, 0.1}; /* one is the base speed */
    frm_bake_def def;
    frm_bake_plan_info info = {sizeof info};
    small(&def, mesh);
    def.symmetry = 1;
    OK(frm_bake_plan(bake, &def, &info));
    CHECK(info.flows == 3 && info.most_flows == 3 && info.isometries == 8);
    CHECK(strstr(info.symmetry, "4 reflections") != NULL);
    def.spin = 1;
    def.speeds = speeds;
    def.speed_count = 3;
    OK(frm_bake_plan(bake, &def, &info));
    CHECK(info.flows == 3 * 3 + 3 && info.most_flows == info.flows);
    OK(frm_bake_def_init(&def, sizeof def));
    def.mesh = mesh;
    def.resolution = 4;
    OK(frm_bake_plan(bake, &def, &info));
    CHECK(info.flows == 10 && info.most_flows == 25); /* standard: 1.5 times as many again */
}

static frm_bake_progress progress_of(void) {
    frm_bake_progress p = {sizeof p};
    OK(frm_bake_get_progress(bake, &p));
    return p;
}

/* Cancelled when the first flow is kept, then gone on with. The map's bytes, to be freed. */
static char *kept_work(const char *mesh, const char *work, uint64_t *size) {
    frm_bake_def def;
    frm_bake_plan_info info = {sizeof info};
    frm_bake_progress p;
    char *map;
    double share = 0;
    uint64_t whole = 0;
    int named = 0;
    small(&def, mesh);
    def.work = work;
    def.threads = 1;
    OK(frm_bake_plan(bake, &def, &info));
    CHECK(info.flows == 6 && info.flows_done == 0 && info.directions == 146 && info.sources == 6);
    CHECK(info.most_flows == 6 && info.isometries == 1 && strcmp(info.symmetry, "none") == 0);
    CHECK(info.updates > 1e6 && info.flow_bytes > 1000 && info.extent > 0.2 && info.extent < 0.5);
    CHECK(progress_of().stage == FRM_BAKE_PLANNED);
    OK(frm_bake_start(bake));
    EXPECT(FRM_ERROR_STATE, "runs", frm_bake_start(bake));
    EXPECT(FRM_ERROR_STATE, "runs", frm_bake_plan(bake, &def, NULL));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_get_map(bake, NULL, 0, &whole));
    EXPECT(FRM_ERROR_STATE, "not done", frm_bake_get_report(bake, NULL, 0, &whole));
    while (p = progress_of(), p.stage == FRM_BAKE_RUNNING && p.flows_done < 1) {
        CHECK(p.share >= share && p.share <= 1 && p.flows == 6);
        share = p.share;
        named |= strncmp(p.flow, "direction ", 10) == 0;
        rest();
    }
    CHECK(named && p.stage == FRM_BAKE_RUNNING);
    OK(frm_bake_cancel(bake));
    EXPECT(FRM_ERROR_STATE, "cancelled", frm_bake_wait(bake));
    CHECK(progress_of().stage == FRM_BAKE_CANCELLED);

    def.threads = 2;
    OK(frm_bake_plan(bake, &def, &info));
    CHECK(info.flows_done >= 1 && info.flows_done < 6);
    OK(frm_bake_start(bake));
    OK(frm_bake_wait(bake));
    OK(frm_bake_wait(bake));
    p = progress_of();
    CHECK(p.stage == FRM_BAKE_DONE && p.share == 1 && p.flows == 6 && p.flows_done == 6);
    EXPECT(FRM_ERROR_STATE, "done", frm_bake_start(bake));
    EXPECT(FRM_ERROR_ARGUMENT, "size is null", frm_bake_get_map(bake, NULL, 0, NULL));
    OK(frm_bake_get_map(bake, NULL, 0, size));
    map = (char *)malloc((size_t)*size);
    EXPECT(FRM_ERROR_CAPACITY, "needed", frm_bake_get_map(bake, map, *size - 1, &whole));
    CHECK(whole == *size);
    OK(frm_bake_get_map(bake, map, *size, &whole));
    EXPECT(FRM_ERROR_VERSION, "progress", frm_bake_get_progress(bake, (p.struct_size = 0, &p)));
    EXPECT(FRM_ERROR_ARGUMENT, "progress", frm_bake_get_progress(bake, NULL));
    return map;
}

static void files(const char *directory, const char *work, const char *map, uint64_t size) {
    char path[1024], *read;
    FILE *file;
    snprintf(path, sizeof path, "%s/bake_every_function.frm", directory);
    EXPECT(FRM_ERROR_ARGUMENT, "path is null", frm_bake_write_map(bake, NULL));
    EXPECT(FRM_ERROR_FILE, "/nowhere/x.frm", frm_bake_write_map(bake, "/nowhere/x.frm"));
    EXPECT(FRM_ERROR_FILE, "/dev/null", frm_bake_write_map(bake, "/dev/null"));
    OK(frm_bake_write_map(bake, path));
    OK(frm_bake_write_map(bake, path));
    read = (char *)malloc((size_t)size + 1);
    file = fopen(path, "rb");
    CHECK(file && fread(read, 1, (size_t)size + 1, file) == size && memcmp(read, map, (size_t)size) == 0);
    if (file) fclose(file);
    remove(path);
    free(read);
    OK(frm_bake_clear_work(bake));
    OK(frm_bake_clear_work(bake));
    CHECK(remove(work) != 0); /* it is gone */
}

/* Of six flows of a draft, which asks nothing of its directions. */
static void the_report(void) {
    uint64_t needed = 0;
    char text[16384];
    const char *flow = text;
    int flows = 0;
    EXPECT(FRM_ERROR_ARGUMENT, "size", frm_bake_get_report(bake, text, sizeof text, NULL));
    OK(frm_bake_get_report(bake, NULL, 0, &needed));
    CHECK(needed > 200 && needed < sizeof text);
    EXPECT(FRM_ERROR_CAPACITY, NULL, frm_bake_get_report(bake, text, needed - 1, &needed));
    OK(frm_bake_get_report(bake, text, sizeof text, &needed));
    CHECK(text[0] == '{' && strlen(text) + 1 == needed);
    CHECK(strstr(text, "\"direction_rms\": 0.") && strstr(text, "\"direction_rms\": null"));
    CHECK(strstr(text, "\"rounding\": 0.00") && strstr(text, "\"direction 1.00 0.00 0.00\""));
    while ((flow = strstr(flow, "\"left_out\": 0.")) != NULL) ++flow, ++flows;
    CHECK(flows == 6);
}

/* In memory alone; and libfrm reads what comes out. */
static void same_again(const char *mesh, const char *map, uint64_t size) {
    frm_bake_def def;
    uint64_t again = 0, needed = 0;
    char *bytes, text[4096];
    frm_context context;
    frm_map opened;
    small(&def, mesh);
    OK(frm_bake_plan(bake, &def, NULL));
    OK(frm_bake_get_notes(bake, NULL, 0, &needed));
    CHECK(needed > 20 && needed < sizeof text);
    EXPECT(FRM_ERROR_CAPACITY, NULL, frm_bake_get_notes(bake, text, needed - 1, &needed));
    OK(frm_bake_get_notes(bake, text, sizeof text, &needed));
    CHECK(strstr(text, "Reynolds number") && text[needed - 2] == '\n');
    EXPECT(FRM_ERROR_ARGUMENT, NULL, frm_bake_last_error(bake, text, sizeof text, NULL));
    OK(frm_bake_start(bake));
    OK(frm_bake_wait(bake));
    OK(frm_bake_get_map(bake, NULL, 0, &again));
    CHECK(again == size);
    bytes = (char *)malloc((size_t)again);
    OK(frm_bake_get_map(bake, bytes, again, &again));
    CHECK(again == size && memcmp(bytes, map, (size_t)size) == 0);
    the_report();
    CHECK(frm_context_create(NULL, &context) == FRM_OK);
    CHECK(frm_map_open_memory(context, bytes, again, &opened) == FRM_OK);
    CHECK(frm_context_destroy(context) == FRM_OK);
    free(bytes);
}

static void destroyed_while_it_runs(const char *mesh) {
    frm_bake_def def;
    const frm_bake gone = bake;
    small(&def, mesh);
    def.quality = FRM_BAKE_HIGH;
    def.resolution = 0;
    OK(frm_bake_plan(bake, &def, NULL));
    OK(frm_bake_start(bake));
    rest();
    CHECK(frm_bake_destroy(bake) == FRM_OK);
    CHECK(frm_bake_destroy(gone) == FRM_ERROR_HANDLE);
}

int main(int argc, char **argv) {
    char work[1024], *map;
    uint64_t size = 0;
    if (argc != 3) return 2;
    snprintf(work, sizeof work, "%s/bake_every_function.work", argv[2]);
    CHECK(frm_bake_create(&bake) == FRM_OK);
    without_a_bake();
    too_early();
    bad_defs(argv[1]);
    plans(argv[1]);
    map = kept_work(argv[1], work, &size);
    files(argv[2], work, map, size);
    same_again(argv[1], map, size);
    destroyed_while_it_runs(argv[1]);
    free(map);
    printf("%d failures\n", failures);
    return failures ? 1 : 0;
}
