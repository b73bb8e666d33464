/*
 * The simulator inside. It holds four things apart:
 *
 *     setup             what is fixed when it is made: scene, sonar, environment, layout of the work
 *     kernels, buffers  what lives on the device
 *     learnt            what pilot pings and calibrations found out; asdic_simulator_forget clears it
 *     shots             one for each ping that goes to the device together: its pose, its water, its
 *                       parameters, its sums. Functions that work on one ping are given its shot.
 */
#ifndef ASDIC_SIM_SIMULATOR_H
#define ASDIC_SIM_SIMULATOR_H

#include <asdic/ping.h>

#include "../../kernels/ping_types.h"
#include "base/arena.h"
#include "beam_fan.h"
#include "faces.h"
#include "glints.h"
#include "lesson.h"
#include "laws/scatterer.h"
#include "quadrature_ping.h"
#include "speckle.h"
#include "environment.h"
#include "ocl/ocl.h"
#include "scene/tracer.h"

/* A pilot ping has at most this many rays. */
#define ASDIC_PILOT_RAYS 4096u

/* The bottom zone of the adaptive sampler takes the bottom to be at this share of the altitude: a bottom
 * assumed too near costs nothing, one assumed too far takes rays from the last bins. */
#define ASDIC_ZONE_ALTITUDE 0.9

typedef enum asdic_deposit {
    ASDIC_DEPOSIT_COLLECT = 0, /* arrivals are kept; each group has one work-item that adds them */
    ASDIC_DEPOSIT_ATOMIC64 = 1,
    ASDIC_DEPOSIT_ATOMIC32 = 2,
} asdic_deposit;

/* How the work is laid out on a device. The layout changes no byte of the result, with one exception:
 * WIDTH changes the last bits of mathematical functions, and is fixed per kind of device. */
typedef struct asdic_layout {
    unsigned width; /* rays per work-item: 1, 8 or 16 */
    asdic_deposit deposit;
    size_t local;       /* work-group size of the ray kernels */
    size_t workers;     /* work-items that share the groups in collect.cl; 0: one for each group */
    size_t batch_slots; /* rays held on the device at once, at least ASDIC_PILOT_RAYS */
    size_t
        ping_batch_slots; /* pings go to the device together while their rays are no more than this */
    unsigned threads; /* of the host, that share a ping's beams, at most: each has THREAD_CELLS */
    size_t thread_cells;
} asdic_layout;

asdic_layout asdic_layout_default(const asdic_device_info *info);

/* How the relative variance of a cell is stated. GROUP is the variance that the spread of a ping's own
 * groups suggests. The cell states
 *
 *     max(ASDIC_OWN_PING of_groups GROUP + of_block, of_groups GROUP) + rare
 *
 * OF_BLOCK comes from the calibration of the block of pings and belongs to pings with the energy MEAN_LIN;
 * a ping with less energy missed something, so that of_block counts for more: of_block and rare are then of a part of
 * MEAN_LIN, see estimate_errors in levels.c. RARE is the variance, relative to MEAN_LIN, of echoes that only few rays
 * bring. With many receivers there is one group: of_block is then all there is, 1 before a calibration and where its
 * pings heard nothing; of_groups is 1 where they heard something, else 0. */
#define ASDIC_OWN_PING 0.4
/* What N rays bring off an object errs by no less than this over N of what random ones would: an edge that three
 * rays hit knows no lattice. */
#define ASDIC_NO_LATTICE 3.0f
typedef struct asdic_stated_error {
    float of_groups, of_block, mean_lin, rare;
} asdic_stated_error;

typedef struct asdic_calibration asdic_calibration; /* see calibrate.c */
typedef struct asdic_drift_store asdic_drift_store; /* see drift.c */

