#include "cones.h"

#include "aim.h"
#include "base/sort.h"
#include "base/vec.h"
#include "sonar_ray.h"

#include <math.h>
#include <string.h>

/* Bounding spheres are widened by this factor, so that every ray that meets an object could have been drawn
 * by its cone. */
#define MARGIN 1.02
/* Objects that look larger than this (sine of the half-angle) are met often enough without a cone. */
#define WIDEST 0.3
/* Share of the rays for one object, and at most for all; the same again for their images. */
#define SHARE_ONE 0.12
#define SHARE_MOST 0.24

/* Rounds of the search for the way over a plane: where rays are straight the first is there. */
#define ROUNDS 8

typedef struct candidate {
    asdic_vec3 towards; /* unit */
    double sine, score;
    size_t part;
    const asdic_passage *way;
} candidate;

/* What is seen, and from where. */
typedef struct outlook {
    const asdic_part *parts;
    size_t part_count;
    asdic_vec3 position_m;
    const dev_beam *beams;
    const dev_ping *ping;
    bool layered;
} outlook;

static double along(const float *row, asdic_vec3 u) {
    return row[0] * u.x + row[1] * u.y + row[2] * u.z;
}

/* How loud an object may be: two-way gain times cross-section over spreading; nothing where it is not heard. */
static double score(const candidate *c, const outlook *o, double range_m) {
    if (o->ping->rear_lin <= 0.0f && along(o->beams[0].rows, c->towards) < -c->sine) {
        return 0.0;
    }
    double spread = c->sine / range_m;
    return asdic_aim_envelope(o->beams, o->ping->beams, c->towards) * spread * spread;
}

/* What lies in direction U, DISTANCE away. */
static candidate candidate_at(const outlook *o, triple u, double distance, double radius) {
    candidate c = {.towards = {u.x, u.y, u.z}, .sine = radius / distance};
    c.score = score(&c, o, distance);
    return c;
}

/* How much deeper or higher a way goes by metre of level distance, at its end. */
static double slope_at(const ray_way *way) {
    triple u = ray_direction(&way->r, way->t);
    return fabs(u.z) / fmax(hypot(u.x, u.y), 1e-9);
}

/* Sets the legs to and from a mirror on the way to what lies APART from the sonar; false: they are on different sides
 * of it. Sharing the level distance out as the legs' slopes demand finds where both are the same. */
static bool find_legs(const dev_ping *ping, const asdic_passage *mirror, asdic_vec3 from_m,
                      asdic_vec3 apart, ray_way legs[2]) {
    const ray_medium water = {asdic_sonar_bend(ping), 1.0};
    const triple to = {apart.x, apart.y, apart.z};
    double down = mirror->plane_m - from_m.z, rest = down - apart.z, near = down / (down + rest);
    if (!(down * rest > 0.0)) {
        return false;
    }
    for (int i = 0; i < ROUNDS; i++) {
        asdic_vec3 at = {near * apart.x, near * apart.y, down};
        legs[0] = asdic_sonar_ray(ping, at, 0.0);
        legs[1] = ray_between(to, (triple){at.x, at.y, at.z}, water, 0.0);
        double drop = near * slope_at(&legs[0]), other = (1.0 - near) * slope_at(&legs[1]);
        near = drop / fmax(drop + other, 1e-30);
    }
    return true;
}

/* PART's image in MIRROR. The louder of its echoes is that out over the mirror and straight home, or the reverse. */
static bool consider_image(const asdic_part *part, const outlook *o, const asdic_passage *mirror,
                           const candidate *direct, double radius, double distance,
                           candidate *out) {
    ray_way legs[2];
    asdic_vec3 apart = asdic_vec3_sub(part->center_m, o->position_m);
    if (!find_legs(o->ping, mirror, o->position_m, apart, legs)) {
        return false;
    }
    double detour = legs[0].t + legs[1].t, slope = slope_at(&legs[0]);
    double share =
        mirror->mirror->material.law->reflected(mirror->mirror, slope / sqrt(1.0 + slope * slope));
    if (share < DEV_MIN_MIRROR || radius > WIDEST * detour ||
        0.5 * (detour + distance) - radius > o->ping->range_m) {
        return false;
    }
    *out = candidate_at(o, legs[0].r.u, detour, radius);
    out->score = share * (2.0 * sqrt(direct->score * out->score) + share * out->score);
    return out->score > 0.0;
}

