/*
 * The simulator: one device, one scene, one environment, one sonar; give it a pose, get a ping.
 *
 * A ping depends on (scene, environment, sonar, sampling, pose, ping index) alone: the bytes are
 * the same for any thread count, work-group size, kernel choice or order of pings on one kind of
 * device, and within 1e-3 dB between kinds.
 */
#ifndef ASDIC_PING_H
#define ASDIC_PING_H

#include <asdic/device.h>
#include <asdic/scene.h>
#include <asdic/sonar.h>
#include <asdic/truth.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum asdic_sampler {
    ASDIC_SAMPLER_ADAPTIVE, /* importance in range and azimuth, learnt per block of pings */
    /* These take tens to thousands of times as many rays for the same error: */
    ASDIC_SAMPLER_BEAM,           /* importance from the beam patterns alone */
    ASDIC_SAMPLER_UNIFORM_SPHERE, /* the paper's */
} asdic_sampler;

/* X(ASDIC_SAMPLER_..., name) for each, in their order: what scene files and programs call them. */
#define ASDIC_SAMPLERS(X)                                                                          \
    X(ASDIC_SAMPLER_ADAPTIVE, "adaptive")                                                          \
    X(ASDIC_SAMPLER_BEAM, "beam")                                                                  \
    X(ASDIC_SAMPLER_UNIFORM_SPHERE, "uniform-sphere")

typedef enum asdic_multipath {
    ASDIC_MULTIPATH_OFF,
    ASDIC_MULTIPATH_FIRST,      /* over objects, one reflection */
    ASDIC_MULTIPATH_BOUNDARIES, /* over bottom and surface as well, which then scatter less */
} asdic_multipath;

/* Forms of the ray kernel (asdic/rays.h): how rays are cast, never what they meet. */
typedef enum asdic_ray_kernel {
    ASDIC_RAY_KERNEL_AUTO, /* what is fastest on the first rays; on a GPU SCALAR */
    ASDIC_RAY_KERNEL_WIDE8,
    ASDIC_RAY_KERNEL_PKT16,
    ASDIC_RAY_KERNEL_FRUSTUM64,
    ASDIC_RAY_KERNEL_SCALAR,
} asdic_ray_kernel;

typedef struct asdic_sampling {
    uint32_t rays; /* 64..2^28 */
    asdic_sampler sampler;
    asdic_multipath multipath;
    uint64_t seed;
    unsigned left_out; /* terms a plan proved negligible (asdic/plan.h); 0: model everything */
    asdic_ray_kernel kernel; /* changes the speed, never a byte */
    bool without_errors;     /* stderr_db stays 0, for the last few per cent of speed */

    /* Pressures at the sonar's array, with phase: RAYS is about how many scatterers there are,
     * which SEED fixes in the world; `sampler` has no effect. */
    bool coherent;
    bool truth; /* pings with truth have theirs filled; rays are cast, whatever a plan leaves out */
} asdic_sampling;

/* 20,000 rays, adaptive, first-order multipath, seed 1. */
ASDIC_API asdic_sampling asdic_sampling_default(void);

/* What rays go over: planes and simple bodies, planes that mirror as well, which makes as many
 * echoes again, or a bottom or objects from files. */
typedef enum asdic_rays_over {
    ASDIC_OVER_PLANES = 0,
    ASDIC_OVER_MIRRORS,
    ASDIC_OVER_MESHES
} asdic_rays_over;

/* Rays for a stated error of about 0.5 dB r.m.s. in bins above the noise: by the bins, by the
 * beams as far as they do not overlap, of more than eight by the gaps between them too, and by what
 * is below them; 20,000 to 524,288. The same on every machine. */
ASDIC_API uint32_t asdic_rays_auto(const asdic_sonar *sonar, double sound_speed_mps,
                                   asdic_rays_over over);

/* The stated error to expect of RAYS a ping, dB r.m.s. in bins above the noise, by the same cells:
 * of sonars like those of data mostly good to a factor of 2, of others of 5, without simulating
 * anything; 6.5 dB at most. */
ASDIC_API double asdic_rays_error_db(const asdic_sonar *sonar, double sound_speed_mps,
                                     asdic_rays_over over, uint32_t rays);

typedef enum asdic_component {
    ASDIC_TOTAL = 0,
    ASDIC_BOTTOM,
    ASDIC_SURFACE,
    ASDIC_VOLUME,
    ASDIC_OBJECT,
    ASDIC_MULTIPATH,
    ASDIC_NOISE,
    ASDIC_COMPONENT_COUNT
} asdic_component;