/* One ping on its way through the simulator. */
typedef struct asdic_ping_shot {
    asdic_pose pose;
    uint64_t index;           /* of the ping in its mission */
    uint32_t stream;          /* of random numbers, ASDIC_STREAM_... */
    asdic_water_column water; /* at the depth of the pose */
    dev_ping *ping;           /* what the device is told; the apertures follow it */
    double tables_np_per_m;   /* absorption that the tables below are for; -1: none yet */
    double *loss, *volume;    /* per bin: TL d^2; s_V times the integral of TL d^2 */
    float *for_device;        /* the device's tables, as row_water in ping_batch.h */
    const char *sums;         /* as RESULTS in reduce.cl, or of a fan in fan.cl */
} asdic_ping_shot;

/* How far layers lie apart that are lifted, see place_layers. */
typedef struct asdic_lift_room {
    double high_m, bend_per_m; /* of any layer, at most */
    double tall_m;             /* of any triangle, at most */
    double rays_m;             /* as far as any comes from the sonar */
    double reach_m, least_m;   /* none touches another so near the frame's origin; at first */
} asdic_lift_room;

/* What is fixed when a simulator is made. */
typedef struct asdic_setup {
    const asdic_scene *scene;
    double
        bend_per_m; /* of the water, over its sound speed at the scene frame's zero; 0: straight */
    dev_layer layers[ASDIC_PROFILE_POINTS + 1]; /* where rays follow more than that */
    size_t layer_count;                         /* 0: they do not */
    asdic_lift_room lift_room;                  /* moves with the sonar, see asdic_sonar_frame */
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam *receivers; /* copy that sonar.receivers points to */
    asdic_sampling sampling;
    asdic_layout layout;
    size_t bins, cells; /* cells: bins times receivers */
    double from_m;      /* what is nearer is not heard: see pulse.h */
    size_t margin;      /* of the bins, the last, which are for the pulse alone: see pulse.h */
    size_t components;  /* that are deposited, see ping_types.h */
    unsigned groups;    /* replicates of a ping, whose spread tells its error */
    size_t per_group;   /* slots of a group in one batch of rays */
    size_t ping_batch;  /* that go to the device together */
    unsigned threads;   /* of the host, that share a ping's beams */
    bool has_mirrors;   /* multipath is wanted, and something in the scene reflects */
    asdic_scatterer *scatterers; /* the scene's materials, then the surface */
    dev_ping ping;               /* the members that are the same in every ping */
} asdic_setup;

/* Those that a simulator does not need are NULL; kernels alone: they are destroyed as an array. */
typedef struct asdic_kernels {
    asdic_kernel *sample, *pilot, *shade;
    asdic_kernel *advance, *volume; /* layers */
    asdic_kernel *connect, *bounce; /* multipath */
    asdic_kernel *collect, *suffix; /* one or the other, by layout.deposit */
    asdic_kernel *reduce;
} asdic_kernels;

/* A ray that is trapped between planes of layers may cross one again and again. It ends after so many legs, at
 * most. */
#define MOST_LEGS 256

/* Memory on the device; what kernels find in it stands at the kernels. */
typedef struct asdic_buffers {
    asdic_buffer *pings; /* dev_ping and apertures of each shot */
    asdic_buffer *table; /* kernels/learnt.h */
    asdic_buffer *parts, *materials, *no_triangles;
    asdic_buffer *rays, *solid_angles, *splats, *hits;
    asdic_buffer *layers, *legs, *leg_hits, *active; /* see advance.cl */
    asdic_buffer *bounced, *bounced_hits, *returning, *returning_hits, *mirrors;
    asdic_buffer *bounced_legs, *returning_legs;
    asdic_buffer *arrivals; /* ASDIC_DEPOSIT_COLLECT alone, see receive.h */
    asdic_buffer *water_tables;
    asdic_buffer *accumulator, *saturated, *totals, *results; /* see reduce.cl */
    asdic_buffer *pilot_rays, *pilot_energies;                /* adaptive sampler only */
    bool accumulator_clear; /* behind all buffers: asdic_store_destroy counts them by it */
} asdic_buffers;

