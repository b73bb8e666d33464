/*
 * Scattering laws: how much sound a surface of the scene returns, at which grazing angle. A
 * material is a law with its numbers. Bottoms, objects and the sea surface each take one.
 */
#ifndef ASDIC_LAW_H
#define ASDIC_LAW_H

#include <asdic/model.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a law is made for, as bits. */
#define ASDIC_LAW_BOTTOM 1u
#define ASDIC_LAW_OBJECT 2u
#define ASDIC_LAW_SURFACE 4u

typedef struct asdic_law asdic_law;

typedef struct asdic_law_info {
    const char *name;              /* "searay" */
    unsigned uses;                 /* ASDIC_LAW_BOTTOM ... */
    const asdic_model_info *model; /* its keys, units, ranges and source, as `asdic model` has it */
} asdic_law_info;

/* How many laws there are, one of them, and one by its name; NULL where there is none. They are
 * static. */
ASDIC_API size_t asdic_law_count(void);
ASDIC_API const asdic_law *asdic_law_get(size_t index);
ASDIC_API const asdic_law *asdic_law_find(const char *name);
ASDIC_API asdic_law_info asdic_law_get_info(const asdic_law *law);

/* A law and the values of its model's keys, in their order: NAN for those that are not given, which
 * have the fallback. ROWS are the pairs of numbers of the file that a law may have; they are
 * borrowed by everything that holds the material. LAW NULL: none. */
typedef struct asdic_material {
    const asdic_law *law;
    double value[ASDIC_MODEL_MAX_KEYS];
    const double *rows;
    size_t row_count;
} asdic_material;

/* LAW with nothing given. */
ASDIC_API asdic_material asdic_material_of(const asdic_law *law);

/* A bottom of the SEARAY model: 1 mud, 2 sand, 3 gravel, 4 rock, fractions allowed; NAN: sand. */
ASDIC_API asdic_material asdic_material_bottom(double bottom_type);

/* A rough facet: impedance 1e6 kg/(m2 s) (water 1.54, steel 45, air 0), r.m.s. height and slope of
 * its roughness. */
ASDIC_API asdic_material asdic_material_facet(double impedance_mrayl, double roughness_rms_m,
                                              double slope_rms);

/* Impedance of a thick body of steel, concrete, wood, ...; the error lists the names. */
ASDIC_API asdic_status asdic_material_find_impedance(asdic_context *ctx, const char *name,
                                                     double *impedance_mrayl);

/* Reads the CSV file PATH that MATERIAL's law takes into its rows, which free() ends. The error
 * names file and line of what is missing, no number, out of range or out of order. */
ASDIC_API asdic_status asdic_material_read_rows(asdic_context *ctx, asdic_material *material,
                                                const char *path);

/* The value of KEY; NAN where it is not given or the law has no such key. Setting one that the law
 * does not have is an error; ranges are checked where the material is used. */
ASDIC_API double asdic_material_get(const asdic_material *material, const char *key);
ASDIC_API asdic_status asdic_material_set(asdic_context *ctx, asdic_material *material,
                                          const char *key, double value);

/* Whether both scatter alike: the same law with the same values and rows. */
ASDIC_API bool asdic_material_equal(const asdic_material *a, const asdic_material *b);

/* Writes what it is in a few words: "sand", "impedance_mrayl 45", "curve". */
ASDIC_API void asdic_material_describe(const asdic_material *material, char *text, size_t size);

/* ASDIC_ERROR_ARGUMENT names the key whose value is out of range or whose rows are missing, out of
 * range or out of order. A number that is not given is none of these: it has the fallback. */
ASDIC_API asdic_status asdic_material_check(asdic_context *ctx, const asdic_material *material);

#ifdef __cplusplus
}
#endif

#endif
