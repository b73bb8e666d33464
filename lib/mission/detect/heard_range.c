#include "heard_range.h"

#include "base/vec.h"
#include "scene/scene.h"
#include "sim/eigenray.h"

#include <math.h>

asdic_heard_water asdic_heard_water_of(const asdic_environment *env, const asdic_scene *scene,
                                       double from_m) {
    asdic_heard_water w = {.bends = asdic_environment_bends(env),
                           .from_m = from_m,
                           .sound_speed_mps = asdic_environment_sound_speed_mps(env, from_m),
                           .top_m = scene->has_surface ? 0.0 : -INFINITY,
                           .bottom_m =
                               scene->has_bottom_plane ? scene->bottom_plane_depth_m : INFINITY};
    asdic_layers_of(env, from_m, &w.layers);
    return w;
}

double asdic_heard_range_m(const asdic_heard_water *w, asdic_vec3 to_m) {
    double across_m = hypot(to_m.x, to_m.y);
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS]; /* that of the least spreading first */
    size_t count =
        w->bends ? asdic_eigenrays_find(&w->layers, w->from_m, w->from_m + to_m.z, across_m, rays)
                 : 0;
    for (size_t i = 0; i < count; i++) {
        if (asdic_eigenray_keeps_between(&w->layers, w->from_m, across_m, &rays[i], w->top_m,
                                         w->bottom_m)) {
            return w->sound_speed_mps * rays[i].end.time_s;
        }
    }
    return asdic_vec3_length(to_m);
}
