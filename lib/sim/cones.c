#include "cones.h"

#include "aim.h"
#include "base/vec.h"
#include "sonar_ray.h"

#include <math.h>
#include <string.h>

/* Bounding spheres are widened by this factor, so that every ray that meets an object could have been drawn
 * by its cone. */
#define MARGIN 1.02
/* Objects that look larger than this (sine of the half-angle) are met often enough without a cone. */
#define WIDEST 0.3
/* Share of the rays for one object, and at most for all. */
#define SHARE_ONE 0.12
#define SHARE_MOST 0.24

typedef struct candidate {
    asdic_vec3 towards; /* unit */
    double sine, score;
    size_t part;
} candidate;

static double along(const float *row, asdic_vec3 u) {
    return row[0] * u.x + row[1] * u.y + row[2] * u.z;
}

/* How loud an object may be: two-way gain times cross-section over spreading. */
static double score(const candidate *c, const dev_beam *beams, size_t receivers, double range_m) {
    double spread = c->sine / range_m;
    return asdic_aim_envelope(beams, receivers, c->towards) * spread * spread;
}

/* False if the object needs no cone, or none of it can be heard. */
static bool consider(const asdic_part *part, asdic_vec3 position_m, const dev_beam *beams,
                     const dev_ping *ping, candidate *out) {
    asdic_vec3 at = part->center_m;
    ray_way to = asdic_sonar_ray(ping, asdic_vec3_sub(at, position_m), 0.0);
    double distance = to.t;
    double radius = MARGIN * part->radius_m;
    if (part->kind != DEV_KIND_OBJECT || !(radius > 0.0) || radius > WIDEST * distance ||
        distance - radius > ping->range_m) {
        return false;
    }
    out->towards = (asdic_vec3){to.r.u.x, to.r.u.y, to.r.u.z};
    out->sine = radius / distance;
    if (ping->rear_lin <= 0.0f && along(beams[0].rows, out->towards) < -out->sine) {
        return false;
    }
    out->score = score(out, beams, ping->beams, distance);
    return true;
}

/* The loudest candidates, loudest first; of equals the first in the scene. */
static unsigned pick(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                     const dev_beam *beams, const dev_ping *ping, candidate *best) {
    unsigned count = 0;
    for (size_t i = 0; i < part_count; i++) {
        candidate c;
        if (!consider(&parts[i], position_m, beams, ping, &c)) {
            continue;
        }
        c.part = i;
        unsigned at = count < DEV_MAX_CONES ? count++ : DEV_MAX_CONES;
        while (at > 0 && c.score > best[at - 1].score) {
            if (at < DEV_MAX_CONES) {
                best[at] = best[at - 1];
            }
            at--;
        }
        if (at < DEV_MAX_CONES) {
            best[at] = c;
        }
    }
    return count;
}

unsigned asdic_cones_pick(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                          const dev_beam *beams, const dev_ping *ping, size_t *with_cone) {
    candidate best[DEV_MAX_CONES];
    unsigned count = pick(parts, part_count, position_m, beams, ping, best);
    for (unsigned c = 0; c < count; c++) {
        with_cone[c] = best[c].part;
    }
    return count;
}

/* Any two axes across the direction. */
static void fill_rows(asdic_vec3 w, float rows[9]) {
    asdic_vec3 up = fabs(w.z) < 0.9 ? (asdic_vec3){0.0, 0.0, 1.0} : (asdic_vec3){1.0, 0.0, 0.0};
    asdic_vec3 u = asdic_vec3_cross(up, w);
    u = asdic_vec3_scale(u, 1.0 / asdic_vec3_length(u));
    asdic_vec3 v = asdic_vec3_cross(w, u);
    const asdic_vec3 axes[3] = {u, v, w};
    for (int i = 0; i < 3; i++) {
        rows[3 * i] = (float)axes[i].x;
        rows[3 * i + 1] = (float)axes[i].y;
        rows[3 * i + 2] = (float)axes[i].z;
    }
}

void asdic_cones_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, dev_ping *ping) {
    candidate best[DEV_MAX_CONES];
    ping->sampling.cones = pick(parts, part_count, position_m, beams, ping, best);
    if (ping->sampling.cones == 0) {
        return;
    }
    double share = fmin(SHARE_ONE * sqrt(ping->sampling.cones), SHARE_MOST) / ping->sampling.cones;
    dev_uint each = (dev_uint)fmax(share * ping->batch.rays, 1.0);
    ping->sampling.background -= ping->sampling.cones * each;
    for (unsigned c = 0; c < ping->sampling.cones; c++) {
        dev_cone *cone = &ping->sampling.cone[c];
        double sine = best[c].sine, cosine = sqrt((1.0 - sine) * (1.0 + sine));
        fill_rows(best[c].towards, cone->rows);
        cone->cap = (float)(sine * sine / (1.0 + cosine));
        /* Its rays cover twice the half-angle of elevation, see sample_adaptive. */
        cone->splat = (float)(4.0 * 2.0 * asin(sine) / each);
        cone->first = ping->sampling.background + c * each;
        cone->count = each;
    }
}
