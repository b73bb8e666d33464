#include <asdic/sonar.h>

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "array.h"
#include "environment.h"
#include "laws/keys.h"
#include "texture.h"

#include "../../kernels/water.h"

#include <string.h>

/* Below a hundredth of the shortest wavelength. An element may be as short as its array's spacing. */
#define LEAST_SPACING_M 1e-6
#define MOST_SPACING_WL 20.0

asdic_sonar asdic_sonar_default(void) {
    return (asdic_sonar){
        .frequency_hz = 100e3,
        .bandwidth_hz = 10e3,
        .ping_rate_hz = 10.0,
        .max_range_m = NAN,
        .source_level_db = 0.0,
        .bin_length_m = 0.5,
        .blanking_m = 0.5,
        .transmitter = {.name = "transmitter", .length_h_m = 0.05, .length_v_m = 0.05},
        .noise_enabled = true,
        .noise_directivity = true,
        .speckle = ASDIC_SPECKLE_NONE,
        .speckle_shape = INFINITY,
        .rear_floor_db = -INFINITY,
        .self_noise_db = -INFINITY,
    };
}

typedef struct sonar_field {
    const char *name, *unit;
    double value, min, max;
} sonar_field;

static asdic_status check_fields(asdic_context *ctx, const char *where, const sonar_field *fields,
                                 size_t count) {
    for (size_t i = 0; i < count; i++) {
        const sonar_field *f = &fields[i];
        if (!(f->value >= f->min && f->value <= f->max)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "sonar: '%s'%s%s = %g is out of range [%g, %g]%s%s", f->name,
                              *where ? " of beam " : "", where, f->value, f->min, f->max,
                              *f->unit ? " " : "", f->unit);
        }
    }
    return ASDIC_OK;
}

/* A name may be empty, or another beam's: only files of missions tell beams by it, and scene files ask for more. */
static asdic_status check_name(asdic_context *ctx, const asdic_beam *beam) {
    return memchr(beam->name, '\0', sizeof beam->name)
               ? ASDIC_OK
               : asdic_fail(
                     ctx, ASDIC_ERROR_ARGUMENT,
                     "sonar: the name of beam '%.16s...' has no terminating zero in %zu bytes",
                     beam->name, sizeof beam->name);
}

static asdic_status check_beam(asdic_context *ctx, const asdic_beam *beam, double least_m) {
    const double turn = 2.0 * ASDIC_PI;
    const sonar_field fields[] = {
        {"pitch_rad", "rad", beam->pitch_rad, -turn, turn},
        {"yaw_rad", "rad", beam->yaw_rad, -turn, turn},
        {"roll_rad", "rad", beam->roll_rad, -turn, turn},
        {"length_h_m", "m", beam->length_h_m, least_m, ASDIC_MOST_LENGTH_M},
        {"length_v_m", "m", beam->length_v_m, least_m, ASDIC_MOST_LENGTH_M},
        {"sensitivity_db", "dB", beam->sensitivity_db, -300.0, 0.0},
    };
    TRY(check_name(ctx, beam));
    return check_fields(ctx, beam->name, fields, sizeof fields / sizeof *fields);
}

static asdic_status check_array(asdic_context *ctx, const asdic_array *a, double frequency_hz) {
    const sonar_field spacing = {"spacing_m", "m", a->spacing_m, LEAST_SPACING_M,
                                 MOST_SPACING_WL * (ASDIC_SOUND_MOST_MPS / frequency_hz)};
    if (a->elements == 0) {
        return ASDIC_OK;
    }
    if (a->elements < 2 || a->elements > ASDIC_ARRAY_MAX_ELEMENTS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%zu elements: out of range [2, %d]",
                          a->elements, ASDIC_ARRAY_MAX_ELEMENTS);
    }
    TRY(check_fields(ctx, "", &spacing, 1));
    TRY(check_beam(ctx, &a->element, LEAST_SPACING_M));
    if ((unsigned)a->shading > ASDIC_SHADING_CHEBYSHEV) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "unknown shading %d", (int)a->shading);
    }
    bool has_level = a->shading == ASDIC_SHADING_TAYLOR || a->shading == ASDIC_SHADING_CHEBYSHEV;
    if (has_level && !(a->side_lobe_db <= -10.0 && a->side_lobe_db >= -100.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "side lobes of %g dB: out of range [-100, -10] dB", a->side_lobe_db);
    }
    return ASDIC_OK;
}

