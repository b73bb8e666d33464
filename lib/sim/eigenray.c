#include "eigenray.h"

#include "base/sort.h"
#include "base/vec.h"

#include <math.h>

/* Elevations that are tried on a stretch between grazing rays; and where more than FEW rays come so, as they do near a
 * channel's axis, where they lie dense. */
#define SEARCH 32
#define FINE_SEARCH 128
#define FEW 6
/* What a ray may miss its end by, m. */
#define MISS 1e-3
/* What is nearer than this horizontally, m, lies straight above or below. */
#define VERTICAL 1e-6
/* Steps of Newton's method, before halving. */
#define MOST_STEPS 12
#define MOST_EDGES (2 * (ASDIC_MOST_LAYERS + 1) + 3)

typedef struct search {
    const asdic_layers *layers;
    double from_m, to_m, across_m;
    int steps; /* of a stretch */
    asdic_eigenray *found;
    size_t count;
} search;

/* ---- One ray ---- */

/* Time after which RAY, which is not to leave its layer before, is at ACROSS_M; from A = c^2 sinh x / (g (cosh x -
 * sin(theta) sinh x)), bent_ray.h, with x = g t. */
static double time_across(const asdic_layers *layers, const asdic_bent_ray *ray, double across_m) {
    double gradient = layers->layer[ray->layer].gradient_per_s, c = ray->speed_mps;
    double area = across_m / ray->level_spm - ray->area_m2_per_s;
    double tanh_per_g = area / (c * c + gradient * area * ray->sine), x = gradient * tanh_per_g;
    if (!(fabs(x) < 1.0) || tanh_per_g < 0.0) {
        return INFINITY;
    }
    return fabs(x) < 1e-8 ? tanh_per_g : atanh(x) / gradient;
}

/* The same where it goes straight up or down to Z_M. */
static double time_down(const asdic_layers *layers, const asdic_bent_ray *ray, double z_m) {
    const asdic_layer *layer = &layers->layer[ray->layer];
    double apart = (z_m - ray->z_m) * (ray->sine > 0.0 ? 1.0 : -1.0);
    double x = layer->gradient_per_s * (z_m - ray->z_m) / ray->speed_mps;
    if (apart < 0.0 || x <= -1.0) {
        return INFINITY;
    }
    return fabs(x) < 1e-12 ? apart / ray->speed_mps : apart / ray->speed_mps * log1p(x) / x;
}

/* What is told of a ray's legs; false: it goes no farther. */
typedef bool (*leg_told)(void *to, const asdic_bent_ray *from, const asdic_bent_ray *end);

/* The ray of ELEVATION_RAD where it is ACROSS_M away, or, where that is nothing, TO_M deep. */
static asdic_bent_ray march(const asdic_layers *layers, double from_m, double to_m, double across_m,
                            double elevation_rad, leg_told tell, void *to) {
    bool vertical = across_m < VERTICAL;
    asdic_bent_ray ray = asdic_bent_ray_start(layers, from_m, elevation_rad);
    for (int i = 0; i < ASDIC_MOST_EIGENRAY_LEGS; i++) {
        int way;
        double exit_s = asdic_bent_ray_exit(layers, &ray, &way);
        double end_s =
            vertical ? time_down(layers, &ray, to_m) : time_across(layers, &ray, across_m);
        asdic_bent_ray next = end_s <= exit_s ? asdic_bent_ray_later(layers, &ray, end_s)
                                              : asdic_bent_ray_at_plane(layers, &ray, exit_s, way);
        bool goes_on = !tell || tell(to, &ray, &next);
        ray = next;
        if (end_s <= exit_s) {
            return ray;
        }
        if (!goes_on || !asdic_bent_ray_cross(layers, &ray, way)) {
            break;
        }
    }
    ray.z_m = NAN; /* it never comes there */
    return ray;
}

static asdic_eigenray ray_of(const search *s, double elevation_rad) {
    return (asdic_eigenray){elevation_rad, march(s->layers, s->from_m, s->to_m, s->across_m,
                                                 elevation_rad, NULL, NULL)};
}

/* ---- All rays ---- */

static bool spreads_less(const void *a, const void *b) {
    return asdic_bent_ray_spread_m2(&((const asdic_eigenray *)a)->end) <
           asdic_bent_ray_spread_m2(&((const asdic_eigenray *)b)->end);
}

