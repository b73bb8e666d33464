#include "bin_laws.h"

#include "../../kernels/backscatter.h"

#include <math.h>

/* Per bin: TL d^2 and the water's integral; what turns a part of that integral into a share of the
 * bin, and water quanta into the bin's TL d^2. */
bool asdic_bin_laws_tabulate(asdic_simulator *sim, const asdic_water_column *water) {
    asdic_bin_laws *laws = &sim->laws[sim->nth];
    if (laws->absorption_np_per_m == water->absorption_np_per_m) {
        return false;
    }
    double strength = pow(10.0, 0.1 * volume_backscatter_db(sim->env.particle_strength_db,
                                                            sim->sonar.frequency_hz / 1e3));
    float *inverse = sim->water + 2 * sim->bins * sim->nth, *ratio = inverse + sim->bins;
    for (size_t n = 0; n < sim->bins; n++) {
        double loss = asdic_water_column_loss(water, sim->sonar.bin_length_m, n);
        double center = ((double)n + 0.5) * sim->sonar.bin_length_m;
        double volume =
            asdic_water_column_volume(water, sim->sonar.bin_length_m, sim->sonar.blanking_m, n);
        /* The device works relative to the bin's centre: integral of d^-2 exp(-2 k (d - d_n)). */
        double local = volume / (loss * center * center);
        inverse[n] = local > 0.0 && isfinite(local) ? (float)(1.0 / local) : 0.0f;
        ratio[n] = isfinite(volume) ? (float)(strength * volume / loss) : 0.0f;
        laws->loss[n] = loss;
        laws->volume[n] = strength * volume;
    }
    laws->absorption_np_per_m = water->absorption_np_per_m;
    return true;
}
