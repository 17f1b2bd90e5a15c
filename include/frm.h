/*
 * frm - the force of water on moving rigid objects, at haptic rates.
 *
 * A *map* (Fluid Resistance Map; Dobashi, Sato, Hasegawa, Yamamoto, Kato and Nishita, VRST 2006) holds what a bake
 * learnt about one object: its surface, split into regions with one *haptic source* each, and the pressure and
 * friction force of a uniform stream on every region, from many directions, over time. At run time a *world* holds
 * *bodies* (a map each) and at most one *water* (a height field with waves). One *tick* finds what part of every body
 * is wet, integrates buoyancy, looks the resistance up by the velocity relative to the water, lets the bodies push
 * the water back, and leaves a *wrench* (force and torque) for each body. The host moves the bodies: from a game, a
 * robot, a haptic *device*. A *recorder* keeps all that a world was told; a *replay* checks that it gives the same
 * bits again.
 *
 *   frm_context context;  frm_context_create(NULL, &context);
 *   frm_map map;          frm_map_open_file(context, "paddle.frm", &map);
 *   frm_world world;      frm_world_create(context, NULL, &world);
 *   frm_water water;      frm_water_create(world, NULL, &water);
 *   frm_body_def def;     frm_body_def_init(&def, sizeof def);
 *   def.map = map;        def.mass = 1.2f;
 *   frm_body body;        frm_body_create(world, &def, &body);
 *   for (;;) {
 *       frm_body_set_motion(body, &pose, &twist);
 *       frm_world_tick(world, 0.002f);
 *       frm_forces forces = { sizeof forces };
 *       frm_body_get_forces(body, &forces);
 *       ... apply forces.total to the object at its origin ...
 *   }
 *   frm_context_destroy(context);
 *
 * Units are SI: m, s, kg, N, N m, Pa, rad. Positions are double, all else float.
 *
 * Frames. The world frame is right-handed with z up unless frm_context_def.axes says otherwise; every position,
 * vector and rotation that crosses this interface is in the host's frame. A body's own frame is the frame of the
 * mesh file that was baked; wrenches and twists are about the body's origin, which is the mesh file's origin.
 *
 * Results. Every function returns an frm_status: FRM_OK (0), or a negative error after which nothing has changed
 * except the context's last-error text (frm_context_last_error; functions of any thread write it). Results come
 * through out pointers, which are written only on success.
 *
 * Handles are 64-bit values; 0 is none. A handle that is stale (until 16 million more objects have been made) or of
 * another type gives FRM_ERROR_HANDLE, never a crash. Destroying an object destroys what was made in it: a context its
 * maps, worlds, devices, servos, recorders and replays; a world its water and bodies.
 *
 * Structs that may grow begin with struct_size. Fill a def with its _def_init, then change what you need; a NULL
 * def pointer means all defaults where the function says so. Set struct_size = sizeof of every struct that the
 * library fills. A struct larger than this library knows (up to 4096 bytes) is accepted if what it does not know is
 * zero; otherwise FRM_ERROR_VERSION.
 *
 * Threads. Each function carries one tag:
 *   [any]      any thread, at any time, while the object exists
 *   [owner]    one thread at a time per context; may allocate, lock or read files
 *   [realtime] as [owner], and no lock, no allocation, bounded time; a refused call may allocate and lock briefly
 *   [offline]  as [owner], and may take seconds
 * Two contexts share nothing that a caller can see. Threads that a context with threads > 1 uses are OpenMP's, which
 * keeps them for the process; a recorder has a thread of its own until it is closed.
 *
 * The caller's floating-point modes (rounding, flush to zero) do not matter and are not changed.
 */
#ifndef FRM_H
#define FRM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define FRM_CALL __cdecl
#if defined(FRM_BUILD)
#define FRM_API __declspec(dllexport)
#else
#define FRM_API __declspec(dllimport)
#endif
#else
#define FRM_CALL
#define FRM_API __attribute__((visibility("default")))
#endif

/* Version of this header. The shared library's SOVERSION is the major version. */
#define FRM_VERSION_MAJOR 0
#define FRM_VERSION_MINOR 1
#define FRM_VERSION_PATCH 0

/* ---- Status ------------------------------------------------------------------------------------------------- */

/* Values are pinned for ever. */
typedef int32_t frm_status;
enum {
    FRM_OK = 0,
    FRM_ERROR_ARGUMENT = -1,  /* a null pointer, a number that is not finite or out of range */
    FRM_ERROR_HANDLE = -2,    /* a handle that is 0, stale or of another type */
    FRM_ERROR_STATE = -3,     /* not allowed now: the message says what must come first */
    FRM_ERROR_VERSION = -4,   /* a struct or file from a version that this library does not know */
    FRM_ERROR_MEMORY = -5,    /* the allocator has no more */
    FRM_ERROR_FILE = -6,      /* a file cannot be opened, read or written */
    FRM_ERROR_CORRUPT = -7,   /* a file's contents are damaged or are not what they claim */
    FRM_ERROR_CAPACITY = -8,  /* the caller's buffer is too small; the needed size was written */
    FRM_ERROR_LIMIT = -9,     /* too many objects, or a size beyond what this version takes */
    FRM_ERROR_DEVICE = -10,   /* a device's driver failed; the text says in which call and with what status */
    FRM_ERROR_END = -11,      /* a recording has no more to give */
    FRM_ERROR_INTERNAL = -12, /* a defect in this library; please report it with the last-error text */
    FRM_ERROR_DIVERGED = -13, /* the waves or forces left the range of numbers; see frm_world_tick */
    FRM_ERROR_UNSUPPORTED = -14 /* this library was built without it, or a library that it needs is not installed */
};

/* The name of a status, such as "FRM_ERROR_HANDLE"; "FRM_UNKNOWN" for other values. Static text, never null. [any] */
FRM_API const char *FRM_CALL frm_status_name(frm_status status);

/* The version of the library that runs, which may differ from this header's. Each pointer may be null. [any] */
FRM_API frm_status FRM_CALL frm_version(uint32_t *major, uint32_t *minor, uint32_t *patch);

/* ---- Handles and plain values ------------------------------------------------------------------------------- */

typedef uint64_t frm_context;
typedef uint64_t frm_map;
typedef uint64_t frm_world;
typedef uint64_t frm_water;
typedef uint64_t frm_body;
typedef uint64_t frm_device;
typedef uint64_t frm_recorder;
typedef uint64_t frm_replay;
typedef uint64_t frm_servo;

typedef struct frm_vec3 {
    float x, y, z;
} frm_vec3;

typedef struct frm_position {
    double x, y, z; /* m */
} frm_position;

/* A rotation from the body's frame to the world's. Need not be exactly of length 1: it is normalised. A length
 * that is not between 1e-6 and 1e6 is an error. */
typedef struct frm_quaternion {
    float x, y, z, w;
} frm_quaternion;

typedef struct frm_pose {
    frm_position position; /* of the body's origin, in the world */
    frm_quaternion rotation;
} frm_pose;

/* Velocity of the body's origin (m/s) and angular velocity (rad/s), both in the world frame. */
typedef struct frm_twist {
    frm_vec3 linear;
    frm_vec3 angular;
} frm_twist;

/* Force (N) and torque about the body's origin (N m), both in the world frame. */
typedef struct frm_wrench {
    frm_vec3 force;
    frm_vec3 torque;
} frm_wrench;

/* ---- Context ------------------------------------------------------------------------------------------------- */

/* The host's axes. Vectors are converted at this interface. A body's frame is the mesh file's (glTF: y up,
 * right-handed) as the host's usual importer shows it: unchanged for the two right-handed ones, x negated for
 * FRM_AXES_Y_UP_LEFT (glTFast, UnityGLTF), y and z exchanged for FRM_AXES_Z_UP_LEFT (Unreal's importer). */
typedef enum frm_axes {
    FRM_AXES_Z_UP_RIGHT = 0, /* frm's own; ROS, Blender */
    FRM_AXES_Y_UP_RIGHT = 1, /* Godot, glTF, OpenGL */
    FRM_AXES_Y_UP_LEFT = 2,  /* Unity */
    FRM_AXES_Z_UP_LEFT = 3   /* Unreal, in metres */
} frm_axes;