/* One ping's result. intensity_lin[c][beam * bins + bin] is the energy of component c in the bin,
 * linear re 1 uPa^2; 0 where there is none. Allocated by asdic_ping_create, reused freely. */
typedef struct asdic_ping {
    size_t beams, bins;
    double bin_length_m;
    double *intensity_lin[ASDIC_COMPONENT_COUNT];
    float *stderr_db;   /* one standard error of the total's sampling, dB, [beam * bins + bin]; NAN
                           of a coherent ping */
    uint64_t rays;      /* primary and secondary rays traced */
    uint64_t saturated; /* deposits cut to the accumulator's range; 0 in any sane scene */
    /* Of a coherent ping, after asdic_ping_add_elements; else 0 and NULL. Baseband pressure re
     * 1 uPa at element e, from port on, and sample n, at range (n + 1/2) times sample_m: the real
     * part at pressure[2 (e * samples + n)], the imaginary part behind it. After a way w it has
     * turned by exp(-2 pi i w / wavelength). The total is then one realisation, and the parts but
     * noise are 0. */
    size_t elements, samples;
    double sample_m;
    float *pressure;
    asdic_ping_truth *truth; /* NULL: not wanted, as in a new ping */
} asdic_ping;

/* A ping of BEAMS x BINS zeros. */
ASDIC_API asdic_status asdic_ping_create(asdic_context *ctx, size_t beams, size_t bins,
                                         asdic_ping **out);
ASDIC_API void asdic_ping_destroy(asdic_ping **ping);

/* Makes room for the pressure at every element. ASDIC_ERROR_ARGUMENT: none, or there is room
 * already. */
ASDIC_API asdic_status asdic_ping_add_elements(asdic_context *ctx, asdic_ping *ping,
                                               size_t elements, size_t samples);
/* Gives PING, from asdic_ping_create, room for truth: simulators made with sampling.truth then fill
 * it. Nothing to do where it has it; asdic_ping_destroy frees it. */
ASDIC_API asdic_status asdic_ping_add_truth(asdic_context *ctx, asdic_ping *ping);

/* 10 log10 of an intensity; -INFINITY for 0. */
ASDIC_API double asdic_level_db(double intensity_lin);

/* The levels of COMPONENT in PING, dB re 1 uPa, as runs keep them: NAN without energy. LEVEL_DB has
 * beams * bins values. */
ASDIC_API asdic_status asdic_ping_levels(const asdic_ping *ping, asdic_component component,
                                         float *level_db);

typedef struct asdic_simulator asdic_simulator;

/* Compiles kernels and uploads the scene. SCENE and DEVICE must outlive the simulator; ENV, SONAR
 * with its receivers, and SAMPLING are copied. The number of bins is fixed here from the sound
 * speed at DEPTH_M (a mission's first depth). A committed scene may serve simulators in several
 * threads; a device serves any number of simulators, one thread at a time.
 *
 * ASDIC_ERROR_ARGUMENT: a scene that is not committed, a field out of its range, named with the
 * limit; ASDIC_ERROR_DEVICE: the compiler refused the kernels; ASDIC_ERROR_MEMORY: more than the
 * device or the host has, said before anything is simulated. */
ASDIC_API asdic_status asdic_simulator_create(asdic_context *ctx, asdic_device *device,
                                              const asdic_scene *scene,
                                              const asdic_environment *env,
                                              const asdic_sonar *sonar,
                                              const asdic_sampling *sampling, double depth_m,
                                              asdic_simulator **out);
ASDIC_API void asdic_simulator_destroy(asdic_simulator **sim);

/* Range bins of a beam, for asdic_ping_create; 0 for NULL. */
ASDIC_API size_t asdic_simulator_bin_count(const asdic_simulator *sim);

/* Samples of an element in a coherent ping, for asdic_ping_add_elements; 0 where pings are not
 * coherent. */
ASDIC_API size_t asdic_simulator_sample_count(const asdic_simulator *sim);

/* Teaches the adaptive sampler where rays matter, with a pilot ping at POSE, and finds with a few
 * more pings what errors the pings will state; they keep what was learnt until the next call. Not
 * calling it is allowed: pings are then a little noisier, never biased, but of 16 receivers or more
 * they state errors of 4.3 dB, and samplers that do not learn know nothing of echoes that no ray
 * brought. Errors are stated as they are near POSE; a vehicle that has pitched, rolled, risen or
 * sunk since may err twenty times as much, one that has gone far over terrain or past objects, or
 * turned there, ten times. */
