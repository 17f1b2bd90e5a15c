/* Maps: opening good and damaged ones, and what they tell. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calls.h"

static unsigned char *read_file(const char *path, uint64_t *size) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    long length;
    *size = 0;
    if (!file) return NULL;
    if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0) {
        bytes = (unsigned char *)malloc((size_t)length);
        if (bytes && fread(bytes, 1, (size_t)length, file) == (size_t)length) *size = (uint64_t)length;
    }
    fclose(file);
    return bytes;
}

static frm_status fill_info(void *info) { return frm_map_get_info(f.map, (frm_map_info *)info); }
static frm_status fill_source(void *source) { return frm_map_get_source(f.map, 0, (frm_map_source *)source); }

static void open_memory(void) {
    frm_map map = 42;
    frm_map_info info = {sizeof info}, other = {sizeof other};
    uint64_t size, i;
    unsigned char *bytes = read_file(f.map_path, &size), *copy;
    CHECK(bytes && size > 64);
    if (!bytes || size <= 64) return;

    OK(frm_map_open_memory(f.context, bytes, size, &map));
    OK(frm_map_get_info(f.map, &info));
    OK(frm_map_get_info(map, &other));
    CHECK(memcmp(&info, &other, sizeof info) == 0);
    CHECK(info.file_bytes == size);
    OK(frm_map_close(map));
    EXPECT(FRM_ERROR_HANDLE, frm_map_close(map));

    map = 42;
    REFUSED(FRM_ERROR_ARGUMENT, "data", frm_map_open_memory(f.context, NULL, size, &map));
    REFUSED(FRM_ERROR_ARGUMENT, "map", frm_map_open_memory(f.context, bytes, size, NULL));
    CHECK(frm_map_open_memory(f.context, bytes, 0, &map) < 0);
    REFUSED_HANDLES(f.stale_context, f.world, frm_map_open_memory(h, bytes, size, &map));

    /* Cut anywhere, or with any byte changed, it is not that map any more. The copy is of exact size so that a memory
     * checker sees a read past the end. */
    for (i = 1; i < size; i += i < 128 ? 1 : size / 50 + 1) {
        copy = (unsigned char *)malloc((size_t)i);
        if (!copy) break;
        memcpy(copy, bytes, (size_t)i);
        REFUSED(FRM_ERROR_CORRUPT, NULL, frm_map_open_memory(f.context, copy, i, &map));
        free(copy);
    }
    for (i = 0; i < size; i += i < 128 ? 1 : size / 200 + 1) {
        frm_status status;
        bytes[i] ^= 0x10;
        status = frm_map_open_memory(f.context, bytes, size, &map);
        CHECK(status == FRM_ERROR_CORRUPT || status == FRM_ERROR_VERSION);
        bytes[i] ^= 0x10;
    }
    CHECK(map == 42);
    free(bytes);
}

static void what_it_tells(void) {
    frm_map_info info = {sizeof info};
    frm_map_source source = {sizeof source};
    char *text;
    uint64_t size = 0, again = 0;
    uint32_t i;
    double area = 0;

    OK(frm_map_get_info(f.map, &info));
    CHECK(info.format_version > 0 && info.content_hash != 0 && info.file_bytes > 0);
    CHECK(info.sources > 0 && info.directions > 0 && info.samples > 0 && info.triangles > 0);
    CHECK(info.period > 0 && info.base_speed > 0 && info.density > 0 && info.viscosity > 0);
    CHECK(info.reynolds > 0 && info.reynolds_solved > 0 && info.reynolds_solved <= info.reynolds);
    CHECK(info.reference_length > 0 && info.area > 0 && info.volume > 0);
    CHECK(info.quantisation_error >= 0 && info.quantisation_error < 0.1f);
    CHECK(info.bounds_low.x < info.bounds_high.x && info.bounds_low.y < info.bounds_high.y &&
          info.bounds_low.z < info.bounds_high.z);
    CHECK(info.reserved == 0);
    for (i = 0; i < info.sources; ++i) {
        OK(frm_map_get_source(f.map, i, &source));
        CHECK(source.area > 0);
        area += source.area;
    }
    /* The regions cover the whole surface, once. */
    CHECK(area > 0.999 * (double)info.area && area < 1.001 * (double)info.area);
    REFUSED(FRM_ERROR_ARGUMENT, "index", frm_map_get_source(f.map, info.sources, &source));
    REFUSED(FRM_ERROR_ARGUMENT, "index", frm_map_get_source(f.map, UINT32_MAX, &source));

    CHECK(info.fluctuation_directions > 0 && info.speeds == 1 && info.has_spin == 0 && info.has_added_mass == 1);
    CHECK(info.direction_error_rms >= 0 && info.direction_error_worst >= 0 && info.uncertainty >= 0);
    CHECK(info.reserved_2 == 0);

    OK(frm_map_get_provenance(f.map, NULL, 0, &size));
    CHECK(size > 2);
    text = (char *)malloc((size_t)size);
    if (!text) return;
    EXPECT(FRM_ERROR_CAPACITY, frm_map_get_provenance(f.map, text, size - 1, &again));
    CHECK(again == size);
    OK(frm_map_get_provenance(f.map, text, size, &again));
    CHECK(again == size && text[0] == '{' && strlen(text) == size - 1);
    free(text);
}