typedef enum frm_log_level { FRM_LOG_ERROR = 0, FRM_LOG_WARNING = 1, FRM_LOG_INFO = 2 } frm_log_level;

/* Returns at least `size` bytes aligned to `alignment` (a power of two), or null. */
typedef void *(FRM_CALL *frm_allocate_fn)(void *user, uint64_t size, uint64_t alignment);
/* Gives back what frm_allocate_fn returned, with the same size and alignment. */
typedef void(FRM_CALL *frm_free_fn)(void *user, void *memory, uint64_t size, uint64_t alignment);

typedef struct frm_context_def {
    uint32_t struct_size;
    uint32_t axes;         /* frm_axes; default FRM_AXES_Z_UP_RIGHT */
    uint32_t threads;      /* 1 to 64, for large water only; default 1. Results do not depend on it */
    uint32_t log_capacity; /* messages kept until polled, 0 to 4096; the oldest go first; default 64 */
    frm_allocate_fn allocate; /* null (default) for the C++ runtime's; else `release` too. zstd's own working
                                 memory while a file is opened or written does not come from it */
    frm_free_fn release;
    void *allocator_user;
} frm_context_def;

/* Fills a def with defaults; writes at most `size` bytes. Null or a size under 4: FRM_ERROR_ARGUMENT. [any] */
FRM_API frm_status FRM_CALL frm_context_def_init(frm_context_def *def, uint64_t size);

/* Makes a context, the root of all other objects. def may be null. At most 64 at a time (FRM_ERROR_LIMIT). A
 * context starts no thread before it needs one. [any] */
FRM_API frm_status FRM_CALL frm_context_create(const frm_context_def *def, frm_context *context);

/* Destroys the context and everything made in it; recordings still open are closed first, but a write that failed is
 * only reported by frm_recorder_close. Every handle of it becomes stale. Calling it again is harmless and returns
 * FRM_ERROR_HANDLE. No other call on this context may be running. [owner] */
FRM_API frm_status FRM_CALL frm_context_destroy(frm_context context);

/* The text of the last error in this context: what was wrong with which argument. Copies it with a closing zero into
 * `text` (`capacity` bytes) and writes the bytes needed, the zero included, to *size. text may be null to ask for
 * the size; too small: FRM_ERROR_CAPACITY. The text stays until the next error. [owner] */
FRM_API frm_status FRM_CALL frm_context_last_error(frm_context context, char *text, uint64_t capacity, uint64_t *size);

/* Takes the oldest waiting log message: as frm_context_last_error, and its frm_log_level to *level (may be null).
 * With no message waiting, *size is 0. A message is removed once it was copied whole. [owner] */
FRM_API frm_status FRM_CALL frm_context_poll_log(frm_context context, uint32_t *level, char *text, uint64_t capacity,
                                                 uint64_t *size);

/* ---- Map ------------------------------------------------------------------------------------------------------ */

typedef struct frm_map_info {
    uint32_t struct_size;
    uint32_t format_version;
    uint64_t file_bytes;
    uint64_t content_hash;    /* of the file's contents; equal hashes, equal maps */
    uint32_t sources;         /* haptic sources, one a region */
    uint32_t directions;      /* of the uniform stream, for means */
    uint32_t samples;         /* of one period of the series */
    uint32_t triangles;       /* sample triangles of the surface */
    float period;             /* map time after which the series repeat, s */
    float base_speed;         /* u0 of Eq. 6, m/s */
    float density;            /* of the fluid baked, kg/m^3 */
    float viscosity;          /* kinematic, of the fluid baked, m^2/s */
    float reynolds;           /* base_speed * reference_length / viscosity */
    float reynolds_solved;    /* at the viscosity that the solver's grid could carry; at most `reynolds` */
    float reference_length;   /* m; the square root of the projected area, mean over the directions */
    float quantisation_error; /* largest error of the whole object's force by rounding, as a share of its peak */
    float area;               /* of the surface, m^2 */
    float volume;             /* m^3 */
    frm_vec3 centroid;        /* of the volume, in the body's frame */
    frm_vec3 bounds_low;      /* bounding box, in the body's frame */
    frm_vec3 bounds_high;
    uint32_t reserved;
    uint32_t fluctuation_directions; /* of the uniform stream, for fluctuations */
    uint32_t speeds;                 /* at which means are known, 1 to 16; fluctuations are of the base speed */
    uint32_t has_spin;               /* 1: the map knows what turning in still water feels; see FRM_MODEL_SPIN */
    uint32_t has_added_mass;         /* 1: frm_map_get_added_mass has an answer */
    float direction_error_rms;   /* of the mean force in directions that the bake held out, as a share of the peak */
    float direction_error_worst; /* force, and the worst of them; 0: not known */
    float uncertainty;           /* standard error of the worst mean drag, share of the largest force; 0: not known */
    uint32_t reserved_2;
} frm_map_info;

/* One haptic source, in the body's frame at scale 1. */
typedef struct frm_map_source {
    uint32_t struct_size;
    float area;        /* of the region, m^2 */
    frm_vec3 position; /* area-weighted centroid of the region, m */
    frm_vec3 normal;   /* area-weighted mean, outward; shorter than 1 where the region is curved */
} frm_map_source;

/* Opens a map file (docs/format.md). The whole file is read and checked: FRM_ERROR_FILE, FRM_ERROR_CORRUPT or
 * FRM_ERROR_VERSION, with a text that names the chunk. path is UTF-8. [offline] */
FRM_API frm_status FRM_CALL frm_map_open_file(frm_context context, const char *path, frm_map *map);

/* As frm_map_open_file, from `size` bytes in memory, which are copied. [offline] */
FRM_API frm_status FRM_CALL frm_map_open_memory(frm_context context, const void *data, uint64_t size, frm_map *map);

/* Closes a map. FRM_ERROR_STATE while a body uses it. [owner] */
FRM_API frm_status FRM_CALL frm_map_close(frm_map map);

/* What the map holds. [owner] */
FRM_API frm_status FRM_CALL frm_map_get_info(frm_map map, frm_map_info *info);

/* One source, index below frm_map_info.sources. [owner] */
FRM_API frm_status FRM_CALL frm_map_get_source(frm_map map, uint32_t index, frm_map_source *source);

/* How the map was made, as JSON text (mesh name and hash, solver, grid, convergence, time spent): two-call rule of
 * frm_context_last_error. [owner] */
FRM_API frm_status FRM_CALL frm_map_get_provenance(frm_map map, char *text, uint64_t capacity, uint64_t *size);

/* The added mass of the object deep in the fluid: six rows of six numbers, force x, y, z and torque x, y, z about the
 * body's origin (rows) for acceleration along x, y, z and angular acceleration about x, y, z (columns), in the body's
 * frame: -matrix times acceleration is the fluid's force. Exactly symmetric. For a body of this scale (1e-3 to 1e3) in
 * a fluid of this density (1e-3 to 1e5 kg/m^3): it goes with density and with scale^3 (kg), scale^4 (kg m) and
 * scale^5 (kg m^2). A tick does not use it: it is for hosts that integrate, who add it to the body's own mass and
 * leave it out in the part of the body that is dry. `matrix` takes 36 numbers. FRM_ERROR_STATE if the map was made
 * without it (frm_map_info.has_added_mass). [owner] */
FRM_API frm_status FRM_CALL frm_map_get_added_mass(frm_map map, float density, float scale, double *matrix);

/* ---- World ---------------------------------------------------------------------------------------------------- */

/* What of the paper's method is repaired, a sum: the coupling of bodies and waves (section 6.3), and what is felt of
 * the map. FRM_MODEL_PAPER repairs nothing of it. The exact clip against the surface, means and fluctuations apart,
 * and the open border are always there. */