/* The shots' memory on the host. */
typedef struct asdic_host_store {
    dev_ping *pings; /* each followed by its apertures */
    double *bin_tables;
    float *water;
    char *results;
    double *scratch;   /* asdic_pulse_scratch for every thread */
    asdic_ping **wide; /* setup.ping_batch with the margin, before the pulse; NULL: no margin */
    dev_pilot *pilot_rays;
    float *pilot_energies;
    asdic_arena memory; /* of these, the shots and what they state */
} asdic_host_store;

/* What a simulator has found out. */
typedef struct asdic_learnt {
    float table[DEV_TABLE_FLOATS]; /* see kernels/learnt.h */
    bool table_uploaded;
    bool azimuths; /* some row of the table's azimuths is not even */
    bool once;     /* something was learnt, even if it is forgotten by now */
    asdic_lesson lesson;
    double zone_altitude;           /* height of the sampler's bottom zone over the altitude */
    asdic_faces faces;              /* that rays are aimed at */
    asdic_glints glints;            /* of bodies, that rays are aimed at too */
    asdic_stated_error *stated;     /* by cell */
    float object_ratio;             /* of_groups of all cells that objects ruled */
    asdic_calibration *calibration; /* NULL before the first */
    asdic_drift_store *drift;       /* NULL before the first over anything but planes */
} asdic_learnt;

/* Rays to point targets; buffers only where something can hide them. */
typedef struct asdic_point_path asdic_point_path; /* points.c */
typedef struct asdic_point_rays {
    asdic_point_path *paths; /* of one ping, point by point */
    dev_ray *rays;
    dev_hit *hits;
    size_t path_count, path_capacity, ray_count, ray_capacity;
    asdic_buffer *ray_buffer, *hit_buffer;
} asdic_point_rays;

/* A point target that was heard. */
typedef struct asdic_truth_point {
    size_t point, bin;
    double down; /* sine of its depression */
    asdic_path by;
} asdic_truth_point;

/* Rows of truth (kernels/truth.h), of the shots on their way. */
typedef struct asdic_truth_rows {
    size_t rows, columns; /* 0: not wanted */
    bool asked;           /* by a ping of these shots */
    dev_truth_row *table; /* [shot][row] */
    asdic_buffer *table_buffer, *cell_buffer;
    void *cells; /* as they came from the device: the cell buffer's */
    size_t bytes;
    double *work;              /* of every thread */
    asdic_truth_point *points; /* of the current shot */
    double *point_lin;         /* their energies, [point][beam] */
    size_t point_count, point_room;
} asdic_truth_rows;

/* Where asdic_simulator_profile adds up time. */
typedef struct asdic_profile {
    double *seconds; /* NULL: nobody asks */
    double from_s;   /* when the current phase began */
} asdic_profile;

typedef struct asdic_coherent asdic_coherent; /* coherent.h */

/* The scene for light, which goes straight where sound does not; NULL until somebody looks, and where sound goes
 * straight too. */
typedef struct asdic_sight {
    asdic_placement *placement;
    asdic_tracer *tracer;
} asdic_sight;

struct asdic_simulator {
    asdic_context *ctx;
    asdic_device *device;
    asdic_setup setup;
    asdic_scene *lifted;        /* what rays meet where they bend; else NULL */
    asdic_placement *placement; /* where objects and points are now */
    asdic_tracer *tracer;       /* NULL without triangles */
    asdic_sight sight;
    asdic_kernels kernels;
    asdic_buffers buffers;
    uint32_t legs_foreseen[3]; /* of rays through layers, by set: as many as the rays before had */
    asdic_beam_fan fan;        /* where receivers are many */
    asdic_point_rays points;
    asdic_truth_rows truth;
    asdic_learnt learnt;
    asdic_host_store host;
    asdic_ping_shot *shots;            /* setup.ping_batch */
    asdic_quadrature_cache quadrature; /* where a plan left rays out */
    asdic_speckle_field *speckle;      /* NULL: none */
    asdic_coherent *coherent;          /* NULL: pings are of intensities */
    asdic_profile profile;
};

