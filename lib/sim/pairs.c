#include "pairs.h"

#include "aim.h"
#include "base/sort.h"
#include "base/vec.h"
#include "cones.h"

#include <math.h>

/* Rays of a fan that meets the body between its top and its bottom; a body that is nearer than this, m, is straight above
 * or below. */
#define FAN 8
#define NEAREST 1e-3
#define MOST_EDGES (2 * ASDIC_MOST_EIGENRAYS)

typedef struct outlook {
    const asdic_passage *way;
    asdic_vec3 position_m, apart_m;
    double across_m, radius_m;
    const dev_beam *beams;
    const dev_ping *ping;
} outlook;

/* What a ball catches of what goes out evenly: with the pattern both ways, and with its root, which is that of one. */
typedef struct caught {
    double both_sr, one_sr;
    size_t fans; /* those that fold count more than once */
} caught;

/* Adds the fan from BEGIN_RAD to END_RAD, if it meets the ball. */
static void look_between(const outlook *o, double begin_rad, double end_rad, caught *sum) {
    double both = 0.0, one = 0.0, last_m = NAN, way_m = 0.0;
    size_t fans = 1;
    for (int i = 0; i < FAN; i++) {
        double elevation = begin_rad + (end_rad - begin_rad) * (i + 0.5) / FAN;
        asdic_bent_ray end =
            asdic_eigenray_end(&o->way->layers, o->position_m.z, o->across_m, elevation);
        double off_m = end.z_m - o->position_m.z - o->apart_m.z;
        if (!(fabs(off_m) < o->radius_m)) {
            return;
        }
        fans += way_m * (off_m - last_m) < 0.0 ? 1 : 0;
        way_m = i > 0 ? off_m - last_m : 0.0;
        last_m = off_m;
        double level = cos(elevation) / o->across_m;
        asdic_vec3 u = {level * o->apart_m.x, level * o->apart_m.y, sin(elevation)};
        double pattern = asdic_aim_envelope(o->beams, o->ping->beams, u);
        double breadth_m = 2.0 * sqrt(o->radius_m * o->radius_m - off_m * off_m);
        both += pattern * level * breadth_m;
        one += sqrt(pattern) * level * breadth_m;
    }
    sum->both_sr += both * (end_rad - begin_rad) / FAN;
    sum->one_sr += one * (end_rad - begin_rad) / FAN;
    sum->fans += fans;
}

/* How much louder what the ball sends comes home by all rays than by a straight one; 0 where there is but one. Of rays i and
 * j with the pattern G both ways and the spreading S all pairs bring the square of the sum of sqrt(G) / S; rays of a ping
 * bring the sum of G / S times what is to be found. The means of both sums over the ball's section are what it catches of
 * what goes out: rays have caustics, but of those no more comes in than was sent. The mean of the square, which sound has
 * and rays do not, is taken to be the square of the mean. */
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
    caught sum = {0.0, 0.0, 0};
    for (size_t i = 0; i + 1 < count; i++) {
        look_between(o, edges[i], edges[i + 1], &sum);
    }
    double section_m2 = ASDIC_PI * o->radius_m * o->radius_m;
    return sum.fans > 1 && sum.both_sr > 0.0
               ? sum.one_sr * sum.one_sr / sum.both_sr / section_m2 * distance_m * distance_m
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
