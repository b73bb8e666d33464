/*
 * Keys of a trial: what is drawn at random, the vehicle's rule, what ends a run.
 */
#include "scene_keys.h"

#include "trial_plan.h"

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

static const asdic_word manoeuvre_words[] = {
    {"hold", ASDIC_HOLD}, {"climb", ASDIC_CLIMB}, {"turn", ASDIC_TURN}, {NULL, 0}};
#define RULE(member) AT(file_rule, member)
static const asdic_key rule_keys[] = {
    {"manoeuvre", ASDIC_KEY_WORD, RULE(manoeuvre), .words = manoeuvre_words, .fallback = "climb",
     .doc = "what the vehicle does about what it sees: hold on, climb, or turn"},
    {"reach_m", ASDIC_KEY_NUMBER, RULE(reach_m), .unit = "m", .min = 0.1, .max = 1e4,
     .fallback = "20", .doc = "detections nearer than this count: the stopping distance"},
    {"sector_deg", ASDIC_KEY_NUMBER, RULE(sector_deg), .unit = "deg", .min = 0, .max = 180,
     .fallback = "180", .doc = "... in beams whose axis is within this angle of the bow"},
    {"posterior", ASDIC_KEY_NUMBER, RULE(posterior), .min = 0, .max = 1, .fallback = "0.5",
     .doc = "... whose probability of a target, by the detector's prior, is this or more"},
    {"loss_ratio", ASDIC_KEY_NUMBER, RULE(loss_ratio), .min = 1e-6, .max = 1e12,
     .doc = "loss of a collision over that of a needless manoeuvre: in place of posterior, the "
            "manoeuvre whose expected loss is less"},
    {"hits", ASDIC_KEY_INTEGER, RULE(hits), .min = 1, .max = 64, .fallback = "1",
     .doc = "pings with such a detection that it takes ..."},
    {"of", ASDIC_KEY_INTEGER, RULE(of), .min = 1, .max = 64, .fallback = "1",
     .doc = "... out of so many, the last ones"},
    {"climb_m", ASDIC_KEY_NUMBER, RULE(climb_m), .unit = "m", .min = 0.1, .max = 1e4,
     .fallback = "5", .doc = "how far to climb; again while something is seen"},
    {"turn_deg", ASDIC_KEY_NUMBER, RULE(turn_deg), .unit = "deg", .min = 1, .max = 180,
     .fallback = "60",
     .doc = "how far to turn, away from the beam that saw it, to starboard where that is ahead"},
    {"hold_s", ASDIC_KEY_NUMBER, RULE(hold_s), .unit = "s", .min = 0, .max = 1e5, .fallback = "10",
     .doc = "how long to stay so after the last detection"},
};
static const asdic_table rule_table = {TABLE(rule_keys, file_rule),
                                       .doc = "when the vehicle gives way, and how"};

static const asdic_key ideal_keys[] = {
    {"pd", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_ideal, pd), .min = 0, .max = 1,
     .doc = "probability of a detection in a ping while something is in the way within reach"},
    {"pfa", ASDIC_KEY_NUMBER, AT(file_ideal, pfa), .min = 0, .max = 1, .fallback = "0",
     .doc = "probability of one in a ping while nothing is"},
};
static const asdic_table ideal_table = {TABLE(ideal_keys, file_ideal),
                                        .doc = "a sonar of these probabilities in place of the "
                                               "simulated one"};

static const asdic_word background_words[] = {{"auto", ASDIC_TRIAL_AUTO},
                                              {"flat", ASDIC_TRIAL_FLAT},
                                              {"ca", ASDIC_TRIAL_CA},
                                              {"os", ASDIC_TRIAL_OS},
                                              {NULL, 0}};
#define TRIAL(member) AT(file_trial, member)
static const asdic_key trial_keys[] = {
    {"draws", ASDIC_KEY_LIST, AT(file_trial, draws), .count = 4096, .table = &draw_table,
     .doc = "what is drawn at random in every run, in place of what the scene says"},
    {"hull_radius_m", ASDIC_KEY_NUMBER, TRIAL(hull_radius_m), .unit = "m", .min = 0, .max = 100,
     .fallback = "0.1", .doc = "nearer than this to anything but the surface is a collision"},
    {"time_s", ASDIC_KEY_NUMBER, TRIAL(time_s), .unit = "s", .min = 0.1, .max = 1e6,
     .doc = "when a run ends; else after three times as long as its waypoints take"},
    {"background", ASDIC_KEY_WORD, TRIAL(background), .words = background_words, .fallback = "auto",
     .doc = "what a bin is compared with: the level expected over a flat bottom (flat), or its "
            "neighbours (ca, os); auto: flat, over a bottom from a file os"},
    {"rule", ASDIC_KEY_MAP, TRIAL(rule), .table = &rule_table,
     .doc = "when the vehicle gives way, and how"},
    {"ideal", ASDIC_KEY_MAP, ASDIC_KEY_OPTIONAL, TRIAL(ideal), .table = &ideal_table,
     .doc = "a sonar of given probabilities in place of the simulated one: what manoeuvring alone "
            "costs"},
};
const asdic_table asdic_trial_table = {TABLE(trial_keys, file_trial),
                                       .doc = "what differs from run to run of a trial"};
