/*
 * frm_bake - from a mesh to a map, inside an editor or a pipeline.
 *
 * What the program `frm bake` does, as a library of its own (libfrm_bake; hosts that only play maps need libfrm alone).
 * A *bake* is an object: it plans (what will it take?), runs on threads of its own, tells how it stands, can be
 * cancelled, and gives the map's bytes or writes the file.
 *
 *   frm_bake bake;      frm_bake_create(&bake);
 *   frm_bake_def def;   frm_bake_def_init(&def, sizeof def);
 *   def.mesh = "paddle.glb";   def.work = "paddle.frm.work";
 *   frm_bake_plan(bake, &def, NULL);
 *   frm_bake_start(bake);
 *   for (;;) {
 *       frm_bake_progress p = { sizeof p };
 *       frm_bake_get_progress(bake, &p);
 *       if (p.stage != FRM_BAKE_RUNNING) break;
 *       ... show p.share, p.seconds_left; frm_bake_cancel(bake) if the user wants ...
 *   }
 *   frm_bake_wait(bake);   frm_bake_write_map(bake, "paddle.frm");
 *   frm_bake_destroy(bake);
 *
 * Units, results, last-error text, growable structs and the two-call rule are those of frm.h. Names of status values
 * are frm_status_name's, which is in libfrm.
 *
 * Threads. Tags as in frm.h; an [owner] call has one thread at a time per bake. A bake computes on OpenMP's threads,
 * and the map does not depend on their number. libgomp keeps idle threads spinning for a while by default: where other
 * work wants the processors too, a bake is then many times slower. Set OMP_WAIT_POLICY=passive in the environment
 * before the process starts (libgomp reads it when it is loaded; the program frm does this for itself), or leave cores
 * free with frm_bake_def.threads.
 *
 * The library installs no signal handler. A host that dies loses nothing that was finished, if def.work is set: the
 * same def goes on from there, also in `frm bake --work`, and two bakes of the same thing at once share the work.
 */
#ifndef FRM_BAKE_H
#define FRM_BAKE_H

#include "frm.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As a frm.h handle: 0 is none; one that is stale gives FRM_ERROR_HANDLE, never a crash. Handles of libfrm are none
 * here. */
typedef uint64_t frm_bake;

typedef enum frm_bake_quality {
    FRM_BAKE_DRAFT = 0,
    FRM_BAKE_STANDARD = 1,
    FRM_BAKE_HIGH = 2
} frm_bake_quality;

typedef enum frm_bake_stage {
    FRM_BAKE_NEW = 0,      /* nothing planned */
    FRM_BAKE_PLANNED = 1,  /* may start */
    FRM_BAKE_RUNNING = 2,
    FRM_BAKE_DONE = 3,     /* there is a map */
    FRM_BAKE_FAILED = 4,   /* frm_bake_wait says why; may start again */
    FRM_BAKE_CANCELLED = 5 /* may start again, and goes on where it was if there is a work folder */
} frm_bake_stage;