/* PART, or its image in MIRROR. False if it needs no cone, or none of it can be heard. */
static bool consider(const asdic_part *part, const outlook *o, const asdic_passage *mirror,
                     candidate *out) {
    ray_way to = asdic_sonar_ray(o->ping, asdic_vec3_sub(part->center_m, o->position_m), 0.0);
    double distance = to.t;
    double radius = MARGIN * part->radius_m;
    if (part->kind != DEV_KIND_OBJECT || !(radius > 0.0) || radius >= distance ||
        distance - radius > o->ping->range_m) {
        return false;
    }
    *out = candidate_at(o, to.r.u, distance, radius);
    const candidate direct = *out;
    return mirror ? consider_image(part, o, mirror, &direct, radius, distance, out)
                  : radius <= WIDEST * distance && direct.score > 0.0;
}

static bool is_louder(const void *a, const void *b) {
    return ((const candidate *)a)->score > ((const candidate *)b)->score;
}

/* Adds to BEST, of COUNT, what is seen by WAY, or straight without one: the loudest, loudest first; of equals the first
 * in the scene. */
static void pick(const outlook *o, const asdic_passage *way, candidate *best, size_t *count) {
    for (size_t i = 0; i < o->part_count; i++) {
        candidate c;
        if (consider(&o->parts[i], o, way && way->mirror ? way : NULL, &c)) {
            c.part = i;
            c.way = way;
            asdic_sort_keep(best, count, DEV_MAX_CONES, &c, sizeof c, is_louder);
        }
    }
}

size_t asdic_cones_pick(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                        const dev_beam *beams, const dev_ping *ping, size_t *with_cone) {
    candidate best[DEV_MAX_CONES];
    size_t count = 0;
    pick(&(outlook){parts, part_count, position_m, beams, ping, false}, NULL, best, &count);
    for (size_t c = 0; c < count; c++) {
        with_cone[c] = best[c].part;
    }
    return count;
}

/* The axis across the direction W next to WIDE, that across both, and W. */
static void fill_rows(asdic_vec3 w, asdic_vec3 wide, float rows[9]) {
    asdic_vec3 axes[3] = {[2] = w};
    axes[0] = asdic_vec3_sub(wide, asdic_vec3_scale(w, asdic_vec3_dot(wide, w)));
    axes[0] = asdic_vec3_scale(axes[0], 1.0 / asdic_vec3_length(axes[0]));
    axes[1] = asdic_vec3_cross(w, axes[0]);
    for (int i = 0; i < 3; i++) {
        rows[3 * i] = (float)axes[i].x;
        rows[3 * i + 1] = (float)axes[i].y;
        rows[3 * i + 2] = (float)axes[i].z;
    }
}

/* ---- Through layers ---- */

/* A tube of rays narrower than this share of its way is taken to be as wide. */
#define NARROWEST 0.1
/* Places that are aimed at: a part's top, its middle and its bottom, as seen straight from the sonar. */
#define LEVELS 3
#define MOST_AIMS (LEVELS * ASDIC_MOST_EIGENRAYS)
/* A bundle of more rays than these is a fan, which cones as narrow as the part share: one as high as the fan would be as
 * wide, and miss with most of its rays. */
#define FEW_AIMS (LEVELS * 6)
#define MOST_PIECES 16.0

/* A ray to a level of a part: PAD more of elevation would miss it by the part's radius. */
typedef struct aim {
    double elevation_rad, pad_rad;
    unsigned level; /* a bit each */
} aim;

static bool is_higher(const void *a, const void *b) {
    return ((const aim *)a)->elevation_rad < ((const aim *)b)->elevation_rad;
}

#define MIDDLE 2u
#define ALL_LEVELS 7u

