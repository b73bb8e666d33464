/*
 * The formulas one by one, by name, as `asdic model` prints them: names, keys and units are those
 * of the command. The same text is evaluated in double on the host or in float on a device.
 */
#ifndef ASDIC_MODEL_H
#define ASDIC_MODEL_H

#include <asdic/device.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ASDIC_MODEL_MAX_KEYS 12

typedef struct asdic_model_key {
    const char *name;  /* "f_khz" */
    const char *words; /* NULL, or the words that stand for min, min + 1, ...: "mud|sand|..." */
    bool numeric;      /* takes a number (a key may take both) */
    bool required;
    double fallback; /* value of an optional key; NAN: none, the formula may ask for it */
    double min, max; /* accepted domain, inclusive */
    double valid_min, valid_max; /* stated validity of the source; outside, a warning in the log */
    /* Of keys that a scene file gives to a scattering law (asdic/law.h): */
    const char *doc;     /* what it means; NULL: the scene file has no such key */
    const char *unit;    /* NULL: a pure number */
    bool chooses;        /* whoever gives it chooses the law; at most one of these is given */
    const char *columns; /* the value is a CSV file with these two columns; NULL: it is a number */
} asdic_model_key;

typedef struct asdic_model_info {
    const char *name;   /* "bottom-backscatter" */
    const char *unit;   /* "dB" */
    const char *what;   /* "bottom backscattering strength re 1 m^2/m^2" */
    const char *source; /* "SEARAY, in: Kraus, ... " */
    size_t key_count;
    asdic_model_key keys[ASDIC_MODEL_MAX_KEYS];
} asdic_model_info;

/* How many formulas there are, and one of them, which is static. */
ASDIC_API size_t asdic_model_count(void);
ASDIC_API const asdic_model_info *asdic_model_get(size_t index); /* NULL when out of range */

/* Evaluates model NAME for COUNT "key=value" strings. DEVICE NULL: host, double; else in single
 * precision there. Unknown names and keys are answered with the nearest one, missing keys with the
 * list of all. Outside the source's stated validity the value is given and a warning logged. */
ASDIC_API asdic_status asdic_model_evaluate(asdic_context *ctx, asdic_device *device,
                                            const char *name, const char *const *assignments,
                                            size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
