/* Status, version, context: what there is before any map. */
#include <stdlib.h>
#include <string.h>

#include "calls.h"

void call_status(void) {
    uint32_t major = 0, minor = 99, patch = 99;
    frm_status s;
    for (s = FRM_ERROR_UNSUPPORTED; s <= FRM_OK; ++s) {
        CHECK(strncmp(frm_status_name(s), s ? "FRM_ERROR_" : "FRM_OK", s ? 10 : 7) == 0);
    }
    CHECK(strcmp(frm_status_name(1), "FRM_UNKNOWN") == 0);
    CHECK(strcmp(frm_status_name(FRM_ERROR_UNSUPPORTED - 1), "FRM_UNKNOWN") == 0);
    CHECK(strcmp(frm_status_name(INT32_MIN), "FRM_UNKNOWN") == 0);
    CHECK(strcmp(frm_status_name(INT32_MAX), "FRM_UNKNOWN") == 0);

    OK(frm_version(NULL, NULL, NULL));
    OK(frm_version(NULL, &minor, NULL));
    CHECK(minor == FRM_VERSION_MINOR);
    OK(frm_version(&major, &minor, &patch));
    CHECK(major == FRM_VERSION_MAJOR && patch == FRM_VERSION_PATCH);
}

static frm_status init(void *def, uint64_t size) { return frm_context_def_init((frm_context_def *)def, size); }

static frm_status use(const void *def) {
    frm_context context = 42;
    const frm_status status = frm_context_create((const frm_context_def *)def, &context);
    if (status == FRM_OK) {
        OK(frm_context_destroy(context));
    } else {
        CHECK(context == 42);
    }
    return status;
}

static void bad_defs(void) {
    static const uint32_t bad[][3] = {/* axes, threads, log_capacity */
                                      {4, 1, 64},          {UINT32_MAX, 1, 64}, {0, 0, 64},        {0, 65, 64},
                                      {0, UINT32_MAX, 64}, {0, 1, 4097},        {0, 1, UINT32_MAX}};
    static const uint32_t good[][3] = {{3, 1, 64}, {0, 64, 64}, {0, 1, 0}, {0, 1, 4096}};
    frm_context_def def;
    size_t i;
    OK(init(&def, sizeof def));
    CHECK(def.axes == FRM_AXES_Z_UP_RIGHT && def.threads == 1 && def.log_capacity == 64);
    CHECK(!def.allocate && !def.release && !def.allocator_user);
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        def.axes = bad[i][0];
        def.threads = bad[i][1];
        def.log_capacity = bad[i][2];
        EXPECT(FRM_ERROR_ARGUMENT, use(&def));
    }
    for (i = 0; i < sizeof good / sizeof good[0]; ++i) {
        def.axes = good[i][0];
        def.threads = good[i][1];
        def.log_capacity = good[i][2];
        OK(use(&def));
    }
    EXPECT(FRM_ERROR_ARGUMENT, frm_context_create(NULL, NULL));
}

static void as_many_as_there_may_be(void) {
    frm_context contexts[64], one_more = 42;
    int made = 1, i; /* the fixture's is the first */
    while (made < 64 && frm_context_create(NULL, &contexts[made]) == FRM_OK) ++made;
    CHECK(made == 64);
    EXPECT(FRM_ERROR_LIMIT, frm_context_create(NULL, &one_more));
    CHECK(one_more == 42);
    for (i = 1; i < made; ++i) OK(frm_context_destroy(contexts[i]));
    OK(use(NULL));
}

/* An allocator that counts, and that has nothing more to give at a point to be set. */
typedef struct counter {
    uint64_t bytes, calls, fail_at; /* fail_at: the number of the call that fails, 0 for none */
    int wrong;
} counter;

typedef struct block {
    void *start;
    uint64_t size, alignment;
} block;

static void *FRM_CALL counted_allocate(void *user, uint64_t size, uint64_t alignment) {
    counter *c = (counter *)user;
    char *start, *memory;
    block *head;
    ++c->calls;
    if (alignment == 0 || (alignment & (alignment - 1)) != 0) c->wrong = 1;
    if (c->fail_at && c->calls >= c->fail_at) return NULL;
    start = (char *)malloc((size_t)(size + alignment + sizeof(block)));
    if (!start) return NULL;
    memory = start + sizeof(block);
    memory += (alignment - (uintptr_t)memory % alignment) % alignment;
    head = (block *)(void *)(memory - sizeof(block));
    {
        const block b = {start, size, alignment};
        memcpy(head, &b, sizeof b); /* not aligned when the alignment asked for is small */
    }
    c->bytes += size;
    return memory;
}

