#include "deposit_scale.h"

#include "base/vec.h"

#include <math.h>

/* Strengths are searched down to this sine of the grazing angle; what lies below is cut only if
 * it exceeds the loudest value above. */
#define MIN_SIN 1e-3
#define STEPS 256
/* The rays' solid angles may add up to too much: by this, divided by the number of rays. */
#define FEW_RAYS_SR 200.0
/* Layers of the water focus what a bin gets by so much, at most; single rays by more. */
#define FOCUS 16.0

/* Largest s / sin(Theta) of a material. */
static double loudest(const asdic_scatterer *s, const dev_ping *ping) {
    double most = 1e-12;
    for (int i = 0; i <= STEPS; i++) {
        double sin_grazing = pow(MIN_SIN, 1.0 - (double)i / STEPS);
        /* The narrowest lobe: of a flat patch without end. */
        asdic_incidence at = {.sine = sin_grazing,
                              .cos2 = (1.0 - sin_grazing) * (1.0 + sin_grazing),
                              .coherent_m2 = 1e12,
                              .range_m = 2.0 * ping->range_m};
        most = fmax(most, s->material.law->strength_lin(s, &at) / sin_grazing);
    }
    bool tabled = s->material.law->formula == DEV_LAW_TABLE;
    most = tabled ? fmax(most, asdic_scatterer_steepest(s, MIN_SIN)) : most;
    return s->silent ? 1e-12 : most;
}

/* Not less than the solid angle that an aperture's pattern covers: of [sinc(L vy) sinc(M vz)]^2
 * dvy dvz / vx the part within 60 degrees of the axis is at most 2 / (L M); beyond, one direction
 * cosine exceeds 0.61, where the pattern is below 1 / (0.61 pi L)^2, over pi sr. */
static double pattern_sr(const asdic_beam *beam, const dev_ping *ping) {
    double l = beam->length_h_m / ping->wavelength_m, m = beam->length_v_m / ping->wavelength_m;
    double lobes = fmin(1.0, 0.28 / pow(fmin(l, m), 2.0));
    double front = fmin(2.0 / (l * m) + ASDIC_PI * lobes, 2.0 * ASDIC_PI);
    return front + 2.0 * ASDIC_PI * ping->rear_lin;
}

/* The most that a deposit's loss may be above that of its bin's middle (ray_relative_loss): in the first bin at its
 * beginning or where receiving begins, elsewhere at ranges of half the middle's or more. */
static double relative_loss_most(const dev_ping *ping) {
    double middle_m = 0.5 * ping->bin_m, np = 2.0 * ping->absorption_np_per_m;
    double nearest_m = fmin(ping->blanking_m, middle_m), ratio = middle_m / nearest_m;
    return fmax(ratio * ratio * exp(np * (middle_m - nearest_m)), 4.0 * exp(np * middle_m));
}

void asdic_deposit_scales(const asdic_scene *scene, const asdic_beam *transmitter,
                          const asdic_scatterer *scatterers, bool layers, dev_ping *ping) {
    double bottom = 1e-12, object = 1e-12;
    double surface = loudest(&scatterers[scene->material_count], ping);
    if (scene->has_bottom_plane) {
        bottom = loudest(&scatterers[scene->bottom_plane_material], ping);
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        double *most = scene->parts[i].kind == DEV_KIND_BOTTOM ? &bottom : &object;
        *most = fmax(*most, loudest(&scatterers[scene->parts[i].material], ping));
    }
    double bound[DEV_DEPOSIT_COUNT];
    bound[DEV_DEPOSIT_BOTTOM] = bottom;
    bound[DEV_DEPOSIT_OBJECT] = object;
    bound[DEV_DEPOSIT_MULTIPATH] = fmax(fmax(bottom, object), surface);
    bound[DEV_DEPOSIT_SURFACE] = surface;
    bound[DEV_DEPOSIT_VOLUME] = layers ? FOCUS : 1.0;
    /* All that the transmitter sends out meets the loudest thing there is. Multipath also comes from where
     * the transmitter does not look: there, all directions count at full gain. With few rays one of them may
     * stand for much, and gets room. A factor of 2 covers the wavelength at another depth, whose square a facet's
     * peak depends on. */
    double sphere = 4.0 * ASDIC_PI, loss = relative_loss_most(ping);
    double sent = fmin(pattern_sr(transmitter, ping) + FEW_RAYS_SR / ping->batch.rays, sphere);
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        double sum = 2.0 * loss * (c == DEV_DEPOSIT_MULTIPATH ? sphere : sent) * bound[c];
        ping->sums.scale[c] = (float)exp2(floor(61.0 - log2(sum)));
    }
    /* A sum overflows at 64 such deposits, that of depressions, which weigh up to 2, at 32. Each needs a ray that stands for half of what the
     * transmitter sends out or more and meets the loudest thing there is. */
    ping->sums.limit = (float)exp2(57.0);
}