/* Whether a simulator's sonar may be so deep. */
asdic_status asdic_simulator_check_depth(asdic_context *ctx, double depth_m);

/* asdic_simulator_create with a layout of the caller's. Without a DEVICE it makes no pings, but aims them. */
asdic_status asdic_simulator_create_with(asdic_context *ctx, asdic_device *device,
                                         const asdic_scene *scene, const asdic_environment *env,
                                         const asdic_sonar *sonar, const asdic_sampling *sampling,
                                         double depth_m, const asdic_layout *layout,
                                         asdic_simulator **out);

/* Fills what does not change from ping to ping; WATER where the mission begins. */
void asdic_simulator_prepare(asdic_simulator *sim, const asdic_water_column *water);

/* Whether bottom and surface are mirrors. */
static inline bool asdic_simulator_boundaries_mirror(const asdic_simulator *sim) {
    return sim->setup.has_mirrors && sim->setup.sampling.multipath == ASDIC_MULTIPATH_BOUNDARIES;
}

/* The surface or, BELOW, the bottom plane, if it is a mirror; else NULL. */
static inline const asdic_scatterer *asdic_simulator_mirror(const asdic_simulator *sim,
                                                            bool below) {
    const asdic_scene *scene = sim->setup.scene;
    const asdic_scatterer *plane =
        &sim->setup.scatterers[below ? scene->bottom_plane_material : scene->material_count];
    bool is_there = below ? scene->has_bottom_plane : scene->has_surface;
    return is_there && asdic_simulator_boundaries_mirror(sim) && plane->material.law->reflected
               ? plane
               : NULL;
}

/* A shot's apertures: transmitter, then receivers. */
static inline dev_beam *asdic_shot_beams(const asdic_ping_shot *shot) {
    return (dev_beam *)(shot->ping + 1);
}

/* Streams of lattice shifts: what users get; the calibration's pings; the pilots, whose table
 * must not depend on the points it is used with. */
#define ASDIC_STREAM_PING 0u
#define ASDIC_MOST_CALIBRATION 8 /* pings */
#define ASDIC_STREAM_CALIBRATION(nth)                                                              \
    ((nth) < 3u ? 1u + (nth) : 3u + (nth)) /* beside the pilots' */
#define ASDIC_STREAM_PILOT 4u              /* and the next */

/* Aims SHOT at POSE: its water column, and its ping of RAYS rays with INDEX and STREAM. */
void asdic_shot_aim(const asdic_simulator *sim, asdic_ping_shot *shot, const asdic_pose *pose,
                    uint64_t index, uint32_t stream, uint32_t rays);

/* Fills SHOT's tables over the bins, unless they are there already: pings at one depth share them. Says
 * whether the device's part of them has changed. */
bool asdic_shot_tabulate(const asdic_simulator *sim, asdic_ping_shot *shot);

/* Uploads the first COUNT shots, samples and traces the batch of rays that the first names. */
asdic_status asdic_simulator_draw(asdic_simulator *sim, size_t count);

/* Runs the first COUNT shots, which are aimed, with setup.sampling.rays rays each; without points, pulse
 * and speckle. */
asdic_status asdic_simulator_simulate(asdic_simulator *sim, size_t count, asdic_ping *const *out);

/* Passes on the STATUS of what went to the device. Where it failed, waits until nothing is on its way there or back any
 * more: the next ping writes to the same memory. */
asdic_status asdic_simulator_settle(asdic_simulator *sim, asdic_status status);

/* SHOT's sums to energies, total, stated error and the count of cut deposits; OUT holds the noise already.
 * Of a fan, waits for the device. A quantum at loss 1 is worth SOURCE_LIN over its scale. */
asdic_status asdic_simulator_convert(asdic_simulator *sim, const asdic_ping_shot *shot,
                                     double source_lin, asdic_ping *out);

/* Slots of a group in one batch of a ping with RAYS rays: whole vectors, and whole work-groups over
 * all groups. */
