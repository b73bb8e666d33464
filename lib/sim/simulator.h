/*
 * The simulator inside: what a ping needs on the device, and how hosts and tests tune it.
 */
#ifndef ASDIC_SIM_SIMULATOR_H
#define ASDIC_SIM_SIMULATOR_H

#include <asdic/ping.h>

#include "../../kernels/ping_types.h"
#include "beam_fan.h"
#include "faces.h"
#include "laws/scatterer.h"
#include "quadrature_ping.h"
#include "speckle.h"
#include "ocl/ocl.h"
#include "scene/tracer.h"
#include "water_column.h"

/* Most rays of a pilot ping. */
#define ASDIC_PILOT_RAYS 4096u

/* The bottom zone of the adaptive sampler assumes a little less altitude than measured: too low
 * costs nothing, too high starves the last bins. */
#define ASDIC_ZONE_ALTITUDE 0.9

typedef enum asdic_deposit {
    ASDIC_DEPOSIT_OWNED = 0, /* a work-item owns a group's cells */
    ASDIC_DEPOSIT_ATOMIC64 = 1,
    ASDIC_DEPOSIT_ATOMIC32 = 2,
} asdic_deposit;

/* How the work is laid out on a device. Never changes a byte of the result, except WIDTH (the last
 * bits of functions), which is fixed per kind of device. */
typedef struct asdic_layout {
    unsigned width; /* rays per work-item: 1, 8 or 16 */
    asdic_deposit deposit;
    size_t local;        /* work-group size of the ray kernels */
    size_t owners;       /* work-items that serve the groups; 0: one each */
    size_t batch_slots;  /* rays held on the device at once, at least ASDIC_PILOT_RAYS */
    size_t volley_slots; /* rays up to which pings go to the device together */
} asdic_layout;

asdic_layout asdic_layout_default(const asdic_device_info *info);

/* A cell's relative variance as a ping states it: OF_BLOCK, which the block's calibration found, and
 * ASDIC_OWN_PING times OF_GROUPS times what the ping's groups suggest; or OF_GROUPS times that alone where
 * it is more, since the vehicle moves on. OF_BLOCK is of a ping with the energy MEAN_LIN: one with less
 * missed something, which stays as uncertain as it was. RARE is the variance, relative to MEAN_LIN, by
 * echoes that few rays bring. Where receivers are many there is one group: OF_BLOCK is all, 1 before a
 * calibration. */
#define ASDIC_OWN_PING 0.4
typedef struct asdic_stated_error {
    float of_groups, of_block, mean_lin, rare;
} asdic_stated_error;

typedef struct asdic_calibration asdic_calibration; /* see calibrate.c */

/* What a ping's depth makes of its bins. */
typedef struct asdic_bin_laws {
    double absorption_np_per_m; /* they are for; -1: none yet */
    double *loss, *volume;      /* TL d^2; s_V times the integral of TL d^2 */
} asdic_bin_laws;

/* A ping to simulate; STREAM as below. */
typedef struct asdic_ping_shot {
    asdic_pose pose;
    uint64_t index;
    uint32_t stream;
} asdic_ping_shot;

struct asdic_simulator {
    asdic_context *ctx;
    asdic_device *device;
    const asdic_scene *scene;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam *receivers; /* owned copy that sonar.receivers points to */
    asdic_sampling sampling;
    asdic_layout layout;
    size_t bins, cells;
    size_t components; /* deposited, see ping_types.h */
    unsigned groups;
    size_t per_group; /* slots of a group in one batch */
    size_t volley;    /* pings that go to the device together, at most */

    asdic_placement *placement; /* where objects and points are now */
    asdic_tracer *tracer;       /* NULL without triangles */
    bool has_mirrors;           /* something in the scene reflects, and multipath is wanted */
    asdic_kernel *sample, *shade, *collect, *suffix, *reduce; /* collect: or suffix */
    asdic_beam_fan fan;                                       /* many receivers, where there are */
    asdic_faces faces;                                        /* that rays are aimed at; learnt */
    asdic_kernel *survey_kernel;                              /* adaptive sampler only */
    asdic_kernel *connect, *bounce;                           /* NULL without mirrors */
    asdic_buffer *ping_buffer; /* dev_ping, then the apertures, for each ping of a volley */
    asdic_buffer *table_buffer;
    asdic_buffer *rays, *solid_angles, *splats, *hits;
    asdic_buffer *bounced, *bounced_hits, *returning, *returning_hits, *mirrors;
    asdic_buffer *parcels; /* where work-items own groups, see receive.h */
    asdic_buffer *parts, *materials, *no_triangles;
    asdic_buffer *water_tables;                      /* as row_water in volley.h */
    asdic_buffer *accumulator, *saturated, *results; /* see reduce.cl */
    asdic_buffer *totals;                            /* of groups, where work-items own them */
    asdic_buffer *survey_ray_buffer,
        *survey_energy_buffer; /* see survey.cl; adaptive sampler only */

    asdic_buffer *point_ray_buffer, *point_hit_buffer; /* NULL without points or triangles */
    dev_ray *point_rays;
    dev_hit *point_hits;

