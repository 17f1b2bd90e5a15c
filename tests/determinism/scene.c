/* Runs the scene and prints a hash for each section and one over all. See --help. */
#include "tests/determinism/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef FRM_SCENE_CHOOSES
void list_instructions(void) { puts("library"); }
int use_instructions(const char *name) { return strcmp(name, "library") == 0; }
#endif

const Section sections[] = {
    {"maps", FRM_AXES_Z_UP_RIGHT, section_maps},
    {"immersed", FRM_AXES_Z_UP_RIGHT, section_immersed},
    {"surface", FRM_AXES_Z_UP_RIGHT, section_surface},
    {"axes", FRM_AXES_Y_UP_LEFT, section_axes},
    {"fluids", FRM_AXES_Z_UP_RIGHT, section_fluids},
    {"far", FRM_AXES_Z_UP_RIGHT, section_far},
    {"absorbing", FRM_AXES_Z_UP_RIGHT, section_absorbing},
    {"reflecting", FRM_AXES_Z_UP_RIGHT, section_reflecting},
    {"host-water", FRM_AXES_Y_UP_RIGHT, section_host_water},
    {"large", FRM_AXES_Z_UP_RIGHT, section_large},
    {"extreme", FRM_AXES_Z_UP_RIGHT, section_extreme},
    {"teleports", FRM_AXES_Z_UP_RIGHT, section_teleports},
    {"hull", FRM_AXES_Z_UP_RIGHT, section_hull},
    {"models", FRM_AXES_Z_UP_RIGHT, section_models},
    {"skips", FRM_AXES_Z_UP_RIGHT, section_skips},
    {"calm", FRM_AXES_Z_UP_RIGHT, section_calm},
    {"budgets", FRM_AXES_Z_UP_RIGHT, section_budgets},
    {"recording", FRM_AXES_Z_UP_RIGHT, section_recording},
    {"golden", FRM_AXES_Z_UP_RIGHT, section_golden},
};
const unsigned section_count = sizeof sections / sizeof sections[0];

static const uint64_t fnv_offset = UINT64_C(14695981039346656037), fnv_prime = UINT64_C(1099511628211);

static void usage(FILE *out) {
    fputs(
        "usage: scene --data DIR --work DIR [--threads N] [--instructions NAME] [--section NAME]\n"
        "       scene --list-instructions | --list-sections | --help\n"
        "Runs every section of the scene and prints a hash for each and one over all.\n"
        "Exit status: 0; 1 a call failed; 2 wrong arguments; 3 a section does not do what it is there for.\n",
        out);
}

void must(const Scene *scene, frm_status status, const char *call) {
    char text[512] = "";
    uint64_t size = 0;
    if (status == FRM_OK) return;
    if (scene->context) frm_context_last_error(scene->context, text, sizeof text, &size);
    fprintf(stderr, "%s: %s: %s\n", call, frm_status_name(status), text);
    exit(1);
}

void covers(int condition, const char *what) {
    if (condition) return;
    fprintf(stderr, "the scene is not what it should be: %s\n", what);
    exit(3);
}

static void join(const char *folder, const char *name, char *text) {
    const size_t a = strlen(folder), b = strlen(name);
    if (a + b + 2 > 1024) {
        fprintf(stderr, "the path of %s is too long\n", name);
        exit(2);
    }
    memcpy(text, folder, a);
    text[a] = '/';
    memcpy(text + a + 1, name, b + 1);
}

void work_path(const Scene *scene, const char *name, char *text) { join(scene->options->work, name, text); }

void data_path(const Scene *scene, const char *name, char *text) { join(scene->options->data, name, text); }

void see_u64(Scene *scene, uint64_t value) {
    int i;
    for (i = 0; i < 8; ++i) scene->hash = (scene->hash ^ (value >> (8 * i) & 0xFF)) * fnv_prime;
}

void see_u32(Scene *scene, uint32_t value) {
    int i;
    for (i = 0; i < 4; ++i) scene->hash = (scene->hash ^ (value >> (8 * i) & 0xFF)) * fnv_prime;
}

void see_text(Scene *scene, const char *text) {
    for (; *text; ++text) scene->hash = (scene->hash ^ (unsigned char)*text) * fnv_prime;
}

static frm_map open_map(Scene *scene, const char *name) {
    char path[1024];
    frm_map map = 0;
    data_path(scene, name, path);
    MUST(scene, frm_map_open_file(scene->context, path, &map));
    return map;
}

/* Each section in a context of its own, so that none depends on what ran before. */
static uint64_t run(const Options *options, const Section *section) {
    Scene scene;
    frm_context_def def;
    memset(&scene, 0, sizeof scene);
    scene.options = options;
    scene.hash = fnv_offset;
    MUST(&scene, frm_context_def_init(&def, sizeof def));
    def.axes = section->axes;
    def.threads = options->threads;
    MUST(&scene, frm_context_create(&def, &scene.context));
    scene.old_map = open_map(&scene, "v1.frm");
    scene.full_map = open_map(&scene, "v2.frm");
    scene.many_map = open_map(&scene, "many.frm");
    section->run(&scene);
    MUST(&scene, frm_context_destroy(scene.context));
    return scene.hash;
}

static void print_hash(const char *name, uint64_t hash) {
    printf("%-12s %08lx%08lx\n", name, (unsigned long)(hash >> 32), (unsigned long)(hash & 0xFFFFFFFFu));
    fflush(stdout);
}

int main(int argc, char **argv) {
    Options options = {NULL, NULL, NULL, 1};
    Scene all;
    unsigned i, ran = 0;
    int k;
    for (k = 1; k < argc; ++k) {
        const char *const name = argv[k], *const value = k + 1 < argc ? argv[k + 1] : NULL;
        if (strcmp(name, "--help") == 0) {
            usage(stdout);
            return 0;
        }
        if (strcmp(name, "--list-instructions") == 0) {
            list_instructions();
            return 0;
        }
        if (strcmp(name, "--list-sections") == 0) {
            for (i = 0; i < section_count; ++i) puts(sections[i].name);
            return 0;
        }
        if (!value) {
            fprintf(stderr, "unknown, or without its value: %s\n", name);
            usage(stderr);
            return 2;
        }
        ++k;
        if (strcmp(name, "--data") == 0) {
            options.data = value;
        } else if (strcmp(name, "--work") == 0) {
            options.work = value;
        } else if (strcmp(name, "--section") == 0) {
            options.section = value;
        } else if (strcmp(name, "--threads") == 0) {
            options.threads = (uint32_t)strtoul(value, NULL, 10);
        } else if (strcmp(name, "--instructions") == 0) {
            if (!use_instructions(value)) {
                fprintf(stderr, "these instructions cannot be had here: %s\n", value);
                return 2;
            }
        } else {
            fprintf(stderr, "unknown: %s\n", name);
            return 2;
        }
    }
    if (!options.data || !options.work) {
        usage(stderr);
        return 2;
    }
    all.hash = fnv_offset;
    for (i = 0; i < section_count; ++i) {
        uint64_t hash;
        if (options.section && strcmp(options.section, sections[i].name) != 0) continue;
        hash = run(&options, &sections[i]);
        see_text(&all, sections[i].name);
        see_u64(&all, hash);
        print_hash(sections[i].name, hash);
        ++ran;
    }
    if (ran == 0) {
        fprintf(stderr, "there is no such section: %s\n", options.section);
        return 2;
    }
    print_hash("all", all.hash);
    return 0;
}
