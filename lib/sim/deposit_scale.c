#include "deposit_scale.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/target.h"

#include <math.h>

/* Strengths are searched down to this sine of the grazing angle; what lies below is cut only if
 * it exceeds the loudest value above. */
#define MIN_SIN 1e-3
#define STEPS 256

static double strength(const dev_material *m, const dev_ping *ping, double sin_grazing) {
    if (m->law == DEV_LAW_BOTTOM) {
        return bottom_backscatter_lin(m->bottom_gain, m->bottom_peak, m->bottom_type, sin_grazing);
    }
    /* The narrowest lobe: of a flat patch without end. */
    double slope = facet_slope_ms(m->slope_ms, 1e12, ping->wavelength_m, 2.0 * ping->range_m);
    return facet_strength_lin(sin_grazing, m->reflection2, m->roughness_g, slope);
}

/* Largest s / sin(Theta) of a material (of the surface when M is NULL). */
static double loudest(const dev_material *m, const dev_ping *ping) {
    double most = 1e-12;
    for (int i = 0; i <= STEPS; i++) {
        double sin_grazing = pow(MIN_SIN, 1.0 - (double)i / STEPS);
        double s =
            m ? strength(m, ping, sin_grazing)
              : surface_backscatter_lin(ping->surface_gain, ping->surface_beta0,
                                        ping->surface_beta1, ping->surface_cap_lin, sin_grazing);
        most = fmax(most, s / sin_grazing);
    }
    return most;
}

void asdic_deposit_scales(const asdic_scene *scene, const dev_material *materials, dev_ping *ping) {
    double bottom = 1e-12, object = 1e-12, surface = loudest(NULL, ping);
    if (scene->has_bottom_plane) {
        bottom = loudest(&materials[scene->bottom_plane_material], ping);
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        double *most = scene->parts[i].kind == DEV_KIND_BOTTOM ? &bottom : &object;
        *most = fmax(*most, loudest(&materials[scene->parts[i].material], ping));
    }
    /* All directions at full gain, on the loudest thing there is. One factor of 4 covers the relative
     * loss inside a bin, (d_n / d)^2 <= 4; one of 2 the wavelength at another depth, on which a
     * facet's peak depends by its square. */
    double bound[DEV_DEPOSIT_COUNT];
    bound[DEV_DEPOSIT_BOTTOM] = bottom;
    bound[DEV_DEPOSIT_OBJECT] = object;
    bound[DEV_DEPOSIT_MULTIPATH] = fmax(fmax(bottom, object), surface);
    bound[DEV_DEPOSIT_SURFACE] = surface;
    bound[DEV_DEPOSIT_VOLUME] = 1.0;
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        double sum = 2.0 * 4.0 * 4.0 * 3.14159265358979323846 * bound[c];
        ping->deposit_scale[c] = (float)exp2(floor(61.0 - log2(sum)));
    }
    /* A sum overflows at 64 such deposits. Each needs a ray that stands for pi / 4 steradians or more
     * and meets the loudest thing there is; all rays together stand for 4 pi. */
    ping->deposit_limit = (float)exp2(57.0);
}
