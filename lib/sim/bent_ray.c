#include "bent_ray.h"

#include "../../kernels/lift.h"

#include <math.h>

/* On the axis of a channel rays near the horizontal cross it without end: this one stands for them. It
 * strays by less than a millimetre where the gradients are more than 0.01 1/s. */
#define AXIS_RAD 1e-4

/* sinh(x) / x, atanh(x) / x. */
static double sinh_ratio(double x) {
    double x2 = x * x;
    return x2 < 1e-4 ? 1.0 + x2 * (1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 / 5040.0)) : sinh(x) / x;
}

static double atanh_ratio(double x) {
    double x2 = x * x;
    return x2 < 1e-4 ? 1.0 + x2 * (1.0 / 3.0 + x2 * (0.2 + x2 * (1.0 / 7.0 + x2 / 9.0)))
                     : atanh(x) / x;
}

/* Whether rays near the horizontal return to the plane below LAYER, within a millimetre of DEPTH_M,
 * from either side. */
static bool is_axis(const asdic_layers *layers, size_t layer, double depth_m) {
    const asdic_layer *above = &layers->layer[layer], *below = above + 1;
    return layer + 1 < layers->count && fabs(above->bottom_m - depth_m) < 1e-3 &&
           above->gradient_per_s < 0.0 && below->gradient_per_s > 0.0;
}

asdic_bent_ray asdic_bent_ray_start(const asdic_layers *layers, double depth_m,
                                    double elevation_rad) {
    asdic_bent_ray ray = {.layer = asdic_layers_find(layers, depth_m), .z_m = depth_m};
    const asdic_layer *layer = &layers->layer[ray.layer];
    if (is_axis(layers, ray.layer, depth_m) ||
        (ray.layer > 0 && is_axis(layers, ray.layer - 1, depth_m))) {
        elevation_rad = copysign(fmax(fabs(elevation_rad), AXIS_RAD), elevation_rad);
    }
    if (depth_m == layer->bottom_m && elevation_rad >= 0.0 && ray.layer + 1 < layers->count) {
        layer = &layers->layer[++ray.layer];
    }
    ray.speed_mps = asdic_layer_speed_mps(layer, depth_m);
    ray.sine = sin(elevation_rad);
    ray.level_spm = cos(elevation_rad) / ray.speed_mps;
    ray.slope = 1.0 / ray.speed_mps;
    return ray;
}

/* Discriminant of the way to a plane DEPTH_M deep: the square of n1 times the sine there over n. *G is
 * the change of speed over the speed there. */
static double reach(const asdic_layer *layer, const asdic_bent_ray *ray, double depth_m,
                    double *g) {
    double speed = asdic_layer_speed_mps(layer, depth_m);
    *g = layer->gradient_per_s * (depth_m - ray->z_m) / speed;
    return speed > 0.0 ? ray->sine * ray->sine - *g * (2.0 - *g) : -1.0;
}

double asdic_bent_ray_exit(const asdic_layers *layers, const asdic_bent_ray *ray, int *way) {
    const asdic_layer *layer = &layers->layer[ray->layer];
    double gradient = layer->gradient_per_s, s = ray->sine, g;
    *way = s > 0.0 || (s == 0.0 && gradient <= 0.0) ? 1 : -1;
    double plane = *way > 0 ? layer->bottom_m : layer->top_m;
    if (s == 0.0 && (gradient == 0.0 || plane == ray->z_m)) { /* along the plane for good */
        return INFINITY;
    }
    if (isfinite(plane)) {
        double square = reach(layer, ray, plane, &g);
        if (square >= 0.0) { /* straight on */
            double w = (plane - ray->z_m) / asdic_layer_speed_mps(layer, plane) /
                       (s + *way * sqrt(square));
            return 2.0 * w * atanh_ratio(gradient * w);
        }
    }
    if (gradient * *way <= 0.0) {
        return INFINITY;
    }
    *way = -*way; /* it turns, and comes to the plane behind it */
    plane = *way > 0 ? layer->bottom_m : layer->top_m;
    if (!isfinite(plane)) {
        return INFINITY;
    }
    double square = reach(layer, ray, plane, &g);
    if (square < 0.0) { /* where c would be 0 */
        return INFINITY;
    }
    return 2.0 * atanh((s - *way * sqrt(square)) / (2.0 - g)) / gradient;
}

asdic_bent_ray asdic_bent_ray_later(const asdic_layers *layers, const asdic_bent_ray *ray,
                                    double time_s) {
    double gradient = layers->layer[ray->layer].gradient_per_s, c = ray->speed_mps, s = ray->sine;
    double half = 0.5 * gradient * time_s, ratio = sinh_ratio(half), h = half * ratio;
    double sinh_x = 2.0 * h * sqrt(1.0 + h * h), cosh_x = 1.0 + 2.0 * h * h;
    double sinh_per_g = time_s * ratio * sqrt(1.0 + h * h);
    asdic_bent_ray later = *ray;
    later.speed_mps = c / (cosh_x - s * sinh_x);
    later.sine = (s * cosh_x - sinh_x) * later.speed_mps / c;
    later.z_m += later.speed_mps * (s * sinh_per_g - time_s * ratio * h);
    double area = c * later.speed_mps * sinh_per_g;
    double chord = sqrt(c * later.speed_mps) * time_s * ratio;
    later.time_s += time_s;
    later.area_m2_per_s += area;
    later.width_m += ray->slope * area;
    later.length_m += chord * lift_asin_ratio(0.5 * gradient * ray->level_spm * chord);
    return later;
}

asdic_bent_ray asdic_bent_ray_at_plane(const asdic_layers *layers, const asdic_bent_ray *ray,
                                       double time_s, int way) {
    const asdic_layer *layer = &layers->layer[ray->layer];
    asdic_bent_ray on = asdic_bent_ray_later(layers, ray, time_s);
    double g;
    on.z_m = way > 0 ? layer->bottom_m : layer->top_m;
    double square = reach(layer, ray, on.z_m, &g);
    on.speed_mps = asdic_layer_speed_mps(layer, on.z_m);
    on.sine = way * sqrt(fmax(square, 0.0)) / (1.0 - g);
    return on;
}

bool asdic_bent_ray_cross(const asdic_layers *layers, asdic_bent_ray *ray, int way) {
    size_t next = way > 0 ? ray->layer + 1 : ray->layer - 1;
    if (next >= layers->count) { /* of layer 0 upwards too */
        return false;
    }
    double step =
        way * (layers->layer[next].gradient_per_s - layers->layer[ray->layer].gradient_per_s);
    ray->slope -=
        ray->width_m * step * ray->level_spm * ray->level_spm / fmax(fabs(ray->sine), 1e-12);
    ray->layer = next;
    return true;
}