typedef struct frm_bake_def {
    uint32_t struct_size;
    uint32_t quality;     /* frm_bake_quality; default FRM_BAKE_STANDARD */
    const char *mesh;     /* path of a .glb or .gltf, UTF-8; required */
    const char *work;     /* folder for finished flows, made if need be, a sub-folder for each set of options; null
                             (default): they are kept in memory alone, and are lost with the process */
    double scale;         /* what the mesh's coordinates are multiplied by to be metres, 1e-6 to 1e6; default 1 */
    double density;       /* 1e-3 to 1e5 kg/m^3; default 1000 */
    double viscosity;     /* kinematic, 1e-9 to 1e2 m^2/s; default 1e-6 */
    double speed;         /* of the stream, 1e-6 to 1e4 m/s; default 0.5 */
    const double *speeds; /* speed_count further speeds in the same range, in any order: the map then follows the
                             Reynolds number. Each costs as much as the first. Default null: none */
    uint32_t speed_count; /* 0 to 15; one that is `speed`, or there twice, counts once */
    uint32_t spin;        /* 1: turns about three axes in still water are solved too; default 0 */
    uint32_t added_mass;  /* 0: the map has none; default 1 */
    uint32_t symmetry;    /* 0: solve every direction, whatever symmetry the mesh has; default 1 */
    double resolution;    /* grid cells across the object, 4 to 512; default 0: by quality */
    uint32_t directions;  /* exactly so many, before symmetry: 6, 18, 38, 66, 102, ... 1026; default 0: by quality,
                             and more where the force bends */
    uint32_t sources;     /* 1 to 4096; default 0: by their error */
    uint32_t triangles;   /* sample triangles at most, 4 to 2097152; default 0: 2000 */
    uint32_t threads;     /* 1 to 256; default 0: as many as OpenMP gives */
    double threshold;     /* harmonics of the fluctuation below this share of the largest mean force are dropped, 0 to
                             1; default 2e-4 */
} frm_bake_def;

typedef struct frm_bake_plan_info {
    uint32_t struct_size;
    uint32_t flows;      /* runs of the flow solver */
    uint32_t flows_done; /* that the work folder has */
    uint32_t most_flows; /* that it can come to: `flows`, unless what they find asks for more directions */
    uint32_t directions; /* that the map stores means for */
    uint32_t sources;
    uint32_t triangles;
    uint32_t isometries; /* that carry the object into itself and are made use of; 1: it has no symmetry, 0:
                            infinitely many, as of a cylinder or a sphere */
    double updates;      /* cell updates of `flows`; a core does some 1e8 a second */
    uint64_t flow_bytes; /* memory of a flow; several run at a time */
    double extent;       /* longest side of the object, after scale, m: what is not between 5 mm and 20 m was probably
                            drawn in another unit */
    char symmetry[96];   /* for people: "none", "8 elements: 4 rotations, 4 reflections", ... */
} frm_bake_plan_info;

typedef struct frm_bake_progress {
    uint32_t struct_size;
    uint32_t stage;       /* frm_bake_stage */
    double share;         /* of the work, 0 to 1; falls where results ask for more flows */
    double seconds_left;  /* below 0: not known */
    uint32_t flows;       /* so far */
    uint32_t flows_done;
    float drag;           /* running mean drag coefficient of the flow named; 0 while it starts */
    float uncertainty;    /* its standard error, as a share; 0 while not known */
    char flow[64];        /* its name, such as "direction 0.71 0.00 -0.71"; empty while other processes have what is
                             left, "making the map" after the last */
} frm_bake_progress;

/* The version of the library that runs. Each pointer may be null. [any] */
FRM_API frm_status FRM_CALL frm_bake_version(uint32_t *major, uint32_t *minor, uint32_t *patch);

/* Fills a def with defaults; writes at most `size` bytes. Null or a size under 4: FRM_ERROR_ARGUMENT. [any] */
FRM_API frm_status FRM_CALL frm_bake_def_init(frm_bake_def *def, uint64_t size);

/* Makes a bake, with nothing planned. At most 64 at a time (FRM_ERROR_LIMIT). [any] */
FRM_API frm_status FRM_CALL frm_bake_create(frm_bake *bake);

/* Cancels what runs, waits for its threads (as frm_bake_cancel) and frees everything but the work folder. Calling
 * it again is harmless and returns FRM_ERROR_HANDLE. No other call on this bake may be running. [owner] */
FRM_API frm_status FRM_CALL frm_bake_destroy(frm_bake bake);

/* The text of the last error of this bake: two-call rule of frm_context_last_error. [any] */
FRM_API frm_status FRM_CALL frm_bake_last_error(frm_bake bake, char *text, uint64_t capacity, uint64_t *size);

