/*
 * Keys of a trial: what is drawn at random.
 */
#include "scene_keys.h"

#define LIMIT 1e12

#define DRAW(member) AT(file_draw, member)
#define DISTRIBUTIONS                                                                              \
    {"uniform",        ASDIC_KEY_NUMBERS,                                                          \
     ASDIC_KEY_ONE_OF, DRAW(uniform),                                                              \
     .min = -LIMIT,    .max = LIMIT,                                                               \
     .count = 2,       .doc = "between these two, each value as likely"},                          \
        {"normal",                                                                                 \
         ASDIC_KEY_NUMBERS,                                                                        \
         ASDIC_KEY_ONE_OF,                                                                         \
         DRAW(normal),                                                                             \
         .min = -LIMIT,                                                                            \
         .max = LIMIT,                                                                             \
         .count = 2,                                                                               \
         .doc = "of the normal distribution with this mean and standard deviation"},               \
        {"within",                                                                                 \
         ASDIC_KEY_NUMBERS,                                                                        \
         DRAW(within),                                                                             \
         .min = -LIMIT,                                                                            \
         .max = LIMIT,                                                                             \
         .count = 2,                                                                               \
         .doc = "normal: only between these two"},                                                 \
    {                                                                                              \
        "choice", ASDIC_KEY_NODE, ASDIC_KEY_ONE_OF, DRAW(choice),                                  \
            .doc =                                                                                 \
                "a list of values of any kind, each as likely; in place of a value another draw "  \
                "may stand, and none in place of a list's entry takes that out"                    \
    }

static const asdic_key inner_keys[] = {DISTRIBUTIONS};
const asdic_table asdic_inner_draw_table = {TABLE(inner_keys, file_draw), .doc = "a draw"};

static const asdic_key draw_keys[] = {
    {"key", ASDIC_KEY_NODE, ASDIC_KEY_REQUIRED, DRAW(key),
     .doc = "what is drawn, by its path in the scene, as objects[0].position_m[1]"},
    DISTRIBUTIONS,
};
static const asdic_table draw_table = {TABLE(draw_keys, file_draw),
                                       .doc = "one value that differs from run to run"};

static const asdic_key trial_keys[] = {
    {"draws", ASDIC_KEY_LIST, AT(file_trial, draws), .count = 4096, .table = &draw_table,
     .doc = "what is drawn at random in every run, in place of what the scene says"},
};
const asdic_table asdic_trial_table = {TABLE(trial_keys, file_trial),
                                       .doc = "what differs from run to run of a trial"};