/* Halves the stretch from A to B, whose rays pass the end on either side. Where there are many, it follows the width of the
 * tube from ray to ray, which is how depth changes with elevation, as long as that stays within the stretch. */
static void close_in(search *s, asdic_eigenray a, asdic_eigenray b) {
    bool below = a.end.z_m > s->to_m;
    asdic_eigenray middle = a;
    double next = 0.5 * (a.elevation_rad + b.elevation_rad), step = INFINITY;
    for (int i = 0; i < 80 && fabs(step) > 1e-16; i++) {
        if (!(fabs(b.elevation_rad - a.elevation_rad) > 1e-16)) {
            break;
        }
        middle = ray_of(s, next);
        if (isnan(middle.end.z_m)) {
            return;
        }
        *((middle.end.z_m > s->to_m) == below ? &a : &b) = middle;
        next = 0.5 * (a.elevation_rad + b.elevation_rad);
        if (s->steps > SEARCH && i < MOST_STEPS) {
            double cosine = sqrt((1.0 - middle.end.sine) * (1.0 + middle.end.sine));
            double to = (s->to_m - middle.end.z_m) * cosine / middle.end.width_m;
            double there = middle.elevation_rad + to;
            bool within = (there - a.elevation_rad) * (there - b.elevation_rad) < 0.0;
            next = within ? there : next;
            step = within ? to : INFINITY;
        }
    }
    if (fabs(middle.end.z_m - s->to_m) < MISS) {
        asdic_sort_keep(s->found, &s->count, ASDIC_MOST_EIGENRAYS, &middle, sizeof middle,
                        spreads_less);
    }
}

static void look_between(search *s, const asdic_eigenray *a, const asdic_eigenray *b) {
    if ((a->end.z_m > s->to_m) != (b->end.z_m > s->to_m)) {
        close_in(s, *a, *b);
    }
}

/* The ray between A and B at which the width changes its sign. */
static asdic_eigenray find_fold(const search *s, asdic_eigenray a, asdic_eigenray b) {
    for (int i = 0; i < 50 && fabs(b.elevation_rad - a.elevation_rad) > 1e-14; i++) {
        asdic_eigenray middle = ray_of(s, 0.5 * (a.elevation_rad + b.elevation_rad));
        *((middle.end.width_m > 0.0) == (a.end.width_m > 0.0) ? &a : &b) = middle;
    }
    return a;
}

/* Follows BEFORE, the last ray of the stretch before: what meets the end on an edge itself, as the level ray between
 * two places at one depth of even water, lies between two stretches. */
static asdic_eigenray look_along(search *s, asdic_eigenray before, double begin_rad,
                                 double end_rad) {
    for (int i = 0; i <= s->steps; i++) {
        /* Denser to the ends, where depth goes as the root of the distance, and just off them. */
        double half = sin(0.5 * ASDIC_PI * i / s->steps), share = half * half;
        share = fmin(fmax(share, 1e-12), 1.0 - 1e-12);
        asdic_eigenray here = ray_of(s, begin_rad + share * (end_rad - begin_rad));
        if (!isnan(before.end.z_m) && !isnan(here.end.z_m)) {
            if (i > 0 && (before.end.width_m > 0.0) != (here.end.width_m > 0.0)) {
                asdic_eigenray fold = find_fold(s, before, here);
                look_between(s, &before, &fold);
                look_between(s, &fold, &here);
            } else {
                look_between(s, &before, &here);
            }
        }
        before = here;
    }
    return before;
}

/* The elevations of rays that graze a plane, level ones, and the ends. */
static size_t find_edges(const search *s, double *edges) {
    const asdic_layers *layers = s->layers;
    double at = asdic_layers_speed_mps(layers, s->from_m);
    size_t count = 0;
    edges[count++] = -0.5 * ASDIC_PI;
    edges[count++] = 0.0;
    edges[count++] = 0.5 * ASDIC_PI;
    for (size_t i = 0; i + 1 < layers->count; i++) {
        double speed = asdic_layer_speed_mps(&layers->layer[i], layers->layer[i].bottom_m);
        if (speed > at) {
            double grazing = atan2(sqrt((speed - at) * (speed + at)), at);
            edges[count++] = grazing;
            edges[count++] = -grazing;
        }
    }
    asdic_sort_doubles(edges, count);
    return count;
}

