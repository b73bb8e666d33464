#include "layers.h"

#include "../../kernels/water.h"

#include <math.h>

/* Gradients this near are one: over 11 km the speeds differ by 1e-5 m/s. */
#define SAME_PER_S 1e-9

double asdic_layer_speed_mps(const asdic_layer *layer, double depth_m) {
    return layer->speed_mps + layer->gradient_per_s * (depth_m - layer->origin_m);
}

size_t asdic_layers_find(const asdic_layers *layers, double depth_m) {
    size_t at = 0;
    while (at + 1 < layers->count && depth_m > layers->layer[at].bottom_m) {
        at++;
    }
    return at;
}

double asdic_layers_speed_mps(const asdic_layers *layers, double depth_m) {
    return asdic_layer_speed_mps(&layers->layer[asdic_layers_find(layers, depth_m)], depth_m);
}

/* Appends a layer below the others, down to BOTTOM_M. */
static void add(asdic_layers *out, double bottom_m, double origin_m, double speed_mps,
                double gradient_per_s) {
    asdic_layer *last = out->count ? &out->layer[out->count - 1] : NULL;
    if (last && fabs(last->gradient_per_s - gradient_per_s) <= SAME_PER_S) {
        last->bottom_m = bottom_m;
        return;
    }
    double top_m = last ? last->bottom_m : -INFINITY;
    out->layer[out->count] =
        (asdic_layer){top_m, bottom_m, origin_m, speed_mps, gradient_per_s, .number = out->count};
    out->count++;
}

static void add_profile(const asdic_sound_profile *p, asdic_layers *out) {
    add(out, p->depth_m[0], p->depth_m[0], p->sound_speed_mps[0], 0.0);
    for (size_t i = 0; i + 1 < p->points; i++) {
        double gradient = (p->sound_speed_mps[i + 1] - p->sound_speed_mps[i]) /
                          (p->depth_m[i + 1] - p->depth_m[i]);
        add(out, p->depth_m[i + 1], p->depth_m[i], p->sound_speed_mps[i], gradient);
    }
    size_t last = p->points - 1;
    add(out, INFINITY, p->depth_m[last], p->sound_speed_mps[last], 0.0);
}

/* Speed at depth 0 where there is no profile. */
static double surface_speed_mps(const asdic_environment *env) {
    return isnan(env->sound_speed_mps)
               ? sound_speed_medwin_mps(env->temperature_degc, env->salinity_ppt, 0.0)
               : env->sound_speed_mps;
}

/* What ENV says of the water, whatever rays follow of it. */
static void all_layers(const asdic_environment *env, asdic_layers *out) {
    out->count = 0;
    if (env->sound_speed_profile.points) {
        add_profile(&env->sound_speed_profile, out);
    } else {
        add(out, INFINITY, 0.0, surface_speed_mps(env), env->sound_speed_gradient_per_s);
    }
}

/* Integral of c, and of c z, from A to B within one layer, over depths from ORIGIN on. */
static void add_moments(const asdic_layer *layer, double a, double b, double origin, double m[2]) {
    double ca = asdic_layer_speed_mps(layer, a) - layer->speed_mps;
    double cb = asdic_layer_speed_mps(layer, b) - layer->speed_mps;
    double za = a - origin, zb = b - origin, length = b - a, c = layer->speed_mps;
    m[0] += length * (c + 0.5 * (ca + cb));
    m[1] += length * (c * 0.5 * (za + zb) + (ca * (2.0 * za + zb) + cb * (za + 2.0 * zb)) / 6.0);
}

/* The line through c of least squares from FROM to TO, into OUT; at one depth the tangent. */
static void fit_layer(const asdic_layers *all, double from, double to, asdic_layers *out) {
    double length = to - from, middle = from + 0.5 * length, m[2] = {0.0, 0.0};
    size_t at = asdic_layers_find(all, middle);
    double speed = asdic_layer_speed_mps(&all->layer[at], middle);
    double gradient = all->layer[at].gradient_per_s;
    if (length > 1e-3) {
        for (size_t i = 0; i < all->count; i++) {
            double a = fmax(all->layer[i].top_m, from), b = fmin(all->layer[i].bottom_m, to);
            if (b > a) {
                add_moments(&all->layer[i], a, b, middle, m);
            }
        }
        speed = m[0] / length;
        gradient = 12.0 * m[1] / (length * length * length);
    }
    out->count = 0;
    add(out, INFINITY, middle, speed, gradient);
}