/* The rays to PART, ACROSS_M away, by WAY, by elevation; returns how many. */
static size_t find_aims(const outlook *o, const asdic_passage *way, const asdic_part *part,
                        double across_m, aim aims[MOST_AIMS]) {
    double radius = MARGIN * part->radius_m, from_m = o->position_m.z;
    double middle_m = asdic_passage_depth_m(way, part->center_m.z), down = middle_m - from_m;
    double scale = radius / fmax(hypot(across_m, down), radius);
    size_t count = 0;
    for (int level = 0; level < LEVELS; level++) {
        double to_m = middle_m + (level - 1) * scale * across_m;
        double there_m = fmax(across_m - (level - 1) * scale * down, 0.0);
        asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
        size_t ray_count = asdic_passage_rays(way, from_m, to_m, there_m, rays);
        for (size_t i = 0; i < ray_count; i++) {
            const asdic_bent_ray *end = &rays[i].end;
            double width = fmax(fabs(end->width_m), NARROWEST * end->length_m);
            const aim a = {rays[i].elevation_rad, radius / width, 1u << level};
            asdic_sort_keep(aims, &count, MOST_AIMS, &a, sizeof a, is_higher);
        }
    }
    return count;
}

/* Elevations from the middle of a cone to its edge, how many aims, and how strongly their rays are focused. */
typedef struct bundle {
    double middle_rad, half_rad, focus;
    size_t aims;
} bundle;

static bool is_brighter(const void *a, const void *b) {
    return ((const bundle *)a)->focus > ((const bundle *)b)->focus;
}

static bool leaves_higher(const void *a, const void *b) {
    return ((const bundle *)a)->middle_rad < ((const bundle *)b)->middle_rad;
}

/* Takes the first of *COUNT AIMS that are one bundle off them. What is seen only in part may be seen up to the next
 * level: at the edge of a shadow the ray to that is missing. */
static bundle take_bundle(const aim **aims, size_t *count) {
    const aim *first = *aims, *last = first, *end = first + *count;
    double middle = first->elevation_rad, focus = first->pad_rad;
    unsigned levels = first->level;
    while (last + 1 < end &&
           last[1].elevation_rad - last->elevation_rad < 2.0 * (last[1].pad_rad + last->pad_rad)) {
        last++;
        levels |= last->level;
        focus += last->pad_rad;
        middle = last->level == MIDDLE ? last->elevation_rad : middle;
    }
    *aims = last + 1;
    *count = (size_t)(end - *aims);
    double pad = levels == ALL_LEVELS ? 0.0 : 1.0;
    double least = first->elevation_rad - pad * first->pad_rad;
    double most = last->elevation_rad + pad * last->pad_rad;
    middle = levels == ALL_LEVELS && last - first + 1 == LEVELS ? middle : 0.5 * (least + most);
    return (bundle){middle, fmin(fmax(most - middle, middle - least), 0.5 * ASDIC_PI), focus,
                    (size_t)(last - first + 1)};
}

/* What is seen of BEST by the rays of a bundle. */
static candidate seen_by(const outlook *o, const candidate *best, const bundle *b) {
    const asdic_part *part = &o->parts[best->part];
    double x = part->center_m.x - o->position_m.x, y = part->center_m.y - o->position_m.y;
    double level = cos(b->middle_rad) / fmax(hypot(x, y), 1e-9);
    candidate c = *best;
    c.sine = fmax(sin(b->half_rad), best->sine);
    c.towards = (asdic_vec3){level * x, level * y, sin(b->middle_rad)};
    c.score = score(&c, o, MARGIN * part->radius_m / best->sine);
    return c;
}

/* The cones of a bundle, of which there is room for ROOM, to BRIGHT, of COUNT. */
static void keep_bright(const outlook *o, const candidate *best, const bundle *b, bundle *bright,
                        size_t *count, size_t room) {
    bool is_fan = b->aims > FEW_AIMS;
    double pieces = is_fan ? fmin(ceil(sin(b->half_rad) / best->sine), MOST_PIECES) : 1.0;
    for (double k = 0.5; k < pieces; k++) {
        double half = b->half_rad / pieces, middle = b->middle_rad + (2.0 * k - pieces) * half;
        bundle piece = {middle, pieces > 1.0 ? hypot(half, best->sine) : half, b->focus / pieces,
                        b->aims};
        candidate c = seen_by(o, best, &piece);
        if (c.sine <= WIDEST && c.score > 0.0) {
            asdic_sort_keep(bright, count, room, &piece, sizeof piece, is_brighter);
        }
    }
}

