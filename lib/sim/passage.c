#include "passage.h"

#include <math.h>

bool asdic_passage_in_water(const asdic_scene *scene, double z_m) {
    return !(scene->has_surface && z_m < 0.0) &&
           !(scene->has_bottom_plane && z_m > scene->bottom_plane_depth_m);
}

size_t asdic_passages_find(const asdic_simulator *sim, double from_m,
                           asdic_passage ways[ASDIC_MOST_PASSAGES]) {
    const asdic_scene *scene = sim->setup.scene;
    double bottom_m = scene->bottom_plane_depth_m;
    asdic_passage *direct = &ways[0];
    size_t count = 1;
    *direct = (asdic_passage){
        .by = ASDIC_PATH_DIRECT,
        .top_m = scene->has_surface ? fmin(0.0, from_m) : -INFINITY,
        .bottom_m = scene->has_bottom_plane ? fmax(bottom_m, from_m) : INFINITY,
    };
    asdic_layers_of(&sim->setup.env, from_m, &direct->layers);
    for (int below = 0; below < 2 && asdic_passage_in_water(scene, from_m); below++) {
        asdic_passage *way = &ways[count];
        *way = (asdic_passage){.by = below ? ASDIC_PATH_BY_BOTTOM : ASDIC_PATH_BY_SURFACE,
                               .mirror = asdic_simulator_mirror(sim, below),
                               .plane_m = below ? bottom_m : 0.0,
                               .top_m = direct->top_m,
                               .bottom_m = direct->bottom_m};
        if (way->mirror) {
            *(below ? &way->bottom_m : &way->top_m) =
                asdic_passage_depth_m(way, below ? way->top_m : way->bottom_m);
            asdic_layers_mirror(&direct->layers, way->plane_m, !below, &way->layers);
            count++;
        }
    }
    return count;
}

double asdic_passage_depth_m(const asdic_passage *way, double z_m) {
    return way->mirror ? 2.0 * way->plane_m - z_m : z_m;
}

size_t asdic_passage_rays(const asdic_passage *way, double from_m, double to_m, double across_m,
                          asdic_eigenray rays[ASDIC_MOST_EIGENRAYS]) {
    size_t found = asdic_eigenrays_find(&way->layers, from_m, to_m, across_m, rays), kept = 0;
    for (size_t i = 0; i < found; i++) {
        if (asdic_eigenray_keeps_between(&way->layers, from_m, across_m, &rays[i], way->top_m,
                                         way->bottom_m)) {
            rays[kept++] = rays[i];
        }
    }
    return kept;
}

/* On a channel's axis the number of rays grows without limit as they swing less; of those that swing by less than a
 * wavelength to either side sound knows nothing: beside a parabolic equation (tests/cli/test_cast.py) the others give the
 * level of a point there within 2 dB. Where there are no others, the one of the least spreading stands for all. */
#define LEAST_SWING_WL 2.0

size_t asdic_passage_waves(const asdic_passage *way, double from_m, double across_m,
                           double wavelength_m, asdic_eigenray *rays, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (asdic_eigenray_swing_m(&way->layers, from_m, across_m, &rays[i]) >=
            LEAST_SWING_WL * wavelength_m) {
            rays[kept++] = rays[i];
        }
    }
    return kept == 0 && count > 0 ? 1 : kept;
}
