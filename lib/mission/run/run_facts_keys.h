/*
 * Words and keys of run.json, which is written and read by them.
 */
#ifndef ASDIC_MISSION_RUN_FACTS_KEYS_H
#define ASDIC_MISSION_RUN_FACTS_KEYS_H

#include "run_facts.h"

#include <stddef.h>

typedef struct asdic_run_time_key {
    const char *name;
    size_t at; /* in asdic_run_times */
} asdic_run_time_key;

/* Components whose laws may state how far they err. */
typedef struct asdic_run_uncertain_key {
    const char *name;
    asdic_component component;
} asdic_run_uncertain_key;

#define ASDIC_RUN_TIME_COUNT 6
#define ASDIC_RUN_UNCERTAIN_COUNT 3
#define ASDIC_RUN_SAMPLER_COUNT (ASDIC_SAMPLER_UNIFORM_SPHERE + 1)
#define ASDIC_RUN_MULTIPATH_COUNT (ASDIC_MULTIPATH_BOUNDARIES + 1)
extern const char *const asdic_run_sampler_names[ASDIC_RUN_SAMPLER_COUNT];
extern const char *const asdic_run_multipath_names[ASDIC_RUN_MULTIPATH_COUNT];
extern const asdic_run_time_key asdic_run_time_keys[ASDIC_RUN_TIME_COUNT];
extern const asdic_run_uncertain_key asdic_run_uncertain_keys[ASDIC_RUN_UNCERTAIN_COUNT];

/* Whether TEXT, a run.json, states the sum of what stands before it. */
bool asdic_run_facts_signed(char *text, size_t length);

#endif