typedef enum frm_model {
    FRM_MODEL_PAPER = 0,
    /* Bodies push the water by the volume that they displace (conserves volume, leaves no current behind), instead
     * of forcing the water's velocity inside them; volume and pressure reach the surface the wider the deeper they
     * are, instead of directly. */
    FRM_MODEL_DISPLACEMENT = 1,
    /* A body does not feel the part of the water's velocity that it made itself: the map's stream holds that flow
     * already. Without it, relative velocity and drag vanish where the body drags the water along. */
    FRM_MODEL_OWN_WAVES = 2,
    /* Between baked directions the fluctuation keeps its strength. Without it a part is lost, up to a third where the
     * neighbours' fluctuations have nothing to do with each other: they are added as they come, and cancel. */
    FRM_MODEL_FLUCTUATION = 4,
    /* A map that knows means at several speeds gives those of the Reynolds number at hand (linear in its logarithm).
     * Without it, and with one speed, those of the base speed at all speeds. */
    FRM_MODEL_SPEEDS = 8,
    /* A map with a spin table gives what turning in still water feels. Without it, and without a table, rotation is
     * felt as each source's own local stream alone (section 8 of the paper names that as an approximation). */
    FRM_MODEL_SPIN = 16,
    FRM_MODEL_DEFAULT = 31
} frm_model;

/* What a tick leaves out where it does not count. Each bit switches one rule on; with the rule on or off the answer
 * agrees within the bound given. frm_world_stats counts where each applied. */
typedef enum frm_skip {
    FRM_SKIP_NOTHING = 0,
    /* Friction of a body that is negligible beside its pressure: below 2e-6 of the largest force of its map. */
    FRM_SKIP_FRICTION = 1,
    /* The fluctuation of sources that hardly fluctuate, their mean alone: below 2e-6 of the largest force. */
    FRM_SKIP_STEADY = 2,
    /* All but the weight of a body that hangs higher above the calm surface than the water is deep (while no wave is as
     * high), and whose own waves have died down. Exact, but for the eight steps
     * that it takes to see a wave that a body throws up higher than that. */
    FRM_SKIP_DRY_BODIES = 4,
    /* The walk over the surface of a body that is wholly under calm water: one evaluation by its moments. 1e-5 of the
     * weight of the water that it displaces. */
    FRM_SKIP_WET_BODIES = 8,
    /* Waves where the water is calm, in tiles of 32 x 32 cells: lower than a millionth of the depth, or of 20 cells. */
    FRM_SKIP_CALM_WATER = 16,
    /* Wave steps shorter than a quarter of the stable one, and than 5 ms: ticks share one. Between steps heights and
     * velocities go on by Eqs. 7 and 8, and what bodies displace rises at once. 0.1 % of buoyancy and resistance in
     * waves of 32 cells; strokes of a plate at 5 kHz 0.6 % rms of the largest buoyancy (docs/model.md, section 7).
     * Not with forced velocity (without FRM_MODEL_DISPLACEMENT). */
    FRM_SKIP_WAVE_STEPS = 32,
    /* What a body does to the water where less than a thousandth of it would be seen at the surface: deeper than 121
     * cells, or so far outside the water that nothing of it reaches. */
    FRM_SKIP_DEEP_BODIES = 64,
    /* Laying out anew the volume of a body that has moved less than a thousandth of a cell since: its displaced volume
     * is off by less than that times the area of its waterline. */
    FRM_SKIP_STILL_BODIES = 128,
    FRM_SKIP_DEFAULT = 255
} frm_skip;

/* Where the fluid ends, for a world without frm_water. */
typedef enum frm_surface {
    FRM_SURFACE_FLAT = 0, /* fluid below `level`, nothing above */
    FRM_SURFACE_NONE = 1  /* fluid everywhere: air, or the deep sea. No buoyancy: it needs a surface (section 8) */
} frm_surface;

typedef struct frm_world_def {
    uint32_t struct_size;
    uint32_t model;    /* frm_model; default FRM_MODEL_DEFAULT */
    uint32_t surface;  /* frm_surface; default FRM_SURFACE_FLAT. A world with FRM_SURFACE_NONE takes no frm_water */
    float gravity;     /* downwards, 0 to 1000 m/s^2; default 9.80665 */
    float density;     /* of the fluid, 1e-3 to 1e5 kg/m^3; default 1000 */
    float viscosity;   /* kinematic, 1e-9 to 1e2 m^2/s; default 1e-6 */
    double level;      /* height of the calm surface, m; default 0 */
    uint32_t skip;     /* frm_skip; default FRM_SKIP_DEFAULT */
    float error_budget; /* N, 0 to 1e9: what a body's resistance may be off for the sake of speed. The coarsest clusters
                           of sources are looked up whose bound is within it; every source of a body that pushes the
                           water, is in water that moves, or is partly wet and turns, if its map knows spin. Default 0:
                           every source, always */
    float time_budget; /* us, 0 to 1e6: what the resistance of all bodies may take, by a fixed price a lookup (so that
                          the bits are the same anywhere), in equal shares of those at or under the calm level. Clusters
                          are made coarser until it is met, at any error, but for the bodies above; one body costs 75 ns
                          at least. over_budget_bodies tells what went over. Buoyancy and waves do not count. Default 0:
                          as long as it takes */
    uint32_t reserved;
} frm_world_def;

typedef struct frm_world_stats {
    uint32_t struct_size;
    uint32_t bodies;
    uint64_t ticks;
    double time;               /* sum of all dt, s */
    uint32_t wet_bodies;       /* in the last tick */
    uint32_t wet_sources;      /* in the last tick: sources with wet ratio > 0 */
    uint32_t clipped_triangles; /* in the last tick: triangles cut by the surface */
    uint32_t water_substeps;   /* in the last tick */
    /* What was left out in the last tick, by frm_skip: */
    uint32_t dry_bodies;       /* not looked at, no wave could reach them */
    uint32_t whole_bodies;     /* wholly wet, by one evaluation */
    uint32_t still_bodies;     /* whose displaced volume was kept */
    uint32_t deep_bodies;      /* too deep, or too far outside, to push the water */
    uint32_t coarse_bodies;    /* by clusters of sources, within a budget */
    uint32_t frictionless_sources; /* wet sources without friction */
    uint32_t steady_sources;   /* wet sources by their mean alone */
    uint32_t active_cells;     /* of the water that were stepped; all others are calm */
    uint64_t water_waits;      /* ticks since the beginning in which the water was not stepped, but later */
    uint32_t over_budget_bodies; /* in the last tick: whose resistance cost more than their share of time_budget, or is
                                    further off than error_budget because of it */
    uint32_t reserved;
} frm_world_stats;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_world_def_init(frm_world_def *def, uint64_t size);

/* Makes an empty world. def may be null. [owner] */
FRM_API frm_status FRM_CALL frm_world_create(frm_context context, const frm_world_def *def, frm_world *world);

/* The world's settings, as made. [owner] */
FRM_API frm_status FRM_CALL frm_world_get_def(frm_world world, frm_world_def *def);

/* Destroys a world with its water and bodies. FRM_ERROR_STATE while a recorder or replay uses it. [owner] */
FRM_API frm_status FRM_CALL frm_world_destroy(frm_world world);

/* Advances the world by dt seconds, 1e-6 to 0.1: buoyancy (Eqs. 1, 4, 5), resistance (Eq. 6), waves (Eqs. 7 to 10),
 * for all bodies in the order of their creation, with the poses and twists last set. The forces are those at the
 * poses given. Ticks may differ in length: the water then takes steps of one length, as many as fit into a tick, and
 * bodies feel it as if it had gone on by what is left. FRM_ERROR_DIVERGED: the tick was done, but a force, or a height
 * of the water (looked at every eight steps), was not a finite number (waves far beyond what linear theory bears); all
 * forces on that body are zero for this tick, and the water has been made calm. Any other error: nothing has changed.
 * Waves are linear: heights are not limited by the depth. [realtime], see frm_recorder_create */
FRM_API frm_status FRM_CALL frm_world_tick(frm_world world, float dt);

/* Counters. [realtime] */
FRM_API frm_status FRM_CALL frm_world_get_stats(frm_world world, frm_world_stats *stats);

/* A 64-bit hash of what decides the world's future: water, poses, map times, forces. Equal histories give equal
 * hashes on every build. Takes time in proportion to the water's cells. [owner] */
FRM_API frm_status FRM_CALL frm_world_hash(frm_world world, uint64_t *hash);

