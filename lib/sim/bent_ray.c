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

/* ---- The plane that layers look like ---- */

/* The sines of rays that do not turn are so much more than of one that just does, at least. */
#define STEEPER 1e-7
/* Rays so near the level that it is no reason to lay out all of them for what others do not reach, if water bends even
 * these towards the end more than they go by themselves. */
#define LEVEL 5e-3
/* Halvings that leave a sine as single precision has it. */
#define HALVINGS 24

/* At what range the ray of SINE, which does not turn, comes to the end of LAYERS. */
static double range_of_end(const asdic_layers *layers, double depth_m, double sine) {
    asdic_bent_ray ray = asdic_bent_ray_start(layers, depth_m, asin(sine));
    double speed_mps = ray.speed_mps;
    int way = 0;
    for (size_t i = 0; i < layers->count; i++) {
        double exit_s = asdic_bent_ray_exit(layers, &ray, &way);
        if (isinf(exit_s)) {
            return INFINITY;
        }
        ray = asdic_bent_ray_at_plane(layers, &ray, exit_s, way);
        if (!asdic_bent_ray_cross(layers, &ray, way)) {
            break;
        }
    }
    return speed_mps * ray.time_s;
}

/* The fastest sound on the way to the end. */
static double fastest_mps(const asdic_layers *layers, double depth_m, double side) {
    double fastest = asdic_layers_speed_mps(layers, depth_m);
    for (size_t i = 0; i < layers->count; i++) {
        const asdic_layer *layer = &layers->layer[i];
        double plane_m = side > 0.0 ? layer->bottom_m : layer->top_m;
        if (side * (plane_m - depth_m) > 0.0) {
            fastest = fmax(fastest, asdic_layer_speed_mps(layer, plane_m));
        }
    }
    return fastest;
}

/* The plane that the ray of SINE meets at RANGE_M, with RATIO of the sound speed there at the sonar: ray_plane_sine as an
 * equation for x = tanh(bend range / 2). */
static asdic_bent_plane plane_met(double ratio, double sine, double range_m) {
    double slower = 1.0 - ratio, turn2 = slower * (1.0 + ratio);
    double bend = 2.0 * atanh(slower / (sine + sqrt(fmax(sine * sine - turn2, 0.0)))) / range_m;
    return (asdic_bent_plane){bend != 0.0 ? slower / ratio / bend : range_m * sine, bend};
}

asdic_bent_plane asdic_bent_plane_through(const asdic_layers *layers, double depth_m, bool below,
                                          double reach_m) {
    double side = below ? 1.0 : -1.0;
    /* By Snell's law rays turn that are no steeper than where sound is fastest. */
    double speed_mps = asdic_layers_speed_mps(layers, depth_m);
    double ratio = speed_mps / fastest_mps(layers, depth_m, side);
    double turning = sqrt((1.0 - ratio) * (1.0 + ratio));
    double sine = turning + STEEPER, range_m = range_of_end(layers, depth_m, side * sine);
    double end_m = below ? layers->layer[layers->count - 1].bottom_m : layers->layer[0].top_m;
    double height_m = fabs(end_m - depth_m), level_m = range_of_end(layers, depth_m, side * LEVEL);
    bool bends_more = turning < LEVEL && level_m * LEVEL < 0.5 * height_m && level_m <= reach_m;
    if (bends_more || (turning < STEEPER && range_m <= reach_m)) {
        return (asdic_bent_plane){height_m, -2.0 * height_m / (level_m * level_m)};
    }
    if (range_m > reach_m) {
        double steep = 1.0;
        for (int i = 0; i < HALVINGS; i++) {
            double middle = 0.5 * (sine + steep);
            bool is_near = range_of_end(layers, depth_m, side * middle) < reach_m;
            *(is_near ? &steep : &sine) = middle;
        }
        range_m = reach_m;
    }
    /* Where sound is slower evenly all the way, level rays bend towards it. */
    double end_ratio = speed_mps / asdic_layers_speed_mps(layers, end_m);
    asdic_bent_plane towards = plane_met(fmax(end_ratio, 1.0), sine, range_m);
    bool is_even = turning < STEEPER && fabs(towards.height_m - height_m) < 0.01 * height_m;
    return is_even ? towards : plane_met(ratio, sine, range_m);
}