static void FRM_CALL counted_free(void *user, void *memory, uint64_t size, uint64_t alignment) {
    counter *c = (counter *)user;
    block b;
    if (!memory) return;
    memcpy(&b, (char *)memory - sizeof(block), sizeof b);
    if (b.size != size || b.alignment != alignment) c->wrong = 1;
    c->bytes -= b.size;
    free(b.start);
}

/* Everything from a context to a tick; the status of the first call that fails. */
static frm_status whole_path(const frm_context_def *def) {
    frm_context context = 0;
    frm_world world;
    frm_water water;
    frm_body body;
    frm_map map;
    frm_body_def body_def;
    frm_status status = frm_context_create(def, &context);
    if (status == FRM_OK) status = frm_map_open_file(context, f.map_path, &map);
    if (status == FRM_OK) status = frm_world_create(context, NULL, &world);
    if (status == FRM_OK) status = frm_water_create(world, NULL, &water);
    if (status == FRM_OK) status = frm_body_def_init(&body_def, sizeof body_def);
    if (status == FRM_OK) {
        body_def.map = map;
        status = frm_body_create(world, &body_def, &body);
    }
    if (status == FRM_OK) status = frm_world_tick(world, 0.002f);
    if (context) OK(frm_context_destroy(context));
    return status;
}

static void own_allocator(void) {
    counter c;
    frm_context_def def;
    uint64_t calls, step;
    memset(&c, 0, sizeof c);
    OK(init(&def, sizeof def));
    def.allocate = counted_allocate;
    EXPECT(FRM_ERROR_ARGUMENT, use(&def));
    def.allocate = NULL;
    def.release = counted_free;
    EXPECT(FRM_ERROR_ARGUMENT, use(&def));
    def.allocate = counted_allocate;
    def.allocator_user = &c;
    OK(whole_path(&def));
    CHECK(c.calls > 0);
    CHECK(c.bytes == 0);
    CHECK(!c.wrong);

    /* Whichever allocation fails, it is an error with nothing lost. At most about 100 of them are tried. */
    calls = c.calls;
    step = calls / 100 + 1;
    for (c.fail_at = 1; c.fail_at <= calls; c.fail_at += step) {
        c.calls = 0;
        EXPECT(FRM_ERROR_MEMORY, whole_path(&def));
        CHECK(c.bytes == 0);
    }
    CHECK(!c.wrong);
}

static void error_text(void) {
    char text[512], part[512];
    uint64_t size = 99, again = 99;
    uint32_t level = 99;
    REFUSED(FRM_ERROR_ARGUMENT, "dt", frm_world_tick(f.world, -1.0f));
    OK(frm_context_last_error(f.context, NULL, 0, &size));
    CHECK(size > 1 && size <= sizeof text);
    memset(text, 0x5A, sizeof text);
    OK(frm_context_last_error(f.context, text, size, &again));
    CHECK(again == size && text[size - 1] == 0 && strlen(text) == size - 1 && text[size] == 0x5A);
    memset(part, 0x5A, sizeof part);
    EXPECT(FRM_ERROR_CAPACITY, frm_context_last_error(f.context, part, size - 1, &again));
    CHECK(again == size && part[size - 1] == 0x5A);
    /* Asking badly is no error of its own: the text that is asked for stays. */
    OK(frm_context_last_error(f.context, part, sizeof part, &again));
    CHECK(again == size && strcmp(part, text) == 0);
    REFUSED_HANDLES(f.stale_context, f.world, frm_context_last_error(h, text, sizeof text, &size));
    REFUSED(FRM_ERROR_ARGUMENT, NULL, frm_context_last_error(f.context, text, sizeof text, NULL));

    /* Drain the log: it ends with size 0. */
    do {
        OK(frm_context_poll_log(f.context, &level, text, sizeof text, &size));
        CHECK(size == 0 || (level <= FRM_LOG_INFO && text[size - 1] == 0));
    } while (size > 0);
    OK(frm_context_poll_log(f.context, NULL, NULL, 0, &size));
    CHECK(size == 0);
    REFUSED(FRM_ERROR_ARGUMENT, "size", frm_context_poll_log(f.context, &level, text, sizeof text, NULL));
    REFUSED_HANDLES(f.stale_context, f.map, frm_context_poll_log(h, &level, text, sizeof text, &size));
}

void call_context(void) {
    check_def("frm_context_def", sizeof(frm_context_def), init, use);
    bad_defs();
    as_many_as_there_may_be();
    own_allocator();
    error_text();
    REFUSED_HANDLES(f.stale_context, f.body, frm_context_destroy(h));
}