/* ---- Water ---------------------------------------------------------------------------------------------------- */

typedef enum frm_border {
    FRM_BORDER_ABSORBING = 0, /* waves leave */
    FRM_BORDER_REFLECTING = 1 /* walls: a closed basin */
} frm_border;

/* A height field of nx by ny cells over a bed at constant depth. Cell (i, j) is stored at index j * nx + i; i runs
 * along the first horizontal axis, j along the second: (x, y) for FRM_AXES_Z_UP_RIGHT, (z, x) for
 * FRM_AXES_Y_UP_RIGHT, (x, z) for FRM_AXES_Y_UP_LEFT, (y, x) for FRM_AXES_Z_UP_LEFT. */
typedef struct frm_water_def {
    uint32_t struct_size;
    uint32_t nx;          /* cells, 8 to 8192; default 200 */
    uint32_t ny;          /* cells, 8 to 8192; default 200 */
    uint32_t border;      /* frm_border; default FRM_BORDER_ABSORBING */
    uint32_t border_cells; /* width of the absorbing layer, 0 to 64 and under a third of nx and ny (small water: make
                              it smaller); default 0 */
    float cell;           /* edge of a cell, 1e-4 to 1e3 m; default 0.025 */
    float depth;          /* d of Eq. 8: mean water depth, 1e-3 to 1e4 m; default 0.5. Waves run at sqrt(g d) */
    float snapshot_interval; /* seconds between snapshots, 0 (every step) to 10; default 1/60 */
    double centre_x;      /* of the field, on the first horizontal axis, m; default 0 */
    double centre_y;      /* on the second; default 0 */
    uint32_t order;       /* of the differences in space, 2 (default) or 4. A wave of 16 cells runs 0.6 % too slowly at
                             second, 0.1 % off at fourth order, which costs nearly three times as much */
    uint32_t reserved;
} frm_water_def;

/* A view of the field. The library fills nx, ny, tick and time, and copies into each array that is not null. */
typedef struct frm_water_state {
    uint32_t struct_size;
    uint32_t nx;
    uint32_t ny;
    uint32_t reserved;
    uint64_t capacity;  /* in: floats that each array can take; nx * ny are needed */
    uint64_t tick;      /* out: ticks of the world when the field was like this */
    double time;        /* out: s */
    float *height;      /* out: above the calm level, at cell centres, no lower than -depth, m; may be null */
    float *velocity_x;  /* out: water velocity along the first horizontal axis, at cell centres, m/s; may be null */
    float *velocity_y;  /* out: along the second; may be null */
} frm_water_state;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_water_def_init(frm_water_def *def, uint64_t size);

/* Gives the world its water, calm. def may be null. A world has at most one (FRM_ERROR_STATE). Outside the field the
 * surface is flat at the world's level. [owner] */
FRM_API frm_status FRM_CALL frm_water_create(frm_world world, const frm_water_def *def, frm_water *water);

/* Takes the water away; the world's surface is flat again. [owner] */
FRM_API frm_status FRM_CALL frm_water_destroy(frm_water water);

/* The water's size, as made. [owner] */
FRM_API frm_status FRM_CALL frm_water_get_def(frm_water water, frm_water_def *def);

/* The field as of its last step (time says when: with FRM_SKIP_WAVE_STEPS up to 5 ms ago, and a step of the waves where
 * ticks differ in length). FRM_ERROR_CAPACITY if capacity < nx * ny while an array is not null. [realtime] */
FRM_API frm_status FRM_CALL frm_water_read(frm_water water, frm_water_state *state);

/* The newest snapshot, while another thread ticks: as frm_water_read, made every snapshot_interval of the world's time
 * and when heights are set; older while three or more slow readers keep the other copies busy. A copy costs as much
 * as a tick, so the longer nobody reads the fewer are made: one is never older than the interval or an eighth of the
 * time since the last read, and a read has the next tick make another. Any number of readers; never waits for the
 * ticking thread and never makes it wait. [any] */
FRM_API frm_status FRM_CALL frm_water_read_snapshot(frm_water water, frm_water_state *state);

/* Sets heights (m, at cell centres, within +-depth) and lets the water rest. `count` must be nx * ny. The heights are
 * those with the bodies where they are: none of them makes a splash, and one that is destroyed takes along only what
 * it has displaced since. [owner] */
FRM_API frm_status FRM_CALL frm_water_set_height(frm_water water, const float *height, uint64_t count);

/* Sets a pressure (Pa, at cell centres) that pushes up on the surface in every tick until it is changed: p of
 * Eqs. 9 and 10, added to what bodies do. Held still it raises the water by p / (density * gravity). Null with
 * count 0 takes it away; else `count` must be nx * ny. [owner] */
FRM_API frm_status FRM_CALL frm_water_set_pressure(frm_water water, const float *pressure, uint64_t count);

/* Height of the surface (m, in the world, level included) at a position on the first and second horizontal axis, no
 * lower than the bed; the calm level outside. Of the field as frm_water_read has it. [realtime] */
FRM_API frm_status FRM_CALL frm_water_get_height(frm_water water, double x, double y, double *height);

/* ---- Body ----------------------------------------------------------------------------------------------------- */

typedef struct frm_body_def {
    uint32_t struct_size;
    float scale;               /* of the map's object, 1e-3 to 1e3; default 1. Forces follow by similarity */
    frm_map map;               /* required */
    float mass;                /* kg, 0 (default; no weight) to 1e9 */
    frm_vec3 centre_of_mass;   /* r_g of Eq. 5, in the body's frame, not scaled, m; default 0 */
    frm_pose pose;             /* default: the origin, unrotated */
    frm_twist twist;           /* default: at rest */
} frm_body_def;

/* The wrench on the body and its parts. total = buoyancy + pressure + friction + gravity. */
typedef struct frm_forces {
    uint32_t struct_size;
    uint32_t reserved;
    frm_wrench total;
    frm_wrench buoyancy; /* hydrostatic pressure, Eq. 1 */
    frm_wrench pressure; /* pressure resistance, Eq. 3 by Eq. 6 */
    frm_wrench friction; /* frictional resistance, Eq. 2 by Eq. 6 */
    frm_wrench gravity;  /* m g at the centre of mass */
} frm_forces;

typedef struct frm_body_state {
    uint32_t struct_size;
    float wet_area;          /* m^2 */
    float displaced_volume;  /* m^3: buoyancy / (density * gravity) */
    float relative_speed;    /* area-weighted mean over the wet sources, m/s */
    float reynolds;          /* at that speed, this scale and this fluid; compare frm_map_info.reynolds_solved */
    uint32_t wet_sources;
    frm_pose pose;           /* as last set */
    frm_twist twist;
} frm_body_state;

/* How the fluid answers a change of a body's motion: what a host that integrates needs for a body that is light beside
 * the water around it. Six rows of six numbers, row after row: force x, y, z and torque x, y, z about the body's origin
 * (rows) for motion along x, y, z and about x, y, z (columns), in the world frame, as frm_wrench and frm_twist are.
 * Both matrices are symmetric, and damping never drives a body (positive semi-definite). */
typedef struct frm_coefficients {
    uint32_t struct_size;
    float wet_share;       /* 0 to 1: wet area over area */
    double added_mass[36]; /* kg, kg m, kg m^2: -added_mass * acceleration is a force that frm_forces does not have. The
                              map's (frm_map_get_added_mass) times wet_share; zero if the map has none */
    double damping[36];    /* N s/m, N s, N m s: how fast resistance grows with velocity, at the last tick's velocity:
                              the sum over the wet sources of (J J^T)^(1/2), J the change of a source's force with its
                              stream */
} frm_coefficients;

/* One haptic source after a tick, in the world frame. */
typedef struct frm_source_state {
    frm_position position;
    frm_vec3 force;             /* pressure + friction, N */
    frm_vec3 relative_velocity; /* of the water against the source, m/s */
    float wet_ratio;            /* alpha of Eq. 6, 0 to 1 */
    float map_time;             /* s of Eq. 6, s */
} frm_source_state;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_body_def_init(frm_body_def *def, uint64_t size);

