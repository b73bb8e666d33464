#include "passage.h"

#include "aim.h"
#include "base/sort.h"
#include "base/vec.h"
#include "cones.h"

#include <math.h>

/* Slices of a body from its top to its bottom. A fan that meets it is cut into pieces, which are halved, so often at most,
 * until they are straight to a part of a slice. A body nearer than this, m, is straight above or below. */
#define SLICES 64
#define FAN 8
#define HALVINGS 8
#define STRAIGHT 0.1
#define NEAREST 1e-3
#define MOST_EDGES (2 * ASDIC_MOST_EIGENRAYS)

typedef struct outlook {
    const asdic_passage *way;
    asdic_vec3 position_m, apart_m;
    double across_m, radius_m;
    const dev_beam *beams;
    const dev_ping *ping;
} outlook;

/* What a ball catches of what goes out evenly: with the pattern both ways; and with its root, which is that of one way,
 * what comes to each slice by metre of breadth, slices from its top down. */
typedef struct caught {
    double both_sr, one_per_m[SLICES];
    size_t fans;  /* those that fold count more than once */
    double way_m; /* down, of the piece before */
} caught;

/* The breadth of slice K. */
static double breadth_m(const outlook *o, size_t k) {
    double up = 2.0 * (k + 0.5) / SLICES - 1.0;
    return 2.0 * o->radius_m * sqrt(1.0 - up * up);
}

/* A ray of a fan, and how far below the ball's middle it comes. */
typedef struct blade {
    double elevation_rad, off_m;
} blade;

static blade blade_at(const outlook *o, double elevation_rad) {
    asdic_bent_ray end =
        asdic_eigenray_end(&o->way->layers, o->position_m.z, o->across_m, elevation_rad);
    return (blade){elevation_rad, end.z_m - o->position_m.z - o->apart_m.z};
}

/* Adds what comes between two blades, evenly over the heights between: over so many at least that the gain over straight
 * spreading is held as that of rays to points is. */
static void lay(const outlook *o, const blade *a, const blade *b, caught *sum) {
    double middle_m = 0.5 * (a->off_m + b->off_m), way_m = b->off_m - a->off_m;
    double elevation = 0.5 * (a->elevation_rad + b->elevation_rad);
    double level = cos(elevation) / o->across_m;
    double sent = level * (b->elevation_rad - a->elevation_rad);
    if (!(fabs(middle_m) < o->radius_m) || !(sent > 0.0)) {
        return;
    }
    asdic_vec3 u = {level * o->apart_m.x, level * o->apart_m.y, sin(elevation)};
    double pattern = asdic_aim_envelope(o->beams, o->ping->beams, u);
    double least_m = ASDIC_LEAST_SPREAD * asdic_vec3_dot(o->apart_m, o->apart_m) * sent;
    double slice_m = 2.0 * o->radius_m / SLICES, half_m = 0.5 * fmax(fabs(way_m), least_m);
    double top = fmax((middle_m - half_m + o->radius_m) / slice_m, 0.0);
    double bottom = fmin((middle_m + half_m + o->radius_m) / slice_m, SLICES);
    for (size_t k = (size_t)top; k < SLICES && (double)k < bottom; k++) {
        double share = (fmin(bottom, k + 1.0) - fmax(top, k)) * slice_m / (2.0 * half_m);
        sum->one_per_m[k] += sqrt(pattern) * sent * share;
        sum->both_sr += pattern * sent * share * breadth_m(o, k);
    }
    sum->fans += way_m * sum->way_m > 0.0 ? 0 : 1;
    sum->way_m = way_m;
}

static bool meets(const outlook *o, const blade *b) {
    return fabs(b->off_m) < o->radius_m;
}

static void lay_halves(const outlook *o, const blade *a, const blade *b, int halvings,
                       caught *sum) {
    const blade middle = blade_at(o, 0.5 * (a->elevation_rad + b->elevation_rad));
    double bend_m = fabs(middle.off_m - 0.5 * (a->off_m + b->off_m));
    if (!meets(o, a) && !meets(o, &middle) && !meets(o, b)) {
        return;
    }
    if (halvings == 0 || bend_m < STRAIGHT * 2.0 * o->radius_m / SLICES) {
        lay(o, a, &middle, sum);
        lay(o, &middle, b, sum);
    } else {
        lay_halves(o, a, &middle, halvings - 1, sum);
        lay_halves(o, &middle, b, halvings - 1, sum);
    }
}

/* Adds the fan from BEGIN_RAD to END_RAD, as far as it meets the ball. */
static void look_between(const outlook *o, double begin_rad, double end_rad, caught *sum) {
    blade a = blade_at(o, begin_rad);
    sum->way_m = 0.0;
    for (int i = 1; i <= FAN; i++) {
        const blade b = blade_at(o, begin_rad + (end_rad - begin_rad) * i / FAN);
        lay_halves(o, &a, &b, HALVINGS, sum);
        a = b;
    }
}

/* How much louder what the ball sends comes home by all rays than by a straight one; 0 where there is but one. Of rays i and
 * j with the pattern G both ways and the spreading S all pairs bring the square of the sum of sqrt(G) / S, which is a mean
 * over the ball's section; rays of a ping bring the mean of the sum of G / S times what is to be found. At caustics the
 * square of rays has no finite mean; that of what comes to slices of the section has. */
static double home_of(const outlook *o) {
    double edges[MOST_EDGES], distance_m = asdic_vec3_length(o->apart_m);
    size_t count = 0;
    for (int side = -1; side <= 1 && o->across_m > NEAREST; side += 2) {
        asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
        double to_m = o->position_m.z + o->apart_m.z + side * o->radius_m;
        size_t found = asdic_passage_rays(o->way, o->position_m.z, to_m, o->across_m, rays);
        for (size_t i = 0; i < found; i++) {
            edges[count++] = rays[i].elevation_rad;
        }
    }
    asdic_sort_doubles(edges, count);
    caught sum = {0};
    for (size_t i = 0; i + 1 < count; i++) {
        look_between(o, edges[i], edges[i + 1], &sum);
    }
    double squares = 0.0, slice_m = 2.0 * o->radius_m / SLICES;
    for (size_t k = 0; k < SLICES; k++) {
        squares += sum.one_per_m[k] * sum.one_per_m[k] * breadth_m(o, k) / slice_m;
    }
    return sum.fans > 1 && sum.both_sr > 0.0 ? squares / sum.both_sr * distance_m * distance_m
                                             : 0.0;
}

void asdic_pairs_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, const asdic_passage *way, dev_ping *ping) {
    size_t bodies[DEV_MAX_CONES];
    size_t count = way->layers.count > 1
                       ? asdic_cones_pick(parts, part_count, position_m, beams, ping, bodies)
                       : 0;
    ping->pair_count = 0;
    for (size_t i = 0; i < count; i++) {
        const asdic_part *part = &parts[bodies[i]];
        const asdic_vec3 apart_m = asdic_vec3_sub(part->center_m, position_m);
        const outlook o = {way,   position_m, apart_m, hypot(apart_m.x, apart_m.y), part->radius_m,
                           beams, ping};
        float home = (float)home_of(&o);
        if (home > 0.0f) {
            ping->pair[ping->pair_count++] = (dev_pair){(dev_uint)bodies[i], home};
        }
    }
}