#define ASDIC_LEARN_BLOCK 32
ASDIC_API asdic_status asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose,
                                             uint64_t index);

/* Whether to learn at POSE before ping INDEX is simulated: at every multiple of ASDIC_LEARN_BLOCK,
 * and where the vehicle has pitched, rolled, risen or sunk, or over terrain and past objects gone
 * or turned, too far from where it learnt. Missions learn when it is due, each block of
 * ASDIC_LEARN_BLOCK pings by itself, so that results do not depend on who ran which ping. false:
 * NULL. */
ASDIC_API bool asdic_simulator_learn_is_due(const asdic_simulator *sim, const asdic_pose *pose,
                                            uint64_t index);

/* Simulates ping number INDEX with the vehicle at POSE, and waits for it. PING must have the
 * simulator's number of beams and bins. ASDIC_ERROR_ARGUMENT: it has others, or POSE is not finite
 * or deeper than 11,000 m; ASDIC_ERROR_MEMORY, ASDIC_ERROR_DEVICE_LOST: the device failed, and the
 * simulator can only be destroyed. */
ASDIC_API asdic_status asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose,
                                            uint64_t index, asdic_ping *ping);

/* COUNT pings, numbered from FIRST on, with the vehicle at POSES[0] and so on: the same bytes as
 * one after the other. Pings of few rays are simulated together, as many at once as
 * asdic_simulator_ping_batch says, in a fraction of the time; the caller learns between blocks, and
 * moves objects. Errors as of asdic_simulator_ping; all of PINGS are undefined then. */
ASDIC_API asdic_status asdic_simulator_pings(asdic_simulator *sim, const asdic_pose *poses,
                                             uint64_t first, size_t count,
                                             asdic_ping *const *pings);

/* 1 where nothing is gained by handing over more than one, at most ASDIC_LEARN_BLOCK; 0: NULL. */
ASDIC_API size_t asdic_simulator_ping_batch(const asdic_simulator *sim);

/* Places the scene's moving object or point NAME (of several of that name the first added) at POSE,
 * mesh frame to world, for the pings and the learning that follow; of a point only the position
 * counts. The scene itself stays as it is: every simulator has poses of its own, so that simulators
 * which share a scene, in several threads, may work on different pings. Call it between pings, from
 * the thread that uses the simulator; place every object where it is at ping INDEX before that
 * ping, and before learning at it, and results depend on INDEX alone.
 *
 * The ping then is that of a scene built anew with the object there: the same bytes where the box
 * round the scene stays the same, as inside a bottom mesh; else, or when a curved object is turned,
 * to the rounding of single precision (some 1e-4 dB). ASDIC_ERROR_ARGUMENT: no such name, an object
 * that was not added as moving, a pose that is not finite. */
ASDIC_API asdic_status asdic_simulator_move(asdic_simulator *sim, const char *name,
                                            const asdic_pose *pose);

/* Phases of a ping, in the order in which it passes them. */
typedef enum asdic_phase {
    ASDIC_PHASE_SAMPLE, /* the host's preparation and the drawing of rays */
    ASDIC_PHASE_TRACE,
    ASDIC_PHASE_SHADE,
    ASDIC_PHASE_BOUNCE,  /* multipath, its tracing included */
    ASDIC_PHASE_COLLECT, /* receiving, where it is not done while shading */
    ASDIC_PHASE_REDUCE,  /* sums, and their way back to the host */
    ASDIC_PHASE_LEVELS,  /* the host's work on the sums */
    ASDIC_PHASE_COUNT
} asdic_phase;

ASDIC_API const char *asdic_phase_name(asdic_phase phase); /* "sample"; never NULL */

/* Simulates a ping as asdic_simulator_ping does and adds to SECONDS[ASDIC_PHASE_COUNT] what each
 * phase took. Waiting for the device after each phase, it takes longer than a ping usually does. */
ASDIC_API asdic_status asdic_simulator_profile(asdic_simulator *sim, const asdic_pose *pose,
                                               uint64_t index, asdic_ping *ping, double *seconds);

/* What a coherent ping takes. */
typedef struct asdic_coherent_forecast {
    size_t scatterers;  /* of bottom, surface, water and objects */
    uint64_t bytes;     /* of memory for them */
    bool fits;          /* there is so much; else there are more scatterers than these */
    double processor_s; /* over all cores, of an AMD EPYC with AVX-512 */
} asdic_coherent_forecast;

#ifdef __cplusplus
}
#endif

#endif