/* Puts a body into a world. The map must be of the same context and stay open. [owner] */
FRM_API frm_status FRM_CALL frm_body_create(frm_world world, const frm_body_def *def, frm_body *body);

/* The body's map, scale, mass and centre of mass as made; pose and twist as last set. [owner] */
FRM_API frm_status FRM_CALL frm_body_get_def(frm_body body, frm_body_def *def);

/* Takes a body out. The water it displaced flows back. [owner] */
FRM_API frm_status FRM_CALL frm_body_destroy(frm_body body);

/* Where the body is and how it moves, from the next tick on. twist may be null: at rest. Positions up to 1e9 m,
 * speeds up to 1e4 m/s and rad/s. [realtime] */
FRM_API frm_status FRM_CALL frm_body_set_motion(frm_body body, const frm_pose *pose, const frm_twist *twist);

/* The forces of the last tick; zero before the first. [realtime] */
FRM_API frm_status FRM_CALL frm_body_get_forces(frm_body body, frm_forces *forces);

/* How wet the body is, and how fast it goes through the water. [realtime] */
FRM_API frm_status FRM_CALL frm_body_get_state(frm_body body, frm_body_state *state);

/* Added mass and damping at the last tick's pose, wetness and velocity; zero where the body is dry. With M the body's
 * own inertia about its origin and F the force and torque on it (frm_forces.total and the host's), solve
 *     (M + added_mass + dt damping) dv = dt F - g added_mass v,      g = 1 - (last tick's wet_share) / wet_share
 * (g = 0 where wet_share did not grow: what gets wet takes its momentum from the body) for the change dv of the body's
 * velocity v, in place of M dv = dt F, which the drag of a light body makes unstable: where drag would turn it around
 * within a step. A body at rest, and one at its final speed, stay so. Takes as long as looking its sources up seven
 * times. [realtime] */
FRM_API frm_status FRM_CALL frm_body_get_coefficients(frm_body body, frm_coefficients *coefficients);

/* The sources after the last tick, for arrows and analysis. Two-call rule: *count receives the number of sources;
 * sources may be null; `capacity` below the number: FRM_ERROR_CAPACITY. [realtime] */
FRM_API frm_status FRM_CALL frm_body_get_sources(frm_body body, frm_source_state *sources, uint32_t capacity,
                                                 uint32_t *count);

/* ---- Device --------------------------------------------------------------------------------------------------- */

typedef enum frm_device_status {
    FRM_DEVICE_READY = 0,
    FRM_DEVICE_UNCALIBRATED = 1, /* poses are not to be trusted yet */
    FRM_DEVICE_FAULT = 2         /* forces are off until the cause is gone */
} frm_device_status;

/* What is wrong with a device, as bits. A driver reports what it sees in frm_device_state.faults. */
typedef enum frm_device_fault {
    FRM_DEVICE_FAULT_NONE = 0,
    FRM_DEVICE_FAULT_UNCALIBRATED = 1,    /* frm_device_calibrate has to come first */
    FRM_DEVICE_FAULT_SHORT_PACKET = 2,    /* an answer was cut off */
    FRM_DEVICE_FAULT_TIMEOUT = 4,         /* no answer in time */
    FRM_DEVICE_FAULT_TRANSFER = 8,        /* the bus refused a transfer, or answered what cannot be */
    FRM_DEVICE_FAULT_UNPLUGGED = 16,      /* it is gone: close it and open it anew */
    FRM_DEVICE_FAULT_LOST_COUNT = 32,     /* too long between two answers: the encoders may have wrapped unseen */
    FRM_DEVICE_FAULT_STUCK_ENCODER = 64,  /* a length stands still while the others say that it changes */
    FRM_DEVICE_FAULT_SLACK_STRING = 128,  /* a string is longer than the way that it spans; passes when it is tight */
    FRM_DEVICE_FAULT_BROKEN_STRING = 256, /* a string is shorter than the way that it spans, or runs off */
    FRM_DEVICE_FAULT_DEADLINE = 512,      /* no exchange within the deadline: it was in its safe state since */
    /* What the safety layer finds by itself, beside the deadline: */
    FRM_DEVICE_FAULT_COMMAND = 65536,    /* the host commanded a wrench that is not finite */
    FRM_DEVICE_FAULT_STEP = 131072,      /* the commanded force leapt by more than any water can */
    FRM_DEVICE_FAULT_SPEED = 262144,     /* the grip ran away */
    FRM_DEVICE_FAULT_STATE = 1048576,    /* the driver's state is not finite or out of range */
    FRM_DEVICE_FAULT_JUMP = 2097152,     /* the pose leapt further than a hand can */
    FRM_DEVICE_FAULT_STALE = 4194304,    /* sequence or time stand still or run backwards */
    FRM_DEVICE_FAULT_DRIVER = 8388608    /* a call of the driver failed, or its status is FRM_DEVICE_FAULT */
} frm_device_fault;

typedef struct frm_device_info {
    uint32_t struct_size;
    uint32_t serial;
    float max_force;    /* N; 0: none is felt */
    float max_torque;   /* N m */
    uint64_t period_ns; /* of its own cycle; 0: as it is asked */
    char name[64];      /* UTF-8, closed by zero */
} frm_device_info;

/* What the host tells the device in one exchange. */
typedef struct frm_device_command {
    uint32_t struct_size;
    uint32_t reserved;
    frm_wrench wrench;    /* to be displayed, about the grip's origin, world frame */
    uint64_t deadline_ns; /* the device goes to its safe state if no exchange follows within this; 0: what its
                             frm_device_safety_def says */
} frm_device_command;

/* What the device tells the host in one exchange. */
typedef struct frm_device_state {
    uint32_t struct_size;
    uint32_t status;   /* frm_device_status */
    frm_pose pose;     /* of the grip */
    frm_twist twist;
    float grip;        /* 0 open to 1 closed */
    uint32_t buttons;  /* one bit each */
    uint64_t time_ns;  /* monotonic, the device's clock */
    uint64_t sequence; /* counts exchanges from 0 */
    frm_wrench achieved; /* that the device displays now, within its limits; a driver that leaves it displays what it
                            was sent */
    uint32_t faults;     /* frm_device_fault, all that hold */
    uint32_t reserved;
} frm_device_state;

/* A driver: any host can write one. `user` is the pointer given to frm_device_open; `instance` is what open made.
 * Each returns an frm_status, and none may throw. No two are called at a time for one instance. They are called from
 * within the frm_device_ functions of their names; `info` also by frm_device_engage, `close` when the context is
 * destroyed, all but `open` and `close` by a servo's thread, and `stop` whenever the safety layer finds a fault, on a
 * thread of its own if the host has stalled. */
typedef struct frm_device_driver {
    uint32_t struct_size;
    uint32_t reserved;
    /* Writes the number of devices to *count and the first `capacity` of them to list (may be null). */
    frm_status(FRM_CALL *enumerate)(void *user, frm_device_info *list, uint32_t capacity, uint32_t *count);
    frm_status(FRM_CALL *open)(void *user, uint32_t index, void **instance);
    frm_status(FRM_CALL *close)(void *user, void *instance);
    frm_status(FRM_CALL *info)(void *user, void *instance, frm_device_info *info);
    /* The grip is at its reference pose now. */
    frm_status(FRM_CALL *calibrate)(void *user, void *instance);
    /* One cycle: takes the command (never null), fills the state. Bounded time, no allocation. */
    frm_status(FRM_CALL *exchange)(void *user, void *instance, const frm_device_command *command,
                                   frm_device_state *state);
    /* Safe state at once: no force. */
    frm_status(FRM_CALL *stop)(void *user, void *instance);
    /* What the last exchange read from the device, byte for byte: at most `capacity` (up to 512) bytes of it to
     * data, and their number to *size. Bounded time, no allocation. May be null: such a device has no packets. */
    frm_status(FRM_CALL *raw)(void *user, void *instance, uint8_t *data, uint32_t capacity, uint32_t *size);
} frm_device_driver;

/* The number of devices that a driver sees, and what they are: two-call rule; a capacity below the number fills what
 * fits and is no error. The driver is only read. [owner] */