size_t asdic_simulator_per_group(const asdic_simulator *sim, size_t rays);

/* Rays that are held on the device at once, at most. */
size_t asdic_simulator_batch_slots(const asdic_simulator *sim);

/* Bytes of a ping with its apertures; of its sums on their way to the host. */
size_t asdic_simulator_ping_bytes(const asdic_simulator *sim);
size_t asdic_simulator_results_bytes(const asdic_simulator *sim);

/* Receivers that the pilot rays are weighed for. */
uint32_t asdic_simulator_picked(const asdic_simulator *sim);

/* Memory on the host and on the device, once all sizes are known. Host first: it holds the shots. */
asdic_status asdic_store_create_host(asdic_simulator *sim);
asdic_status asdic_store_create_device(asdic_simulator *sim);
void asdic_store_destroy(asdic_simulator *sim);

/* The scene's triangles on the device, or a buffer to point at when there are none. */
asdic_buffer *asdic_simulator_triangles(const asdic_simulator *sim);

/* In what a sonar sees what moves: a frame (scene/placement.h), and how far out from its origin layers lie apart. Both
 * follow from its position alone. */
typedef struct asdic_sonar_frame {
    asdic_vec3 origin_m;
    double reach_m;
} asdic_sonar_frame;

asdic_sonar_frame asdic_simulator_frame(const asdic_simulator *sim, asdic_vec3 position_m);

/* Brings what moves into the frame of a sonar at POSITION_M, before it is aimed there. */
asdic_status asdic_simulator_center(asdic_simulator *sim, asdic_vec3 position_m);

/* Lifts the scene anew, with layers that lie apart out to REACH_M. */
asdic_status asdic_simulator_part_layers(asdic_simulator *sim, double reach_m);

/* What light meets: the scene as it stands now, without triangles NULL. The simulator's. */
asdic_status asdic_simulator_look(asdic_simulator *sim, asdic_tracer **out);

/* The same MOVABLE for light, where somebody has looked. */
asdic_status asdic_sight_move(asdic_simulator *sim, size_t movable, const asdic_pose *pose);
asdic_status asdic_sight_center(asdic_sight *sight, asdic_vec3 position_m);
void asdic_sight_finish(asdic_sight *sight);

/* Has the first ping do what others would wait for: where pings have to keep time. */
void asdic_simulator_hasten(asdic_simulator *sim);

/* Whether the scene has a mesh of KIND (DEV_KIND_BOTTOM, DEV_KIND_OBJECT). */
bool asdic_simulator_has(const asdic_simulator *sim, unsigned kind);

/* What the device is told about part INDEX of the scene. */
dev_part asdic_simulator_part(const asdic_part *part, size_t index);

/* The source's intensity at 1 m, linear, less the metre of absorption that the paper prints more. */
double asdic_simulator_source_lin(const asdic_simulator *sim, const asdic_water_column *water);

/* Measures how much the groups overstate the error of a whole ping, see calibrate.c. */
asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index);

void asdic_calibration_destroy(asdic_calibration **calibration);

/* Of a beam the first bins with an echo of the bottom, and those of the surface, err unlike those behind. */
#define ASDIC_BOUNDARIES 2
#define ASDIC_FIRST_BINS 2
extern const asdic_component asdic_boundaries[ASDIC_BOUNDARIES];

/* That a deposit goes to. */
extern const asdic_component asdic_component_of[DEV_DEPOSIT_COUNT];

/* The first of a beam's BINS that holds ENERGY; BINS: none does. */
size_t asdic_first_bin(const double *energy, size_t bins);

/* Where BEAM first heard BOUNDARY when the simulator learnt, before the pulse's length; beyond all bins: nowhere. */
size_t asdic_calibration_first_bin(const asdic_simulator *sim, size_t boundary, size_t beam);

/* Back to an even table and no calibration. */
void asdic_simulator_forget(asdic_simulator *sim);

#endif
