/* One scene of everything: what it is made of. Plain C over frm.h, in + - * / alone, so that it is the same scene with
 * every compiler and machine. */
#ifndef FRM_TESTS_DETERMINISM_SCENE_H
#define FRM_TESTS_DETERMINISM_SCENE_H

#include <stdint.h>

#include "frm.h"

/* What the command line says. */
typedef struct Options {
    const char *data;    /* folder of the fixture maps and the recording */
    const char *work;    /* folder for what is written */
    const char *section; /* null: all */
    uint32_t threads;
} Options;

/* A context with the fixture maps open, and the hash of all that was seen in it. */
typedef struct Scene {
    const Options *options;
    frm_context context;
    frm_map old_map;  /* 12 sources, of version 1 of the format: one speed, one direction set */
    frm_map full_map; /* 8 sources, with all that a map can have */
    frm_map many_map; /* 150 sources, some of which fluctuate: clusters, levels of detail, several blocks of lanes */
    uint64_t hash;
} Scene;

typedef struct Section {
    const char *name;
    uint32_t axes;
    void (*run)(Scene *scene);
} Section;

/* Ends the program (status 1) with the text of the library's error unless the status is FRM_OK. */
void must(const Scene *scene, frm_status status, const char *call);
#define MUST(scene, call) must(scene, call, #call)
/* Ends the program (status 3) if the scene does not do what its section is there for: a hash of nothing proves nothing. */
void covers(int condition, const char *what);
/* `name` in the work folder; in `text`, 1024 bytes. */
void work_path(const Scene *scene, const char *name, char *text);
void data_path(const Scene *scene, const char *name, char *text);

/* Hashing: FNV-1a over the bits of numbers, the lowest byte first. */
void see_u32(Scene *scene, uint32_t value);
void see_u64(Scene *scene, uint64_t value);
void see_float(Scene *scene, float value);
void see_double(Scene *scene, double value);
void see_vec3(Scene *scene, const frm_vec3 *value);
void see_text(Scene *scene, const char *text);
/* Forces, state and every source of a body. */
void see_body(Scene *scene, frm_body body);
/* Counters, and the library's own hash of the world. */
void see_world(Scene *scene, frm_world world);
/* The field or (snapshot) its newest copy. */
void see_water(Scene *scene, frm_water water, int snapshot);

/* Making things. */
frm_world_def world_def(void);
frm_world make_world(Scene *scene, const frm_world_def *def);
frm_water make_water(Scene *scene, frm_world world, uint32_t nx, uint32_t ny, uint32_t border, uint32_t order);
frm_body make_body(Scene *scene, frm_world world, frm_map map, float scale, float mass);

/* Moving things: around a centre, as far as `reach` along each axis, with its own period along each; turning, and the
 * twist that belongs to the way. */
typedef struct Path {
    frm_position centre;
    frm_vec3 reach; /* m */
    double period;  /* s, along x; 1.25 and 1.5 times that along y and z */
    float turn;     /* of the quaternion's vector part */
    float spin;     /* rad/s */
} Path;
void place(Scene *scene, frm_body body, const Path *path, double time);

extern const Section sections[];
extern const unsigned section_count;

/* sections_body.c */
void section_maps(Scene *scene);
void section_immersed(Scene *scene);
void section_surface(Scene *scene);
void section_axes(Scene *scene);
void section_fluids(Scene *scene);
void section_far(Scene *scene);
/* sections_water.c */
void section_absorbing(Scene *scene);
void section_reflecting(Scene *scene);
void section_host_water(Scene *scene);
void section_large(Scene *scene);
void section_extreme(Scene *scene);
void section_teleports(Scene *scene);
void section_hull(Scene *scene);
/* sections_rules.c */
void section_models(Scene *scene);
void section_skips(Scene *scene);
void section_calm(Scene *scene);
void section_budgets(Scene *scene);
/* sections_recording.c */
void section_recording(Scene *scene);
void section_golden(Scene *scene);

/* instructions.cpp; without it (a program that has the shared library alone) the library chooses by itself. */
void list_instructions(void);
int use_instructions(const char *name);

#endif