FRM_API frm_status FRM_CALL frm_device_enumerate(frm_context context, const frm_device_driver *driver, void *user,
                                                 frm_device_info *list, uint32_t capacity, uint32_t *count);

/* Opens device `index` of a driver. The driver struct is copied; `user` must outlive the device. [owner] */
FRM_API frm_status FRM_CALL frm_device_open(frm_context context, const frm_device_driver *driver, void *user,
                                            uint32_t index, frm_device *device);

/* A device that is not there: its grip rests at the origin, its clock runs 2 ms an exchange, forces are swallowed.
 * For hosts that run without hardware, and for tests. [owner] */
FRM_API frm_status FRM_CALL frm_device_open_null(frm_context context, frm_device *device);

/* A device that moves as one in a recording did: exchange k gives the state recorded in exchange k of device
 * `index` (0 for the first that was added to the recorder); after the last, FRM_ERROR_END. Forces are swallowed.
 * FRM_ERROR_STATE if the recording holds no such device, or was made with other axes than this context's. [offline] */
FRM_API frm_status FRM_CALL frm_device_open_replay(frm_context context, const char *path, uint32_t index,
                                                   frm_device *device);

/* The SPIDAR-G that answer, their rotary switch as serial: two-call rule; a capacity below the number fills what fits
 * and is no error. Each is opened, asked and closed again; one that is open already is not seen. Errors are those of
 * frm_device_open_spidar_g. [offline] */
FRM_API frm_status FRM_CALL frm_device_enumerate_spidar_g(frm_context context, const char *configuration,
                                                          frm_device_info *list, uint32_t capacity, uint32_t *count);

/* Opens a SPIDAR-G, a grip on eight strings, through libusb or hidapi as its configuration says: a JSON file
 * (docs/devices.md), or null for the built-in SpidarG6X3R on an SH4 amplifier. `rotary` is the switch on the
 * amplifier, 0 to 15; -1 takes the first that answers. Strings show the least tension until frm_device_calibrate was
 * called with the grip at the centre, unturned. Not yet run on hardware. FRM_ERROR_UNSUPPORTED: built without libusb
 * or hidapi, or it is not installed; FRM_ERROR_FILE, FRM_ERROR_CORRUPT, FRM_ERROR_VERSION and FRM_ERROR_ARGUMENT: the
 * configuration; FRM_ERROR_DEVICE: none answers. [offline] */
FRM_API frm_status FRM_CALL frm_device_open_spidar_g(frm_context context, const char *configuration, int32_t rotary,
                                                     frm_device *device);

/* A simulated SPIDAR-G with strings, motors, encoders, its amplifier's packets and a hand that holds the grip: all of
 * the driver but the bus runs. Its clock is that of its exchanges, one period each, however far they lie apart.
 * [offline] */
FRM_API frm_status FRM_CALL frm_device_open_simulated(frm_context context, const char *configuration,
                                                      frm_device *device);

/* Stops the device and closes it. [owner] */
FRM_API frm_status FRM_CALL frm_device_close(frm_device device);

/* What the device is. [owner] */
FRM_API frm_status FRM_CALL frm_device_get_info(frm_device device, frm_device_info *info);

/* Tells the device that its grip is at the reference pose. [owner] */
FRM_API frm_status FRM_CALL frm_device_calibrate(frm_device device);

/* One cycle. command may be null: no force. What the device is sent is what the safety layer leaves of the wrench:
 * nothing before frm_device_engage. A command that is not finite is refused before the driver sees it
 * (FRM_ERROR_ARGUMENT), and a state that is not finite is FRM_ERROR_DEVICE; both stop an engaged device. A fault is not
 * an error of this call: state.status is FRM_DEVICE_FAULT from the exchange in which it was found until it is cleared.
 * Bounded as the driver is. FRM_ERROR_STATE while a servo runs the device. [realtime] */
FRM_API frm_status FRM_CALL frm_device_exchange(frm_device device, const frm_device_command *command,
                                                frm_device_state *state);

/* The packet that the last exchange read, as the driver gives it (at most 512 bytes), or as it was recorded: two-call
 * rule; *size receives its length, 0 where there is none; data may be null; `capacity` below the length:
 * FRM_ERROR_CAPACITY. FRM_ERROR_STATE while a servo runs the device. [realtime] */
FRM_API frm_status FRM_CALL frm_device_get_raw(frm_device device, uint8_t *data, uint32_t capacity, uint32_t *size);

/* Safe state at once; disengages. [realtime] */
FRM_API frm_status FRM_CALL frm_device_stop(frm_device device);

/* ---- Safety ----------------------------------------------------------------------------------------------------- */

/* What stands between every host and every device (docs/servo.md). A device is disengaged when it is opened: it gives
 * its pose and feels nothing. Engaged, it is sent the commanded wrench times a ramp that grows from 0 to 1, limited in
 * magnitude and slew, with damping where the loop makes energy. A fault takes the force away at once (for a grip that
 * runs away: a brake first), stops the device and stays, with its reason, until frm_device_clear_fault; the way back
 * leads over frm_device_engage and a ramp from zero. A limit of 0 that says so takes the device's own. */
typedef struct frm_device_safety_def {
    uint32_t struct_size;
    uint32_t passivity;      /* 1 (default): passivity observer and controller, in a servo a drag limit; 0: neither */
    float max_force;         /* N, 0 to 1e4; default 0: frm_device_info.max_force, which is never exceeded */
    float max_torque;        /* N m, 0 to 1e4; default 0: frm_device_info.max_torque, which is never exceeded */
    float slew_time;         /* s, 0 to 1: the least for a change from none to the largest wrench; default 0.005 */
    float ramp_time;         /* s, 0 to 60: from engaging to the whole force; default 1 */
    float max_step;          /* N, 0 to 1e9: a larger change of the command between two exchanges is a fault; 0
                                (default): never. For torque the same share of max_torque as this is of max_force */
    float max_speed;         /* m/s, 0.01 to 1e3: faster is a fault, after which the grip is braked; default 3 */
    float max_spin;          /* rad/s, 0.01 to 1e4; default 30 */
    float brake_time;        /* s, 0 to 10: for so long a grip that ran away is braked; default 0.25 */
    float grip_mass;         /* kg, 1e-3 to 1e3: the least that moves with the grip; default 0.1. Damping, of the brake,
                                the passivity controller and quick drag, stays under grip_mass / (4 cycles) */
    float grip_inertia;      /* kg m^2, 1e-8 to 1e3: the least, about the grip's origin; default 5e-5 */
    float energy_reserve;    /* J, 0 to 1e3: what the quick part of the force may give before it counts as made by the
                                loop; default 0.005 */
    float quick_time;        /* s, 1e-3 to 10, and at least 20 cycles: what changes more slowly (weight, swell, current)
                                is not the loop's; default 0.02 */
    float dead_band;         /* m/s, 0 to 1: no damping of slower quick motion, which may be the encoders'; default
                                0.005 */
    float spin_dead_band;    /* rad/s, 0 to 10; default 0.05 */
    uint32_t max_stale;      /* 1 to 1e6 exchanges in which sequence and time may stand still; default 20 */
    uint32_t dead_man_buttons; /* a force only while one of these is held; 0 (default): always */
    float dead_man_grip;     /* 0 to 1: a force only while the grip is closed as far; default 0 */
    uint32_t reserved;
    uint64_t deadline_ns;    /* 1e6 to 1e10: an engaged device that meets no exchange for so long is stopped; default
                                5e7. frm_device_command.deadline_ns, where it is not 0, takes its place */
} frm_device_safety_def;