    asdic_scatterer *scatterers;    /* the scene's materials, then the surface */
    dev_ping fixed;                 /* what does not change from ping to ping */
    dev_ping *pings, *ping;         /* a volley's, and the current one; the apertures follow */
    size_t nth;                     /* the current ping's place in its volley */
    asdic_bin_laws *laws;           /* of each ping of a volley */
    double *bin_tables;             /* what they hold */
    float *water;                   /* their part for the device, as WATER_TABLES */
    double *smear_scratch;          /* asdic_pulse_scratch, and for calibrations */
    asdic_stated_error *stated;     /* cells */
    asdic_calibration *calibration; /* NULL before the first */
    float table[DEV_TABLE_FLOATS];  /* see kernels/learnt.h */
    bool azimuths_learnt;           /* some row of it is not even */
    double zone_altitude;           /* where the bottom zone assumes the bottom, re the altitude */
    double *phase_s;                /* NULL, or where asdic_simulator_profile adds */
    double phase_from_s;            /* when the current phase began */
    asdic_quadrature_cache quadrature; /* where a plan left rays out */
    asdic_speckle_field *speckle;      /* NULL: none */
    bool table_uploaded;
    bool learnt; /* once at least */
    bool accumulator_clear;
    char *host_results; /* as RESULTS in reduce.cl, or of a fan in fan.cl */
    dev_survey *survey_rays;
    float *survey_energies;
};

/* asdic_simulator_create with a layout of the caller's. */
asdic_status asdic_simulator_create_with(asdic_context *ctx, asdic_device *device,
                                         const asdic_scene *scene, const asdic_environment *env,
                                         const asdic_sonar *sonar, const asdic_sampling *sampling,
                                         double depth_m, const asdic_layout *layout,
                                         asdic_simulator **out);

/* Fills what does not change from ping to ping; WATER where the mission begins. */
void asdic_simulator_prepare(asdic_simulator *sim, const asdic_water_column *water);

/* The apertures of the current ping: transmitter, then receivers. */
static inline dev_beam *asdic_simulator_beams(const asdic_simulator *sim) {
    return (dev_beam *)(sim->ping + 1);
}

/* Streams of lattice shifts: what users get; the calibration's pings; the pilots, whose table
 * must not depend on the points it is used with. */
#define ASDIC_STREAM_PING 0u
#define ASDIC_STREAM_CALIBRATION 1u /* and the next two */
#define ASDIC_STREAM_PILOT 4u       /* and the next */

/* Makes the volley's NTH ping the current one. */
void asdic_simulator_select(asdic_simulator *sim, size_t nth);

/* Steps of a ping that learning shares with it. Describe: fills sim->ping for INDEX at POSE with
 * RAYS rays. Draw: uploads COUNT pings, samples and traces the batch that the first names. */
void asdic_simulator_describe(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                              uint32_t stream, uint32_t rays);
asdic_status asdic_simulator_draw(asdic_simulator *sim, size_t count);

/* Slots of a group in one batch of a ping with RAYS rays: whole vectors, and whole work-groups over
 * all groups. */
size_t asdic_simulator_per_group(const asdic_simulator *sim, size_t rays);

/* Rays that are held on the device at once, at most. */
size_t asdic_simulator_batch_slots(const asdic_simulator *sim);

/* Bytes of a ping with its apertures; of its sums on their way to the host. */
size_t asdic_simulator_ping_bytes(const asdic_simulator *sim);
size_t asdic_simulator_results_bytes(const asdic_simulator *sim);

/* Receivers that a survey of pilot rays picks. */
uint32_t asdic_simulator_picked(const asdic_simulator *sim);

/* Memory of host and device, when all that it depends on is known. Host: before anything is described. */
asdic_status asdic_store_create_host(asdic_simulator *sim);
asdic_status asdic_store_create_device(asdic_simulator *sim);
void asdic_store_destroy(asdic_simulator *sim);

/* The scene's triangles on the device, or a buffer to point at when there are none. */
asdic_buffer *asdic_simulator_triangles(const asdic_simulator *sim);

/* Whether the scene has a mesh of KIND (DEV_KIND_BOTTOM, DEV_KIND_OBJECT). */
bool asdic_simulator_has(const asdic_simulator *sim, unsigned kind);

/* What the device is told about a part. */
dev_part asdic_simulator_part(const asdic_part *part);

/* COUNT pings without points, pulse and speckle, a volley at most. */
asdic_status asdic_simulator_simulate(asdic_simulator *sim, const asdic_ping_shot *shots,
                                      size_t count, asdic_ping *const *out);

/* The current ping's sums to energies, total and stated error, and the count of cut deposits; OUT holds
 * the noise already. Of a fan, waits for the device. A quantum at loss 1 is worth SOURCE_LIN over its
 * scale. */
asdic_status asdic_simulator_convert(asdic_simulator *sim, double source_lin, asdic_ping *out);

/* The source's intensity at 1 m, linear, less the metre of absorption that the paper prints more. */
double asdic_simulator_source_lin(const asdic_simulator *sim, const asdic_water_column *water);

/* Measures how much the groups overstate the error of a whole ping, see calibrate.c. */
asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index);

void asdic_calibration_destroy(asdic_calibration **calibration);

/* Back to an even table and no calibration. */
void asdic_simulator_forget(asdic_simulator *sim);

/* Ends a phase of a ping that is profiled: waits for the device, adds the time. */
asdic_status asdic_simulator_end_phase(asdic_simulator *sim, asdic_phase phase);

#endif
