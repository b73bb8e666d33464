/*
 * The sonar: one transmitter, any number of receivers, and how time is cut into bins.
 */
#ifndef ASDIC_SONAR_H
#define ASDIC_SONAR_H

#include <asdic/environment.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A rectangular aperture, aimed relative to the vehicle. Positive pitch looks down. */
typedef struct asdic_beam {
    char name[ASDIC_NAME_SIZE]; /* ends with a zero; may be empty, or another beam's as well */
    double pitch_rad, yaw_rad, roll_rad;
    double length_h_m, length_v_m; /* horizontal and vertical side */
    double sensitivity_db; /* of a receiver, in intensities: on its axis, re 0 dB; at most 0 */
} asdic_beam;

typedef enum asdic_speckle {
    ASDIC_SPECKLE_NONE,     /* expected intensities */
    ASDIC_SPECKLE_RAYLEIGH, /* exponential intensity per resolution cell */
    ASDIC_SPECKLE_K,        /* gamma-modulated exponential, shape nu */
} asdic_speckle;

/* How the elements of an array are weighed to form beams. */
typedef enum asdic_shading {
    ASDIC_SHADING_NONE,
    ASDIC_SHADING_HANN,
    ASDIC_SHADING_TAYLOR,    /* first side lobes at side_lobe_db, then falling */
    ASDIC_SHADING_CHEBYSHEV, /* all side lobes at side_lobe_db */
} asdic_shading;

#define ASDIC_ARRAY_MAX_ELEMENTS 1024
#define ASDIC_SONAR_MAX_RECEIVERS 4096

/* Equal elements on a line through the sonar's position, from port to starboard. What coherent
 * pings receive with; the sonar's receivers are the beams that are formed of them. */
typedef struct asdic_array {
    size_t elements;  /* 0: there is no array; else 2..ASDIC_ARRAY_MAX_ELEMENTS */
    double spacing_m; /* 1e-6 m to 20 wavelengths, in water of 1700 m/s */
    asdic_shading shading;
    double side_lobe_db; /* of Taylor and Chebyshev, below 0 */
    asdic_beam element;  /* where all of them look, and their sides */
} asdic_array;

/* Fills WEIGHTS, one for each element; their sum is 1. Chebyshev: C. L. Dolph, Proc. IRE 34, 335
 * (1946); Taylor: T. T. Taylor, IRE Trans. AP-3, 16 (1955). */
ASDIC_API void asdic_array_weights(const asdic_array *array, double *weights);

/* Gives the COUNT beams, which are aimed in the array's plane already, the sides and the
 * sensitivity with which pings of intensities agree with what the array forms there: an even
 * aperture that takes in as much from all around as the weights do, as long as it looks from the
 * beam's direction (H. L. Van Trees, Optimum Array Processing (2002), chapter 2), with an element's
 * sensitivity there. */
ASDIC_API void asdic_array_form(const asdic_array *array, double wavelength_m, asdic_beam *beams,
                                size_t count);

/* More bins than any sonar has: a unit is wrong somewhere. */
#define ASDIC_SONAR_MAX_BINS 65536

typedef struct asdic_sonar {
    double frequency_hz; /* 100 Hz to 3 MHz */
    double bandwidth_hz;
    double ping_rate_hz;    /* no echo from beyond c / (2 ping_rate) is received */
    double source_level_db; /* dB re 1 uPa at 1 m, after pulse compression */
    double bin_length_m;
    double blanking_m; /* no echo is heard before it; behind it a pulse's tail from nearer is */
    asdic_beam transmitter;
    const asdic_beam *receivers; /* borrowed: must outlive the call it is passed to */
    size_t receiver_count;       /* 1..ASDIC_SONAR_MAX_RECEIVERS */
    bool noise_enabled;          /* noise in the band, in every bin: ambient, and the sonar's own */
    bool noise_directivity;      /* ambient noise less by the receiver's directivity */
    asdic_speckle speckle;
    double speckle_shape; /* of K: nu, 0.05 to 1000; small is spiky */
    double rear_floor_db; /* leak behind faces, dB re the same angle in front; -INFINITY: none */
    double max_range_m;   /* nothing farther is received; NAN: as far as the ping rate lets */
    asdic_array array;
    double self_noise_db; /* the sonar's own, at a receiver, of an array at each element: a spectrum
                             level, dB re 1 uPa^2/Hz, at most 300; -INFINITY: none */
} asdic_sonar;

/* 100 kHz, 10 kHz, 10 Hz and its range, 0 dB, 0.5 m bins and blanking, 0.05 m apertures, noise on,
 * no speckle. Source level and receivers are the caller's to give: without a receiver the check
 * fails. */
ASDIC_API asdic_sonar asdic_sonar_default(void);

/* Checks every field against its range; the error names field, value and limit. Bins are those in
 * the slowest water; asdic_simulator_create counts them in its own. */
ASDIC_API asdic_status asdic_sonar_check(asdic_context *ctx, const asdic_sonar *sonar);

/* c / (2 ping_rate), or max_range_m where that is less, m; and the number of whole bins within it
 * (at least 1). */
ASDIC_API double asdic_sonar_max_range_m(const asdic_sonar *sonar, double sound_speed_mps);
ASDIC_API size_t asdic_sonar_bin_count(const asdic_sonar *sonar, double sound_speed_mps);

/* Independent looks in a bin: its length in resolution cells c / (2 bandwidth), rounded, at least 1
 * and at most 1000. */
ASDIC_API unsigned asdic_sonar_looks(const asdic_sonar *sonar, double sound_speed_mps);

#ifdef __cplusplus
}
#endif

#endif