void asdic_layers_of(const asdic_environment *env, double depth_m, asdic_layers *out) {
    asdic_layers all;
    all_layers(env, &all);
    if (env->refraction == ASDIC_REFRACTION_FULL) {
        *out = all;
    } else if (env->refraction == ASDIC_REFRACTION_LAYER) {
        fit_layer(&all, env->layer_from_m, env->layer_to_m, out);
    }
    if (env->refraction == ASDIC_REFRACTION_OFF ||
        (out->count == 1 && out->layer[0].gradient_per_s == 0.0)) {
        double speed = asdic_environment_sound_speed_mps(env, depth_m);
        out->count = 0;
        add(out, INFINITY, depth_m, speed, 0.0);
    }
}

bool asdic_environment_bends(const asdic_environment *env) {
    asdic_layers layers;
    if (!env || env->refraction == ASDIC_REFRACTION_OFF ||
        (env->sound_speed_gradient_per_s == 0.0 && env->sound_speed_profile.points == 0)) {
        return false;
    }
    asdic_layers_of(env, 0.0, &layers);
    return layers.count > 1 || layers.layer[0].gradient_per_s != 0.0;
}

double asdic_environment_sound_speed_mps(const asdic_environment *env, double depth_m) {
    asdic_layers layers;
    if (!env) {
        return NAN;
    }
    if (env->sound_speed_gradient_per_s == 0.0 && env->sound_speed_profile.points == 0) {
        return isnan(env->sound_speed_mps)
                   ? sound_speed_medwin_mps(env->temperature_degc, env->salinity_ppt, depth_m)
                   : env->sound_speed_mps;
    }
    all_layers(env, &layers);
    if (env->refraction == ASDIC_REFRACTION_LAYER) {
        asdic_layers all = layers;
        fit_layer(&all, env->layer_from_m, env->layer_to_m, &layers);
    }
    return asdic_layers_speed_mps(&layers, depth_m);
}

void asdic_layers_between(const asdic_environment *env, const asdic_flat_scene *flat,
                          asdic_layers *out) {
    asdic_layers all;
    double top_m = flat->has_surface ? 0.0 : -INFINITY;
    double bottom_m = flat->has_bottom ? flat->depth_m + flat->altitude_m : INFINITY;
    asdic_layers_of(env, flat->depth_m, &all);
    out->count = 0;
    for (size_t i = 0; i < all.count; i++) {
        asdic_layer layer = all.layer[i];
        layer.top_m = fmax(layer.top_m, top_m);
        layer.bottom_m = fmin(layer.bottom_m, bottom_m);
        if (layer.bottom_m > layer.top_m) {
            out->layer[out->count++] = layer;
        }
    }
    if (out->count == 0) { /* no water at all: the boundaries touch */
        out->layer[out->count++] = all.layer[asdic_layers_find(&all, top_m)];
        out->layer[0].top_m = top_m;
        out->layer[0].bottom_m = bottom_m;
    }
}

void asdic_layers_end(asdic_layers *layers, double bottom_m) {
    while (layers->count > 1 && layers->layer[layers->count - 1].top_m >= bottom_m) {
        layers->count--;
    }
    layers->layer[layers->count - 1].bottom_m = INFINITY;
}

void asdic_layers_mirror(const asdic_layers *water, double plane_m, bool below, asdic_layers *out) {
    size_t n = water->count;
    out->count = 0;
    for (size_t i = 0; i < 2 * n; i++) {
        bool image = (i < n) == below;
        asdic_layer layer = water->layer[image ? n - 1 - i % n : i % n];
        *(below ? &layer.top_m : &layer.bottom_m) =
            below ? fmax(layer.top_m, plane_m) : fmin(layer.bottom_m, plane_m);
        if (!(layer.bottom_m > layer.top_m)) {
            continue;
        }
        if (image) {
            double top_m = layer.top_m;
            layer.top_m = 2.0 * plane_m - layer.bottom_m;
            layer.bottom_m = 2.0 * plane_m - top_m;
            layer.origin_m = 2.0 * plane_m - layer.origin_m;
            layer.gradient_per_s = -layer.gradient_per_s;
            layer.image = true;
        }
        out->layer[out->count++] = layer;
    }
}