typedef struct frm_device_safety_state {
    uint32_t struct_size;
    uint32_t engaged;          /* 1: forces are sent; 2: they will be, when a good state has come */
    uint32_t faults;           /* frm_device_fault, those that are latched */
    float ramp;                /* 0 to 1 */
    frm_wrench sent;           /* to the device, in the last exchange */
    float energy;              /* J, within +-energy_reserve: of quick motion, what the hand gave less what it got */
    float spin_energy;         /* of rotation */
    float damping;             /* N s/m, of the passivity controller, in the last exchange */
    float spin_damping;        /* N m s/rad */
    float quick_gain;          /* of the quick part of the force, by the passivity controller: 1, down to 0.05 */
    float quick_spin_gain;     /* of the torque */
    uint64_t limited;          /* exchanges since engaging in which magnitude or slew were limited */
    uint64_t damped;           /* in which the passivity controller damped */
    uint64_t fault_count;      /* faults latched since the device was opened */
    char reason[128];          /* of the first fault that is latched: UTF-8, closed by zero; empty without one */
} frm_device_safety_state;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_device_safety_def_init(frm_device_safety_def *def, uint64_t size);

/* Sets the limits. def may be null: the defaults. FRM_ERROR_STATE while the device is engaged. [owner] */
FRM_API frm_status FRM_CALL frm_device_set_safety(frm_device device, const frm_device_safety_def *def);

/* What the safety layer is doing. [realtime] */
FRM_API frm_status FRM_CALL frm_device_get_safety(frm_device device, frm_device_safety_state *state);

/* Forces from now on, beginning at zero. They begin when an exchange has given a good state; one that is not
 * calibrated, faulty or too fast is a fault. FRM_ERROR_STATE while a fault is latched: the text has its reason. Again
 * is no error. Starts the thread that watches the deadline; FRM_ERROR_UNSUPPORTED where libfrm was built without
 * threads (WebAssembly). [owner] */
FRM_API frm_status FRM_CALL frm_device_engage(frm_device device);

/* No forces from now on: they go to zero within slew_time of exchanges. Again is no error. [realtime] */
FRM_API frm_status FRM_CALL frm_device_disengage(frm_device device);

/* Forgets the fault; the device stays disengaged. One whose cause remains comes back when it is engaged. Without a
 * fault nothing happens. [realtime] */
FRM_API frm_status FRM_CALL frm_device_clear_fault(frm_device device);

/* ---- Servo ------------------------------------------------------------------------------------------------------ */

/* A thread that closes the loop between a device and a body at a rate of its own: exchange with the device, move the
 * body, tick the world, and send what the body feels with the next exchange. While it runs the world and the device
 * are its own: other threads' calls that touch them give FRM_ERROR_STATE, except frm_water_read_snapshot and the
 * functions of this section. What ticks depend on (dt, motion) does not depend on the clock: a recording of a servo's
 * world replays to the same bits. */

/* Called on the servo's thread in every tick, when its body has been moved and before the world is ticked: here the
 * host may use the world (move other bodies). `tick` counts from 0. Bounded time, no lock. Another status than FRM_OK
 * ends the servo with it. */
typedef frm_status(FRM_CALL *frm_servo_tick_fn)(void *user, uint64_t tick, float dt);

typedef struct frm_servo_def {
    uint32_t struct_size;
    uint32_t rate;         /* ticks a second, 100 to 5000; default 1000 */
    frm_device device;     /* required */
    frm_body body;         /* required: what the grip holds; its world is what the servo ticks */
    frm_pose grip;         /* of the body's frame in the grip's, m, not scaled; default: the same */
    uint32_t priority;     /* real-time (SCHED_FIFO), 1 to 99, where the system allows it; 0: none; default 80 */
    uint32_t lock_memory;  /* 1 (default): asks the system to keep the process's memory in core (mlockall of what there
                              is when it starts, for the whole process, until that ends), where it may; 0: does not */
    frm_servo_tick_fn on_tick; /* may be null (default) */
    void *user;                /* for on_tick */
} frm_servo_def;

/* What the host tells a servo, at any time. */
typedef struct frm_servo_input {
    uint32_t struct_size;
    float motion_scale; /* m in the world for each m of the device, 1e-3 to 1e3; default 1. Rotation is not scaled */
    float force_scale;  /* of what the body feels, 0 to 1e3; default 1 */
    float torque_scale; /* 0 to 1e3; default 1 */
    frm_pose anchor;    /* of the device's frame in the world: where the grip's origin is; default the world's frame */
    frm_wrench extra;   /* added to what is displayed, about the grip's origin, world frame, not scaled; default 0 */
} frm_servo_input;

/* A servo as it was after its last tick. */
typedef struct frm_servo_state {
    uint32_t struct_size;
    uint32_t running;     /* 1: its thread ticks */
    uint64_t ticks;       /* of this servo since it was started */
    double time;          /* of the world, s */
    frm_pose pose;        /* of the body */
    frm_twist twist;
    frm_wrench wrench;    /* on the body, the total of its forces */
    frm_wrench displayed; /* by the device, in its own frame */
    frm_pose grip_pose;   /* in the device's own frame */
    float grip;           /* as in frm_device_state, and what follows */
    uint32_t buttons;
    uint32_t device_status;
    uint32_t engaged;     /* as in frm_device_safety_state, and what follows */
    uint32_t faults;
    float ramp;
    float energy;
    int32_t status;       /* an frm_status: FRM_OK, or the last failure of an exchange or tick, or what ended it */
    char reason[128];     /* of the fault that is latched, or of that failure; UTF-8, closed by zero */
} frm_servo_state;

/* How punctual a servo is, since it was started. Times in ns. Quantiles are upper edges of histogram bins: at most a
 * quarter too large. */
typedef struct frm_servo_stats {
    uint32_t struct_size;
    uint32_t realtime;        /* 1: real-time priority was given */
    uint64_t period_ns;
    uint64_t ticks;
    uint64_t missed;          /* ticks that ended after the next should have begun */
    uint64_t skipped;         /* periods without a tick: the world's time lacks them */
    uint64_t failed_exchanges;
    uint64_t diverged;        /* ticks that gave FRM_ERROR_DIVERGED */
    uint64_t tick_p50, tick_p99, tick_p9999, tick_max; /* from waking to the end of the tick */
    uint64_t late_p50, late_p99, late_p9999, late_max; /* of waking, after the time at which it should: the jitter */
    uint32_t memory_locked;   /* 1: memory was locked */
    uint32_t reserved;
} frm_servo_stats;

typedef enum frm_servo_time {
    FRM_SERVO_TICK = 0, /* how long ticks take */
    FRM_SERVO_LATE = 1  /* how late they begin */
} frm_servo_time;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_servo_def_init(frm_servo_def *def, uint64_t size);

/* Fills an input with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_servo_input_init(frm_servo_input *input, uint64_t size);

/* Makes a servo, which stands still. Device, body and world cannot be destroyed while it is there. A device takes one
 * (FRM_ERROR_STATE). [owner] */
FRM_API frm_status FRM_CALL frm_servo_create(frm_context context, const frm_servo_def *def, frm_servo *servo);

/* Stops it and destroys it. [owner] */
FRM_API frm_status FRM_CALL frm_servo_destroy(frm_servo servo);

/* Starts its thread; statistics begin anew. What the system did not allow (priority, locked memory) is in
 * frm_servo_stats and no error. FRM_ERROR_STATE while another servo runs this world; FRM_ERROR_UNSUPPORTED where
 * libfrm was built without threads (WebAssembly). [owner] */
FRM_API frm_status FRM_CALL frm_servo_start(frm_servo servo);

/* Ends its thread after the tick that it is in; the device is disengaged and stopped. Again is no error. [owner] */
FRM_API frm_status FRM_CALL frm_servo_stop(frm_servo servo);

/* Tells it something else from its next tick on. Never waits for the servo. [owner] */
FRM_API frm_status FRM_CALL frm_servo_set_input(frm_servo servo, const frm_servo_input *input);

/* As frm_device_engage, in its next tick; if a fault is latched then, nothing happens. May be asked for before it is
 * started. [owner] */
FRM_API frm_status FRM_CALL frm_servo_engage(frm_servo servo);

/* As frm_device_disengage, in its next tick. [owner] */
FRM_API frm_status FRM_CALL frm_servo_disengage(frm_servo servo);

/* As frm_device_clear_fault, in its next tick. [owner] */
FRM_API frm_status FRM_CALL frm_servo_clear_fault(frm_servo servo);

/* The newest state. Never waits for the servo and never makes it wait. [any] */
FRM_API frm_status FRM_CALL frm_servo_get_state(frm_servo servo, frm_servo_state *state);