/* Reads the mesh and says what the bake will take; `info` may be null. What the def points to is copied.
 * FRM_ERROR_ARGUMENT: an option is out of range, or the mesh cannot be baked; the text names which and what to do.
 * FRM_ERROR_FILE: the work folder. FRM_ERROR_STATE: while it runs. A plan and a map that were there are gone, also
 * where this fails after its arguments were checked. [offline] */
FRM_API frm_status FRM_CALL frm_bake_plan(frm_bake bake, const frm_bake_def *def, frm_bake_plan_info *info);

/* What the user should know of the mesh and of what was found in the work folder, a line each: two-call rule. Empty
 * before frm_bake_plan. [any] */
FRM_API frm_status FRM_CALL frm_bake_get_notes(frm_bake bake, char *text, uint64_t capacity, uint64_t *size);

/* Starts the work, on threads of its own, and returns. FRM_ERROR_STATE unless planned, failed or cancelled. [owner] */
FRM_API frm_status FRM_CALL frm_bake_start(frm_bake bake);

/* How it stands. Never waits for the work. [any] */
FRM_API frm_status FRM_CALL frm_bake_get_progress(frm_bake bake, frm_bake_progress *progress);

/* Asks the work to end; it does so within some tenths of a second, once it makes the map when that is made (some
 * seconds; without added mass some tenths). Flows that are finished stay in the work folder. FRM_OK also if nothing
 * runs. [any] */
FRM_API frm_status FRM_CALL frm_bake_cancel(frm_bake bake);

/* Waits for the work to end. FRM_OK: there is a map. FRM_ERROR_STATE: it was cancelled or never started. Else why it
 * failed: FRM_ERROR_FILE (the work folder: a full disk, say), FRM_ERROR_MEMORY, FRM_ERROR_DIVERGED (the flow cannot be
 * solved so; the text says what to change). [offline] */
FRM_API frm_status FRM_CALL frm_bake_wait(frm_bake bake);

/* The map's bytes, for frm_map_open_memory or a file: writes their number to *size and copies them if `data` is not
 * null; too small: FRM_ERROR_CAPACITY. FRM_ERROR_STATE unless done. [owner] */
FRM_API frm_status FRM_CALL frm_bake_get_map(frm_bake bake, void *data, uint64_t capacity, uint64_t *size);

/* How good the map is, as JSON: two-call rule. FRM_ERROR_STATE unless done. [owner]
 *
 * "errors" has, as shares: "direction_rms" and "direction_worst" (each flow's mean force as the others predict it, of
 * the largest force), "rounding", "uncertainty" (of the worst flow's mean drag, likewise), "added_mass", and what the
 * regions cost ("regions", of which "wet_ratio", "velocity", "arm"). "budgets" has what is asked of some of them.
 * "notes" are those of frm_bake_get_notes that are of the mesh. "flows" has one object a flow: "name", "kind" ("stream"
 * or "spin"), "direction" (of a spin its axis), "speed" (m/s; of a spin rad/s), "cd" and its "uncertainty", "left_out"
 * (how far the others are off that flow). null: not known, or not asked. Names are those of bake.json, which
 * `frm bake --report` writes; more may join them. */
FRM_API frm_status FRM_CALL frm_bake_get_report(frm_bake bake, char *text, uint64_t capacity, uint64_t *size);

/* Writes the map to a file, which appears whole or not at all and replaces an older one. FRM_ERROR_STATE unless done,
 * FRM_ERROR_FILE. path is UTF-8. [owner] */
FRM_API frm_status FRM_CALL frm_bake_write_map(frm_bake bake, const char *path);

/* Takes the finished flows out of the work folder, unless another process uses them, and then the folder if nothing
 * else is in it. To be called when the map is safe. FRM_ERROR_STATE unless done. [owner] */
FRM_API frm_status FRM_CALL frm_bake_clear_work(frm_bake bake);

#ifdef __cplusplus
}
#endif

#endif
