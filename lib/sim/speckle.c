#include "speckle.h"

#include "variates.h"

#include "../../kernels/random.h"

#include <math.h>

double asdic_speckle_draw(const asdic_background *law, double fixed_lin, uint64_t seed,
                          uint64_t index, uint32_t cell) {
    asdic_variates v = asdic_variates_begin(RANDOM_SPECKLE, seed, index, cell);
    double speckle = asdic_variates_gamma(&v, (double)law->looks) / (double)law->looks;
    double texture = isfinite(law->shape) ? asdic_variates_gamma(&v, law->shape) / law->shape : 1.0;
    return (law->mean_lin * texture + fixed_lin) * speckle;
}

void asdic_speckle_apply(const asdic_sonar *sonar, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping) {
    double *const *part = ping->intensity_lin;
    if (sonar->speckle == ASDIC_SPECKLE_NONE) {
        return;
    }
    asdic_background law = {.looks = asdic_sonar_looks(sonar, sound_speed_mps),
                            .shape = sonar->speckle == ASDIC_SPECKLE_K ? sonar->speckle_shape
                                                                       : (double)INFINITY};
    /* Bins shorter than a resolution cell are parts of one and share what it draws. */
    double cells = fmin(sonar->bin_length_m * 2.0 * sonar->bandwidth_hz / sound_speed_mps, 1.0);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        size_t bin = i % ping->bins, cell = i - bin + (size_t)(((double)bin + 0.5) * cells);
        law.mean_lin = part[ASDIC_BOTTOM][i] + part[ASDIC_SURFACE][i] + part[ASDIC_VOLUME][i];
        double fixed_lin = part[ASDIC_OBJECT][i] + part[ASDIC_MULTIPATH][i] + part[ASDIC_NOISE][i];
        part[ASDIC_TOTAL][i] = asdic_speckle_draw(&law, fixed_lin, seed, index, (uint32_t)cell);
    }
}
