/*
 * A scattering law inside. One file makes one law: its parameters, its strength against the grazing
 * angle, the share it reflects. `meson.build` lists the files; all that knows of laws follows from
 * that list.
 */
#ifndef ASDIC_LAWS_SCATTERER_H
#define ASDIC_LAWS_SCATTERER_H

#include <asdic/law.h>

#include "../../kernels/types.h"
#include "base/columns.h"

/* Of a law whose keys may stand at an object itself, without a material round them. */
#define ASDIC_LAW_BRIEF 8u

/* What a law may depend on beside its own numbers. */
typedef struct asdic_law_water {
    double frequency_hz, sound_speed_mps, wavelength_m, wind_speed_kn;
} asdic_law_water;

/* The grazing angle: near normal incidence its squared cosine is the more precise, near grazing its
 * sine. A flat patch of COHERENT_M2 at RANGE_M reflects in phase; facets alone ask for these. */
typedef struct asdic_incidence {
    double sine, cos2;
    double coherent_m2, range_m;
} asdic_incidence;

/* On a plane: its patches are endless. */
static inline asdic_incidence asdic_incidence_on_plane(double sine, double cos2) {
    return (asdic_incidence){.sine = sine, .cos2 = cos2, .coherent_m2 = 1e12, .range_m = 1e30};
}

/* Room for what a law computes once for all angles. */
#define ASDIC_LAW_MADE 32

/* A material in its water: all that is the same for every angle is computed. */
typedef struct asdic_scatterer {
    asdic_material material;
    asdic_law_water water;
    double value[ASDIC_MODEL_MAX_KEYS]; /* the material's, with fallbacks where there are some */
    double made[ASDIC_LAW_MADE];
    dev_material device; /* of a table: where it lies is not known here */
    bool silent;         /* returns nothing; reflects as before */
} asdic_scatterer;

struct asdic_law {
    const char *name;
    const char *surface_word; /* what `surface: {law: ...}` calls it; NULL: it is not named there */
    unsigned uses;            /* ASDIC_LAW_BOTTOM ... */
    unsigned formula; /* of the device (DEV_LAW_*); DEV_LAW_TABLE: it tabulates the functions */
    asdic_model_info
        model; /* parameters, units, ranges, fallbacks, source; one row of the models */

    asdic_columns table; /* of the file that a key of MODEL with columns names; none: {0} */
    /* Fills MADE and, for a formula, DEVICE; NULL: nothing to compute. */
    void (*prepare)(asdic_scatterer *s);
    /* Backscattering strength, linear, 1/sr. */
    double (*strength_lin)(const asdic_scatterer *s, const asdic_incidence *at);
    /* Its largest value at any angle as far as RANGE_M; NULL: it is searched. */
    double (*most_lin)(const asdic_scatterer *s, double range_m);
    /* Share of the arriving energy that goes on in the mirror direction; NULL: none. */
    double (*reflected)(const asdic_scatterer *s, double sine);
    /* The same for a smooth face, and its row of the models, a loss in dB with the keys of MODEL; NULL:
     * there is none. */
    double (*smooth_reflected)(const asdic_scatterer *s, double sine);
    const asdic_model_info *mirror_model;
    /* How far the source of the law says that it may err, dB either way; NULL or NAN: it does not. */
    double (*uncertainty_db)(const asdic_scatterer *s);
    /* Grazing angles at which the strength has a kink or a narrow peak, ascending, NAN after the
     * last; NULL: it is smooth. */
    double (*knot_deg)(const asdic_scatterer *s, size_t index);
};

/* The place of KEY in the law's model; key_count: it has none. */
size_t asdic_law_key(const asdic_law *law, const char *key);

/* asdic_material_read_rows with what is wrong in the file as PROBLEMS, which keep PATH; the rows stay as they
 * were then. */
asdic_status asdic_material_read_table(asdic_context *ctx, asdic_material *material,
                                       const char *path, asdic_problems *problems);

/* asdic_material_check, and whether the law is made for USE, one of ASDIC_LAW_BOTTOM ..., a bottom's also for objects. */
asdic_status asdic_material_check_use(asdic_context *ctx, const asdic_material *material,
                                      unsigned use);

/* The word that stands for VALUE of KEY, LENGTH characters; NULL: none does. */
const char *asdic_law_word(const asdic_model_key *key, double value, int *length);

/* MATERIAL, which has passed its check, in WATER. */
asdic_scatterer asdic_scatterer_at(const asdic_material *material, const asdic_law_water *water);

/* How far S may lie from nature by the law's own source, dB either way; NAN: the source does not say. */
double asdic_scatterer_uncertainty_db(const asdic_scatterer *s);

/* Its law's knot_deg at INDEX, NAN after the last. */
double asdic_scatterer_knot_deg(const asdic_scatterer *s, size_t index);

/* How many it has. */
size_t asdic_scatterer_knots(const asdic_scatterer *s);

/* Makes it return nothing. */
void asdic_scatterer_silence(asdic_scatterer *s);

/* Strength at the sine of a grazing angle on a plane without end. */
double asdic_scatterer_strength(const asdic_scatterer *s, double sine);

/* Most of the strength; most of strength / sine from the sine LEAST on. A plane as far as RANGE_M. */
double asdic_scatterer_most(const asdic_scatterer *s, double range_m);
double asdic_scatterer_steepest(const asdic_scatterer *s, double least);

#endif