asdic_status asdic_sonar_check_bins(asdic_context *ctx, const asdic_sonar *sonar,
                                    double sound_speed_mps) {
    size_t bins = asdic_sonar_bin_count(sonar, sound_speed_mps);
    return bins <= ASDIC_SONAR_MAX_BINS
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                            "sonar: %zu bins, more than %d; lengthen bin_length_m, lower "
                            "max_range_m or raise ping_rate_hz",
                            bins, ASDIC_SONAR_MAX_BINS);
}

asdic_status asdic_sonar_check(asdic_context *ctx, const asdic_sonar *sonar) {
    if (!sonar) {
        return asdic_fail_null(ctx, __func__);
    }
    const sonar_field fields[] = {
        {"frequency_hz", "Hz", sonar->frequency_hz, 100.0, 1e3 * ASDIC_MOST_KHZ},
        {"bandwidth_hz", "Hz", sonar->bandwidth_hz, 1.0, 1e6},
        {"ping_rate_hz", "Hz", sonar->ping_rate_hz, 0.01, 1000.0},
        {"source_level_db", "dB", sonar->source_level_db, -300.0, 300.0},
        {"bin_length_m", "m", sonar->bin_length_m, 1e-3, 1000.0},
        {"blanking_m", "m", sonar->blanking_m, 0.01, 1e4},
        {"receiver_count", "", (double)sonar->receiver_count, 1.0, ASDIC_SONAR_MAX_RECEIVERS},
    };
    TRY(check_fields(ctx, "", fields, sizeof fields / sizeof *fields));
    if (!isnan(sonar->max_range_m) && !(sonar->max_range_m > 0.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "sonar: 'max_range_m' = %g is not above 0 m",
                          sonar->max_range_m);
    }
    /* In the slowest water, where a range holds fewest: what is within the limit in its own water is within it here. */
    TRY(asdic_sonar_check_bins(ctx, sonar, ASDIC_SOUND_LEAST_MPS));
    if (!(sonar->rear_floor_db <= 0.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "sonar: 'rear_floor_db' = %g is above 0 dB re on-axis",
                          sonar->rear_floor_db);
    }
    if (!(sonar->self_noise_db <= 300.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "sonar: 'self_noise_db' = %g is above 300 dB re 1 uPa^2/Hz",
                          sonar->self_noise_db);
    }
    if ((unsigned)sonar->speckle > ASDIC_SPECKLE_K) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "sonar: unknown speckle %d",
                          (int)sonar->speckle);
    }
    const sonar_field shape = {"speckle_shape", "", sonar->speckle_shape, ASDIC_SHAPE_LEAST,
                               ASDIC_SHAPE_MOST};
    if (sonar->speckle == ASDIC_SPECKLE_K) {
        TRY(check_fields(ctx, "", &shape, 1));
    }
    TRY(check_array(ctx, &sonar->array, sonar->frequency_hz));
    TRY(check_beam(ctx, &sonar->transmitter, ASDIC_LEAST_LENGTH_M));
    if (!sonar->receivers) {
        return asdic_fail_null(ctx, __func__);
    }
    for (size_t i = 0; i < sonar->receiver_count; i++) {
        TRY(check_beam(ctx, &sonar->receivers[i], ASDIC_LEAST_LENGTH_M));
    }
    return ASDIC_OK;
}

double asdic_sonar_max_range_m(const asdic_sonar *sonar, double sound_speed_mps) {
    if (!sonar) {
        return NAN;
    }
    /* fmin takes the other one where one is NAN */
    return fmin(sonar->max_range_m, max_range_m(sound_speed_mps, sonar->ping_rate_hz));
}

size_t asdic_sonar_bin_count(const asdic_sonar *sonar, double sound_speed_mps) {
    if (!sonar) {
        return 0;
    }
    double bins = asdic_sonar_max_range_m(sonar, sound_speed_mps) / sonar->bin_length_m;
    /* 75 m of 0.1 m bins are 750 bins, though 75 / 0.1 is 749.9999999999999 somewhere. */
    double whole = floor(bins * (1.0 + 1e-9));
    return whole >= 1.0 ? (size_t)whole : 1;
}

unsigned asdic_sonar_looks(const asdic_sonar *sonar, double sound_speed_mps) {
    if (!sonar) {
        return 0;
    }
    double cells = sonar->bin_length_m * 2.0 * sonar->bandwidth_hz / sound_speed_mps;
    return (unsigned)fmin(fmax(round(cells), 1.0), 1000.0);
}