/* Adds to OUT, of COUNT and at most MOST, what is seen of BEST by the rays that come to it: by the brightest bundles that
 * there is room for, upper ones first. */
static void follow(const outlook *o, const candidate *best, size_t most, candidate *out,
                   size_t *count) {
    const asdic_part *part = &o->parts[best->part];
    double across = hypot(part->center_m.x - o->position_m.x, part->center_m.y - o->position_m.y);
    aim found[MOST_AIMS];
    const aim *aims = found;
    size_t aim_count = find_aims(o, best->way, part, across, found);
    bundle bright[DEV_MAX_BUNDLES], ordered[DEV_MAX_BUNDLES];
    size_t room = most - *count, kept = 0, placed = 0;
    while (aim_count > 0 && room > 0) {
        const bundle b = take_bundle(&aims, &aim_count);
        keep_bright(o, best, &b, bright, &kept, room);
    }
    for (size_t i = 0; i < kept; i++) {
        asdic_sort_keep(ordered, &placed, kept, &bright[i], sizeof *bright, leaves_higher);
    }
    for (size_t i = 0; i < placed; i++) {
        out[(*count)++] = seen_by(o, best, &ordered[i]);
    }
}

/* ---- Rays ---- */

void asdic_cones_add(dev_ping *ping, asdic_vec3 towards, asdic_vec3 wide, double narrow,
                     dev_uint rays) {
    dev_cone *cone = &ping->sampling.cone[ping->sampling.cones++];
    double half_rad = asin(asdic_vec3_length(wide));
    fill_rows(towards, wide, cone->rows);
    cone->chord[0] = (float)(2.0 * sin(0.5 * half_rad));
    cone->chord[1] = (float)(2.0 * sin(0.5 * asin(narrow)));
    /* Its rays cover twice the half-angle of elevation, see sample_adaptive. */
    cone->splat = (float)(4.0 * 2.0 * half_rad / rays);
    cone->first = ping->sampling.background -= rays;
    cone->count = rays;
}

/* Gives each of COUNT candidates its cone, with rays that the background has had. */
static void place(const outlook *o, const candidate *best, size_t count, size_t most,
                  dev_ping *ping) {
    candidate seen[DEV_MAX_BUNDLES];
    if (o->layered) {
        size_t seen_count = 0;
        for (size_t c = 0; c < count; c++) {
            follow(o, &best[c], most, seen, &seen_count);
        }
        best = seen;
        count = seen_count;
    }
    double share = fmin(SHARE_ONE * sqrt((double)count), SHARE_MOST) / fmax((double)count, 1.0);
    dev_uint each = (dev_uint)fmax(share * ping->batch.rays, 1.0);
    for (size_t c = 0; c < count; c++) {
        asdic_vec3 axes[2];
        asdic_vec3_across(best[c].towards, axes);
        asdic_cones_add(ping, best[c].towards, asdic_vec3_scale(axes[0], best[c].sine),
                        best[c].sine, each);
    }
}

void asdic_cones_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, const asdic_passage *ways, size_t way_count,
                       dev_ping *ping) {
    bool layered = way_count > 0 && ways[0].layers.count > 1;
    const outlook o = {parts, part_count, position_m, beams, ping, layered};
    candidate best[DEV_MAX_CONES] = {0};
    size_t count = 0;
    ping->sampling.cones = 0;
    pick(&o, ways, best, &count);
    place(&o, best, count, DEV_MAX_BUNDLES, ping);
    count = 0;
    for (size_t w = 1; w < way_count; w++) {
        pick(&o, &ways[w], best, &count);
    }
    place(&o, best, count, DEV_MAX_CONES, ping);
}