static void look_everywhere(search *s, int steps) {
    double edges[MOST_EDGES];
    size_t count = find_edges(s, edges);
    asdic_eigenray last = {.end.z_m = NAN};
    s->steps = steps;
    s->count = 0;
    for (size_t i = 0; i + 1 < count && (s->count <= FEW || steps > SEARCH); i++) {
        if (edges[i + 1] - edges[i] > 1e-9) {
            last = look_along(s, last, edges[i], edges[i + 1]);
        }
    }
}

size_t asdic_eigenrays_find(const asdic_layers *layers, double from_m, double to_m, double across_m,
                            asdic_eigenray found[ASDIC_MOST_EIGENRAYS]) {
    search s = {layers, from_m, to_m, across_m, SEARCH, found, 0};
    if (across_m < VERTICAL) {
        asdic_eigenray ray = ray_of(&s, copysign(0.5 * ASDIC_PI, to_m - from_m));
        found[0] = ray;
        return isnan(ray.end.z_m) || from_m == to_m ? 0 : 1;
    }
    look_everywhere(&s, SEARCH);
    if (s.count > FEW) {
        look_everywhere(&s, FINE_SEARCH);
    }
    return s.count;
}

asdic_bent_ray asdic_eigenray_end(const asdic_layers *layers, double from_m, double across_m,
                                  double elevation_rad) {
    return march(layers, from_m, NAN, across_m, elevation_rad, NULL, NULL);
}

/* ---- Legs ---- */

typedef struct leg_list {
    asdic_eigenray_leg *legs;
    size_t count;
} leg_list;

static bool add_leg(void *to, const asdic_bent_ray *from, const asdic_bent_ray *end) {
    leg_list *list = to;
    list->legs[list->count++] =
        (asdic_eigenray_leg){from->layer, end->level_spm * end->area_m2_per_s, end->z_m};
    return true;
}

size_t asdic_eigenray_legs(const asdic_layers *layers, double from_m, double across_m,
                           const asdic_eigenray *ray,
                           asdic_eigenray_leg legs[ASDIC_MOST_EIGENRAY_LEGS]) {
    leg_list list = {legs, 0};
    march(layers, from_m, ray->end.z_m, across_m, ray->elevation_rad, add_leg, &list);
    return list.count;
}

/* How far up and down a ray goes, and how often it turns. */
typedef struct strait {
    const asdic_layers *layers;
    double top_m, bottom_m; /* it ends where it goes beyond */
    double least_m, most_m;
    int turns;
} strait;

/* Where it turns, sin(theta) = 0, it is where the speed is 1 / p. */
static bool keep_leg(void *to, const asdic_bent_ray *from, const asdic_bent_ray *end) {
    strait *s = to;
    const asdic_layer *layer = &s->layers->layer[from->layer];
    double least = fmin(from->z_m, end->z_m), most = fmax(from->z_m, end->z_m);
    if (from->sine * end->sine < 0.0) {
        double turn =
            layer->origin_m + (1.0 / from->level_spm - layer->speed_mps) / layer->gradient_per_s;
        least = fmin(least, turn);
        most = fmax(most, turn);
        s->turns++;
    }
    s->least_m = fmin(s->least_m, least);
    s->most_m = fmax(s->most_m, most);
    return least >= s->top_m && most <= s->bottom_m;
}

bool asdic_eigenray_keeps_between(const asdic_layers *layers, double from_m, double across_m,
                                  const asdic_eigenray *ray, double top_m, double bottom_m) {
    strait s = {layers, top_m - MISS, bottom_m + MISS, INFINITY, -INFINITY, 0};
    march(layers, from_m, ray->end.z_m, across_m, ray->elevation_rad, keep_leg, &s);
    return s.least_m >= s.top_m && s.most_m <= s.bottom_m;
}

double asdic_eigenray_swing_m(const asdic_layers *layers, double from_m, double across_m,
                              const asdic_eigenray *ray) {
    strait s = {layers, -INFINITY, INFINITY, INFINITY, -INFINITY, 0};
    march(layers, from_m, ray->end.z_m, across_m, ray->elevation_rad, keep_leg, &s);
    return s.turns < 2 ? INFINITY : s.most_m - s.least_m;
}
