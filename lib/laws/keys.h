/*
 * Keys of a law's model: those of the scene file, and those of the situation, which the scene says
 * elsewhere.
 */
#ifndef ASDIC_LAWS_KEYS_H
#define ASDIC_LAWS_KEYS_H

#include "scatterer.h"

#include <math.h>

/* A number that the scene's environment, sonar or geometry gives: domain, and what is vouched for. */
#define LAW_SITUATION(key, lo, hi, valid_lo, valid_hi)                                             \
    {                                                                                              \
        .name = key, .numeric = true, .required = true, .min = lo, .max = hi,                      \
        .valid_min = valid_lo, .valid_max = valid_hi                                               \
    }
/* As high as imaging sonars go; from 3162 kHz on the SEARAY bottom would put mud above rock. */
#define ASDIC_MOST_KHZ 3000.0
#define LAW_F_KHZ(valid_lo, valid_hi)                                                              \
    LAW_SITUATION("f_khz", 0.1, ASDIC_MOST_KHZ, valid_lo, valid_hi)
#define LAW_C_MPS LAW_SITUATION("c_mps", 1300.0, 1700.0, 1300.0, 1700.0)
#define LAW_GRAZING LAW_SITUATION("grazing_deg", 0.0, 90.0, 0.0, 90.0)

#endif