static void added_mass(void) {
    double once[36], other[36];
    int i, j;

    OK(frm_map_get_added_mass(f.map, 1000.0f, 1.0f, once));
    OK(frm_map_get_added_mass(f.map, 500.0f, 2.0f, other));
    for (i = 0; i < 6; ++i) {
        CHECK(once[7 * i] > 0);
        for (j = 0; j < 6; ++j) {
            const int lengths = 3 + (i >= 3) + (j >= 3);
            const double expected = 0.5 * (double)(1 << lengths) * once[6 * i + j];
            CHECK(once[6 * i + j] == once[6 * j + i]);
            CHECK(other[6 * i + j] >= expected * 0.999999 - 1e-12 && other[6 * i + j] <= expected * 1.000001 + 1e-12);
        }
    }
    once[0] = 42;
    REFUSED(FRM_ERROR_ARGUMENT, "matrix", frm_map_get_added_mass(f.map, 1000.0f, 1.0f, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "density", frm_map_get_added_mass(f.map, 0.0f, 1.0f, once));
    REFUSED(FRM_ERROR_ARGUMENT, "density", frm_map_get_added_mass(f.map, not_a_number, 1.0f, once));
    REFUSED(FRM_ERROR_ARGUMENT, "density", frm_map_get_added_mass(f.map, 2e5f, 1.0f, once));
    REFUSED(FRM_ERROR_ARGUMENT, "scale", frm_map_get_added_mass(f.map, 1000.0f, 0.0f, once));
    REFUSED(FRM_ERROR_ARGUMENT, "scale", frm_map_get_added_mass(f.map, 1000.0f, not_a_number, once));
    REFUSED(FRM_ERROR_ARGUMENT, "scale", frm_map_get_added_mass(f.map, 1000.0f, 2e3f, once));
    REFUSED_HANDLES(f.stale_map, f.world, frm_map_get_added_mass(h, 1000.0f, 1.0f, once));
    CHECK(once[0] == 42);
}

void call_map(void) {
    frm_map map = 42;
    frm_map_info info = {sizeof info};
    frm_map_source source = {sizeof source};
    char text[8];
    uint64_t size;

    REFUSED(FRM_ERROR_FILE, "no such.frm", frm_map_open_file(f.context, "/nowhere/no such.frm", &map));
    REFUSED(FRM_ERROR_FILE, NULL, frm_map_open_file(f.context, "", &map));
    CHECK(frm_map_open_file(f.context, f.directory, &map) < 0);
    REFUSED(FRM_ERROR_ARGUMENT, "path", frm_map_open_file(f.context, NULL, &map));
    REFUSED(FRM_ERROR_ARGUMENT, "map", frm_map_open_file(f.context, f.map_path, NULL));
    REFUSED_HANDLES(f.stale_context, f.water, frm_map_open_file(h, f.map_path, &map));
    CHECK(map == 42);
    open_memory();

    check_filled("frm_map_info", sizeof(frm_map_info), fill_info);
    check_filled("frm_map_source", sizeof(frm_map_source), fill_source);
    what_it_tells();
    added_mass();
    REFUSED(FRM_ERROR_ARGUMENT, "info", frm_map_get_info(f.map, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "source", frm_map_get_source(f.map, 0, NULL));
    REFUSED(FRM_ERROR_ARGUMENT, "size", frm_map_get_provenance(f.map, text, sizeof text, NULL));
    REFUSED_HANDLES(f.stale_map, f.context, frm_map_get_info(h, &info));
    REFUSED_HANDLES(f.stale_map, f.world, frm_map_get_source(h, 0, &source));
    REFUSED_HANDLES(f.stale_map, f.body, frm_map_get_provenance(h, text, sizeof text, &size));
    REFUSED_HANDLES(f.stale_map, f.water, frm_map_close(h));
    REFUSED(FRM_ERROR_STATE, "body", frm_map_close(f.map));
}
