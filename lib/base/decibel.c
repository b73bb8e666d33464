#include "decibel.h"

#include "bits.h"
#include "widest.h"

#include <float.h>
#include <math.h>

#define MANTISSA_BITS 52
#define MANTISSA (((uint64_t)1 << MANTISSA_BITS) - 1)
#define ONE 0x3ff0000000000000u       /* 1.0 */
#define SQRT_HALF 0x3fe6a09e667f3bcdu /* sqrt(1/2) */
#define TWO52 0x4330000000000000u     /* 2^52: its last bits count in ones */

/* x = 2^e m with m in [sqrt(1/2), sqrt(2)); ln m = 2 artanh(s), s = (m - 1) / (m + 1), |s| < 0.172,
 * by its series up to s^17, which leaves less than 1e-15 of it out. */
static inline double level_of(double x) {
    const double db_per_octave = 3.010299956639812, twice_db_per_neper = 8.685889638065035;
    uint64_t shifted = asdic_bits_of(x) + (ONE - SQRT_HALF);
    double e = asdic_double_of(TWO52 | shifted >> MANTISSA_BITS) - (0x1p52 + 1023.0);
    double m = asdic_double_of((shifted & MANTISSA) + SQRT_HALF);
    double s = (m - 1.0) / (m + 1.0), z = s * s;
    double tail =
        z * (1.0 / 3 +
             z * (1.0 / 5 +
                  z * (1.0 / 7 +
                       z * (1.0 / 9 +
                            z * (1.0 / 11 + z * (1.0 / 13 + z * (1.0 / 15 + z * (1.0 / 17))))))));
    return e * db_per_octave + (s + s * tail) * twice_db_per_neper;
}

/* Two loops: compilers vectorise the first, which has no comparison. */
WIDEST static void convert(const double *intensity_lin, size_t count, float *level_db) {
    for (size_t i = 0; i < count; i++) {
        level_db[i] = (float)level_of(intensity_lin[i]);
    }
    for (size_t i = 0; i < count; i++) {
        double x = intensity_lin[i];
        if (!(x >= DBL_MIN && x <= DBL_MAX)) {
            level_db[i] = x > DBL_MAX ? INFINITY : NAN;
        }
    }
}

/* The resolver of clones is static: as a symbol of its own it would be exported. */
void asdic_decibels(const double *intensity_lin, size_t count, float *level_db) {
    convert(intensity_lin, count, level_db);
}