/* Its statistics, while it runs too. [any] */
FRM_API frm_status FRM_CALL frm_servo_get_stats(frm_servo servo, frm_servo_stats *stats);

/* A histogram of ticks, `which` an frm_servo_time. Bin i counts those from edges[i] (ns) to edges[i + 1]; the first
 * holds what is shorter too, the last what is longer. Each array may be null; *count receives the number of bins.
 * `capacity` below the number while an array is not null: FRM_ERROR_CAPACITY. [any] */
FRM_API frm_status FRM_CALL frm_servo_get_histogram(frm_servo servo, uint32_t which, uint64_t *edges, uint64_t *counts,
                                                    uint32_t capacity, uint32_t *count);

/* ---- Recorder and replay -------------------------------------------------------------------------------------- */

typedef struct frm_recorder_def {
    uint32_t struct_size;
    uint32_t hash_interval; /* ticks between two recorded hashes of the whole world, 1 to 1e6; default 100. It is
                               worked out within the tick, in proportion to the water's cells */
    uint32_t queue_bytes;   /* of memory between the calls that are recorded and the thread that writes, 2^16 to 2^30,
                               rounded up to a power of two; default 2^22: seconds of one body and device at 1 kHz */
    uint32_t waits;         /* what happens where that is full. 0 (default): the event is lost, counted, and the gap
                               marked in the recording. 1: the call waits until there is room, for work offline */
    uint32_t force_interval; /* ticks between two whose forces are kept, and exchanges between two whose wrenches
                                (commanded, achieved) are, 1 to 1e6; default 1: all. What a tick reads, and of each tick
                                a check of every part of the forces, are kept always: a replay finds the first tick that
                                differs. At 1 kHz 16 makes a third less: forces on what a hand moves are mostly noise */
} frm_recorder_def;

typedef struct frm_recorder_stats {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t ticks;       /* of the world that the writer has taken */
    uint64_t lost_events; /* for which there was no room; 0 is good */
    uint64_t file_bytes;  /* written so far */
    uint64_t queue_bytes; /* there are */
    uint64_t queue_most;  /* the most that were waiting at a time, bytes */
} frm_recorder_stats;

typedef struct frm_replay_info {
    uint32_t struct_size;
    uint32_t torn;       /* 1: the recording was cut off; all up to there is replayed */
    uint64_t ticks;
    double time;         /* sum of all dt, s */
    uint32_t bodies;     /* ever created in it */
    uint32_t devices;
    uint32_t has_water;
    uint32_t maps;
    uint64_t lost_events; /* missing where the replay ends: the recorder's queue was full; 0: none */
} frm_replay_info;

/* How far a result may be off, as one version's is from another's: the length of the difference of two forces, or two
 * torques. All 0 (default): not by a bit. */
typedef struct frm_replay_tolerance {
    uint32_t struct_size;
    float relative; /* as a share of the largest total force (or torque) on that body in the whole recording, 0 to 1 */
    float force;    /* N, added to that, 0 to 1e9 */
    float torque;   /* N m, likewise */
} frm_replay_tolerance;

/* What a replay compares, in the order in which it compares. */
typedef enum frm_part {
    FRM_PART_NONE = 0,
    FRM_PART_BUOYANCY = 1,
    FRM_PART_PRESSURE = 2,
    FRM_PART_FRICTION = 3,
    FRM_PART_GRAVITY = 4,
    FRM_PART_TOTAL = 5,
    FRM_PART_WORLD = 6 /* the hash of the whole world */
} frm_part;

typedef struct frm_replay_step_result {
    uint32_t struct_size;
    uint32_t diverged; /* 1: this tick's result differs from the recording */
    uint64_t tick;     /* of the world after this step; the first tick is 1 */
    uint32_t body;     /* the first that differs, in order of creation */
    uint32_t part;     /* frm_part, the first that differs */
    double time;       /* of the world after this step, s */
    uint32_t component; /* of that part's wrench, the one that is furthest off: 0 to 2 force x, y, z, 3 to 5 torque
                           x, y, z; in the replay's axes, as `recorded` and `replayed` */
    float recorded;    /* N or N m; 0 for FRM_PART_WORLD; NaN in a tick of which only the check was kept */
    float replayed;
    uint32_t reserved;
} frm_replay_step_result;

/* Fills a def with defaults; writes at most `size` bytes. [any] */
FRM_API frm_status FRM_CALL frm_recorder_def_init(frm_recorder_def *def, uint64_t size);

/* Records what a world is told and what it answers, from now until closed; the maps are kept inside the recording.
 * The world must not have ticked yet (FRM_ERROR_STATE) and takes one recorder. def may be null. The recording grows
 * as `path`.part and gets its name when it is closed; if the process dies, the .part file is still a recording that
 * lacks at most its last frame: 40 ms of the world's time (128 ticks, 4096 events), and what a thread that looks every
 * 5 ms had not taken yet. An existing file is replaced on closing, an older .part file at once: move it away first.
 * Recording starts that thread; calls that are real-time stay so, unless def.waits is set. Where libfrm was built
 * without threads (WebAssembly), each call writes what it records itself. path is UTF-8. [offline] */
FRM_API frm_status FRM_CALL frm_recorder_create(frm_world world, const char *path, const frm_recorder_def *def,
                                                frm_recorder *recorder);

/* Records every exchange of this device too. At most 16. [owner] */
FRM_API frm_status FRM_CALL frm_recorder_add_device(frm_recorder recorder, frm_device device);

/* How it goes. [realtime] */
FRM_API frm_status FRM_CALL frm_recorder_get_stats(frm_recorder recorder, frm_recorder_stats *stats);

/* Writes what is left and gives the file its name. A write that failed since the start (disk full) is reported
 * here: FRM_ERROR_FILE, and the .part file is left. FRM_ERROR_CAPACITY: events were lost, for which the queue had no
 * room; the file has its name, and replays up to the gap. The handle is stale afterwards in any case. [owner] */
FRM_API frm_status FRM_CALL frm_recorder_close(frm_recorder recorder);

/* Opens a recording and makes a world of its own to replay it in, in this context's axes whatever the recording's
 * were. It stands before the first tick then: the bodies and maps of the beginning are there. [offline] */
FRM_API frm_status FRM_CALL frm_replay_open(frm_context context, const char *path, frm_replay *replay);

/* Closes a replay and destroys its world and maps. [owner] */
FRM_API frm_status FRM_CALL frm_replay_close(frm_replay replay);

/* What the recording holds. [owner] */
FRM_API frm_status FRM_CALL frm_replay_get_info(frm_replay replay, frm_replay_info *info);

/* How far what is compared may be off from the next step on; null: not by a bit. With a tolerance the hash is not
 * compared. [owner] */
FRM_API frm_status FRM_CALL frm_replay_set_tolerance(frm_replay replay, const frm_replay_tolerance *tolerance);

/* Replays up to and including the next tick and compares bit for bit, or within the tolerance. After the last tick, and
 * where events were lost: FRM_ERROR_END. A
 * difference is not an error: it is reported, and the replay can go on. [owner] */
FRM_API frm_status FRM_CALL frm_replay_step(frm_replay replay, frm_replay_step_result *result);

/* The replay's world, to look at (stats, hash); it must not be ticked or changed by the caller. [owner] */
FRM_API frm_status FRM_CALL frm_replay_get_world(frm_replay replay, frm_world *world);

/* The replay's water; FRM_ERROR_STATE while there is none. [owner] */
FRM_API frm_status FRM_CALL frm_replay_get_water(frm_replay replay, frm_water *water);

/* Body `index` in order of creation; FRM_ERROR_STATE if it is not there now. [owner] */
FRM_API frm_status FRM_CALL frm_replay_get_body(frm_replay replay, uint32_t index, frm_body *body);

/* Map `index`, below frm_replay_info.maps, in the order in which bodies first used them; FRM_ERROR_ARGUMENT if it has
 * not been used yet. [owner] */
FRM_API frm_status FRM_CALL frm_replay_get_map(frm_replay replay, uint32_t index, frm_map *map);

#ifdef __cplusplus
}
#endif

#endif /* FRM_H */
